"""Budgets of exact computations: what would run for ever or fill the memory is refused before it starts.

Sizes have fixed limits. Work is counted in units of about a limb multiplication (some nanoseconds), estimated before
each operation, and limited inside `budget`. Nothing is measured in seconds, so that the same computation is refused, or
not, on every machine.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

__all__ = [
    "LARGEST_SIDE",
    "MOST_BITS",
    "MOST_DEGREE",
    "MOST_TERMS",
    "MOST_WORDS",
    "BudgetError",
    "budget",
    "multiply_cost",
    "spend",
]

#: largest number of rows or columns of a matrix
LARGEST_SIDE = 1000
#: bits of the numerator or denominator of an entry or a coefficient
MOST_BITS = 50_000
#: total degree of a polynomial
MOST_DEGREE = 400
#: terms of all polynomials of a matrix together, and machine words that their exponents may fill
MOST_TERMS, MOST_WORDS = 300_000, 50_000_000

_LIMB = 64
_left: ContextVar[list[float] | None] = ContextVar("work left", default=None)


class BudgetError(ValueError):
    """A computation that is larger than an exact proof has any need of."""


@contextmanager
def budget(units: float) -> Iterator[None]:
    """Allow so many units of work inside the block, inner blocks included."""
    if _left.get() is not None:
        yield
        return
    token = _left.set([units])
    try:
        yield
    finally:
        _left.reset(token)


def spend(units: float, what: str) -> None:
    """Count work that is about to be done.

    Raises
    ------
    BudgetError
        If the work allowed by `budget` does not reach; outside of it work is not counted.
    """
    left = _left.get()
    if left is None:
        return
    left[0] -= units
    if left[0] < 0:
        raise BudgetError(f"{what}: more work than a check may take")


def multiply_cost(bits: float, other: float) -> float:
    """Units of one product of rationals of so many bits."""
    a, b = bits / _LIMB + 1, other / _LIMB + 1
    return 10 + (a + b) * min(a, b, 30)
