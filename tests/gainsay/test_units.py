"""Units of tables: exact factors to SI, and what is refused."""

import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.tables.units import OTHER_SYMBOLS, PREFIXES, SI_SYMBOLS, is_exact, to_si

SYMBOLS = st.sampled_from([*SI_SYMBOLS, *OTHER_SYMBOLS])
POWERS = st.sampled_from(["", "^2", "^3"])


# definitions of the SI brochure, 9th edition, tables 7 and 8
@pytest.mark.parametrize(
    ("unit", "si", "factor"),
    [
        ("1", "1", 1),
        ("%", "1", Fraction(1, 100)),
        ("km", "m", 1000),
        ("cm^2", "m^2", Fraction(1, 10**4)),
        ("g", "kg", Fraction(1, 1000)),
        ("mN m", "N m", Fraction(1, 1000)),
        ("km^3/s^2", "m^3/s^2", 10**9),
        ("kg^0.5 m/s", "kg^0.5 m/s", 1),
        ("cm^0.5", "m^0.5", Fraction(1, 10)),
        ("N m s^0.5", "N m s^0.5", 1),
        ("1/s^2", "1/s^2", 1),
        ("kHz", "1/s", 1000),
        ("Hz s", "1", 1),
        ("km/h", "m/s", Fraction(1000, 3600)),
        ("N m/rad/s", "N m/rad/s", 1),
        ("mixed", "mixed", 1),
    ],
)
def test_factors_are_those_of_si(unit, si, factor):
    assert to_si(unit) == (si, factor)
    assert to_si(si) == (si, 1)
    assert is_exact(unit)


@pytest.mark.parametrize(
    ("unit", "si", "double"),
    # 180 deg = pi, 60 arcmin = 1 deg, 1 rpm = 2 pi/60 rad/s; pi/180 and pi/30 rounded once, by the C library's pi
    [("deg", "rad", math.pi / 180), ("deg/s", "rad/s", math.pi / 180), ("rpm", "rad/s", math.pi / 30)],
)
def test_angles_keep_pi_apart(unit, si, double):
    name, factor = to_si(unit)
    assert name == si
    assert float(factor) == pytest.approx(double, rel=2e-16)
    assert not is_exact(unit)
    # where the power of pi cancels, so does pi
    assert to_si(f"{unit}/deg")[1].denominator < 100
    assert is_exact(f"{unit}/deg")


@given(SYMBOLS, POWERS, SYMBOLS, POWERS)
@settings(max_examples=100, deadline=None)
def test_factors_of_products_and_quotients_multiply_and_divide(first, power, second, other):
    a, b = first + power, second + other
    (_, one), (_, two) = to_si(a), to_si(b)
    assert to_si(f"{a} {b}")[1] == one * two
    assert to_si(f"{a}/{b}")[1] == one / two


@given(st.sampled_from([s for s in SI_SYMBOLS if s != "kg"]), st.sampled_from(list(PREFIXES)))
def test_a_prefix_is_a_power_of_ten(symbol, prefix):
    unit = prefix + symbol
    if unit in SI_SYMBOLS or unit in OTHER_SYMBOLS:  # cd, min and such are symbols of their own
        return
    assert to_si(unit) == (symbol, Fraction(10) ** PREFIXES[prefix])


@pytest.mark.parametrize(
    "unit",
    ["", " ", "stone", "N  m", "m ", "m/", "/s", "1/1", "1 m", "m^0", "m^-1", "m^0.0", "m^1e3", "m**2", "m/s s", "kkg",
     "mkg", "kmin", "mdeg", "k%", "mixed m", "N·m", "µm", "m²", "m^١", "nan", "Mm\n"],
)  # fmt: skip
def test_what_is_no_unit_is_refused(unit):
    with pytest.raises(InputError, match="known unit"):
        to_si(unit)


@pytest.mark.parametrize("unit", ["km^0.5", "deg^0.5", "rpm^1.5", "m/g^0.5"])
def test_factors_that_are_not_exact_are_refused(unit):
    with pytest.raises(InputError, match="stays rational"):
        to_si(unit)
