from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.exact.digits import PrintedNumber

SIGNS = st.sampled_from(["", "+", "-"])
DIGITS = st.text("0123456789", min_size=1, max_size=12)


@st.composite
def decimals(draw) -> str:
    text = draw(SIGNS) + draw(DIGITS)
    if draw(st.booleans()):
        text += "." + draw(DIGITS)
    if draw(st.booleans()):
        text += draw(st.sampled_from("eE")) + draw(SIGNS) + str(draw(st.integers(0, 99)))
    return text


@given(decimals())
def test_value_is_the_one_that_decimal_reads(text):
    # Oracle: the standard library's decimal arithmetic, exact for every literal.
    number = PrintedNumber(text)
    assert number.value == Fraction(Decimal(text))
    assert number.text == text


@given(decimals())
def test_half_unit_is_half_of_decimals_last_place(text):
    # Oracle: Decimal keeps the exponent of the last digit given, trailing zeros included.
    number = PrintedNumber(text)
    assert number.half_unit == Fraction(Decimal((0, (1,), Decimal(text).as_tuple().exponent))) / 2
    assert number.high - number.low == 2 * number.half_unit
    assert number.low + number.high == 2 * number.value


@given(st.decimals(min_value=-1000, max_value=1000, places=9), st.integers(0, 8))
def test_what_was_rounded_lies_in_the_interval_of_its_digits(true, places):
    # Law: rounding to nearest errs by at most half a unit of the last digit kept.
    printed = PrintedNumber(f"{round(true, places):f}")
    assert printed.low <= Fraction(true) <= printed.high


@given(decimals())
def test_digits_survive_a_round_trip_through_decimal_notation(text):
    number = PrintedNumber(text)
    plain = PrintedNumber(f"{Decimal(text):f}")
    assert plain.value == number.value
    assert plain.half_unit <= max(number.half_unit, Fraction(1, 2))


def test_trailing_zeros_and_exponents_count():
    # By hand: 0.0050 is printed to 1e-4; 7.2787e-4 to 1e-8; 200 to 1.
    assert PrintedNumber("0.0050").half_unit == Fraction(5, 100000)
    assert PrintedNumber("0.005").half_unit == Fraction(5, 10000)
    assert PrintedNumber("7.2787e-4").half_unit == Fraction(5, 10**9)
    assert PrintedNumber("200").half_unit == Fraction(1, 2)
    assert PrintedNumber("2e2").half_unit == 50


@given(decimals())
def test_a_double_can_hold_every_number(text):
    assert abs(float(PrintedNumber(text))) < float("inf")


@pytest.mark.parametrize(
    "text",
    ["", " 1", "1 ", "1\n", "1,5", "1.", ".5", "1..2", "--1", "−1", "1e", "1e1.5", "0x10", "nan", "inf", "1/2", "1_000",
     "٣", "1.٣", "１", "1e999", "1 000", "2·1"],
)  # fmt: skip
def test_anything_else_is_refused_with_the_value_and_what_was_expected(text):
    with pytest.raises(InputError) as caught:
        PrintedNumber(text)
    assert caught.value.value == text
    assert "a decimal number" in str(caught.value)
    assert "\n" not in str(caught.value)
