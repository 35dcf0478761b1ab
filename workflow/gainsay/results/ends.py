"""Ends of an enclosure, as a certificate proves them."""

import math
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
