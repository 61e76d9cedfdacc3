"""The reference of what a snapshot holds, from the declarations of its fields."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from doseki.record.fields import FIELDS, GRAIN_FIELDS, ParticleField
from doseki.record.quantities import quantity_label, quantity_names

from .markup import code, prose, sentence, table

SHAPES = {"scalar": "(N,)", "vector": "(N, dim)", "symmetric": "(N, 3, 3)"}


def field_pages() -> Iterator[tuple[str, str]]:
    """The page of fields."""
    particles, grains = _rows(FIELDS), _rows(GRAIN_FIELDS)
    header = ("In Python", "In files", "Shape", "Unit", "Type", "Meaning")
    yield (
        "reference/fields.md",
        TEXT.format(
            particles=table(header, particles, "keys scenario-fields"),
            grains=table(header, grains, "keys scenario-fields"),
            quantities=table(("Name", "Unit"), _quantities()),
        ),
    )


def _rows(fields: Iterable[ParticleField]) -> Iterator[tuple[str, ...]]:
    for field in fields:
        units = dict.fromkeys((field.unit_in(3), field.unit_in(2)))
        unit = "; 2-D: ".join(units)
        shape = SHAPES.get(field.shape) or f"(N, {field.width})"
        kind = "text" if field.key in ("material", "body") else str(field.dtype)
        meaning = sentence(prose(field.doc))
        yield code(field.key), code(field.file_name), shape, unit, kind, meaning


def _quantities() -> Iterator[tuple[str, str]]:
    for name in quantity_names(3):
        yield code(name), quantity_label(name, 3).partition(" (")[2].rstrip(")")


TEXT = """\
# Every field of a snapshot

A snapshot is one file of `DIR/snapshots`: what all particles were at one moment. Read it in Python with
`snapshot = doseki.load("DIR").at(1.5)` and a name of the first column, `snapshot["velocity"]`; programs such as ParaView show the
name of the second column. *N* is the number of particles at that moment, *dim* is 2 or 3. This page is made from the code;
[How to read results](../how-to/read-results.md) shows how to use it.

In files vectors always have three components, and tensors six: XX, YY, ZZ, XY, YZ, XZ. `material` and `body` are names in
Python and indices in files. `fixed` (true where `motion` is 1) is there in Python alone. In 2-D masses are per metre of width.

{particles}

## Bodies that move

`snapshot.grains` holds one row for each rigid or deformable body (in files the group `/Grains`); it is empty where none moves. The
field `grain` of a particle is the row of its body, so `snapshot.grains["position"][snapshot["grain"]]` is the centre of the body
that a particle belongs to (take particles with `grain` from 0 on).

{grains}

## What figures and movies can be coloured by

`colour` of a figure and `--colour` of a movie take these names; a 2-D run has no components along z of vectors.

{quantities}
"""
