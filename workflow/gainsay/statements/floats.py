"""The formulas of a statement as expressions of the LMI layer.

Whatever holds no unknown is evaluated by the checker's own evaluator, in rationals or balls, and rounded once: the
program that the solver sees is, entry by entry, the nearest doubles of what the certificate speaks of, on every machine
the same. What holds unknowns is evaluated here, over `gainsay.lmi.Affine`.
"""

import ast
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from flint import arb

from gainsay.errors import CertificateError, GainsayError
from gainsay.exact.ball import precision
from gainsay.exact.matrix import Matrix
from gainsay.exact.rational import fraction_of
from gainsay.lmi import Affine, Variable, affine, sym, trace
from gainsay.proof import formulas
from gainsay.proof.scope import Reader
from gainsay.proof.syntax import OPERATORS, integers, is_star, one_line, parse, subscripts

__all__ = ["Floats", "nearest"]

_BITS = 160


def nearest(value: Matrix) -> np.ndarray:
    """Nearest doubles of a matrix of rationals, or of the midpoints of balls, shape that of the matrix."""

    def rounded(x: Any) -> float:
        return float(x.mid()) if isinstance(x, arb) else float(fraction_of(x))

    return np.array([[rounded(x) for x in row] for row in value.rows()])


class Floats:
    """Evaluates formulas over the tables of a case and unknowns of the LMI layer.

    Parameters
    ----------
    case : gainsay.tables.Case or any `gainsay.proof.scope.Tables`
    definitions : mapping of str to str
        In order.
    unknowns : mapping of str to Variable
    before : Floats, optional
        Of a program that is nearly the same: values of formulas that mean the same in both are taken over.
    """

    def __init__(
        self,
        case: Any,
        definitions: Mapping[str, str],
        unknowns: Mapping[str, Variable],
        before: "Floats | None" = None,
    ) -> None:
        self.case, self.definitions, self.unknowns = case, dict(definitions), dict(unknowns)
        self._reader = Reader(case, "statement")
        self._exact: dict[str, Matrix] = {}
        self._affine: dict[str, Affine] = {}
        self._constraints: dict[tuple[str, str], Any] = {}
        self._names: dict[str, frozenset[str]] = {} if before is None else before._names
        self._free = self._names_with_unknowns()
        if before is not None and before.case is case:
            self._take_over(before)

    def _names_with_unknowns(self) -> set[str]:
        free, later = set(self.unknowns), set(self.definitions)
        for name, text in self.definitions.items():
            formulas.check_name(name)
            if name in self.unknowns:
                raise CertificateError(f"the name {name!r} is defined twice")
            names = self._names_in(text)
            if names & later:
                raise CertificateError(f"definition of {name!r}: {min(names & later)!r} is not defined before it")
            later.remove(name)
            if names & free:
                free.add(name)
        return free

    def _names_in(self, text: str) -> frozenset[str]:
        """Names in a formula, looked for once however many programs follow each other."""
        if text not in self._names:
            self._names[text] = formulas.names_in(text)
        return self._names[text]

    def _take_over(self, before: "Floats") -> None:
        same = {name for name, unknown in self.unknowns.items() if _alike(unknown, before.unknowns.get(name))}
        self.unknowns |= {name: before.unknowns[name] for name in same}
        for name, text in self.definitions.items():
            if before.definitions.get(name) == text and self._names_in(text) <= same:
                same.add(name)
        self._exact = {text: value for text, value in before._exact.items() if self._names_in(text) <= same}
        self._affine = {text: value for text, value in before._affine.items() if self._names_in(text) <= same}
        self._constraints = {key: held for key, held in before._constraints.items() if self._names_in(key[1]) <= same}

    def value(self, text: str) -> Affine:
        """Expression of a formula.

        Raises
        ------
        CertificateError
            If the text is not a formula, or names something unknown; the message quotes it.
        InputError
            If it is not affine in the unknowns, or its shapes do not fit.
        """
        if text not in self._affine:
            self._affine[text] = _Walk(self, text).run(parse(text))
        return self._affine[text]

    def constraint(self, label: str, text: str, make: Callable[[], Any]) -> Any:
        """Constraint of a label and a text, made where it was not before."""
        if (label, text) not in self._constraints:
            self._constraints[label, text] = make()
        return self._constraints[label, text]

    def constant(self, text: str) -> np.ndarray:
        """Nearest doubles of a formula without unknowns."""
        return nearest(self.exact(text))

    def exact(self, text: str) -> Matrix:
        """Exact value, or enclosure, of a formula without unknowns."""
        if text not in self._exact:
            self._exact[text] = self._evaluated(text)
        return self._exact[text]

    def _evaluated(self, text: str) -> Matrix:
        names = {}
        for name in formulas.names_in(text):
            if name in self._free:
                raise CertificateError(f"formula {text[:80]!r}: {name!r} is unknown")
            if name in self.definitions:
                names[name] = self.exact(self.definitions[name])
        with precision(_BITS):
            return formulas.evaluate(text, names, self._reader)

    def named(self, name: str) -> Affine:
        """Expression of an unknown, or of a definition that holds unknowns."""
        return self.unknowns[name] if name in self.unknowns else self.value(self.definitions[name])

    def is_free(self, name: str) -> bool:
        """Whether a name is an unknown, or a definition that holds unknowns."""
        return name in self._free


def _alike(one: Variable, other: Variable | None) -> bool:
    return other is not None and (one.kind, one.shape) == (other.kind, other.shape)


class _Walk:
    """Evaluates one formula: the parts that hold unknowns here, the others by the checker."""

    def __init__(self, floats: Floats, text: str) -> None:
        self.floats, self.line = floats, one_line(text)
        self._with_unknowns: set[int] = set()

    def run(self, node: ast.expr) -> Affine:
        try:
            self._note(node)
            return self.visit(node)
        except GainsayError:
            raise
        except (ValueError, ArithmeticError, RecursionError) as error:
            raise self.fail(error) from error

    def _note(self, node: ast.AST) -> bool:
        """Note which parts of the formula hold unknowns, in one pass."""
        parts = [self._note(part) for part in ast.iter_child_nodes(node)]
        held = any(parts) or (isinstance(node, ast.Name) and self.floats.is_free(node.id))
        if held:
            self._with_unknowns.add(id(node))
        return held

    def holds_unknowns(self, node: ast.AST) -> bool:
        """Whether a part of the formula holds unknowns."""
        return id(node) in self._with_unknowns

    def fail(self, what: object) -> CertificateError:
        shown = self.line if len(self.line) <= 80 else self.line[:77] + "..."
        return CertificateError(f"formula {shown!r}: {what}")

    def visit(self, node: ast.expr) -> Affine:
        if not self.holds_unknowns(node):
            return affine(self.floats.constant(self.line[node.col_offset : node.end_col_offset]))
        match node:
            case ast.Name(id=name):
                return self.floats.named(name)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.visit(operand)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.visit(operand)
            case ast.BinOp():
                return self.combined(node)
            case ast.Attribute(attr="T", value=value):
                return self.visit(value).T
            case ast.List():
                return self.blocks(node)
            case ast.Subscript():
                return self.part(node)
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in _FUNCTIONS:
                return _FUNCTIONS[name](self, args)
        raise self.fail(f"{ast.unparse(node)[:60]!r} is not affine in the unknowns")

    def combined(self, node: ast.BinOp) -> Affine:
        if isinstance(node.op, ast.Div):
            if self.holds_unknowns(node.right):
                raise self.fail("division by an unknown is not affine")
            return self.visit(node.left) * (1 / self.number(node.right))
        if isinstance(node.op, ast.Pow):
            raise self.fail("a power of an unknown is not affine")
        left, right = self.visit(node.left), self.visit(node.right)
        if isinstance(node.op, ast.Add | ast.Sub) and left.shape != right.shape:
            raise self.fail(f"a sum of shapes {left.shape} and {right.shape}")
        if type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](left, right)
        raise self.fail(f"{type(node.op).__name__} is not part of the formula language")

    def number(self, node: ast.expr) -> float:
        value = self.visit(node)
        if value.shape != (1, 1):
            raise self.fail("division by a matrix")
        return float(value.constant[0, 0])

    def blocks(self, node: ast.List) -> Affine:
        lines = [line.elts for line in node.elts if isinstance(line, ast.List)]
        if len(lines) != len(node.elts):
            raise self.fail("a list of one level: write [[a, b]], col(a, b) or row(a, b)")
        return self.assembled(lines)

    def assembled(self, lines: Sequence[Sequence[ast.expr]]) -> Affine:
        """Block matrix: ``...`` is the transpose of the mirrored block, a number zero fills a block of any size."""
        values = [[None if is_star(cell) else self.visit(cell) for cell in line] for line in lines]
        for i, line in enumerate(values):
            for j, value in enumerate(line):
                if value is None:
                    mirrored = values[j][i] if j < len(values) and i < len(values[j]) else None
                    if mirrored is None:
                        raise self.fail("a star without a block across the diagonal")
                    line[j] = mirrored.T
        return _grid([[cell for cell in line if cell is not None] for line in values], self.fail)

    def part(self, node: ast.Subscript) -> Affine:
        value = self.visit(node.value)
        rows, columns = subscripts(node, value.shape)
        return value[rows, columns]


def _grid(rows: Sequence[Sequence[Affine]], fail: Callable[[object], CertificateError]) -> Affine:
    if len({len(row) for row in rows}) != 1:
        raise fail(f"block rows of {', '.join(str(len(row)) for row in rows)} blocks: expected the same number in each")

    def fills(cell: Affine) -> bool:
        return cell.shape == (1, 1) and cell.is_constant and not cell.constant.any()

    def size(cells: Sequence[Affine], side: int, what: str) -> int:
        sizes = {cell.shape[side] for cell in cells if not fills(cell)} or {1}
        if len(sizes) != 1:
            raise fail(f"{what} holds blocks of {' and '.join(map(str, sorted(sizes)))} {('rows', 'columns')[side]}")
        return sizes.pop()

    heights = [size(row, 0, f"block row {i + 1}") for i, row in enumerate(rows)]
    widths = [size(column, 1, f"block column {j + 1}") for j, column in enumerate(zip(*rows, strict=True))]
    constant = np.zeros((sum(heights), sum(widths)))
    terms: dict[Variable, np.ndarray] = {}
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            if fills(cell):
                continue
            place = tuple(slice(sum(s[:k]), sum(s[: k + 1])) for s, k in ((heights, i), (widths, j)))
            constant[place] = cell.constant
            for variable, coefficient in cell.terms.items():
                if variable not in terms:
                    terms[variable] = np.zeros((*constant.shape, variable.size))
                terms[variable][place] = coefficient
    return Affine(constant, terms)


def _kron(walk: _Walk, args: list[ast.expr]) -> Affine:
    left, right = (walk.visit(arg) for arg in args)
    if left.terms and right.terms:
        raise walk.fail("a product of two unknowns is not affine")
    shape = tuple(a * b for a, b in zip(left.shape, right.shape, strict=True))

    def product(a: np.ndarray, b: np.ndarray, count: int) -> np.ndarray:
        return np.einsum("ijk,lmn->iljmkn", a, b).reshape(*shape, count)

    terms = {v: product(c, right.constant[:, :, None], c.shape[2]) for v, c in left.terms.items()}
    terms |= {v: product(left.constant[:, :, None], c, c.shape[2]) for v, c in right.terms.items()}
    return Affine(np.kron(left.constant, right.constant), terms)


def _take(walk: _Walk, args: list[ast.expr]) -> Affine:
    value = walk.visit(args[0])
    rows, columns = (integers(node, size - 1) for node, size in zip(args[1:], value.shape, strict=True))
    return value[rows, columns]


def _diag(walk: _Walk, args: list[ast.expr]) -> Affine:
    blocks, zero = [walk.visit(arg) for arg in args], affine(0)
    return _grid([[b if i == j else zero for j, b in enumerate(blocks)] for i in range(len(blocks))], walk.fail)


def _arity(count: int | None, apply: Callable[[_Walk, list[ast.expr]], Affine]) -> Callable:
    def checked(walk: _Walk, args: list[ast.expr]) -> Affine:
        if count is not None and len(args) != count:
            raise walk.fail(f"a function of {count} arguments, found {len(args)}")
        return apply(walk, args)

    return checked


#: the functions of the formula language that an expression with unknowns may stand in
_FUNCTIONS: dict[str, Callable[[_Walk, list[ast.expr]], Affine]] = {
    "sym": _arity(1, lambda w, a: sym(w.visit(a[0]))),
    "trace": _arity(1, lambda w, a: trace(w.visit(a[0]))),
    "block": _arity(1, lambda w, a: w.visit(a[0])),
    "diag": _arity(None, _diag),
    "col": _arity(None, lambda w, a: w.assembled([[x] for x in a])),
    "row": _arity(None, lambda w, a: w.assembled([a])),
    "take": _arity(3, _take),
    "kron": _arity(2, _kron),
}
