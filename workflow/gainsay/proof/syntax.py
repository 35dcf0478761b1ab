"""The syntax of the formula language, whatever ring its formulas are evaluated over: trees, comparisons, subscripts."""

import ast
import operator
import re
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, Literal

from gainsay.errors import CertificateError
from gainsay.exact.budget import BudgetError, spend

__all__ = [
    "KEPT",
    "LARGEST_SIZE",
    "OPERATORS",
    "Relation",
    "compared",
    "integers",
    "is_star",
    "literal_integer",
    "one_line",
    "parse",
    "quote",
    "segment",
    "subscripts",
]

Relation = Literal["<", "<=", "==", ">=", ">"]
_RELATIONS: dict[type, Relation] = {ast.Lt: "<", ast.LtE: "<=", ast.Eq: "==", ast.GtE: ">=", ast.Gt: ">"}
#: what adds and multiplies, of numbers and matrices of every ring; division differs from ring to ring
OPERATORS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.MatMult: operator.matmul,
}
#: largest literal integer: sizes, subscripts
LARGEST_SIZE = 400
_LONGEST = 20_000
#: formulas whose reading is kept
KEPT = 512
# What an expression of the language is made of: no comments, escapes or characters that do not show.
_ALLOWED = re.compile(r"[A-Za-z0-9_ \n+\-*/@.,:()\[\]'<>=]*", re.ASCII)


def quote(text: str) -> str:
    """Text of a formula as messages show it: in one line, cut where it is long."""
    line = " ".join(text.split())
    return repr(line if len(line) <= 80 else line[:77] + "...")


def one_line(text: str) -> str:
    """Text of a formula that is broken over lines, as one line."""
    return text.replace("\n", " ").strip(" ")


def parse(text: str) -> ast.expr:
    """Syntax tree of a formula or a constraint; its columns count in `one_line` of the text.

    Raises
    ------
    CertificateError
        If the text is too long, holds a character that is not part of the language, or is not an expression.
    """
    count_text(text)
    return tree_of(text)


def count_text(text: str) -> None:
    """Count the length of a formula as work, whether it was read before or not.

    Raises
    ------
    CertificateError
        If it is no text, or too long, or more work than what is left of the budget.
    """
    if not isinstance(text, str) or len(text) > _LONGEST:
        raise CertificateError(f"a formula must be a text of at most {_LONGEST} characters")
    try:
        spend(50 * len(text), "reading it")
    except BudgetError as error:
        raise CertificateError(f"formula {quote(text)}: {error}") from error


@lru_cache(maxsize=KEPT)
def tree_of(text: str) -> ast.expr:
    """Syntax tree of a formula that is counted; it is read at every point of a map, and nobody changes a tree."""
    if not _ALLOWED.fullmatch(text):
        raise CertificateError(f"formula {quote(text)}: a character that is not part of the formula language")
    try:
        return ast.parse(one_line(text), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise CertificateError(f"formula {quote(text)}: not an expression") from error


def segment(text: str, node: ast.expr) -> str:
    """Text of a part of a formula."""
    return one_line(text)[node.col_offset : node.end_col_offset]


def compared(text: str) -> tuple[ast.expr, Relation, ast.expr] | None:
    """The two sides of a constraint and the relation between them; None of what is not a comparison of two formulas.

    Raises
    ------
    CertificateError
        As `parse`.
    """
    node = parse(text)
    if not isinstance(node, ast.Compare) or len(node.ops) != 1 or type(node.ops[0]) not in _RELATIONS:
        return None
    return node.left, _RELATIONS[type(node.ops[0])], node.comparators[0]


def is_star(node: ast.AST) -> bool:
    """Whether a cell is ``...``, the transpose of the block across the diagonal."""
    return isinstance(node, ast.Constant) and node.value is ...


def literal_integer(node: ast.AST, largest: int = LARGEST_SIZE) -> int:
    """Value of a literal integer; anything else, or a larger one, raises ValueError."""
    if isinstance(node, ast.Constant) and type(node.value) is int and 0 <= node.value <= largest:
        return node.value
    raise ValueError(f"expected a literal integer from 0 to {largest}")


def integers(node: ast.AST, largest: int = LARGEST_SIZE) -> list[int]:
    """Values of a list of literal integers; anything else raises ValueError."""
    if not isinstance(node, ast.List):
        raise ValueError("expected a list of integers")
    return [literal_integer(x, largest) for x in node.elts]


def subscripts(node: ast.Subscript, shape: Sequence[int]) -> list[list[int]]:
    """Rows and columns that a subscript takes of a matrix; one subscript is enough for a row or a column.

    Raises
    ------
    ValueError
        If it leaves the matrix, or is not a subscript of the language.
    """
    parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    if len(parts) == 1 and 1 in shape:
        parts = [*parts, ast.Slice()] if shape[1] == 1 else [ast.Slice(), *parts]
    if len(parts) != 2:
        raise ValueError("a matrix takes two subscripts, a row or a column one")
    return [_indices(part, size) for part, size in zip(parts, shape, strict=True)]


def _indices(node: ast.AST, size: int) -> list[int]:
    if not isinstance(node, ast.Slice):
        return [literal_integer(node, size - 1)]
    if node.step is not None:
        raise ValueError("a slice with a step")
    start = 0 if node.lower is None else literal_integer(node.lower, size)
    stop = size if node.upper is None else literal_integer(node.upper, size)
    return list(range(start, stop))
