"""Ends of an enclosure, as a certificate proves them."""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from gainsay.exact.rational import doubles_around


def proved_ends(conclusion: Any) -> tuple[float, float]:
    """Lower and upper end that a conclusion of a certificate gives, as doubles on the safe side."""
    relation, value = conclusion.relation, conclusion.value
    if value is None:
        return {"holds": (1.0, 1.0), "fails": (0.0, 0.0)}[relation]
    low, _, high = value.partition("..")
    lower, upper = doubles_around(Fraction(low), Fraction(high or low))
    return {
        "at_most": (-math.inf, upper),
        "less_than": (-math.inf, upper),
        "at_least": (lower, math.inf),
        "greater_than": (lower, math.inf),
        "inside": (lower, upper),
    }[relation]


@dataclass(frozen=True)
class ProvedNumber:
    """A number that a certificate concludes on: the value, and ends, None where it proves none."""

    value: float
    lower: float | None
    upper: float | None


def proved_numbers(certificate: Any) -> dict[str, ProvedNumber]:
    """What a certificate concludes on each of its quantities.

    Of what is enclosed the value is the middle, of what is bounded the level that was asked for, inside the ends.
    A yes is 1, a no is 0, without ends.
    """
    ends: dict[str, list[tuple[float, float]]] = {}
    levels: dict[str, float] = {}
    for conclusion in certificate.conclusions:
        if not conclusion.quantity:
            continue
        ends.setdefault(conclusion.quantity, []).append(proved_ends(conclusion))
        if conclusion.value is not None:
            low, _, high = conclusion.value.partition("..")
            if high or conclusion.quantity not in levels:
                levels[conclusion.quantity] = float((Fraction(low) + Fraction(high or low)) / 2)
    numbers = {}
    for quantity, pairs in ends.items():
        lower, upper = max(low for low, _ in pairs), min(high for _, high in pairs)
        if quantity not in levels:
            numbers[quantity] = ProvedNumber(lower, None, None)
            continue
        value = min(max(levels[quantity], lower), upper)
        finite = [end if math.isfinite(end) else None for end in (lower, upper)]
        numbers[quantity] = ProvedNumber(value, *finite)
    return numbers
