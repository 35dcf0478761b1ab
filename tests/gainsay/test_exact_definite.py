from itertools import pairwise

import numpy as np
import pytest
from flint import acb, acb_mat, arb, arb_mat, fmpq, fmpq_mat
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gainsay.exact.ball import ball, decimal_above, decimal_below, eigenvalues, hull, lower, precision, upper
from gainsay.exact.definite import (
    ball_positive_definite,
    cholesky_factor,
    hermitian_positive_definite,
    inertia,
    positive_definite,
    positive_semidefinite,
    rational_positive_definite,
)
from gainsay.exact.rational import exact

small = st.integers(-6, 6)


def symmetric(draw_rows):
    n = len(draw_rows)
    return fmpq_mat([[draw_rows[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)])


square = st.integers(1, 5).flatmap(lambda n: st.lists(st.lists(small, min_size=n, max_size=n), min_size=n, max_size=n))


def floats(matrix):
    return np.array([[int(x.p) / int(x.q) for x in row] for row in matrix.tolist()])


@given(square)
def test_exact_definiteness_agrees_with_eigenvalues(rows):
    f = symmetric(rows)
    least = np.linalg.eigvalsh(floats(f))[0]  # numpy as an independent oracle, away from its rounding
    assume(abs(least) > 1e-9)
    assert rational_positive_definite(f) == (least > 0)
    assert positive_definite(f) == (least > 0)


@given(square)
def test_gram_matrices_are_semidefinite_and_definite_when_regular(rows):
    a = fmpq_mat(rows)
    gram = a.transpose() * a  # z' A'A z = |A z|^2 >= 0, zero only for A z = 0
    assert rational_positive_definite(gram, semidefinite=True)
    assert rational_positive_definite(gram) == (a.det() != 0)
    assert positive_semidefinite(gram)
    if gram != 0 * gram:
        assert not rational_positive_definite(-gram, semidefinite=True)


@given(square)
def test_inertia_agrees_with_descartes_rule(rows):
    f = symmetric(rows)
    # a real-rooted polynomial has exactly as many positive roots as sign changes (Descartes)
    coefficients = [c for c in f.charpoly().coeffs() if c != 0]
    plus = sum(a * b < 0 for a, b in pairwise(coefficients))
    found = inertia(f)
    assert (found[0], found[2]) == (plus, f.nrows() - f.rank())
    assert sum(found) == f.nrows()


def test_zero_pivot_with_a_row_is_not_semidefinite():
    assert not rational_positive_definite(fmpq_mat([[0, 1], [1, 5]]), semidefinite=True)
    assert rational_positive_definite(fmpq_mat([[0, 0], [0, 5]]), semidefinite=True)


def test_not_symmetric_is_not_definite():
    assert not positive_definite(fmpq_mat([[2, 1], [0, 2]]))
    assert not rational_positive_definite(fmpq_mat([[2, 1], [0, 2]]))


@given(square, st.integers(1, 40))
@settings(max_examples=60)
def test_balls_never_prove_what_some_matrix_in_them_refutes(rows, tenths):
    f = symmetric(rows)
    radius = fmpq(tenths, 10)
    wide = arb_mat([[ball(x, radius) for x in row] for row in f.tolist()])
    corner = f - fmpq_mat([[radius * (i == j) for j in range(f.nrows())] for i in range(f.nrows())])
    if ball_positive_definite(wide):
        assert rational_positive_definite(corner)


@given(square, square)
def test_hermitian_definiteness_agrees_with_eigenvalues(real, imaginary):
    n = min(len(real), len(imaginary))
    x = np.array([row[:n] for row in real[:n]]) + 1j * np.array([row[:n] for row in imaginary[:n]])
    h = x + x.conj().T + 6 * np.eye(n)
    least = np.linalg.eigvalsh(h)[0]  # numpy as an independent oracle, away from its rounding
    assume(abs(least) > 1e-9)
    assert hermitian_positive_definite(acb_mat([[acb(z.real, z.imag) for z in row] for row in h])) == (least > 0)


@given(square)
def test_cholesky_factor_is_near(rows):
    a = fmpq_mat(rows)
    f = a.transpose() * a + fmpq_mat([[int(i == j) for j in range(a.nrows())] for i in range(a.nrows())])
    factor = cholesky_factor(f)
    rest = factor.transpose() * factor - arb_mat(f)
    assert all(abs(x) < 1e-9 for row in rest.tolist() for x in row)


def test_wide_balls_that_gershgorin_settles():
    # 3 I + [-1/4, 1/4] off the diagonal, n = 4: row sums 3 - 3/4 > 0
    wide = arb_mat([[arb(3) if i == j else ball(0, fmpq(1, 4)) for j in range(4)] for i in range(4)])
    assert ball_positive_definite(wide)
    # with 6/5 in place of 1/4 the matrix of all off-diagonal entries -6/5 has the eigenvalue 3 - 18/5
    wide = arb_mat([[arb(3) if i == j else ball(0, fmpq(6, 5)) for j in range(4)] for i in range(4)])
    assert not ball_positive_definite(wide)


def test_nearly_singular_rationals_are_decided_exactly():
    tiny = fmpq(1, 10**60)  # far below the 128 bits of the balls
    assert positive_definite(fmpq_mat([[1, 1], [1, 1 + tiny]]))
    assert not positive_definite(fmpq_mat([[1, 1], [1, 1 - tiny]]))
    assert not positive_definite(fmpq_mat([[1, 1], [1, 1]]))


def test_nan_balls_prove_nothing():
    assert not ball_positive_definite(arb_mat([[arb("nan")]]))
    with pytest.raises(ArithmeticError):
        lower(arb("nan"))


@given(st.fractions(max_denominator=10**6), st.integers(1, 20))
def test_decimals_on_the_safe_side(value, digits):
    assert decimal_below(value, digits) <= value <= decimal_above(value, digits)


@given(st.fractions(max_denominator=10**6), st.fractions(min_value=0, max_denominator=10**6))
def test_a_hull_holds_its_ends(low, width):
    found = hull(low, low + width)
    assert lower(found) <= low
    assert upper(found) >= low + width
    middle, radius = exact(found.mid().fmpq()), exact(found.rad().fmpq())
    assert middle - radius <= low <= low + width <= middle + radius


def test_precision_is_local():
    with precision(300):
        inside = upper(arb(2).sqrt()) - lower(arb(2).sqrt())
    outside = upper(arb(2).sqrt()) - lower(arb(2).sqrt())
    assert 0 < inside < exact("1e-80") < outside


def test_eigenvalues_of_a_companion_matrix():
    with precision():
        roots = sorted(eigenvalues(arb_mat([[0, 1], [-2, -3]])), key=lambda s: float(s.real.mid()))
    # (s + 1)(s + 2)
    assert roots[0].contains(-2)
    assert roots[1].contains(-1)


def test_repeated_eigenvalues_are_refused():
    with pytest.raises(ArithmeticError, match="separated"):
        eigenvalues(arb_mat([[1, 1], [0, 1]]))


@pytest.mark.parametrize("size", [7, 8, 20, 27])
def test_a_large_hermitian_matrix_turns_at_its_least_eigenvalue(size):
    x = np.random.default_rng(size).normal(size=(2, size, size))
    x = x[0] + 1j * x[1]
    h = x + x.conj().T
    least = np.linalg.eigvalsh(h)[0]
    for shift, holds in ((least - 1e-6, True), (least + 1e-6, False)):
        shifted = h - shift * np.eye(size)
        # the upper triangle and the imaginary parts of the diagonal are not read
        given_ = [[acb(z.real, z.imag) if j < i else acb(z.real, 9) if i == j else acb(9) for j, z in enumerate(row)]
                  for i, row in enumerate(shifted)]  # fmt: skip
        assert hermitian_positive_definite(acb_mat(given_)) == holds


@pytest.mark.parametrize("rows", [[[2, 1], [0, 2]], [[0, 1], [-1, 0]], [[1, 0]], [[1], [0]]])
def test_an_order_is_of_symmetric_matrices(rows):
    # z' F z would not see what is skew: a matrix that is not symmetric is neither
    for holds in (positive_definite, positive_semidefinite, rational_positive_definite):
        assert not holds(fmpq_mat(rows))
    assert not rational_positive_definite(fmpq_mat(rows), semidefinite=True)
