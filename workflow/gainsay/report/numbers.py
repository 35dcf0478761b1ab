"""Numbers as a reader wants them: six significant digits in sight, every digit of the double behind them."""

import math
import re
from collections.abc import Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal

from markupsafe import Markup, escape

DIGITS = 6
_ALL_DIGITS = 17
_MOST_DIGITS = 9  # of the ends of a range that a reader tells apart
_NEAR = 2  # powers of ten within which two numbers are written alike
_POWER = re.compile(r"\^(-?\d+(?:\.\d+)?)")
_ROUNDING = {"": ROUND_HALF_EVEN, "down": ROUND_FLOOR, "up": ROUND_CEILING}


def shorten(text: str, digits: int = DIGITS, towards: str = "", power: int | None = None) -> str:
    """Return a decimal number with at most so many significant digits, as plain text.

    Parameters
    ----------
    text : str
        A decimal number, or a word such as ``inf``, which is returned as it is.
    digits : int
    towards : str
        ``down`` or ``up`` to round an end of a range outward; empty: to nearest.
    power : int, optional
        Power of ten to write it with, as another number beside it is; taken where it is near the number's own.
    """
    try:
        exact = Decimal(text)
    except ArithmeticError:
        return text
    if not exact.is_finite():
        return text
    rounded = Context(prec=digits, rounding=_ROUNDING[towards]).create_decimal(exact)
    if not rounded:
        return "0"
    exponent = rounded.adjusted()
    if power is not None and abs(exponent - power) <= _NEAR:
        exponent = power
    elif -5 < exponent < max(digits, DIGITS):
        plain = format(rounded, "f")
        return plain.rstrip("0").rstrip(".") if "." in plain else plain
    whole = format(rounded.scaleb(-exponent), "f")
    whole = whole.rstrip("0").rstrip(".") if "." in whole else whole
    return f"{whole}e{exponent}"


def typeset(text: str) -> Markup:
    """Return decimal digits with a true minus sign and a power of ten instead of ``e``."""
    mantissa, _, exponent = text.lower().partition("e")
    if not exponent or not re.fullmatch(r"[+-]?[\d.]+", mantissa):
        return escape(text.replace("-", "\u2212") if re.fullmatch(r"-[\d.]+|-inf", text) else text)
    power = str(int(exponent)).replace("-", "\u2212")
    return Markup("{}&nbsp;×&nbsp;10<sup>{}</sup>").format(mantissa.replace("-", "\u2212"), power)


def unit(text: str) -> Markup:
    """Return a unit with its powers raised; nothing for the unit 1."""
    if text in ("", "1"):
        return Markup("")
    return Markup(_POWER.sub(lambda m: f"<sup>{m[1].replace('-', chr(0x2212))}</sup>", str(escape(text))))


def number(text: str, of: str = "", *, digits: int = DIGITS, towards: str = "", power: int | None = None) -> Markup:
    """Return a computed number in short, all digits in its title and value, with its unit.

    Parameters
    ----------
    text : str
        The number as a result file gives it; empty for none.
    of : str
        Its unit.
    digits : int
    towards, power
        See `shorten`.
    """
    if not text:
        return Markup("")
    shown = typeset(shorten(text, digits, towards, power))
    return with_unit(Markup('<data value="{0}" title="{0}">{1}</data>').format(text, shown), of)


def with_unit(shown: Markup, of: str) -> Markup:
    """Join a number and its unit by a space that does not break."""
    named = unit(of)
    return Markup('{}<span class="unit">&nbsp;{}</span>').format(shown, named) if named else shown


def span(low: str, high: str, of: str = "") -> Markup:
    """Return a range, its ends rounded outward; a narrow one as its middle and half width; one end alone is a bound."""
    if low == high:
        return number(low, of)
    if low and high:
        digits = _digits_of_range(low, high)
        if digits > _MOST_DIGITS:
            middle = str((Decimal(low) + Decimal(high)) / 2)
            return Markup("{} ({})").format(number(middle, of), enclosure(middle, low, high, of))
        ends = [number(low, digits=digits, towards="down"), number(high, digits=digits, towards="up")]
        return with_unit(Markup("{} to {}").format(*ends), of)
    if low:
        return Markup("≥&nbsp;{}").format(number(low, of, towards="down"))
    if high:
        return Markup("≤&nbsp;{}").format(number(high, of, towards="up"))
    return Markup("")


def _digits_of_range(low: str, high: str) -> int:
    """Return how many digits keep a range about as narrow as it is, six at least."""
    width = float(high) - float(low)
    for digits in range(DIGITS, _ALL_DIGITS):
        if float(shorten(high, digits, "up")) - float(shorten(low, digits, "down")) <= 1.5 * width:
            return digits
    return _ALL_DIGITS


def enclosure(value: str, low: str, high: str, of: str = "") -> Markup:
    """Return a range around a value: its half width, rounded up, where that is small; else its ends.

    Parameters
    ----------
    value, low, high : str
        ``low <= value <= high``; ends may be empty.
    of : str
        Unit.
    """
    if not low or not high:
        return span(low, high, of)
    radius = max(Decimal(high) - Decimal(value), Decimal(value) - Decimal(low))
    if radius > abs(Decimal(value)) / 1000:
        return span(low, high, of)
    shown = typeset(shorten(str(radius), 2, "up"))
    return with_unit(Markup('<span title="{} to {}">± {}</span>').format(low, high, shown), of)


def digits_apart(text: str, others: Sequence[str]) -> int:
    """Return how many digits tell a number from others that it differs from, six at least."""
    try:
        value = float(text)
        against = [float(other) for other in others if other]
    except ValueError:
        return DIGITS
    against = [other for other in against if other != value and math.isfinite(other)]
    for digits in range(DIGITS, _ALL_DIGITS):
        if all(float(shorten(text, digits)) != other for other in against):
            return digits
    return _ALL_DIGITS
