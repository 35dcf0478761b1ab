from fractions import Fraction

import pytest
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st

from gainsay.exact.linear import Unsolvable, complete
from gainsay.exact.rational import exact, rational_matrix, shorten, shorten_matrix, to_text

fractions = st.fractions(min_value=-(10**9), max_value=10**9, max_denominator=10**12)


@given(fractions)
def test_text_is_exact(value):
    assert exact(to_text(value)) == value


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_float_is_the_binary_number_that_it_is(value):
    assert float(exact(value)) == value
    assert exact(to_text(exact(value))) == exact(value)


@pytest.mark.parametrize("text", ["0.1", "-8.8129e-4", "1/3", "5", "+.5", "2.", "1E+3"])
def test_texts_that_are_numbers(text):
    assert exact(text) == Fraction(text)


@pytest.mark.parametrize("text", ["", "0x1", "1e9999", "nan", "1/0", "1 2", "1_000", "−1", "1/00", "0.1e", "--1"])
def test_texts_that_are_not(text):
    with pytest.raises(ValueError, match="exact number"):
        exact(text)


def test_short_decimals_read_like_the_papers():
    # the digits are those put in: no computing
    assert [to_text(x) for x in ("-8.8129e-4", "1.13e-10", "200", "0.0079", "1/3")] == [
        "-0.00088129",
        "1.13e-10",
        "200",
        "0.0079",
        "1/3",
    ]


@given(st.floats(min_value=-1e6, max_value=1e6), st.integers(1, 17))
def test_shortened_within_half_a_unit_of_its_digits(value, digits):
    short = shorten(value, digits)
    # rounding to d significant digits: relative error at most 5e-d (Higham 2002, section 2.2, base ten)
    assert abs(short - exact(value)) <= abs(exact(value)) * Fraction(5, 10**digits)


def test_symmetric_rounding_is_exactly_symmetric():
    short = shorten_matrix([[1.0, 0.3333333], [0.3333334, 2.0]], 6, symmetric=True)
    assert short == short.transpose()


def test_rows_of_different_length_are_refused():
    with pytest.raises(ValueError, match="length"):
        rational_matrix([["1", "2"], ["3"]])


rationals = st.integers(-9, 9).map(fmpq)


@given(
    st.integers(1, 5).flatmap(lambda n: st.tuples(st.just(n), st.lists(st.lists(rationals, min_size=n, max_size=n))))
)
def test_completed_values_satisfy_consistent_equations(case):
    size, rows = case
    # right sides from a known point: the equations are consistent by construction
    point = [fmpq(k + 1, 3) for k in range(size)]
    equations = [(dict(enumerate(row)), sum((c * x for c, x in zip(row, point, strict=True)), fmpq(0))) for row in rows]
    near = [x + fmpq(1, 1000) for x in point]
    solved = complete(equations, near, [1.0] * size)
    for coefficients, right in equations:
        assert sum((c * solved[i] for i, c in coefficients.items()), fmpq(0)) == right


def test_values_that_satisfy_the_equations_stay():
    equations = [({0: fmpq(1), 1: fmpq(-2)}, fmpq(0)), ({1: fmpq(3), 2: fmpq(1)}, fmpq(4))]
    assert complete(equations, [fmpq(2), fmpq(1), fmpq(1)], [1.0] * 3) == [2, 1, 1]


def test_contradicting_equations_are_refused():
    with pytest.raises(Unsolvable):
        complete([({0: fmpq(1)}, fmpq(1)), ({0: fmpq(2)}, fmpq(3))], [fmpq(0)], [1.0])
