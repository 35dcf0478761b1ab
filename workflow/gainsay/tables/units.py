"""Units of tables: products of powers of unit symbols, such as ``N m``, ``km^3/s^2`` or ``kg^0.5 m/s``, and SI.

Factors stand apart by a space; each stroke divides by the one factor behind it. Symbols are those below with the
prefixes of SI. Factors to SI are exact rationals, except that those of angles in degrees and turns hold a power of pi,
which is kept as such: a number in such a unit has no exact rational value in SI.

The library pint can be told to calculate in ``Fraction`` as well. It is not used: a root of a prefix passes through
floats there (the square root of 1000 becomes 31622776601683793/10^15), pi is a decimal of 50 digits unless a registry
of our own says otherwise, and its import costs each of a run's thirty steps a tenth of a second of CPU. What is left,
reading ``a b^p/c``, is shorter than what would adapt it.
"""

import re
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from typing import NamedTuple

from gainsay.errors import InputError

#: pi to 60 digits: a double, a printed digit or a bound decided with it is decided as with pi
PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494")
_BASE = ("m", "s", "kg", "A", "K", "mol", "cd")
_DERIVED = ("rad", "sr", "N", "Pa", "J", "W", "V", "C", "T", "Wb", "H", "F", "ohm")
#: SI symbols that results are written in; each may have a prefix but for kg
SI_SYMBOLS = (*_BASE, *_DERIVED)
#: other symbols -> SI unit, rational factor to it, and the power of pi that belongs to the factor
OTHER_SYMBOLS: dict[str, tuple[str, Fraction, int]] = {
    "g": ("kg", Fraction(1, 1000), 0),
    "Hz": ("1/s", Fraction(1), 0),
    "%": ("1", Fraction(1, 100), 0),
    "min": ("s", Fraction(60), 0),
    "h": ("s", Fraction(3600), 0),
    "d": ("s", Fraction(86400), 0),
    "deg": ("rad", Fraction(1, 180), 1),
    "arcmin": ("rad", Fraction(1, 10_800), 1),
    "arcsec": ("rad", Fraction(1, 648_000), 1),
    "rpm": ("rad/s", Fraction(1, 30), 1),
}
PREFIXES = {"p": -12, "n": -9, "u": -6, "m": -3, "c": -2, "d": -1, "k": 3, "M": 6, "G": 9, "T": 12}
_NO_PREFIX = {"kg", *OTHER_SYMBOLS} - {"g", "Hz"}
#: a table whose entries have units of their own
MIXED = "mixed"
_FACTOR = re.compile(r"(?P<symbol>[A-Za-z%]+)(\^(?P<power>[1-9]\d?(\.\d{1,2})?|0\.\d?[1-9]))?", re.ASCII)
EXPECTED = "a known unit, such as N m, km^3/s^2, deg/s or 1"


class _Converted(NamedTuple):
    """SI unit, rational factor to it and power of pi beside the factor."""

    si: str
    factor: Fraction
    pi: int


def with_unit(number: str, unit: str) -> str:
    """Return a number with its unit; a pure number has none to show."""
    return number if unit == "1" else f"{number} {unit}"


def to_si(unit: str) -> tuple[str, Fraction]:
    """Return the SI unit and the factor of a unit, where pi belongs to it with `PI` for pi.

    Raises
    ------
    InputError
        If the unit is not known, or its factor to SI is neither rational nor a rational times a power of pi.

    Examples
    --------
    >>> to_si("km^3/s^2")
    ('m^3/s^2', Fraction(1000000000, 1))
    >>> to_si("mN m")
    ('N m', Fraction(1, 1000))
    """
    si, factor, pi = _converted(unit)
    return si, factor * PI**pi


def is_exact(unit: str) -> bool:
    """Whether a rational number in the unit is a rational number in SI: whether no pi belongs to its factor."""
    return _converted(unit).pi == 0


@cache
def _converted(unit: str) -> _Converted:
    if unit == MIXED:
        return _Converted(MIXED, Fraction(1), 0)
    powers: dict[str, Fraction] = {}
    factor, pi = Fraction(1), Fraction(0)
    for symbol, power in _factors(unit, unit):
        name, scale, turns = _symbol(symbol, unit)
        for base, exponent in _factors(name, unit):
            powers[base] = powers.get(base, Fraction(0)) + exponent * power
        factor, pi = factor * _raised(scale, power, unit), pi + turns * power
    # whole: no root of a factor with pi is rational
    return _Converted(_text(powers), factor, int(pi))


def _factors(text: str, unit: str) -> Iterator[tuple[str, Fraction]]:
    """Symbols and powers of a unit's text, those behind a stroke negative."""
    above, *below = text.split("/")
    signed = [(part, 1) for part in above.split(" ") if above != "1"] + [(part, -1) for part in below]
    for part, sign in signed:
        match = _FACTOR.fullmatch(part)
        if match is None:
            raise InputError("unit", value=unit, expected=EXPECTED)
        yield match["symbol"], sign * Fraction(match["power"] or 1)


def _symbol(symbol: str, unit: str) -> tuple[str, Fraction, int]:
    """SI unit, rational factor and power of pi of one symbol, which may have a prefix."""
    if symbol in SI_SYMBOLS:
        return symbol, Fraction(1), 0
    if symbol in OTHER_SYMBOLS:
        return OTHER_SYMBOLS[symbol]
    prefix, rest = symbol[:1], symbol[1:]
    if prefix not in PREFIXES or rest in _NO_PREFIX or rest not in (*SI_SYMBOLS, *OTHER_SYMBOLS):
        raise InputError("unit", value=unit, expected=EXPECTED)
    si, factor, pi = _symbol(rest, unit)
    return si, factor * Fraction(10) ** PREFIXES[prefix], pi


def _raised(factor: Fraction, power: Fraction, unit: str) -> Fraction:
    """Rational power of a factor, where it is rational."""
    whole = factor ** abs(power.numerator)
    ends = [_root(end, power.denominator) for end in (whole.numerator, whole.denominator)]
    if None in ends:
        raise InputError("unit", value=unit, expected="powers under which the factor to SI stays rational")
    root = Fraction(*(end or 1 for end in ends))
    return root if power > 0 else 1 / root


def _root(number: int, degree: int) -> int | None:
    """Integer root of a positive integer, where there is one."""
    near = round(number ** (1 / degree)) if number < 10**15 else 0
    return number if degree == 1 else near if near**degree == number else None


def _text(powers: dict[str, Fraction]) -> str:
    """SI unit as tables write it: numerator in order, then a stroke before each divisor."""
    parts = {symbol: symbol if abs(p) == 1 else f"{symbol}^{float(abs(p)):g}" for symbol, p in powers.items()}
    above = " ".join(parts[symbol] for symbol, p in powers.items() if p > 0) or "1"
    return "/".join([above, *(parts[symbol] for symbol, p in powers.items() if p < 0)])
