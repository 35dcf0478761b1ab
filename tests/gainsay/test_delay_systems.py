import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from flint import fmpq
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.special import lambertw

from gainsay.errors import ComputationError, InputError
from gainsay.systems.collocation import chebyshev
from gainsay.systems.delay import DelaySystem, hurwitz
from gainsay.systems.delay_bounds import (
    bessel_legendre,
    legendre_slopes,
    level,
    proved_delay,
)
from gainsay.systems.delay_spectrum import (
    gain_stays_below,
    hinf_norm,
    rightmost_roots,
    spectral_abscissa,
    unstable_root_count,
)
from gainsay.systems.norms import hinf_norm as undelayed_norm

MODERATE = st.floats(0.1, 3.0)


def scalar(a: float, b: float) -> DelaySystem:
    """x' = -a x - b x(t - d) + w, y = x."""
    return DelaySystem([[-a]], [[-b]], [[1]], [[1]], [[1]])


def servo(stiffness: float, damping: float) -> DelaySystem:
    """x'' = -stiffness x(t - d) - damping x'(t - d)."""
    return DelaySystem([[0, 1], [0, 0]], [[0], [1]], [[-stiffness, -damping]])


def random_system(seed: int, n: int = 3) -> DelaySystem:
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(n, n)) - 1.5 * np.eye(n)
    return DelaySystem(
        A, rng.normal(size=(n, 1)), rng.normal(size=(1, n)), rng.normal(size=(n, 2)), rng.normal(size=(1, n))
    )


def test_pure_delayed_integrator_loses_stability_at_half_pi():
    margin = scalar(0, 1).quasi_polynomial.margin()
    # s = -e^{-sd} has s = j at d = pi/2: closed form
    assert margin.lower < math.pi / 2 < margin.upper
    assert margin.upper - margin.lower < 1e-14
    assert margin.frequency == pytest.approx(1, abs=1e-15)


@given(MODERATE, MODERATE)
def test_margin_of_a_scalar_equation_is_its_closed_form(a, excess):
    b = a + excess
    # |jw + a| = b and angle: d = acos(-a/b) / sqrt(b^2 - a^2)
    expected = math.acos(-a / b) / math.sqrt(b * b - a * a)
    assert scalar(a, b).quasi_polynomial.margin().delay == pytest.approx(expected, rel=1e-12)


@given(MODERATE, MODERATE)
def test_margin_of_a_delayed_servo_is_its_closed_form(k, c):
    # w^4 = k^2 + c^2 w^2 and the phase of k + jcw is w d
    w = math.sqrt((c * c + math.sqrt(c**4 + 4 * k * k)) / 2)
    assert servo(k, c).quasi_polynomial.margin().delay == pytest.approx(math.atan2(c * w, k) / w, rel=1e-12)


def test_no_delay_destabilises_where_the_delayed_gain_is_small():
    assert scalar(2, 1).quasi_polynomial.margin().delay == math.inf


def test_a_loop_unstable_without_delay_has_no_margin():
    assert servo(-1.0, 1.0).quasi_polynomial.margin().delay == 0
    assert not servo(-1.0, 1.0).quasi_polynomial.stable_without_delay()


@given(st.integers(0, 10_000))
def test_quasi_polynomial_is_the_determinant(seed):
    rng = np.random.default_rng(seed)
    system = DelaySystem(rng.normal(size=(4, 4)), rng.normal(size=(4, 2)), rng.normal(size=(2, 4)))
    s = complex(*rng.normal(size=2))
    expected = np.linalg.det(system.characteristic_matrix(s, 0.7))
    assert abs(system.quasi_polynomial(s, 0.7) - expected) < 1e-10 * (1 + abs(expected))


def crossings_by_kronecker(system: DelaySystem) -> list[float]:
    """Frequencies at which some delay puts a root on the axis, from A0 + z A1, |z| = 1 (Chen, Gu, Nett, 1995)."""
    n = system.order
    unit, A0, A1 = np.eye(n), system.A, system.A1
    middle = np.kron(A0, unit) + np.kron(unit, A0)
    zero, one = np.zeros((n * n, n * n)), np.eye(n * n)
    left = np.block([[zero, one], [-np.kron(unit, A1), -middle]])
    right = np.block([[one, zero], [zero, np.kron(A1, unit)]])
    from scipy.linalg import eig

    found = set()
    for z in eig(left, right, right=False):
        if np.isfinite(z) and abs(abs(z) - 1) < 1e-7:
            for s in np.linalg.eigvals(A0 + z * A1):
                if abs(s.real) < 1e-6 and s.imag > 1e-6:
                    found.add(round(s.imag, 5))
    return sorted(found)


@pytest.mark.parametrize("seed", range(12))
def test_crossings_agree_with_the_matrix_pencil_method(seed):
    system = random_system(seed)
    found = sorted(float(c.frequency.mid()) for c in system.quasi_polynomial.crossings())
    assert [round(w, 5) for w in found] == pytest.approx(crossings_by_kronecker(system), abs=2e-5)


@given(st.integers(0, 10_000))
def test_every_crossing_is_a_root_of_the_quasi_polynomial(seed):
    quasi = random_system(seed).quasi_polynomial
    for crossing in quasi.crossings():
        w, d = float(crossing.frequency.mid()), float(crossing.delay.mid())
        assert 0 < d < 2 * math.pi / w
        assert abs(quasi(1j * w, d)) < 1e-9 * (1 + w) ** 3


@pytest.mark.parametrize("seed", range(12))
def test_stability_changes_exactly_at_the_margin(seed):
    system = random_system(seed)
    margin = system.quasi_polynomial.margin()
    if not 0 < margin.delay < math.inf:
        return
    assert spectral_abscissa(system, 0.999 * margin.delay) < 0 < spectral_abscissa(system, 1.001 * margin.delay)
    assert unstable_root_count(system, 0.99 * margin.delay) == 0
    assert unstable_root_count(system, 1.01 * margin.delay) == 2


def test_fractions_stay_exact():
    third = Fraction(1, 3)
    p, q = DelaySystem([[third]], [[third]], [[1]]).quasi_polynomial.coefficients
    assert p.coeffs() == [fmpq(-1, 3), fmpq(1)]
    assert q.coeffs() == [fmpq(-1, 3)]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (([[1]], [[1, 2]], [[1]]), "(2, 1)"),
        (([[1, 2]], [[1]], [[1]]), "(1, 1)"),
        (([[math.nan]], [[1]], [[1]]), "finite"),
        (([1], [[1]], [[1]]), "two dimensions"),
    ],
)
def test_bad_matrices_are_refused(arguments, expected):
    with pytest.raises(InputError, match=r"A|Bd|Cd") as refused:
        DelaySystem(*arguments)
    assert expected in str(refused.value)


def test_degenerate_crossings_are_refused():
    two = DelaySystem([[-1, 0], [0, -1]], [[-2, 0], [0, -2]], [[1, 0], [0, 1]])
    with pytest.raises(ComputationError, match="rank 2"):
        two.quasi_polynomial.crossings()
    with pytest.raises(ComputationError, match="s = 0"):
        servo(0, 1).quasi_polynomial.crossings()
    assert not hurwitz(servo(1, 0).quasi_polynomial.undelayed())  # roots +-j


@pytest.mark.parametrize("delay", [0.3, 1.0, 2.0])
def test_roots_are_branches_of_lambert_w(delay):
    # s = -e^{-sd}: s d e^{sd} = -d, so s = W_k(-d) / d
    branches = np.array([lambertw(-delay, k) / delay for k in range(-4, 4)])
    expected = branches[np.argsort(-branches.real)][:6]
    found = rightmost_roots(scalar(0, 1), delay, 6)
    for root in expected:
        assert np.abs(found - root).min() < 1e-9


def test_roots_without_delay_are_eigenvalues():
    system = random_system(3)
    np.testing.assert_allclose(
        sorted(rightmost_roots(system, 0.0).real), sorted(np.linalg.eigvals(system.A + system.A1).real)
    )


def test_differentiation_matrix_is_exact_on_polynomials():
    x, D = chebyshev(8)
    np.testing.assert_allclose(D @ x**8, 8 * x**7, atol=1e-12)


# delays near the smallest double are refused, in one line: 1/d overflows in the collocation
@given(MODERATE, st.floats(0.05, 0.9), st.just(0.0) | st.floats(1e-6, 3.0))
@settings(max_examples=25)
def test_norm_of_a_positive_system_is_its_static_gain(a, share, delay):
    # x' = -a x + b x(t - d) + w with 0 < b < a is positive: |G| is largest at w = 0, 1/(a - b), whatever the delay
    system = scalar(a, -share * a)
    assert hinf_norm(system, delay).value == pytest.approx(1 / (a * (1 - share)), rel=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_norm_without_delay_is_that_of_the_undelayed_loop(seed):
    system = random_system(seed)
    if spectral_abscissa(system, 0.0) >= 0:
        return
    expected, _ = undelayed_norm(system.A + system.A1, system.B, system.C)
    assert hinf_norm(system, 0.0).value == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("seed", range(8))
def test_norm_under_delay_is_the_top_of_a_fine_grid(seed):
    system, delay = random_system(seed), 0.2
    if spectral_abscissa(system, delay) >= 0:
        return
    peak = hinf_norm(system, delay)
    grid = np.concatenate([np.linspace(0, 30, 6001), [peak.frequency]])
    top = max(np.linalg.norm(system.response(w, delay), 2) for w in grid)
    # a grid can only miss the peak: it lies below, by less than the curvature between its points allows
    assert top <= peak.value * (1 + 1e-12)
    assert peak.value <= top * (1 + 1e-4)


def test_covering_the_axis_proves_a_level_above_the_norm_and_none_below():
    system = scalar(1, Fraction(1, 2))
    peak = hinf_norm(system, 1.0).value
    above, below = (fmpq(round(peak * (1 + e) * 10**12), 10**12) for e in (1e-6, -1e-6))
    assert gain_stays_below(system, fmpq(1), above)
    assert not gain_stays_below(system, fmpq(1), below)


def test_norm_of_an_unstable_loop_is_refused():
    with pytest.raises(InputError, match="unstable"):
        hinf_norm(scalar(0, 1), 2.0)
    with pytest.raises(InputError, match="delay"):
        rightmost_roots(scalar(0, 1), -1.0)


def test_legendre_slopes_are_those_of_integration_by_parts():
    # int_{-h}^0 L_k(u) x'(t+u) du with shifted Legendre polynomials, on x(u) = exp(u): both sides by Gauss quadrature
    h = 1.7
    nodes, weights = np.polynomial.legendre.leggauss(30)
    u, w = h * (nodes - 1) / 2, weights * h / 2
    x = np.exp(u)
    moment = [(w * np.polynomial.legendre.Legendre.basis(k)(nodes) * x).sum() / h for k in range(5)]
    for k in range(5):
        left = (w * np.polynomial.legendre.Legendre.basis(k)(nodes) * x).sum()  # x' = x
        right = 1 - (-1) ** k * math.exp(-h) + legendre_slopes(5, k) @ moment
        assert left == pytest.approx(right, abs=1e-12)


def proved(system: DelaySystem, degree: int, relative: float = 1e-4) -> tuple[float, float]:
    """Delay that a degree of the hierarchy proves, and the next that was tried in vain, s."""
    parts = system.A, system.Bd, system.Cd
    limit = system.quasi_polynomial.margin().upper
    return proved_delay(lambda h: bessel_legendre(*parts, h, degree).blocks, limit, relative)


def test_bounds_grow_with_the_degree_towards_the_exact_margin():
    system = servo(1.0, 1.0)
    exact = system.quasi_polynomial.margin().delay
    found = [proved(system, degree, 1e-3)[0] for degree in (0, 1)]
    assert all(a < b for a, b in pairwise([*found, exact]))
    assert found[1] > 0.99 * exact


@given(st.integers(0, 1000), st.floats(0.1, 2.0))
@settings(max_examples=12)
def test_no_condition_holds_where_the_system_is_unstable(seed, delay):
    system = random_system(seed, 2)
    assume(spectral_abscissa(system, delay) > 1e-3)
    found = level(bessel_legendre(system.A, system.Bd, system.Cd, delay, 1))
    # a proved point with t > 0 would prove a loop stable that is not; where the two ends meet there is none either
    assert -found.upper <= 0 and (np.isnan(found.value) or -found.value < 1e-8)


def test_a_known_example_of_the_hierarchy():
    # A. Seuret, F. Gouaisbaut (2015), example 1 has the exact bound 6.1725 s; x1 decides: x1' = -2 x1 - x1(t - h) is
    # stable for every h, x2' = -0.9 x2 - x2(t - h) up to acos(-0.9)/sqrt(1 - 0.81)
    system = scalar(0.9, 1.0)
    exact = math.acos(-0.9) / math.sqrt(1 - 0.81)
    assert exact == pytest.approx(6.1725, abs=1e-4)
    # Table 1 there: 4.472 for degree 0 (Jensen), 6.059 for degree 1
    for degree, published in ((0, 4.472), (1, 6.059)):
        low, high = proved(system, degree, 2e-4)
        assert low <= published + 1e-3 and published - 1e-3 <= high
        assert high - low < 2e-3


def test_bounds_do_not_depend_on_the_coordinates():
    # the same servo with its rate in another unit: a congruence of every block
    system = servo(1.0, 1.0)
    T = np.diag([1.0, 3.0])
    moved = DelaySystem(np.linalg.solve(T, system.A @ T), np.linalg.solve(T, system.Bd), system.Cd @ T)
    assert proved(system, 0)[0] == pytest.approx(proved(moved, 0)[0], rel=2e-4)


def test_one_channel_proves_as_much_as_the_whole_state():
    # S and R of the delayed signal against S and R of the state, as the hierarchy is published
    system = servo(1.0, 1.0)
    state = DelaySystem(system.A, system.A1, np.eye(2))
    limit = system.quasi_polynomial.margin().upper
    whole, _ = proved_delay(lambda h: bessel_legendre(state.A, state.Bd, state.Cd, h, 1).blocks, limit)
    assert proved(system, 1)[0] == pytest.approx(whole, rel=2e-4)


def test_proved_delay_ends_at_the_bound():
    system = servo(1.0, 1.0)
    parts = system.A, system.Bd, system.Cd
    exact = system.quasi_polynomial.margin().delay
    proved, tried = proved_delay(lambda h: bessel_legendre(*parts, h, 0).blocks, 1.01 * exact, 1e-3)
    # Jensen's condition for the servo: a longer delay than the bound is never proved
    assert proved < exact
    assert tried - proved <= 1.01e-3 * exact
    unstable = DelaySystem([[1.0]], [[0.0]], [[1.0]])
    assert proved_delay(lambda h: bessel_legendre(unstable.A, unstable.Bd, unstable.Cd, h, 0).blocks, 1.0, 0.1)[0] == 0
