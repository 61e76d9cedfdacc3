"""What an expression may be written with, and what to write in place of the rest."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator

ALLOWED = (
    ast.Constant,
    ast.Name,
    ast.UnaryOp,
    ast.BinOp,
    ast.BoolOp,
    ast.Compare,
    ast.IfExp,
    ast.Call,
    ast.expr_context,
)
OPERATORS = {
    ast.BitXor: "^: a power is written **, as in 2**3",
    ast.BitAnd: "&: of two conditions that both hold write `and`",
    ast.BitOr: "|: of two conditions of which one holds write `or`",
    ast.Invert: "~: write `not`",
    ast.LShift: "<<: write a product with a power, as in 4*2**3",
    ast.RShift: ">>: write a quotient with a power, as in 4/2**3",
    ast.MatMult: "@: a product is written *",
    ast.Is: "`is`: write ==",
    ast.IsNot: "`is not`: write !=",
    ast.In: "`in`: compare with == and join with `or`",
    ast.NotIn: "`not in`: compare with != and join with `and`",
}
OTHERS = {
    ast.Attribute: "a dot before a name, which means nothing here",
    ast.Subscript: "square brackets after a value, which mean nothing here",
    ast.List: "a list: an expression is one number, so write one for each element",
    ast.Tuple: "a comma outside a call: an expression is one number, with a decimal point",
    ast.JoinedStr: "a string with braces, which means nothing here",
    ast.NamedExpr: ":=, which means nothing here: name a number under [parameters]",
    ast.Starred: "* before a single value: a product has two",
    ast.Lambda: "`lambda`: only the functions that are there can be called",
}
TYPED = {  # what is no Python, in the order in which it is looked for
    "&&": "of two conditions that both hold write `and`",
    "||": "of two conditions of which one holds write `or`",
    "?": "a choice is written `a if condition else b`",
    "!": "write `not`, and != for unequal",
}
KEYWORDS = "if|else|and|or|not|in|is"
# A number before a name, but no base (0x1), no exponent (1e5) and no word of the language.
PRODUCT = re.compile(
    rf"(?<![\w.])(?!0[xX][\da-fA-F]|0[oObB]\d)[\d.]+(?![eE][-+]?\d)\s*"
    rf"(?!(?:{KEYWORDS})\b)[A-Za-z_]"
)
ARGUMENTS = {"round": (1, 2), "min": (2, None), "max": (2, None)}  # least and most; others: 1


def complaint(tree: ast.Expression, functions: Collection[str]) -> str | None:
    """What an expression may not have, in words; None where it may have all of it."""
    nodes = list(ast.walk(tree.body))
    called = {id(node.func) for node in nodes if isinstance(node, ast.Call)}
    for node in nodes:
        if isinstance(node, ast.Name) and node.id in functions and id(node) not in called:
            return f"has {node.id} without values: write {node.id}(...)"
    return next((said for node in nodes for said in _of(node, functions)), None)


def advice(source: str) -> str:
    """What to write in place of what cannot be read at all; "" where nothing is known."""
    bare = re.sub("'[^']*'|\"[^\"]*\"|[!=<>]=", "", source)
    if bare.count("(") != bare.count(")"):
        state = "closed" if bare.count("(") > bare.count(")") else "opened"
        return f": a parenthesis is not {state}"
    for typed, hint in TYPED.items():
        if typed in bare:
            return f": it has {typed}: {hint}"
    words = bare.split()
    if "=" in bare:
        return ": it has = once more: whether two are equal is written =="
    if "if" in words and "else" not in words:
        return ": it has `if` without `else`: write `a if condition else b`"
    if PRODUCT.search(bare):
        return ": a product is written *"
    return ""


def depends_on(tree: ast.Expression, names: Collection[str]) -> bool:
    """Whether it chooses by, or joins, conditions that depend on one of the names."""
    chosen = [part for node in ast.walk(tree) for part in _conditions(node)]
    return any(
        isinstance(node, ast.Name) and node.id in names
        for part in chosen
        for node in ast.walk(part)
    )


def _conditions(node: ast.AST) -> Iterator[ast.AST]:
    match node:
        case ast.IfExp():
            yield node.test
        case ast.BoolOp() | ast.UnaryOp(op=ast.Not() | ast.Invert()):
            yield node
        case ast.BinOp(op=ast.BitAnd() | ast.BitOr()):
            yield node
        case ast.Compare() if len(node.ops) > 1:
            yield node


def _of(node: ast.AST, functions: Collection[str]) -> Iterator[str]:
    """What is wrong with one part of an expression."""
    if isinstance(node, ast.operator | ast.unaryop | ast.cmpop | ast.boolop):
        if type(node) in OPERATORS:
            yield f"has {OPERATORS[type(node)]}"
    elif isinstance(node, ast.Constant):
        if not isinstance(node.value, bool | int | float | str):
            yield f"has {ast.unparse(node)}, which is no number"
    elif isinstance(node, ast.Call):
        yield from _of_call(node, functions)
    elif not isinstance(node, ALLOWED):
        yield f"has {OTHERS.get(type(node), 'what is no arithmetic: ' + ast.unparse(node)[:60])}"


def _of_call(call: ast.Call, functions: Collection[str]) -> Iterator[str]:
    if not isinstance(call.func, ast.Name):
        if not isinstance(call.func, ast.Attribute):
            yield "has a value before a parenthesis: a product is written *"
        return
    name = call.func.id
    if name not in functions:
        yield f"calls {name}, which is not one of {', '.join(functions)}; a product is written *"
    if call.keywords:
        yield f"gives {name} an argument with =: write values alone"
    least, most = ARGUMENTS.get(name, (1, 1))
    given = len(call.args)
    if given < least or (most is not None and given > most):
        values = "value" if given == 1 else "values"
        yield f"gives {name} {given or 'no'} {values}: it takes {_taken(least, most)}"


def _taken(least: int, most: int | None) -> str:
    if most is None:
        return f"{least} or more"
    return f"{least}" if least == most else f"{least} or {most}"
