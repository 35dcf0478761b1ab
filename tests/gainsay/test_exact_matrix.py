"""Exact matrices: what is added, multiplied, taken and refused, against nested fractions."""

from fractions import Fraction

import numpy as np
import pytest
from flint import arb, arb_mat, fmpq_mat, fmpq_mpoly_ctx
from hypothesis import given
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.exact.blocks import block, diagonal, kron
from gainsay.exact.digits import PrintedNumber, double
from gainsay.exact.floats import real_array, real_number, real_row
from gainsay.exact.matrix import Matrix, RingError, eye, zeros
from gainsay.exact.rational import rational_matrix, to_text


def drawn(seed):
    """Three rows of three fractions."""
    rng = np.random.default_rng(seed)
    return [[Fraction(int(rng.integers(-9, 10)), int(rng.integers(1, 8))) for _ in range(3)] for _ in range(3)]


def fractions(matrix):
    return np.array([[Fraction(int(x.p), int(x.q)) for x in row] for row in matrix.rows()], dtype=object)


@pytest.mark.parametrize("seed", range(5))
def test_arithmetic_is_that_of_fractions(seed):
    one, other = drawn(seed), drawn(seed + 100)
    a, b = np.array(one, dtype=object), np.array(other, dtype=object)
    A, B = Matrix.of(one), Matrix.of(other)
    for found, expected in (
        (A + B, a + b),
        (A - B, a - b),
        (-A, -a),
        (A @ B, a @ b),
        (A.T, a.T),
        (A.power(0), np.eye(3, dtype=int)),
        (A.power(3), a @ a @ a),
        (A.trace(), [[a[0, 0] + a[1, 1] + a[2, 2]]]),
        (A.take([2, 0], [1]), a[[2, 0], 1:2]),
        (kron(A, B), np.kron(a, b)),
        (A.scaled(Matrix.number(Fraction(2, 3))), a * Fraction(2, 3)),
    ):
        assert (fractions(found) == expected).all()
    assert A.equals(Matrix.of(one)) and not A.equals(B)


@pytest.mark.parametrize("seed", range(5))
def test_an_inverse_times_its_matrix_is_one(seed):
    A = Matrix.of(drawn(seed))
    assert (A.inverse() @ A).equals(eye(3))
    with pytest.raises((RingError, ArithmeticError)):
        Matrix.of([*drawn(seed)[:2], drawn(seed)[0]]).inverse()


def refused_shapes():
    A, wide = Matrix.of([[1, 2], [3, 4]]), Matrix.of([[1, 2, 3]])
    yield lambda: wide.power(2)
    yield lambda: wide.power(1)
    yield lambda: A.power(-1)
    yield lambda: A.take([0], [2])
    yield lambda: A.take([2], [0])
    yield lambda: A.take([0], [-1])
    yield lambda: A.take([-1], [0])
    yield lambda: A.take([], [0])
    yield lambda: A.take([0], [])
    yield lambda: A + wide
    yield lambda: A - wide
    yield lambda: A @ wide
    yield lambda: wide.trace()
    yield lambda: wide.inverse()
    yield lambda: A.value()
    yield lambda: A.over(A)
    yield lambda: A.over(Matrix.number(0))
    yield lambda: A.scaled(wide)
    yield lambda: block([[A, wide]])
    yield lambda: block([[A], [A, A]])
    yield lambda: block([[A, A], [A, None, A]])
    yield lambda: block([[None, A], [None, A]])
    yield lambda: block([])
    yield lambda: Matrix(fmpq_mat(0, 3))


@pytest.mark.parametrize("number", range(24))
def test_shapes_that_do_not_fit_are_refused(number):
    with pytest.raises((RingError, ArithmeticError)):
        list(refused_shapes())[number]()


def test_every_shape_above_is_tried():
    assert len(list(refused_shapes())) == 24


def test_blocks_are_placed_and_mirrored():
    A, b = Matrix.of([[1, 2], [3, 4]]), Matrix.of([[5], [6]])
    whole = [[1, 2, 5], [3, 4, 6], [5, 6, 0]]
    assert (fractions(block([[A, b], [None, Matrix.number(0)]])) == whole).all()
    assert (fractions(diagonal([A, Matrix.number(7)])) == [[1, 2, 0], [3, 4, 0], [0, 0, 7]]).all()
    assert (fractions(block([[A], [Matrix.number(0)]])) == [[1, 2], [3, 4], [0, 0]]).all()


@pytest.mark.parametrize("nothing", [Matrix.number(0), Matrix.number(0).to_ball(), zeros(1, 1)])
def test_division_by_what_is_or_may_be_zero_is_refused(nothing):
    with pytest.raises(RingError, match="is or may be zero"):
        eye(2).over(nothing)


def test_balls_and_polynomials_do_not_mix():
    x = Matrix.number(fmpq_mpoly_ctx.get(["x"]).gens()[0])
    pi = Matrix.number(arb.pi())
    for make in (lambda: x + pi, lambda: pi @ x, lambda: x.to_ball(), lambda: block([[x, pi]])):
        with pytest.raises(RingError):
            make()
    assert (x + Matrix.number(1)).ring == "polynomial" and (pi + Matrix.number(1)).ring == "ball"
    assert not pi.is_exact and not x.is_exact and Matrix.number(1).is_exact
    assert zeros(2, 3).shape == (2, 3) and Matrix(arb_mat(1, 2)).ring == "ball"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Fraction(10**39), "1e39"),
        (Fraction(int("1" * 40)), "1." + "1" * 39 + "e39"),
        (Fraction(int("1" * 41)), "1" * 41 + "/1"),
        (Fraction(1, 3), "1/3"),
        (Fraction(1, 2**200), f"1/{2**200}"),
        (Fraction(-5, 4), "-1.25"),
        (Fraction(1234567), "1234567"),
        (Fraction(12345678), "1.2345678e7"),
        (Fraction(1, 10**4), "0.0001"),
    ],
)
def test_texts_of_numbers(value, text):
    # the form that the docstring states: a decimal of at most 40 digits, else a ratio
    assert to_text(value) == text
    assert Fraction(text) == value


def test_a_matrix_of_no_rows_has_none():
    assert (rational_matrix([]).nrows(), rational_matrix([]).ncols()) == (0, 0)


@pytest.mark.parametrize(
    "bad",
    [
        [1, None],
        [None, 1],
        [[1, "2"], [3, 4]],
        ["1"],
        [1j],
        [[1], [2, 3]],
        [True, "x"],
        [Fraction(1, 2), "2"],
        object(),
    ],
)
def test_arrays_that_hold_anything_but_numbers_are_refused(bad):
    with pytest.raises(InputError, match="field"):
        real_array(bad, "field")


def test_arrays_of_numbers():
    assert real_array([Fraction(1, 4), 2, 0.5], "x").tolist() == [0.25, 2.0, 0.5]
    for bad in ([1.0, np.nan], [np.inf, 1.0]):
        with pytest.raises(InputError, match="finite"):
            real_array(bad, "x")
        assert len(real_array(bad, "x", finite=False)) == 2
    assert real_row([1, 2], 2, "x").tolist() == [1.0, 2.0]
    for bad in ([1, 2, 3], [[1, 2]], 1.0):
        with pytest.raises(InputError, match="2 numbers"):
            real_row(bad, 2, "x")
    for bad in (np.nan, np.inf, "1", None, 1j, [1]):
        with pytest.raises(InputError, match="finite number"):
            real_number(bad, "x")


@pytest.mark.parametrize(
    ("text", "low", "high"),
    [("1.50", "1.495", "1.505"), ("-2", "-2.5", "-1.5"), ("3e2", "250", "350"), ("1.2E-3", "0.00115", "0.00125")],
)
def test_digits_stand_for_what_rounds_to_them(text, low, high):
    assert (PrintedNumber(text).low, PrintedNumber(text).high) == (Fraction(low), Fraction(high))


@pytest.mark.parametrize("text", ["１", "٣", "1.", ".5", "1e100", "1e", "", " 1", "1 ", "0x1", "1_0", "nan", "1" * 251])
def test_digits_of_anything_else_are_refused(text):
    with pytest.raises(InputError):
        PrintedNumber(text)


def test_as_many_digits_as_allowed():
    assert PrintedNumber("1" * 250).value == int("1" * 250)


@pytest.mark.parametrize("text", ["１.0", "1_0.0", "+1.0", " 1.0", "1e5", "infinity", "-nan", "0x1p3", ""])
def test_doubles_are_texts_of_repr(text):
    with pytest.raises(InputError):
        double(text)


@given(st.floats(allow_nan=False))
def test_a_double_is_read_as_it_was_written(value):
    assert double(repr(value)) == value
