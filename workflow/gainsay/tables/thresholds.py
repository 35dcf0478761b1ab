"""Thresholds of claims: what the paper prints, or a range of readings whose ends have a source."""

import re
from collections.abc import Iterator
from fractions import Fraction

from gainsay.errors import InputError
from gainsay.exact.digits import PrintedNumber
from gainsay.tables.case import Case
from gainsay.tables.models import Claim
from gainsay.tables.units import to_si

_POWER_OF_TEN = re.compile(r"\s*(?:\\times|\\cdot)\s*10\^\{?(-?\d+)\}?")
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?( ?(?:%|\\%))?")


def published_ends(published: str) -> tuple[PrintedNumber, PrintedNumber]:
    """Return the two ends of a published `low..high`.

    Raises
    ------
    InputError
        If it is anything else.
    """
    low, dots, high = published.partition("..")
    if not dots:
        raise InputError("published", value=published, expected="`low..high`")
    return PrintedNumber(low), PrintedNumber(high)


def thresholds(claim: Claim) -> tuple[PrintedNumber, PrintedNumber]:
    """Return the smallest and the largest threshold of a claim: the same where the paper prints it.

    Raises
    ------
    InputError
        If the published value is neither a number nor, for at_most and at_least, a range.
    """
    if claim.comparator in ("at_most", "at_least") and ".." in claim.published:
        return published_ends(claim.published)
    return PrintedNumber(claim.published), PrintedNumber(claim.published)


def printed_in(statement: str) -> set[Fraction]:
    """Return the sizes of the numbers that a sentence prints, those in percent as shares too.

    Examples
    --------
    >>> printed_in(r"below $1.5\\times 10^{-3}$ N m, 5 % of it") == {Fraction("0.0015"), Fraction(5), Fraction("0.05")}
    True
    """
    numbers = set()
    for match in _NUMBER.finditer(_POWER_OF_TEN.sub(r"e\1", statement)):
        text, percent = match[0], match[1]
        value = abs(Fraction(text.removesuffix(percent) if percent else text))
        numbers |= {value, value / 100} if percent else {value}
    return numbers


def _is_said(case: Case, claim: Claim, value: Fraction) -> bool:
    """Whether a threshold is that of a sign or of a ratio, or the sentence or a parameter prints it."""
    if value == 0 or (abs(value) == 1 and claim.unit == "1") or abs(value) in printed_in(claim.statement):
        return True
    unit, factor = to_si(claim.unit)
    numbers = [row for row in case.parameters.values() if row.type == "number" and row.status != "assumed"]
    sizes = ((to_si(row.unit), abs(PrintedNumber(row.value).value)) for row in numbers)
    return any(of[0] == unit and size * of[1] == abs(value) * factor for of, size in sizes)


def reading_faults(case: Case, claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield the faults of a threshold that the paper does not print: it needs two ends and their source."""
    if claim.comparator not in ("at_most", "at_least", "inside"):
        if claim.reading:
            yield "reading", claim.reading, f"nothing, since {claim.comparator or 'a remark'} has no threshold"
        return
    ranged = ".." in claim.published
    try:
        ends = published_ends(claim.published) if ranged else (PrintedNumber(claim.published),)
    except InputError:
        return  # said where the published value is looked at, as is the order of the ends
    printed = ends[0].value > ends[-1].value or all(_is_said(case, claim, end.value) for end in ends)
    ours = ranged and not (claim.comparator == "inside" and printed)
    if ours and not claim.reading:
        yield "reading", "", f"where the ends of the thresholds {claim.published} come from"
    if not ranged and not printed:
        expected = "a threshold that `statement` or a parameter prints, or a range `low..high` with its `reading`"
        yield "published", claim.published, expected
    elif claim.reading and not ours:
        yield "reading", claim.reading, "nothing, or a range of thresholds `low..high` in published"
