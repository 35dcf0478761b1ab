"""Matrix expressions that are affine in the unknowns of a matrix inequality, and the constraints that compare them.

An expression holds its constant part and one coefficient tensor per unknown, so that it can be evaluated in plain
numpy, scaled, and handed to a solver without a modelling layer in between; a product of two unknowns is refused where
it is written.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gainsay.errors import InputError
from gainsay.exact.floats import real_array

Values = Mapping[str, Any]

# squared entries of one unknown: its tensor of coordinates holds so many doubles, or half of them
_MOST_COEFFICIENTS = 200_000_000


class Affine:
    """A matrix ``constant + sum of coefficients[..., k] * coordinate k`` over the coordinates of its unknowns.

    Parameters
    ----------
    constant : ndarray, shape (r, c)
        Part that depends on no unknown.
    terms : mapping of Variable to ndarray, shape (r, c, k)
        Coefficients of the k free coordinates of each unknown.
    """

    # numpy then leaves `array @ expression` and `array < expression` to the reflected operators below
    __array_ufunc__ = None

    def __init__(self, constant: np.ndarray, terms: Mapping["Variable", np.ndarray]) -> None:
        self.constant, self.terms = constant, dict(terms)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.constant.shape

    @property
    def T(self) -> "Affine":
        """The transpose."""
        return Affine(self.constant.T, {v: c.transpose(1, 0, 2) for v, c in self.terms.items()})

    @property
    def is_constant(self) -> bool:
        """Whether no unknown occurs."""
        return not self.terms

    def value(self, values: Values) -> np.ndarray:
        """Evaluate in floats.

        Parameters
        ----------
        values : mapping
            Name of each unknown to its matrix (a number for a scalar).

        Raises
        ------
        InputError
            An unknown of the expression has no value, or one of the wrong shape.
        """
        total = self.constant.astype(float)
        for variable, coefficient in self.terms.items():
            if variable.name not in values:
                raise InputError("no value for the unknown", field=variable.name, expected=f"shape {variable.shape}")
            total = total + coefficient @ variable.coordinates(values[variable.name])
        return total

    def _combine(self, other: Any, sign: float) -> "Affine":
        right = affine(other)
        if self.shape != right.shape:
            if right.shape == (1, 1) and right.is_constant and not right.constant.any():
                return self
            raise InputError("sum of matrices of different shapes", value=(self.shape, right.shape))
        terms = dict(self.terms)
        for variable, coefficient in right.terms.items():
            terms[variable] = terms[variable] + sign * coefficient if variable in terms else sign * coefficient
        return Affine(self.constant + sign * right.constant, terms)

    def __add__(self, other: Any) -> "Affine":
        return self._combine(other, 1.0)

    __radd__ = __add__

    def __sub__(self, other: Any) -> "Affine":
        return self._combine(other, -1.0)

    def __rsub__(self, other: Any) -> "Affine":
        return (-self)._combine(other, 1.0)

    def __neg__(self) -> "Affine":
        return Affine(-self.constant, {v: -c for v, c in self.terms.items()})

    def __matmul__(self, other: Any) -> "Affine":
        return _product(self, affine(other))

    def __rmatmul__(self, other: Any) -> "Affine":
        return _product(affine(other), self)

    def __mul__(self, other: Any) -> "Affine":
        """Scale by a number, or spread a scalar unknown over a constant matrix."""
        right = affine(other)
        if self.shape == (1, 1):
            return _spread(self, right)
        if right.shape == (1, 1):
            return _spread(right, self)
        raise InputError("`*` scales; use `@` for matrix products", value=(self.shape, right.shape))

    __rmul__ = __mul__

    def __truediv__(self, number: float) -> "Affine":
        return self * (1.0 / number)

    def __getitem__(self, index: Any) -> "Affine":
        """Rows and columns by slices or indices; the result stays a matrix."""
        rows, columns = (_span(i, n) for i, n in zip(index, self.shape, strict=True))
        terms = {v: c[rows][:, columns] for v, c in self.terms.items()}
        return Affine(self.constant[rows][:, columns], terms)

    def __lt__(self, other: Any) -> "Definite":
        return Definite.difference(other, self, strict=True)

    def __gt__(self, other: Any) -> "Definite":
        return Definite.difference(self, other, strict=True)

    def __le__(self, other: Any) -> "Definite":
        return Definite.difference(other, self, strict=False)

    def __ge__(self, other: Any) -> "Definite":
        return Definite.difference(self, other, strict=False)


class Variable(Affine):
    """An unknown matrix with the coordinates that its structure leaves free.

    Parameters
    ----------
    name : str
        Name under which its value is returned.
    kind : {"symmetric", "full", "diagonal", "positive", "scalar"}
        Structure; ``positive`` is a scalar that a program keeps above zero.
    rows, columns : int
        Shape.

    Raises
    ------
    InputError
        The name is empty or no text, or the shape has no entries or more coefficients than memory should hold.
    """

    def __init__(self, name: str, kind: str, rows: int, columns: int) -> None:
        if not isinstance(name, str) or not name:
            raise InputError("unknown", value=name, expected="a name")
        if any(type(n) is bool or not isinstance(n, int | np.integer) or n < 1 for n in (rows, columns)):
            raise InputError("unknown", field=name, value=(rows, columns), expected="at least one row and one column")
        if (rows * columns) ** 2 > _MOST_COEFFICIENTS:
            raise InputError("unknown", field=name, value=(rows, columns), expected="fewer entries")
        self.name, self.kind = name, kind
        if kind == "symmetric":
            self.index = [(i, j) for j in range(columns) for i in range(j + 1)]
        elif kind == "diagonal":
            self.index = [(i, i) for i in range(rows)]
        else:
            self.index = [(i, j) for i in range(rows) for j in range(columns)]
        basis = np.zeros((rows, columns, len(self.index)))
        for k, (i, j) in enumerate(self.index):
            basis[i, j, k] = 1.0
            if kind == "symmetric":
                basis[j, i, k] = 1.0
        super().__init__(np.zeros((rows, columns)), {self: basis})

    @property
    def size(self) -> int:
        """Number of free coordinates."""
        return len(self.index)

    def coordinates(self, value: Any) -> np.ndarray:
        """Free coordinates of a value; one of the wrong shape, or of no real numbers, raises InputError."""
        array = real_array(value, f"value of {self.name}", finite=False)
        array = array.reshape(1, 1) if array.ndim == 0 else array
        if array.shape != self.shape:
            raise InputError("shape of the value", field=self.name, value=array.shape, expected=str(self.shape))
        rows, columns = np.array(self.index).T
        return array[rows, columns]

    def matrix(self, coordinates: np.ndarray) -> np.ndarray | float:
        """Value from free coordinates; a number for a scalar unknown."""
        value = self.terms[self] @ coordinates
        return float(value[0, 0]) if self.kind in ("positive", "scalar") else value

    def __repr__(self) -> str:
        return f"{self.kind} {self.name} {self.shape}"


def symmetric(name: str, size: int) -> Variable:
    """Return an unknown symmetric matrix of `size` rows."""
    return Variable(name, "symmetric", size, size)


def matrix(name: str, rows: int, columns: int) -> Variable:
    """Return an unknown matrix without structure."""
    return Variable(name, "full", rows, columns)


def diagonal(name: str, size: int) -> Variable:
    """Return an unknown diagonal matrix of `size` rows."""
    return Variable(name, "diagonal", size, size)


def positive(name: str) -> Variable:
    """Return an unknown positive number; every program in which it occurs keeps it above zero."""
    return Variable(name, "positive", 1, 1)


def scalar(name: str) -> Variable:
    """Return an unknown number of either sign."""
    return Variable(name, "scalar", 1, 1)


def affine(value: Any) -> Affine:
    """Read a number, array, expression or block matrix as an expression.

    Raises
    ------
    InputError
        The value does not hold real numbers, or has not two dimensions (a vector is ambiguous: give it as a row or a
        column).
    """
    if isinstance(value, Affine):
        return value
    assembled = getattr(value, "assembled", None)  # asked once: it is put together anew each time
    if assembled is not None:
        return assembled
    array = real_array(value, "matrix expression", finite=False)
    if array.ndim == 0:
        array = array.reshape(1, 1)
    if array.ndim != 2:
        raise InputError("matrix expression", value=array.shape, expected="two dimensions")
    return Affine(array, {})


def sym(expression: Any) -> Affine:
    """M + M', which the papers write sym(M) or He(M)."""
    read = affine(expression)
    return read + read.T


def trace(expression: Any) -> Affine:
    """Sum of the diagonal, as a 1 x 1 expression."""
    read = affine(expression)
    if read.shape[0] != read.shape[1]:
        raise InputError("trace", value=read.shape, expected="a square matrix")
    terms = {v: np.einsum("iik->k", c)[None, None, :] for v, c in read.terms.items()}
    return Affine(np.array([[np.trace(read.constant)]]), terms)


class _Stated:
    """What is stated, not computed: it is neither true nor false before its program is solved."""

    def __bool__(self) -> bool:
        """Refuse: ``a < F < b`` would keep its last half alone."""
        raise InputError("constraint", value=type(self).__name__, expected="each comparison on its own: a < F, F < b")


@dataclass(frozen=True)
class Definite(_Stated):
    """A matrix inequality, kept as `expression` > 0 (or >= 0).

    Parameters
    ----------
    label : str
        Where it stands in the paper.
    expression : Affine, shape (n, n)
        Symmetric matrix that is to be positive.
    strict : bool
        Whether a margin is asked for.
    rows : tuple of (str, int)
        Names and sizes of the block rows.
    """

    label: str
    expression: Affine
    strict: bool = True
    rows: tuple[tuple[str, int], ...] = ()

    @classmethod
    def difference(cls, larger: Any, smaller: Any, strict: bool) -> "Definite":
        """Read ``larger > smaller``; 0 stands for the zero matrix."""
        named = larger if hasattr(larger, "label") else smaller
        big, small = affine(larger), affine(smaller)
        for one, other in ((big, small), (small, big)):
            if one.shape == (1, 1) != other.shape and one.is_constant and not one.constant.any():
                expression = big if other is big else -small
                break
        else:
            expression = big - small
        if expression.shape[0] != expression.shape[1]:
            raise InputError("matrix inequality", value=expression.shape, expected="a square matrix")
        skew = expression - expression.T
        if expression.shape[0] == 0:
            raise InputError("matrix inequality", field=getattr(named, "label", None), expected="at least one row")
        size = max([np.abs(expression.constant).max(), *(np.abs(c).max() for c in expression.terms.values())])
        if max([np.abs(skew.constant).max(), *(np.abs(c).max() for c in skew.terms.values())]) > 1e-12 * size:
            raise InputError("matrix inequality", field=getattr(named, "label", None), expected="a symmetric matrix")
        label = getattr(named, "label", None) or getattr(named, "name", "") or "constraint"
        rows = getattr(named, "sizes", None) or (("", expression.shape[0]),)
        return cls(label, (expression + expression.T) / 2, strict, tuple(rows))

    def named(self, label: str) -> "Definite":
        """Return the same inequality under another name."""
        return replace(self, label=label)


@dataclass(frozen=True)
class Entrywise(_Stated):
    """Every entry of `expression` (any shape) is at least zero."""

    label: str
    expression: Affine


@dataclass(frozen=True)
class Equal(_Stated):
    """Every entry of `expression` (any shape) is zero."""

    label: str
    expression: Affine


Constraint = Definite | Entrywise | Equal


def _span(index: Any, length: int) -> Any:
    return (
        slice(index, index + 1 or None) if isinstance(index, int) else index if isinstance(index, slice) else [*index]
    )


def _product(left: Affine, right: Affine) -> Affine:
    if left.shape[1] != right.shape[0]:
        raise InputError("product of matrices of unfit shapes", value=(left.shape, right.shape))
    if left.terms and right.terms:
        names = ", ".join(v.name for v in (*left.terms, *right.terms))
        raise InputError("product of two unknowns is not affine", value=names, expected="a change of variables")
    terms = {v: np.tensordot(left.constant, c, 1) for v, c in right.terms.items()}
    terms |= {v: np.einsum("ijk,jl->ilk", c, right.constant, optimize=True) for v, c in left.terms.items()}
    return Affine(left.constant @ right.constant, terms)


def _spread(number: Affine, factor: Affine) -> Affine:
    if number.terms and factor.terms:
        names = ", ".join(v.name for v in (*number.terms, *factor.terms))
        raise InputError("product of two unknowns is not affine", value=names, expected="a change of variables")
    terms = {v: factor.constant[:, :, None] * c for v, c in number.terms.items()}
    terms |= {v: number.constant[0, 0] * c for v, c in factor.terms.items()}
    return Affine(number.constant[0, 0] * factor.constant, terms)
