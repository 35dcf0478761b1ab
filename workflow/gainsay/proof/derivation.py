"""Formulas read as expressions in unknown matrices, for proofs that hold for every entry and every size.

The constructions of the formula language that make sense there: sums, products, ``.T``, blocks with stars and zeros,
``eye``, ``zeros``, ``diag``, ``col``, ``row``, ``block``, ``sym``, ``inverse``, powers and division by numbers. Table
entries are not read: what holds for the matrices of the paper's example holds for all, or is proved by another kind.
"""

import ast
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from gainsay.errors import CertificateError
from gainsay.exact.rational import exact
from gainsay.exact.words import Letter, Words, WordsError, identity, nothing, stacked
from gainsay.proof.syntax import OPERATORS, is_star, literal_integer, one_line, parse

__all__ = ["FUNCTIONS", "evaluate"]

FUNCTIONS = ("block", "col", "diag", "eye", "inverse", "row", "sym", "zeros")
_LARGEST_POWER = 16


def evaluate(text: str, names: Mapping[str, Words], letters: Mapping[str, Letter]) -> Words:
    """Expression of a formula.

    Parameters
    ----------
    text : str
    names : mapping of str to Words
        Definitions.
    letters : mapping of str to Letter
        Unknowns.

    Raises
    ------
    CertificateError
        If the text is not a formula of this kind, or its blocks do not fit; the message quotes it.
    """
    line, tree = one_line(text), parse(text)
    try:
        return _Reading(line, names, letters).visit(tree)
    except (ValueError, RecursionError) as error:
        raise CertificateError(f"formula {line[:77]!r}: {error}") from error


class _Reading:
    def __init__(self, line: str, names: Mapping[str, Words], letters: Mapping[str, Letter]) -> None:
        self.line, self.names, self.letters = line, names, letters

    def visit(self, node: ast.expr) -> Words:
        match node:
            case ast.Constant(value=int() | float()) if type(node.value) is not bool:
                return Words.number(self.literal(node), self.letters)
            case ast.Name(id=name) if name in self.names:
                return self.names[name]
            case ast.Name(id=name) if name in self.letters:
                return Words.letter(name, self.letters)
            case ast.Name(id=name):
                raise WordsError(f"unknown name {name!r}")
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.visit(operand)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.visit(operand)
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self.power(self.visit(left), literal_integer(right))
            case ast.BinOp():
                return self.combined(node)
            case ast.Attribute(attr="T", value=value):
                return self.visit(value).T
            case ast.List(elts=lines):
                return self.blocks(lines)
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in FUNCTIONS and args:
                return self.call(name, args)
        raise WordsError(f"{ast.unparse(node)[:60]!r} is not part of a derivation in unknown matrices")

    def literal(self, node: ast.Constant) -> Fraction:
        text = self.line[node.col_offset : node.end_col_offset]
        try:
            return exact(text)
        except ValueError as error:
            raise WordsError(f"{text[:40]!r} is not a decimal") from error

    def power(self, base: Words, exponent: int) -> Words:
        if exponent > _LARGEST_POWER or base.shape[0] != base.shape[1]:
            raise WordsError(f"power {exponent} of shape {base.shape}")
        result = identity(base.shape[0], self.letters)
        for _ in range(exponent):
            result = result * base if base.is_number else result @ base
        return result

    def combined(self, node: ast.BinOp) -> Words:
        left, right = self.visit(node.left), self.visit(node.right)
        if type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](left, right)
        if isinstance(node.op, ast.Div) and right.is_number:
            return left * right.inverse()
        raise WordsError(f"{ast.unparse(node)[:60]!r} is not part of a derivation in unknown matrices")

    def blocks(self, lines: list[ast.expr]) -> Words:
        if not all(isinstance(line, ast.List) for line in lines):
            raise WordsError("a list of one level: write [[a, b]], col(a, b) or row(a, b)")
        rows: list[Any] = [line.elts for line in lines if isinstance(line, ast.List)]
        star = [[None if is_star(x) else self.visit(x) for x in row] for row in rows]
        return stacked(star, self.letters)

    def call(self, name: str, args: list[ast.expr]) -> Words:
        count = {"eye": 1, "zeros": 2, "sym": 1, "inverse": 1, "block": 1}.get(name)
        if count is not None and len(args) != count:
            raise WordsError(f"{name} takes {count} arguments, found {len(args)}")
        if name in ("eye", "zeros"):
            sizes = [literal_integer(x) for x in args]
            if 0 in sizes:
                raise WordsError("a matrix without entries")
            return identity(sizes[0], self.letters) if name == "eye" else nothing(sizes[0], sizes[1], self.letters)
        values = [self.visit(x) for x in args]
        match name:
            case "sym":
                return values[0] + values[0].T
            case "inverse":
                return values[0].inverse()
            case "col":
                return stacked([[value] for value in values], self.letters)
            case "row":
                return stacked([values], self.letters)
            case "diag":
                zero = Words.number(Fraction(0), self.letters)
                rows = [[v if i == j else zero for j, v in enumerate(values)] for i in range(len(values))]
                return stacked(rows, self.letters)
        return values[0]
