"""One matrix type over three rings: rationals, balls, and polynomials with rational coefficients.

The ring of a result is the smallest that holds it: rational op rational stays rational, rational op ball is a ball
(at the precision in force), rational op polynomial is a polynomial. Balls and polynomials do not mix.
A number is a matrix of shape (1, 1).
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat, ctx, fmpq, fmpq_mat, fmpq_mpoly, fmpz

from gainsay.exact.budget import (
    LARGEST_SIDE,
    MOST_BITS,
    MOST_DEGREE,
    MOST_TERMS,
    MOST_WORDS,
    BudgetError,
    multiply_cost,
    spend,
)
from gainsay.exact.rational import rational_matrix, to_fmpq

__all__ = ["Matrix", "RingError", "eye", "fits", "zeros"]

RATIONAL, BALL, POLYNOMIAL = "rational", "ball", "polynomial"


class RingError(ValueError):
    """An operation that the shapes or the rings of its operands do not allow."""


class Matrix:
    """Matrix over one of the three rings, with at least one entry.

    Parameters
    ----------
    data : fmpq_mat, arb_mat or sequence of rows of fmpq_mpoly
        The entries; the ring follows from the type.

    Raises
    ------
    RingError
        If it has no entries.
    BudgetError
        If it is larger than `gainsay.exact.budget` allows.
    """

    __slots__ = ("bits", "data", "ring", "shape", "terms")

    def __init__(self, data: Any) -> None:
        self.data = data
        if isinstance(data, fmpq_mat):
            self.ring, self.shape = RATIONAL, (data.nrows(), data.ncols())
        elif isinstance(data, arb_mat):
            self.ring, self.shape = BALL, (data.nrows(), data.ncols())
        else:
            self.data = [list(row) for row in data]
            self.ring, self.shape = POLYNOMIAL, (len(self.data), len(self.data[0]) if self.data else 0)
        if 0 in self.shape:
            raise RingError(f"a matrix of shape {self.shape} has no entries")
        self.bits, self.terms = self._measured()

    def _measured(self) -> tuple[int, int]:
        """Largest bits of an entry or coefficient (0 for balls), and number of terms; refused where too large."""
        fits(self.shape)
        count = self.shape[0] * self.shape[1]
        spend(1000 + 50 * count, f"a matrix of shape {self.shape}")
        if self.ring == BALL:
            return 0, count
        if self.ring == RATIONAL:
            bits, terms = max(map(fmpq.height_bits, self.data.entries())), count
        else:
            entries = [x for row in self.data for x in row]
            terms = sum(len(x) for x in entries)
            if terms > MOST_TERMS:
                raise BudgetError(f"polynomials of {terms} terms: at most {MOST_TERMS}")
            spend(100 * terms, f"polynomials of {terms} terms")
            degree = max((int(x.total_degree()) for x in entries if x != 0), default=0)
            if degree > MOST_DEGREE:
                raise BudgetError(f"a polynomial of degree {degree}: at most {MOST_DEGREE}")
            bits = max((c.height_bits() for x in entries for c in x.coeffs()), default=1)
        if bits > MOST_BITS:
            raise BudgetError(f"a number of {bits} bits: at most {MOST_BITS}")
        return bits, terms

    @classmethod
    def number(cls, value: object) -> "Matrix":
        """Number of any ring as a matrix of shape (1, 1)."""
        if isinstance(value, arb):
            return cls(arb_mat([[value]]))
        if isinstance(value, fmpq_mpoly):
            return cls([[value]])
        return cls(fmpq_mat(1, 1, [to_fmpq(value)]))

    @classmethod
    def of(cls, rows: Sequence[Sequence[object]]) -> "Matrix":
        """Rational matrix of nested sequences of texts, fractions, integers or floats (taken as binary numbers)."""
        return cls(rational_matrix(rows))

    @property
    def is_number(self) -> bool:
        """Whether the shape is (1, 1)."""
        return self.shape == (1, 1)

    @property
    def is_exact(self) -> bool:
        """Whether the ring is that of the rationals."""
        return self.ring == RATIONAL

    def entry(self, i: int, j: int) -> Any:
        """Entry (i, j), counted from 0, as an element of the ring."""
        return self.data[i][j] if self.ring == POLYNOMIAL else self.data[i, j]

    def rows(self) -> list[list[Any]]:
        """Entries as nested lists of ring elements."""
        return [list(row) for row in self.data] if self.ring == POLYNOMIAL else self.data.tolist()

    def value(self) -> Fraction:
        """Exact value of a rational number.

        Raises
        ------
        RingError
            If this is not a rational number.
        """
        if self.ring != RATIONAL or not self.is_number:
            raise RingError(f"expected a rational number, found a {self.ring} of shape {self.shape}")
        entry = self.data[0, 0]
        return Fraction(int(entry.p), int(entry.q))

    def to_ball(self) -> "Matrix":
        """Enclose the entries in balls at the precision in force."""
        if self.ring == POLYNOMIAL:
            raise RingError("a polynomial has no enclosure")
        return self if self.ring == BALL else Matrix(arb_mat(self.data))

    def to_polynomial(self, context: Any) -> "Matrix":
        """Write the entries as constant polynomials."""
        if self.ring == BALL:
            raise RingError("balls and indeterminates do not mix: an identity or a Farkas proof needs rationals")
        if self.ring == POLYNOMIAL:
            return self
        return Matrix([[context.constant(x) for x in row] for row in self.data.tolist()])

    def _pair(self, other: "Matrix") -> tuple["Matrix", "Matrix"]:
        if self.ring == other.ring:
            return self, other
        if POLYNOMIAL in (self.ring, other.ring):
            context = (self if self.ring == POLYNOMIAL else other).entry(0, 0).context()
            return self.to_polynomial(context), other.to_polynomial(context)
        return self.to_ball(), other.to_ball()

    def _entrywise(self, other: "Matrix", operate: Callable[[Any, Any], Any]) -> "Matrix":
        if self.shape != other.shape:
            raise RingError(f"shapes {self.shape} and {other.shape} do not add")
        a, b = self._pair(other)
        spend(_sum_cost(a, b), "a sum of matrices")
        if a.ring != POLYNOMIAL:
            return Matrix(operate(a.data, b.data))
        lines = zip(a.data, b.data, strict=True)
        return Matrix([[operate(x, y) for x, y in zip(p, q, strict=True)] for p, q in lines])

    def __add__(self, other: "Matrix") -> "Matrix":
        return self._entrywise(other, lambda x, y: x + y)

    def __sub__(self, other: "Matrix") -> "Matrix":
        return self._entrywise(other, lambda x, y: x - y)

    def __neg__(self) -> "Matrix":
        return self.scaled(Matrix.number(-1))

    def scaled(self, factor: "Matrix") -> "Matrix":
        """Multiply by a number."""
        if not factor.is_number:
            raise RingError(f"factor of shape {factor.shape} where a number is expected")
        spend(_product_cost(self, factor, self.shape[0] * self.shape[1]), "a multiple of a matrix")
        if self.ring == POLYNOMIAL or factor.ring == POLYNOMIAL:
            if BALL in (self.ring, factor.ring):
                raise RingError("balls and indeterminates do not mix: an identity or a Farkas proof needs rationals")
            number = factor.entry(0, 0)
            _room(self.terms * factor.terms, self if self.ring == POLYNOMIAL else factor)
            if self.ring == POLYNOMIAL:
                return Matrix([[x * number for x in row] for row in self.data])
            return Matrix([[number * x for x in row] for row in self.data.tolist()])
        a, b = self._pair(factor)
        return Matrix(a.data * b.data[0, 0])

    def __mul__(self, other: "Matrix") -> "Matrix":
        if other.is_number:
            return self.scaled(other)
        if self.is_number:
            return other.scaled(self)
        raise RingError(f"product * of shapes {self.shape} and {other.shape}: matrices multiply with @")

    def __matmul__(self, other: "Matrix") -> "Matrix":
        if self.shape[1] != other.shape[0]:
            raise RingError(f"shapes {self.shape} and {other.shape} do not multiply")
        if POLYNOMIAL not in (self.ring, other.ring):
            a, b = self._pair(other)
            spend(_product_cost(a, b, self.shape[0] * self.shape[1] * other.shape[1]), "a product of matrices")
            return Matrix(a.data * b.data)
        if BALL in (self.ring, other.ring):
            raise RingError("balls and indeterminates do not mix: an identity or a Farkas proof needs rationals")
        context = (self if self.ring == POLYNOMIAL else other).entry(0, 0).context()
        zero = context.constant(0)
        left = [[(k, x) for k, x in enumerate(row) if x != 0] for row in self.rows()]
        right = other.rows()
        words = _words(context)
        made = 0
        coefficient = multiply_cost(self.bits, other.bits)
        result = []
        for row in left:
            line = [zero] * other.shape[1]
            for k, x in row:
                for j, y in enumerate(right[k]):
                    if y != 0:
                        pairs = _count(x) * _count(y)
                        spend(200 + pairs * coefficient * 3 + len(line[j]) * words, "a product of polynomials")
                        if (made + pairs) * words > MOST_WORDS:
                            raise BudgetError("a product of polynomials that would fill the memory")
                        made -= len(line[j])
                        line[j] = line[j] + x * y
                        made += len(line[j])
            result.append(line)
        return Matrix(result)

    def over(self, other: "Matrix") -> "Matrix":
        """Divide by a number that is not a polynomial and provably not zero."""
        if not other.is_number:
            raise RingError(f"division by a matrix of shape {other.shape}")
        number = other.entry(0, 0)
        if other.ring == POLYNOMIAL:
            if not number.is_constant():
                raise RingError("division by an indeterminate")
            number = number.leading_coefficient() if number != 0 else fmpq(0)
            other = Matrix.number(number)
        if (other.ring == RATIONAL and number == 0) or (other.ring == BALL and number.contains(0)):
            raise RingError("division by a number that is or may be zero")
        return self.scaled(Matrix.number(1 / number))

    @property
    def T(self) -> "Matrix":
        """Transpose."""
        if self.ring == POLYNOMIAL:
            return Matrix([list(column) for column in zip(*self.data, strict=True)])
        return Matrix(self.data.transpose())

    def power(self, exponent: int) -> "Matrix":
        """Non-negative integer power of a number or a square matrix."""
        if self.shape[0] != self.shape[1] or exponent < 0:
            raise RingError(f"power {exponent} of shape {self.shape}")
        result = eye(self.shape[0])
        for _ in range(exponent):
            result = result @ self
        return result

    def inverse(self) -> "Matrix":
        """Inverse of a square matrix of rationals or balls.

        Raises
        ------
        RingError
            If it is singular, or not provably regular, or holds indeterminates.
        """
        if self.ring == POLYNOMIAL or self.shape[0] != self.shape[1]:
            raise RingError(f"no inverse of a {self.ring} matrix of shape {self.shape}")
        size = self.shape[0]
        bits = 128 if self.ring == BALL else _common_bits(self)
        spend(size**3 * multiply_cost(bits if self.ring == BALL else size * bits, bits), "an inverse")
        try:
            return Matrix(self.data.inv())
        except ZeroDivisionError as error:
            raise RingError("inverse of a matrix that is singular or not provably regular") from error

    def trace(self) -> "Matrix":
        """Sum of the diagonal."""
        if self.shape[0] != self.shape[1]:
            raise RingError(f"trace of shape {self.shape}")
        total = Matrix.number(0)
        for i in range(self.shape[0]):
            total = total + Matrix.number(self.entry(i, i))
        return total

    def take(self, rows: Sequence[int], columns: Sequence[int]) -> "Matrix":
        """Sub-matrix of the rows and columns named, counted from 0."""
        if any(not 0 <= i < self.shape[0] for i in rows) or any(not 0 <= j < self.shape[1] for j in columns):
            raise RingError(f"rows {list(rows)}, columns {list(columns)} of shape {self.shape}")
        if not rows or not columns:
            raise RingError("a sub-matrix without entries")
        fits((len(rows), len(columns)))
        entries = self.rows()
        picked = [[entries[i][j] for j in columns] for i in rows]
        if self.ring == POLYNOMIAL:
            return Matrix(picked)
        return Matrix(arb_mat(picked) if self.ring == BALL else rational_matrix(picked))

    def equals(self, other: "Matrix") -> bool:
        """Whether two matrices of rationals or polynomials are the same; balls are never known to be."""
        if self.shape != other.shape or BALL in (self.ring, other.ring):
            return False
        a, b = self._pair(other)
        return a.data == b.data

    def map(self, function: Callable[[Any], Any]) -> "Matrix":
        """Apply a function of balls entry by entry."""
        return Matrix(arb_mat([[function(x) for x in row] for row in self.to_ball().rows()]))


def fits(shape: tuple[int, int]) -> None:
    """Refuse a shape that is too large."""
    if max(shape) > LARGEST_SIDE:
        raise BudgetError(f"a matrix of shape {shape}: the largest side is {LARGEST_SIDE}")


def _words(context: Any) -> float:
    """Machine words of the exponents of a term."""
    return 2 + len(context.names()) / 8


def _room(pairs: int, polynomial: Matrix) -> None:
    if pairs * _words(polynomial.entry(0, 0).context()) > MOST_WORDS:
        raise BudgetError("a product of polynomials that would fill the memory")


def _count(entry: Any) -> int:
    return len(entry) if isinstance(entry, fmpq_mpoly) else 1


def _sum_cost(a: Matrix, b: Matrix) -> float:
    return max(a.terms, b.terms) * multiply_cost(a.bits, b.bits)


def _product_cost(a: Matrix, b: Matrix, count: int) -> float:
    """Units of so many products of an entry of each, the sums of rationals brought to common denominators."""
    if POLYNOMIAL in (a.ring, b.ring):
        return 3 * a.terms * b.terms * multiply_cost(a.bits, b.bits)
    if BALL in (a.ring, b.ring):
        return 2 * count * multiply_cost(ctx.prec, ctx.prec)
    if count < 1000:
        return count * multiply_cost(2 * a.bits, 2 * b.bits)
    return count * multiply_cost(_common_bits(a), _common_bits(b))


def _common_bits(matrix: Matrix) -> int:
    """Bits of the entries of a rational matrix over their common denominator, or a number that is too many."""
    common = fmpz(1)
    for denominator in {int(x.q) for x in matrix.data.entries()}:
        common = common.lcm(denominator)
        if common.bit_length() > 4 * MOST_BITS:
            break
    return matrix.bits + common.bit_length()


def zeros(rows: int, columns: int) -> Matrix:
    """Zero matrix."""
    fits((rows, columns))
    return Matrix(fmpq_mat(rows, columns))


def eye(size: int) -> Matrix:
    """Identity matrix."""
    fits((size, size))
    return Matrix(fmpq_mat([[int(i == j) for j in range(size)] for i in range(size)]))
