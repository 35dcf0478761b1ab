"""When a number meets a claim: between two ends that its comparator, published value and tolerance give."""

import math
from dataclasses import dataclass
from fractions import Fraction

from gainsay.errors import InputError
from gainsay.exact.digits import PrintedNumber
from gainsay.tables.models import Claim
from gainsay.tables.thresholds import published_ends, thresholds
from gainsay.tables.units import to_si

Number = Fraction | float
#: comparators that hold a quantity against numbers of the table
NUMERIC = ("equal", "at_most", "at_least", "inside")


@dataclass(frozen=True)
class Criterion:
    """The values that meet a claim, in SI: an interval that holds its ends.

    Attributes
    ----------
    floor, ceiling : Fraction or infinite float
    tolerance : Fraction
        What of the interval is tolerance.
    phrase : str
        The same in words, in the unit of the claim.
    """

    floor: Number
    ceiling: Number
    tolerance: Fraction
    phrase: str

    def holds(self, value: Number) -> bool:
        """Say whether a value meets the claim."""
        return self.floor <= value <= self.ceiling

    def holds_on(self, low: Number, high: Number) -> bool | None:
        """Say whether every value in low..high meets the claim (True), none (False), or some (None)."""
        if self.floor <= low and high <= self.ceiling:
            return True
        return False if high < self.floor or low > self.ceiling else None


def tolerance(claim: Claim) -> Fraction:
    """Return the absolute tolerance in SI: as stated, else half a printed unit where equality is meant."""
    factor = to_si(claim.unit)[1]
    if claim.tolerance:
        return PrintedNumber(claim.tolerance).value * factor
    return PrintedNumber(claim.published).half_unit * factor if claim.comparator == "equal" else Fraction(0)


def criteria(claim: Claim) -> tuple[Criterion, ...]:
    """Return when a number meets a claim: under its threshold, or under the strictest and the most lenient reading.

    A bound holds its end, and gets no tolerance from its digits.

    Raises
    ------
    InputError
        If the claim's comparator holds a quantity against no number of the table.
    """
    if claim.comparator not in NUMERIC:
        raise InputError(f"claim {claim.id}:", field="comparator", value=claim.comparator, expected=", ".join(NUMERIC))
    if claim.comparator == "inside":
        return (_criterion(claim, *published_ends(claim.published), claim.published),)
    low, high = thresholds(claim)
    if low == high:
        return (_criterion(claim, low, high, claim.published),)
    readings = (low, high) if claim.comparator == "at_most" else (high, low)
    return tuple(_criterion(claim, one, one, one.text) for one in readings)


def _criterion(claim: Claim, low: PrintedNumber, high: PrintedNumber, printed: str) -> Criterion:
    factor, allowed = to_si(claim.unit)[1], tolerance(claim)
    floor: Number = low.value * factor - allowed
    ceiling: Number = high.value * factor + allowed
    if claim.comparator == "at_most":
        floor = -math.inf
    if claim.comparator == "at_least":
        ceiling = math.inf
    words = {"equal": "", "inside": "inside ", "at_most": "at most ", "at_least": "at least "}[claim.comparator]
    within = f" +- {claim.tolerance}" if claim.tolerance else ""
    return Criterion(floor, ceiling, allowed, f"{words}{printed}{within} {claim.unit}".removesuffix(" 1"))
