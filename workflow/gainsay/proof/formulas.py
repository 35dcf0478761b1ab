"""The formula language of certificates: a small, safe expression language over exact rationals, balls and polynomials.

A formula is one Python expression in ASCII, parsed by `ast` and never run as Python. Every literal is exact ("0.1" is
1/10). Numbers are matrices of shape (1, 1). A name stands for one thing: constants and functions are never redefined.

==============================  =====================================================================
``A + B``, ``A - B``, ``-A``    entrywise, equal shapes
``a * B``, ``B / a``            a number; matrices multiply with ``@``
``A @ B``, ``A.T``, ``A ** 2``  product, transpose, power (a literal integer, at most 64)
``[[A, B], [..., 0]]``          block matrix: ``0`` fills a block of any size, ``...`` is the transpose of the
                                mirrored block (the star of the papers)
``A[0:3, 1]``                   entry, row, column or block, counted from 0; a slice keeps rows and columns
``number('mass')``              entry of the parameter table, exact, in SI
``printed('L')``                matrix as printed, exact
``box('L')``                    every matrix that rounds to the printed digits, as balls
``design('repaired', 'K')``     matrix of a design of ours, the binary numbers as they are
``interval(0.9, 1.1)``          every number between, as a ball
``plausible('mass')``           every plausible value of what the paper leaves out, as a ball, in SI
``ends('mass')``                row of the least and the greatest plausible value, exact, in SI
``eye(n)``, ``zeros(m, n)``     identity, zero
``diag(a, B, ...)``             block diagonal
``block([[...]])``, ``col(a, b)``, ``row(a, b)``  block matrix, column, row
``take(A, [0, 2], [0, 2])``     rows and columns by number
``sym(A)``, ``trace(A)``, ``inverse(A)``, ``kron(A, B)``, ``unit(n, i)``
``sqrt(a)``, ``pi``             balls; the root of a rational square is exact
``sin``, ``cos``, ``exp``, ``log``  balls, entrywise
==============================  =====================================================================

A constraint is two formulas joined by one of ``< <= == >= >``; between symmetric matrices the order is that of
quadratic forms.
"""

import ast
import keyword
import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from math import isqrt
from typing import Any, Protocol

from flint import arb, fmpq

from gainsay.errors import CertificateError
from gainsay.exact.ball import hull
from gainsay.exact.blocks import block, diagonal, kron
from gainsay.exact.budget import spend
from gainsay.exact.matrix import Matrix, RingError, eye, zeros
from gainsay.exact.rational import exact
from gainsay.proof.syntax import (
    KEPT,
    OPERATORS,
    compared,
    count_text,
    integers,
    is_star,
    literal_integer,
    one_line,
    parse,
    quote,
    subscripts,
    tree_of,
)

__all__ = ["Source", "check_name", "constraint", "ends_in", "evaluate", "names_in", "parameter_of"]

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,63}", re.ASCII)
_CONSTANTS = ("pi",)
_LARGEST_POWER = 64


class Source(Protocol):
    """Where formulas read table entries from."""

    def number(self, name: str) -> Matrix:
        """Parameter in SI."""

    def plausible(self, name: str) -> Matrix:
        """Every plausible value of a number that the paper leaves out, in SI."""

    def ends(self, name: str) -> Matrix:
        """Row of its least and its greatest plausible value."""

    def printed(self, name: str) -> Matrix:
        """Matrix as printed."""

    def box(self, name: str) -> Matrix:
        """Box of the printed digits."""

    def design(self, name: str, entry: str) -> Matrix:
        """Matrix of a design."""


def evaluate(text: str, names: Mapping[str, Matrix], source: Source) -> Matrix:
    """Value of a formula.

    Parameters
    ----------
    text : str
        The formula.
    names : mapping of str to Matrix
        Values of the names it may use.
    source : Source
        The tables.

    Raises
    ------
    CertificateError
        If the text is not a formula, names something unknown, or its shapes do not fit; the message quotes it.
    """
    return _Evaluator(text, names, source).run(parse(text))


def constraint(text: str, names: Mapping[str, Matrix], source: Source) -> tuple[Matrix, str]:
    """Left side minus right side of a constraint, and its relation.

    A side that is the number 0 fits any shape. Raises like `evaluate`.
    """
    sides = compared(text)
    if sides is None:
        raise CertificateError(f"constraint {quote(text)}: expected one of < <= == >= > between two formulas")
    evaluator = _Evaluator(text, names, source)
    left, relation, right = evaluator.run(sides[0]), sides[1], evaluator.run(sides[2])

    def is_zero(side: Matrix) -> bool:
        return side.is_number and side.is_exact and side.value() == 0

    try:
        if is_zero(right):
            difference = left
        elif is_zero(left):
            difference = -right
        else:
            difference = left - right
    except (RingError, ArithmeticError) as error:
        raise CertificateError(f"constraint {quote(text)}: {error}") from error
    return difference, relation


def names_in(text: str) -> frozenset[str]:
    """Names that a formula or a constraint uses, those of functions and constants left out."""
    count_text(text)
    return _names(text)


@lru_cache(maxsize=KEPT)
def _names(text: str) -> frozenset[str]:
    names = {node.id for node in ast.walk(tree_of(text)) if isinstance(node, ast.Name)}
    return frozenset(names - {*_FUNCTIONS, *_CONSTANTS})


def ends_in(text: str) -> frozenset[str]:
    """Plausible ranges of which a formula reads the ends."""
    count_text(text)
    calls = (node for node in ast.walk(tree_of(text)) if isinstance(node, ast.Call))
    found = set()
    for call in calls:
        match call:
            case ast.Call(func=ast.Name(id="ends"), args=[ast.Constant(value=str(name))]):
                found.add(name)
    return frozenset(found)


def parameter_of(text: str, definitions: Mapping[str, str]) -> str | None:
    """Name of the parameter that a formula is, directly or through definitions; None where it is anything else."""
    for _ in range(len(definitions) + 1):
        node = parse(text)
        if isinstance(node, ast.Name) and node.id in definitions:
            text = definitions[node.id]
            continue
        match node:
            case ast.Call(func=ast.Name(id="number"), args=[ast.Constant(value=str(name))], keywords=[]):
                return name
        return None
    return None


def check_name(name: object) -> str:
    """Return a name that a definition or an unknown may have.

    Raises
    ------
    CertificateError
        If it is no ASCII identifier (Python would fold others into each other), or stands for something else already.
    """
    if not isinstance(name, str) or not _NAME.fullmatch(name) or keyword.iskeyword(name):
        raise CertificateError(f"{str(name)[:80]!r} is not a name: expected ASCII letters, digits and underscores")
    if name in _FUNCTIONS or name in _CONSTANTS:
        raise CertificateError(f"the name {name!r} belongs to the formula language")
    return name


def _root(x: arb | fmpq) -> arb | fmpq:
    if isinstance(x, fmpq) and x >= 0:
        p, q = int(x.p), int(x.q)
        if isqrt(p) ** 2 == p and isqrt(q) ** 2 == q:
            return fmpq(isqrt(p), isqrt(q))
        x = arb(x)
    value = arb(x).sqrt()
    if not value.is_finite():
        raise RingError("root of a number that is or may be negative")
    return value


class _Evaluator:
    def __init__(self, text: str, names: Mapping[str, Matrix], source: Source) -> None:
        self.text, self.names, self.source = text, names, source
        self.written = one_line(text)

    def fail(self, what: object) -> CertificateError:
        return CertificateError(f"formula {quote(self.text)}: {what}".replace("\n", " "))

    def run(self, node: ast.expr) -> Matrix:
        try:
            value = self.visit(node)
        except (ValueError, ArithmeticError, RecursionError, MemoryError) as error:
            if isinstance(error, CertificateError):
                raise
            raise self.fail(error) from error
        if not isinstance(value, Matrix):
            raise self.fail("a text or a list where a number or a matrix is expected")
        return value

    def visit(self, node: ast.AST) -> Any:
        spend(1000, "a formula")
        method: Callable[[Any], Any] | None = getattr(self, f"on_{type(node).__name__.lower()}", None)
        if method is None:
            raise self.fail(f"{type(node).__name__} is not part of the formula language")
        return method(node)

    def matrix(self, node: ast.AST) -> Matrix:
        value = self.visit(node)
        if not isinstance(value, Matrix):
            raise self.fail("a text or a list where a number or a matrix is expected")
        return value

    def string(self, node: ast.AST) -> str:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            return node.value
        raise self.fail("expected a name in quotes")

    def on_constant(self, node: ast.Constant) -> Matrix:
        if type(node.value) not in (int, float):
            raise self.fail(f"{node.value!r} where a number is expected")
        literal = self.written[node.col_offset : node.end_col_offset]
        try:
            return Matrix.number(exact(literal))
        except ValueError as error:
            raise self.fail(f"{literal!r} is not a decimal") from error

    def on_name(self, node: ast.Name) -> Matrix:
        if node.id in self.names:
            return self.names[node.id]
        if node.id == "pi":
            return Matrix.number(arb.pi())
        raise self.fail(f"unknown name {node.id!r}")

    def on_unaryop(self, node: ast.UnaryOp) -> Matrix:
        value = self.matrix(node.operand)
        if isinstance(node.op, ast.USub):
            return -value
        if isinstance(node.op, ast.UAdd):
            return value
        raise self.fail(f"{type(node.op).__name__} is not part of the formula language")

    def on_binop(self, node: ast.BinOp) -> Matrix:
        left = self.matrix(node.left)
        if isinstance(node.op, ast.Pow):
            exponent = literal_integer(node.right)
            if exponent > _LARGEST_POWER:
                raise self.fail(f"power {exponent} exceeds {_LARGEST_POWER}")
            return left.power(exponent)
        right = self.matrix(node.right)
        if isinstance(node.op, ast.Div):
            return left.over(right)
        if type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](left, right)
        raise self.fail(f"{type(node.op).__name__} is not part of the formula language")

    def on_attribute(self, node: ast.Attribute) -> Matrix:
        if node.attr != "T":
            raise self.fail(f"attribute {node.attr!r}: only .T is part of the formula language")
        return self.matrix(node.value).T

    def on_list(self, node: ast.List) -> Matrix:
        rows = []
        for line in node.elts:
            if not isinstance(line, ast.List):
                raise self.fail("a list of one level: write [[a, b]], col(a, b) or row(a, b)")
            rows.append([None if is_star(x) else self.matrix(x) for x in line.elts])
        return block(rows)

    def on_subscript(self, node: ast.Subscript) -> Matrix:
        value = self.matrix(node.value)
        return value.take(*subscripts(node, value.shape))

    def on_call(self, node: ast.Call) -> Matrix:
        if not isinstance(node.func, ast.Name) or node.keywords:
            raise self.fail("only plain calls of the functions of the formula language")
        function = _FUNCTIONS.get(node.func.id)
        if function is None:
            raise self.fail(f"unknown function {node.func.id!r}")
        arity, apply = function
        if arity is not None and len(node.args) != arity:
            raise self.fail(f"{node.func.id} takes {arity} arguments, found {len(node.args)}")
        if not node.args:
            raise self.fail(f"{node.func.id} without arguments")
        return apply(self, node.args)


def _unit(e: _Evaluator, args: list[ast.expr]) -> Matrix:
    size, place = literal_integer(args[0]), literal_integer(args[1])
    return eye(size).take(range(size), [place])


def _balls(function: str) -> tuple[int, Callable[[_Evaluator, list[ast.expr]], Matrix]]:
    return 1, lambda e, args: e.matrix(args[0]).map(lambda x: getattr(x, function)())


def _sqrt(e: _Evaluator, args: list[ast.expr]) -> Matrix:
    value = e.matrix(args[0])
    if value.is_number and value.is_exact:
        return Matrix.number(_root(value.entry(0, 0)))
    return value.map(_root)


_FUNCTIONS: dict[str, tuple[int | None, Callable[[_Evaluator, list[ast.expr]], Matrix]]] = {
    "number": (1, lambda e, a: e.source.number(e.string(a[0]))),
    "plausible": (1, lambda e, a: e.source.plausible(e.string(a[0]))),
    "ends": (1, lambda e, a: e.source.ends(e.string(a[0]))),
    "printed": (1, lambda e, a: e.source.printed(e.string(a[0]))),
    "box": (1, lambda e, a: e.source.box(e.string(a[0]))),
    "design": (2, lambda e, a: e.source.design(e.string(a[0]), e.string(a[1]))),
    "interval": (2, lambda e, a: Matrix.number(hull(e.matrix(a[0]).value(), e.matrix(a[1]).value()))),
    "eye": (1, lambda e, a: eye(literal_integer(a[0]))),
    "zeros": (2, lambda e, a: zeros(literal_integer(a[0]), literal_integer(a[1]))),
    "unit": (2, _unit),
    "diag": (None, lambda e, a: diagonal([e.matrix(x) for x in a])),
    "block": (1, lambda e, a: e.matrix(a[0])),
    "col": (None, lambda e, a: block([[e.matrix(x)] for x in a])),
    "row": (None, lambda e, a: block([[e.matrix(x) for x in a]])),
    "take": (3, lambda e, a: e.matrix(a[0]).take(integers(a[1]), integers(a[2]))),
    "sym": (1, lambda e, a: (lambda x: x + x.T)(e.matrix(a[0]))),
    "trace": (1, lambda e, a: e.matrix(a[0]).trace()),
    "inverse": (1, lambda e, a: e.matrix(a[0]).inverse()),
    "kron": (2, lambda e, a: kron(e.matrix(a[0]), e.matrix(a[1]))),
    "sqrt": (1, _sqrt),
    "sin": _balls("sin"),
    "cos": _balls("cos"),
    "exp": _balls("exp"),
    "log": _balls("log"),
}
