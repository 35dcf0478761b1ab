import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.report.numbers import digits_apart, enclosure, number, shorten, span, typeset, unit

doubles = st.floats(allow_nan=False, allow_infinity=False)
TITLE = re.compile(r'title="([^"]*)"')


@given(doubles)
def test_rounding_to_nearest_is_within_half_a_unit_of_the_sixth_digit(value):
    # Definition of rounding to six significant digits: relative error at most half of 1e-5.
    shown = Fraction(shorten(repr(value)))
    assert abs(shown - Fraction(repr(value))) <= abs(Fraction(repr(value))) * Fraction(5, 10**6)


@given(doubles)
def test_ends_of_a_range_are_rounded_outward(value):
    exact = Fraction(repr(value))
    assert Fraction(shorten(repr(value), towards="down")) <= exact <= Fraction(shorten(repr(value), towards="up"))


@given(doubles, st.integers(6, 17), st.integers(-3, 3))
def test_a_common_power_of_ten_changes_no_value(value, digits, power):
    assert Fraction(shorten(repr(value), digits, power=power)) == Fraction(shorten(repr(value), digits))


@given(doubles)
def test_all_digits_of_a_double_stand_behind_the_short_number(value):
    assert float(TITLE.search(number(repr(value), "N"))[1]) == value


@given(st.floats(-1e300, 1e300), st.floats(0, 1e3), st.floats(0, 1e3))
def test_an_enclosure_never_looks_narrower_than_it_is(value, below, above):
    low, high = value - below, value + above
    shown = str(enclosure(repr(value), repr(low), repr(high)))
    if "±" in shown:
        radius = Fraction(plain(shown).removeprefix("±").strip())
        assert Fraction(repr(value)) - radius <= Fraction(repr(low))
        assert Fraction(repr(high)) <= Fraction(repr(value)) + radius
    elif "to" in shown:
        ends = [Fraction(plain(end)) for end in re.sub("<data[^>]*>", "", shown).split(" to ")]
        assert ends[0] <= Fraction(repr(low))
        assert Fraction(repr(high)) <= ends[1]


def plain(shown: str) -> str:
    """Undo the typesetting of a number."""
    power = re.sub(r"&nbsp;×&nbsp;10<sup>(.*?)</sup>", r"e\1", re.sub("<(?!/?sup)[^>]*>", "", shown))
    return power.replace("\u2212", "-")


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("1250000.25", "1.25&nbsp;×&nbsp;10<sup>6</sup>"),
        ("-7.2787e-4", "\u22127.2787&nbsp;×&nbsp;10<sup>\u22124</sup>"),
        ("0.0050", "0.0050"),
        ("1e-3", "1&nbsp;×&nbsp;10<sup>\u22123</sup>"),
        ("see-text", "see-text"),
        ("<b>", "&lt;b&gt;"),
    ],
)
def test_typesetting(text, shown):
    # digits as printed stay as they are; only computed numbers are shortened
    assert typeset(shorten(text) if text == "1250000.25" else text) == shown


def test_numbers_that_differ_never_look_alike():
    assert shorten("39.9999996", digits_apart("39.9999996", ["40"])) != "40"
    assert shorten("40.00000000000001", digits_apart("40.00000000000001", ["40"])) != "40"
    assert digits_apart("40.0", ["40"]) == 6
    assert digits_apart("audit.cost", ["40"]) == 6


def test_units():
    assert unit("1") == ""
    assert unit("kg m^2") == "kg m<sup>2</sup>"
    assert unit("N m s^0.5") == "N m s<sup>0.5</sup>"
    assert span("", "3.0", "m").startswith("≤")
    assert span("3.0", "", "m").startswith("≥")
    assert span("", "") == enclosure("1", "", "") == ""
    narrow = span("-0.51152574854808170", "-0.51152574854808160")  # of seventeen digits, six and half its width
    assert ">−0.511526</data>" in narrow and "± 5&nbsp;×&nbsp;10<sup>−17</sup>" in narrow
    assert ">1.23457</data>" in span("1.23456789", "1.23456789")
