"""The units that tables may use, each with its factor to SI."""

from fractions import Fraction

from gainsay.errors import InputError

#: unit as written in a table -> (SI unit of results, exact factor to it; None where pi makes it irrational)
UNITS: dict[str, tuple[str, Fraction]] = {
    "1": ("1", Fraction(1)),
    "%": ("1", Fraction(1, 100)),
    "m": ("m", Fraction(1)),
    "km": ("m", Fraction(1000)),
    "s": ("s", Fraction(1)),
    "kg": ("kg", Fraction(1)),
    "N": ("N", Fraction(1)),
    "N^2": ("N^2", Fraction(1)),
    "N m": ("N m", Fraction(1)),
    "N m s": ("N m s", Fraction(1)),
    "N m/s": ("N m/s", Fraction(1)),
    "N s": ("N s", Fraction(1)),
    "rad": ("rad", Fraction(1)),
    # 1 deg = pi/180 rad: the double nearest to it, as an exact rational, so that conversion is deterministic
    "deg": ("rad", Fraction(0.017453292519943295)),
    "deg/s": ("rad/s", Fraction(0.017453292519943295)),
    "m/s": ("m/s", Fraction(1)),
    "m/s^2": ("m/s^2", Fraction(1)),
    "rad/s": ("rad/s", Fraction(1)),
    "rad/s^2": ("rad/s^2", Fraction(1)),
    "rad^2": ("rad^2", Fraction(1)),
    "rad^2/s^2": ("rad^2/s^2", Fraction(1)),
    "rad^2 s": ("rad^2 s", Fraction(1)),
    "m^2 s": ("m^2 s", Fraction(1)),
    "1/s": ("1/s", Fraction(1)),
    "1/s^2": ("1/s^2", Fraction(1)),
    "Hz": ("1/s", Fraction(1)),
    "kg m^2": ("kg m^2", Fraction(1)),
    "kg^0.5 m": ("kg^0.5 m", Fraction(1)),
    "kg^0.5 m/s": ("kg^0.5 m/s", Fraction(1)),
    "N/m": ("N/m", Fraction(1)),
    "N s/m": ("N s/m", Fraction(1)),
    "N m/rad": ("N m/rad", Fraction(1)),
    "N m s/rad": ("N m s/rad", Fraction(1)),
    "N m s^0.5": ("N m s^0.5", Fraction(1)),
    "m^3/s^2": ("m^3/s^2", Fraction(1)),
    "km^3/s^2": ("m^3/s^2", Fraction(10**9)),
    "rpm": ("rad/s", Fraction(0.10471975511965977)),
    "g": ("kg", Fraction(1, 1000)),
    "cm": ("m", Fraction(1, 100)),
    "mixed": ("mixed", Fraction(1)),
}


def with_unit(number: str, unit: str) -> str:
    """Return a number with its unit; a pure number has none to show."""
    return number if unit == "1" else f"{number} {unit}"


def to_si(unit: str) -> tuple[str, Fraction]:
    """Return the SI unit and the exact factor of a unit.

    Raises
    ------
    InputError
        If the unit is not known.
    """
    try:
        return UNITS[unit]
    except KeyError:
        raise InputError("unit", value=unit, expected=f"one of {', '.join(UNITS)}") from None
