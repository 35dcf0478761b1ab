"""Balls: real numbers enclosed as midpoint and radius, at a stated precision in bits.

Reference: F. Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval arithmetic", IEEE Transactions on
Computers 66 (2017) 1281-1292.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction

from flint import acb_mat, arb, arb_mat, ctx

from gainsay.exact.budget import MOST_BITS, spend
from gainsay.exact.rational import exact, to_fmpq

__all__ = [
    "DEFAULT_BITS",
    "ball",
    "decimal_above",
    "decimal_below",
    "eigenvalues",
    "hull",
    "lower",
    "precision",
    "upper",
]

DEFAULT_BITS = 128


@contextmanager
def precision(bits: int = DEFAULT_BITS) -> Iterator[None]:
    """Work at a precision of so many bits inside the block."""
    with ctx.workprec(bits):
        yield


def ball(value: object, radius: object = 0) -> arb:
    """Enclosure of the interval from value - radius to value + radius."""
    middle = arb(to_fmpq(value))
    spread = exact(radius)
    return middle if spread == 0 else middle + arb(mid=0, rad=arb(to_fmpq(spread)).upper())


def hull(low: object, high: object) -> arb:
    """Smallest enclosure at hand of the interval from low to high.

    Raises
    ------
    ValueError
        If low exceeds high.
    """
    a, b = exact(low), exact(high)
    if a > b:
        raise ValueError(f"interval from {a} to {b} is empty")
    return ball((a + b) / 2, (b - a) / 2)


def lower(value: arb) -> Fraction:
    """Exact lower end of a ball.

    Raises
    ------
    ArithmeticError
        If the ball is not finite, or of a size that no number in a certificate has.
    """
    return _end(value, value.lower())


def upper(value: arb) -> Fraction:
    """Exact upper end of a ball; raises like `lower`."""
    return _end(value, value.upper())


def _end(value: arb, end: arb) -> Fraction:
    if not value.is_finite():
        raise ArithmeticError("an enclosure is not finite")
    _, power = end.man_exp()
    if abs(power) > MOST_BITS:  # written out as a ratio it would fill the memory
        raise ArithmeticError("an enclosure too large or too near to zero to be written out")
    return exact(end.fmpq())


def decimal_below(value: Fraction, digits: int = 17) -> Fraction:
    """Largest decimal of so many significant digits that is not above the value."""
    return _decimal(value, digits, -1)


def decimal_above(value: Fraction, digits: int = 17) -> Fraction:
    """Smallest decimal of so many significant digits that is not below the value."""
    return _decimal(value, digits, 1)


def _decimal(value: Fraction, digits: int, side: int) -> Fraction:
    if value == 0:
        return value
    power = len(str(abs(value.numerator))) - len(str(value.denominator)) - digits
    unit = Fraction(10) ** power
    scaled = value / unit
    return unit * (scaled.__floor__() if side < 0 else scaled.__ceil__())


def eigenvalues(matrix: arb_mat) -> list:
    """Enclosures of all eigenvalues, each in a ball of its own.

    Raises
    ------
    ArithmeticError
        If they could not be separated: repeated, or the matrix too wide.
    """
    if not all(x.is_finite() for x in matrix.entries()):
        raise ArithmeticError("eigenvalues of a matrix that is not finite")
    spend(500 * matrix.nrows() ** 3 * (1 + ctx.prec / 64), "eigenvalues")
    try:
        values = acb_mat(matrix).eig()
    except (ValueError, ArithmeticError) as error:
        raise ArithmeticError("eigenvalues could not be separated (repeated, or the enclosure too wide)") from error
    return list(values)
