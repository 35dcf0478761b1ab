"""What a value on record may differ by, and how much of that a value of today uses."""

import math
from collections.abc import Mapping
from decimal import ROUND_CEILING, Context

from gainsay.tables.models import Toleranced

#: relative rounding allowed in the evaluation of a double whose condition is not examined: 1e6 units of rounding
ROUNDING = "1e-9"
#: columns of a row of quantities.csv
Row = Mapping[str, str]


def allowed(recorded: Toleranced) -> float:
    """Return the absolute difference that a value on record allows."""
    return float(recorded.absolute) + float(recorded.relative) * abs(float(recorded.value))


def share(recorded: Toleranced, value: float) -> float:
    """Return the part of its tolerance by which a value differs from the one on record: above 1 it is another value.

    Examples
    --------
    A value that allows nothing is the same or infinitely far.
    """
    difference = abs(value - float(recorded.value))
    if difference == 0:
        return 0.0
    limit = allowed(recorded)
    return difference / limit if limit > 0 and math.isfinite(difference) else math.inf


def decimal_above(value: float, digits: int = 2) -> str:
    """Return the next decimal of so few digits at or above a number.

    Examples
    --------
    >>> decimal_above(0.00123)
    '0.0013'
    """
    return (
        str(Context(prec=digits, rounding=ROUND_CEILING).create_decimal_from_float(value).normalize())
        .replace("E+", "e")
        .replace("E", "e")
    )


def proposed(row: Row, meaning: str) -> tuple[str, str, str, str]:
    """Return class, relative and absolute tolerance and their reason, of a quantity that is new on record.

    What a yes or no or a count is, is exact; what has an enclosure may move inside it; anything else is a double whose
    rounding is bounded by a condition that is stated, not measured.
    """
    value = float(row["value"])
    if math.isnan(value):
        return "exact", "0", "0", "undecided: neither side is proved"
    if row["lower"] and row["upper"]:
        width = float(row["upper"]) - float(row["lower"])
        if width > 0:
            return "enclosed", "1e-12", decimal_above(width), "width of its enclosure"
    if row["unit"] == "1" and value.is_integer() and meaning.startswith(("whether", "number of", "rank", "order")):
        return "exact", "0", "0", "a yes or no, or a count"
    return "rounding", ROUNDING, "0", "rounding of doubles, with a condition of up to a million"
