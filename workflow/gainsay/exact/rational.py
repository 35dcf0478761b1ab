"""Exact rationals: from text, to text, from floats, and rounding of floats to short decimals."""

import math
import re
from collections.abc import Sequence
from fractions import Fraction
from numbers import Integral, Rational, Real
from typing import Any

from flint import fmpq, fmpq_mat

__all__ = [
    "exact",
    "fraction_of",
    "rational_matrix",
    "rational_rows",
    "shorten",
    "shorten_matrix",
    "to_fmpq",
    "to_text",
]

# Decimal or ratio of integers; the exponent is bounded so that a text cannot ask for gigabytes of digits.
# ASCII alone: \d takes the digits of every script.
_DECIMAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?", re.ASCII)
_RATIO = re.compile(r"[+-]?\d+/\d+", re.ASCII)
_LONGEST_DECIMAL = 40


def exact(value: object) -> Fraction:
    """Exact value of a text, an integer, a fraction or a float.

    Parameters
    ----------
    value : str, int, Fraction, fmpq or float
        A decimal ("-8.8129e-4") or ratio ("1/3") as text; a float stands for the binary number that it is.

    Returns
    -------
    Fraction

    Raises
    ------
    ValueError
        If the text is no decimal and no ratio, or the float is not finite.
    """
    if isinstance(value, str):
        text = value.strip(" ")
        if _DECIMAL.fullmatch(text) or (_RATIO.fullmatch(text) and text.split("/")[1].strip("0")):
            return Fraction(text)
        raise ValueError(f"{value!r} is no exact number: expected a decimal or a ratio of integers")
    if isinstance(value, fmpq):
        return Fraction(int(value.p), int(value.q))
    if isinstance(value, (Rational, Integral)):
        return Fraction(value)
    if isinstance(value, Real):
        number = float(value)
        if not math.isfinite(number):
            raise ValueError(f"{value!r} is not finite")
        return Fraction(number)
    raise ValueError(f"{value!r} is no exact number")


def to_fmpq(value: object) -> fmpq:
    """`exact(value)` as a python-flint rational."""
    if isinstance(value, fmpq):
        return value
    if isinstance(value, float) and math.isfinite(value):  # at once: blocks hold thousands
        return fmpq(*value.as_integer_ratio())
    fraction = exact(value)
    return fmpq(fraction.numerator, fraction.denominator)


def fraction_of(value: fmpq) -> Fraction:
    """The `Fraction` equal to a python-flint rational."""
    return Fraction(int(value.p), int(value.q))


def to_text(value: object) -> str:
    """Shortest exact text of a rational: a decimal where one of at most 40 digits exists, else "p/q"."""
    number = exact(value)
    if number == 0:
        return "0"
    twos, fives, rest = 0, 0, number.denominator
    while rest % 2 == 0 and twos <= 4 * _LONGEST_DECIMAL:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0 and fives <= 4 * _LONGEST_DECIMAL:
        rest, fives = rest // 5, fives + 1
    if rest != 1:
        return f"{number.numerator}/{number.denominator}"
    places = max(twos, fives)
    digits = number.numerator * 10**places // number.denominator
    power = -places
    while digits % 10 == 0:
        digits, power = digits // 10, power + 1
    length = len(str(abs(digits)))
    if length > _LONGEST_DECIMAL:
        return f"{number.numerator}/{number.denominator}"
    if power >= 0 and length + power <= 7:
        return str(digits * 10**power)
    if power < 0 and -power <= length + 4:
        sign, body = ("-", str(-digits)) if digits < 0 else ("", str(digits))
        body = body.rjust(1 - power, "0")
        return f"{sign}{body[:power]}.{body[power:]}"
    sign, body = ("-", str(-digits)) if digits < 0 else ("", str(digits))
    mantissa = body if length == 1 else f"{body[0]}.{body[1:]}"
    return f"{sign}{mantissa}e{power + length - 1}"


def shorten(value: float, digits: int) -> Fraction:
    """The float rounded to so many significant decimal digits, as an exact rational."""
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{value!r} is not finite")
    return Fraction(f"{number:.{max(digits, 1) - 1}e}") if number else Fraction(0)


def shorten_matrix(values: object, digits: int, symmetric: bool = False) -> fmpq_mat:
    """A float matrix rounded entry by entry to short decimals.

    Parameters
    ----------
    values : array_like, shape (m, n)
        Floats.
    digits : int
        Significant decimal digits of each entry.
    symmetric : bool, optional
        Round the mean of the matrix and its transpose, so that the result is exactly symmetric.
    """
    rows = float_rows(values)
    if symmetric:
        rows = [[(rows[i][j] + rows[j][i]) / 2 for j in range(len(rows))] for i in range(len(rows))]
    return rational_matrix([[shorten(x, digits) for x in row] for row in rows])


def doubles_around(low: Fraction, high: Fraction) -> tuple[float, float]:
    """Return the nearest doubles that enclose an interval.

    Examples
    --------
    >>> lower, upper = doubles_around(Fraction(1, 10), Fraction(1, 10))
    >>> Fraction(lower) <= Fraction(1, 10) <= Fraction(upper), lower == upper
    (True, False)
    """
    lower, upper = float(low), float(high)
    return (
        lower if Fraction(lower) <= low else math.nextafter(lower, -math.inf),
        upper if Fraction(upper) >= high else math.nextafter(upper, math.inf),
    )


def float_rows(values: Any) -> list[list[float]]:
    """Nested lists of floats of an array, a nested sequence or a scalar."""
    listed = values.tolist() if hasattr(values, "tolist") else values
    if not isinstance(listed, Sequence):
        return [[float(listed)]]
    if listed and not isinstance(listed[0], Sequence):
        return [[float(x)] for x in listed]
    return [[float(x) for x in row] for row in listed]


def rational_matrix(rows: Sequence[Sequence[object]]) -> fmpq_mat:
    """Rational matrix of nested sequences of anything that `exact` reads.

    Raises
    ------
    ValueError
        If the rows differ in length, or an entry is no exact number.
    """
    listed = [[to_fmpq(x) for x in row] for row in rows]
    width = len(listed[0]) if listed else 0
    if any(len(row) != width for row in listed):
        raise ValueError("the rows of a matrix differ in length")
    return fmpq_mat(len(listed), width, [x for row in listed for x in row])


def rational_rows(matrix: fmpq_mat) -> list[list[str]]:
    """Entries of a rational matrix as exact texts."""
    return [[to_text(x) for x in row] for row in matrix.tolist()]
