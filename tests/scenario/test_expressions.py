"""Expressions: arithmetic works, nothing else does."""

import contextlib
import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from doseki.scenario.values.expressions import (
    SCALAR_FUNCTIONS,
    ExpressionError,
    evaluate,
    evaluate_at,
    names_in,
)

NAMES = {"a": 2, "b": 0.5, "word": "single"}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("= 1 + 2*3", 7),
        ("= a/b", 4.0),
        ("=2**0.5", math.sqrt(2)),
        ("= sqrt(pi)", math.sqrt(math.pi)),
        ("= round(2.6)", 3),
        ("= round(1.234, 4/2)", 1.23),
        ("= ceil(2.1) - floor(2.9)", 1),
        ("= max(a, b, 1)", 2),
        ("= log(exp(a))", 2),
        ("= log10(1000)", 3),
        ("= sinh(a)/cosh(a) - tanh(a)", 0),
        ("= cosh(a)**2 - sinh(a)**2", 1),
        ("= 'one' if a == 2 and not b > 1 else 'many'", "one"),
        ("= word", "single"),
        ("= 1 if 0 < a < 3 else 0", 1),
    ],
)
def test_value(text, value):
    assert evaluate(text, NAMES) == pytest.approx(value)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("= 1/0", "divides by zero"),
        ("= c", "unknown name c"),
        ("= aa", "did you mean a?"),
        ("= open('x')", "calls open"),
        ("= (1).real", "has a dot before a name"),
        ("= [1][0]", "has square brackets after a value"),
        ("= [1, 2]", "has a list"),
        ("= 1,5", "has a comma outside a call"),
        ("= 'x'*1000000000", "arithmetic needs numbers"),
        ("= 'x' < 1", "a comparison needs numbers"),
        ("= sqrt('x')", "sqrt needs numbers"),
        ("= f'{a}'", "has a string with braces"),
        ("= lambda: 1", "has `lambda`"),
        ("= [i for i in a]", "has what is no arithmetic"),
        ("= a^3", "has ^: a power is written **"),
        ("= a & b", "has &: of two conditions that both hold write `and`"),
        ("= a | b", "has |: of two conditions of which one holds write `or`"),
        ("= ~a", "has ~: write `not`"),
        ("= a << 2", "has <<: write a product with a power"),
        ("= a is b", "has `is`: write =="),
        ("= a in b", "has `in`: compare with =="),
        ("= 2j", "has 2j, which is no number"),
        ("= None", "has None, which is no number"),
        ("= ln(2)", "calls ln, which is not one of sqrt"),
        ("= a(2)", "a product is written *"),
        ("= 2(a)", "a product is written *"),
        ("= 2a", "a product is written *"),
        ("= log(8, 2)", "gives log 2 values: it takes 1"),
        ("= log(0)", "log(0) is no finite number"),
        ("= cosh(1000)", "cosh(1000) is no finite number"),
        ("= sin(1, 2)", "gives sin 2 values: it takes 1"),
        ("= max(1)", "gives max 1 value: it takes 2 or more"),
        ("= round()", "gives round no values: it takes 1 or 2"),
        ("= max(1, key=2)", "gives max an argument with ="),
        ("= sin", "has sin without values: write sin(...)"),
        ("= !a", "it has !: write `not`"),
        ("= a && b", "it has &&: of two conditions that both hold write `and`"),
        ("= a ? 1 : 2", "a choice is written `a if condition else b`"),
        ("= 1 if a", "it has `if` without `else`"),
        ("= a = 2", "whether two are equal is written =="),
        ("= exp(1000)", "exp(1000) is no finite number"),
        ("= " + "9" * 400 + "/2", "has numbers that are too large"),
        ("= (1 and 2", "a parenthesis is not closed"),
        ("= (2 if a else 3", "a parenthesis is not closed"),
        ("= a)", "a parenthesis is not opened"),
        ("= 2exp(1)", "a product is written *"),
        ("= round(1.234, 1.5)", "the second value of round, how many digits, is not whole"),
        ("= 1 +", "not a valid expression"),
        ("= ", "not a valid expression"),
        ("= sqrt(-1)", "sqrt(-1) is no finite number"),
        ("= " + "1+" * 400 + "1", "500 characters"),
    ],
)
def test_refusal(text, complaint):
    with pytest.raises(ExpressionError, match=re.escape(complaint)) as said:
        evaluate(text, NAMES)
    assert not re.search("ast|object|__|instance", str(said.value))


@pytest.mark.parametrize(
    "text", ["2 if a else", "3 and", "5 in", "3 or (1)(", "0x1G", "1E5 +", "'2a(' 1"]
)
def test_a_product_is_named_only_where_one_is_missing(text):
    with pytest.raises(ExpressionError) as said:
        evaluate(f"= {text}", NAMES)
    assert "product" not in str(said.value)


@pytest.mark.parametrize(
    "text",
    [
        "1 if x > 0 else 2",
        "0 < x < 1",
        "x > 0 and y > 0",
        "x > 0 or y > 0",
        "not x",
        "(x > 0) & (y > 0)",
        "(x > 0) | (y > 0)",
        "~(x > 0)",
    ],
)
def test_what_differs_from_place_to_place_is_not_chosen(text):
    """A condition is one number at each place, which may be a factor."""
    position = np.array([[-1.0, 0.0], [1.0, 0.0]])
    with pytest.raises(
        ExpressionError, match=r"multiply by conditions, as in \(x > 0\)\*2"
    ) as said:
        evaluate_at(f"= {text}", {}, position)
    joined = "a product for both, max(...) for one of them, 1 - (...) for not"
    assert joined in str(said.value)
    np.testing.assert_array_equal(evaluate_at("= (x > 0)*2 + (x <= 0)*3", {}, position), [3, 2])


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("(x > 0) * (y > 0)", [0, 0, 1]),
        ("max(x > 0, y > 0)", [0, 1, 1]),
        ("1 - (x > 0)", [1, 0, 0]),
        ("(x > 0) - (y >= 0)", [-1, 1, 0]),
        ("-(x > 0)", [0, -1, -1]),
        ("+(x != 0)", [1, 1, 1]),
        ("(x == 2) + (y == 1)", [0, 1, 2]),
        ("(max(a, 1) > 0)*x", [-1, 2, 2]),
        ("(sqrt(a) > 0)*3", [3, 3, 3]),
        ("(floor(a) == 2)*x", [-1, 2, 2]),
        ("-(sqrt(a) != 0) if floor(a) > 0 and not sqrt(a) < 0 else 5", [-1, -1, -1]),
    ],
)
def test_conditions_are_numbers_at_each_place(text, values):
    position = np.array([[-1.0, 0.0], [2.0, -1.0], [2.0, 1.0]])
    np.testing.assert_array_equal(evaluate_at(f"= {text}", NAMES, position), values)


def test_powers_do_not_grow_into_huge_integers():
    assert evaluate("= 9**9**9", {}) == math.inf


def test_field_of_position():
    position = np.array([[0.0, 0.0], [1.0, 0.25]])
    values = evaluate_at("= a*sin(2*pi*y)", NAMES, position)
    np.testing.assert_allclose(values, [0.0, 2.0])
    np.testing.assert_array_equal(evaluate_at("= max(x, 0.5)", {}, position), [0.5, 1.0])
    kept = position.copy()
    np.testing.assert_array_equal(
        evaluate_at("= min(x + 1, 5, y - 9)", {}, position), kept[:, 1] - 9
    )
    np.testing.assert_array_equal(
        evaluate_at("= max(x, y, x*0 - 2)", {}, position), kept.max(axis=1)
    )
    for text in ("= sin(x, y)", "= min(x)", "= sqrt(x, y)"):
        with pytest.raises(ExpressionError):
            evaluate_at(text, {}, position)
    np.testing.assert_array_equal(position, kept)


@pytest.mark.parametrize("name", ["log", "log10", "sinh", "cosh", "tanh"])
def test_functions_are_those_of_numpy_at_each_position(name):
    position = np.array([[0.5, 1.0], [2.0, 3.0]])
    values = evaluate_at(f"= {name}(x)", {}, position)
    np.testing.assert_array_equal(values, getattr(np, name)(position[:, 0]))


def test_the_page_of_scenarios_names_every_function():
    page = (Path(__file__).parents[2] / "docs" / "scenarios.md").read_text()
    (listed,) = re.findall(r"and these functions: (.*?)\n\n", page, re.DOTALL)
    assert set(SCALAR_FUNCTIONS) <= set(re.findall(r"`(\w+)`", listed))


@pytest.mark.parametrize("text", ["= log(x)", "= 1/x", "= z", "= 'word'", "= x.tofile('leak')"])
def test_field_refusal(text):
    with pytest.raises(ExpressionError):
        evaluate_at(text, {}, np.zeros((3, 2)))


def test_names_are_found():
    assert names_in("= a*sin(x) + 1") == {"a", "sin", "x"}


@settings(max_examples=50)
@given(st.text(max_size=30))
def test_any_text_is_a_value_or_an_expression_error(text):
    with contextlib.suppress(ExpressionError):
        evaluate(f"={text}", NAMES)
