"""Movies of a run: GIF always, MP4 where the program ffmpeg is there."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from matplotlib.colors import to_rgb
from PIL import Image
from scipy.spatial import cKDTree

from ..errors import UserError
from ..measure.views import View, named_window, tilt, whole_space
from ..record.reader import Run, Snapshot
from ..util.files import clear_errors, write_whole
from .colouring import colouring
from .dots import dots, extent_of, picture
from .layout import time_text
from .nothing import NothingToDrawError
from .space.box import balls_of, seen_extent
from .space.ground import ground_behind, space_of
from .space.surfaces import Camera, render
from .space.way import Way
from .stage import WIDTH, Stage
from .text import plain_text

SIDEWAYS = np.array([0.0, 1.0, 0.0])  # away from the viewer
QUALITY = 60  # of 100, of a .webp
SAMPLES = 20  # snapshots looked at to choose the limits of the picture and of the colours
SHADES, SEEN = 256, 6  # colours of a .gif, frames that they are chosen from


def make_movie(
    run: Run,
    path: str | Path,
    colour: str = "material",
    window: str | None = None,
    frames_per_second: int = 20,
    width: int = WIDTH,
) -> Path:
    """Write every snapshot as one frame into `path`, which ends in .gif, .webp or .mp4.

    `colour` names a quantity (see quantities.py), `window` a window of the scenario (default:
    everything, gravity pointing down), `width` the pixels of what is shown.  3-D runs are seen
    from the side, those on a terrain from where they go to, as shaded surfaces behind translucent
    water.  Raises UserError for another
    ending, a file that exists, an unknown colour or window, and an .mp4 without ffmpeg.
    """
    path = Path(path)
    check_movie(path)
    encode = ENCODERS[path.suffix.lower()]
    if not len(run):
        raise UserError(f"{run.directory}: the run has no snapshot to show")
    with plain_text():
        try:
            camera = _Camera(run, colour, window, width)
        except NothingToDrawError as reason:
            raise UserError(f"{run.directory}: no movie: {reason}") from None
    with clear_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, lambda temporary: encode(temporary, camera, frames_per_second))
    return path


def check_movie(path: Path) -> None:
    """Raise UserError where no movie can be written, before anything is drawn."""
    if path.suffix.lower() not in ENCODERS:
        raise UserError(f"{path}: a movie is a .gif, a .webp or an .mp4")
    if path.exists():
        raise UserError(f"{path}: exists and is not overwritten")


class _Camera:
    """Turns snapshots into frames that all have the same limits and colours."""

    def __init__(self, run: Run, colour: str, window: str | None, width: int = WIDTH) -> None:
        self._run, self._width = run, width
        self._view = self._choose_view(window)
        step = max(1, len(run) // SAMPLES)
        samples = [*run[::step], run[-1]]
        self._side: Camera | None = None
        if run.scenario["dim"] == 3:
            self._space = space_of(run, samples, self._view)
            way = None if self._space.buried is None else Way.between(samples)
            self._side = Camera.looking(SIDEWAYS) if way is None else way.looking_back()
            self._extent = seen_extent(self._space, samples, self._side)
            self._behind = ground_behind(run, self._space, self._side, self._extent, width)
        else:
            self._extent = extent_of(samples, self._view)
        self._colours = colouring(run, samples, colour, self._view)
        slanting = self._side is not None and self._side.away[2] != 0.0
        self.stage = Stage(run, self._view, self._extent, self._colours, width, not slanting)

    def _choose_view(self, window: str | None) -> View:
        if window is not None:
            return named_window(self._run, window)
        return whole_space(self._run.scenario["dim"], rotate=-tilt(self._run))

    def frames(self) -> Iterator[Image.Image]:
        """One picture for each snapshot."""
        return (self._frame(snapshot) for snapshot in self._run)

    def palette(self) -> np.ndarray:
        """Shades (SHADES, 3) uint8 for all frames, the colours of the key among them."""
        count = len(self._run)
        seen = np.unique(np.linspace(0, count - 1, min(SEEN, count)).round().astype(int))
        key = [to_rgb(colour) for _, colour in self._colours.legend_entries()]
        kept = np.round(255 * np.array([(1.0, 1.0, 1.0), (0.0, 0.0, 0.0), *key])).astype(np.uint8)
        return _palette([self._frame(self._run[int(index)]) for index in seen], kept)

    def _frame(self, snapshot: Snapshot) -> Image.Image:
        pixels = self._pixels(snapshot)
        return self.stage.frame(pixels, time_text(snapshot.time, self._run.times[-1]))

    def _pixels(self, snapshot: Snapshot) -> np.ndarray:
        if self._side is not None:
            balls = balls_of(self._run, snapshot, self._colours, self._space, self._side)
            return render(balls, self._side, self._extent, self._width, self._behind)
        shown = dots(snapshot, self._view)
        rgba = self._colours.rgba(snapshot)[shown.index]
        return picture(shown, rgba, self._extent, self._width)


def _palette(frames: Sequence[Image.Image], kept: np.ndarray) -> np.ndarray:
    """Shades (SHADES, 3): the colours `kept` (n, 3), and what comes nearest to those of the frames.

    The root of how often a colour is there counts, or a wide background would take all shades.
    """
    codes = np.concatenate([_codes(frame).ravel() for frame in frames])
    colours, count = np.unique(codes, return_counts=True)
    weighed = np.repeat(_rgb(colours), np.sqrt(count).astype(int), axis=0)
    small = Image.fromarray(weighed[None]).quantize(SHADES - len(kept))
    found = np.array(small.getpalette(), dtype=np.uint8).reshape(-1, 3)
    return np.resize(np.concatenate([kept, found])[:SHADES], (SHADES, 3))


def _in_palette(frame: Image.Image, palette: np.ndarray) -> Image.Image:
    """A frame in the nearest of the shades; Pillow looks them up too coarsely to keep a colour."""
    codes, pixel = np.unique(_codes(frame), return_inverse=True)
    _, nearest = cKDTree(palette).query(_rgb(codes))
    image = Image.fromarray(nearest.astype(np.uint8)[pixel].reshape(frame.height, frame.width))
    image.putpalette(palette.tobytes())
    return image


def _codes(frame: Image.Image) -> np.ndarray:
    """The colour of each pixel (rows, columns) as one number."""
    red, green, blue = np.moveaxis(np.asarray(frame).astype(np.int32), -1, 0)
    return red << 16 | green << 8 | blue


def _rgb(codes: np.ndarray) -> np.ndarray:
    return np.stack([codes >> 16, codes >> 8 & 255, codes & 255], axis=-1).astype(np.uint8)


def _encode_gif(path: Path, camera: _Camera, frames_per_second: int) -> None:
    palette = camera.palette()
    small = (_in_palette(frame, palette) for frame in camera.frames())
    first = next(small)
    first.save(
        path, format="GIF", save_all=True, append_images=small, loop=0,
        duration=round(1000 / frames_per_second),
    )  # fmt: skip


def _encode_webp(path: Path, camera: _Camera, frames_per_second: int) -> None:
    frames = camera.frames()
    first = next(frames)
    first.save(
        path, format="WEBP", save_all=True, append_images=frames, loop=0, quality=QUALITY,
        duration=round(1000 / frames_per_second),
    )  # fmt: skip


def _encode_mp4(path: Path, camera: _Camera, frames_per_second: int) -> None:
    program = shutil.which("ffmpeg")
    if program is None:
        raise UserError("an .mp4 needs the program ffmpeg, which is not installed; a .gif does not")
    frames = camera.frames()
    first = next(frames)
    command = [
        program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
        "-s", f"{first.width}x{first.height}", "-r", str(frames_per_second), "-i", "-",
        "-pix_fmt", "yuv420p", "-f", "mp4", str(path),
    ]  # fmt: skip
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
        assert encoder.stdin is not None
        encoder.stdin.write(first.tobytes())
        for frame in frames:
            encoder.stdin.write(frame.tobytes())
        _, message = encoder.communicate()
    if encoder.returncode:
        raise UserError(f"{path}: ffmpeg failed: {message.decode().strip()}")


ENCODERS = {".gif": _encode_gif, ".webp": _encode_webp, ".mp4": _encode_mp4}
