"""Norms against closed forms and published examples, over dampings, units and spreads where rounding goes astray."""

import math
from fractions import Fraction

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import ComputationError, InputError
from gainsay.systems.norms import h2_enclosure, h2_norm, hinf_enclosure, hinf_norm


def resonance(rate: float, damping: float):
    """w^2/(s^2 + 2 z w s + w^2)."""
    return [[0, 1], [-(rate**2), -2 * damping * rate]], [[0], [rate**2]], [[1, 0]]


def doubles(rate: float, damping: float) -> tuple[float, float]:
    """Frequency and damping of the mode whose coefficients are those of `resonance` as doubles."""
    stiffness, friction = Fraction(rate**2), Fraction(2 * damping * rate)
    w = math.sqrt(stiffness)
    return w, float(friction / 2) / w


@pytest.mark.parametrize("rate", [1e-8, 1e-3, 1.0, 60.0, 1e8])
@pytest.mark.parametrize("damping", [0.7, 0.05, 1e-6, 1e-12])
def test_a_resonance_of_any_rate_and_damping(rate, damping):
    # closed forms: 1/(2 z sqrt(1 - z^2)) and sqrt(w/(4 z)); textbook (Zhou, Doyle, Glover 1996, chapter 4)
    w, z = doubles(rate, damping)
    bounds = hinf_enclosure(*resonance(rate, damping))
    expected = 1 / (2 * z * math.sqrt(1 - z**2))
    assert bounds.lower <= expected * (1 + 1e-12)
    assert expected <= bounds.upper * (1 + 1e-12)
    assert bounds.upper <= bounds.lower * (1 + 1e-9)
    assert bounds.frequency == pytest.approx(w * math.sqrt(1 - 2 * z**2), rel=1e-4)
    assert h2_norm(*resonance(rate, damping)) == pytest.approx(math.sqrt(w / (4 * z)), rel=1e-9)


@pytest.mark.parametrize("spread", [1e4, 1e8, 1e16, 1e30])
def test_lags_of_far_apart_time_constants(spread):
    # closed form: a sum of lags k/(T s + 1) with k > 0 has its largest gain, the sum of k, at zero
    rates = np.array([1.0, spread, 1 / spread])
    norm, frequency = hinf_norm(-np.diag(rates), rates[:, None], [[1.0, 2.0, 4.0]])
    assert norm == pytest.approx(7.0, rel=1e-10)
    assert frequency < 1e-3 / spread
    # closed form: |sum k_i r_i/(s + r_i)|_2^2 = sum k_i k_j r_i r_j/(r_i + r_j)
    k = np.array([1.0, 2.0, 4.0])
    square = (np.outer(k, k) * np.outer(rates, rates) / (rates[:, None] + rates[None, :])).sum()
    assert h2_norm(-np.diag(rates), rates[:, None], [k]) == pytest.approx(math.sqrt(square), rel=1e-9)


@pytest.mark.parametrize("powers", [(0, 27, -27), (0, 60, 10), (-100, 0, 100)])
def test_units_of_the_states_change_nothing(powers):
    # law: a similarity by powers of two is exact
    A = np.array([[-1.0, 2.0, 0.0], [-3.0, -0.5, 1.0], [0.25, 0.0, -0.125]])
    B, C = np.array([[1.0], [0.5], [0.0]]), np.array([[1.0, 0.0, 2.0]])
    scale = 2.0 ** np.array(powers)
    moved = A * scale[:, None] / scale[None, :], B * scale[:, None], C / scale[None, :]
    assert hinf_norm(*moved)[0] == pytest.approx(hinf_norm(A, B, C)[0], rel=1e-10)
    assert h2_norm(*moved) == pytest.approx(h2_norm(A, B, C), rel=1e-9)


def test_the_example_of_slicot():
    # SLICOT, documentation of AB13DD, program results: norm 0.5000000001D+06 at 0.1414213562D+01 rad/s
    A = np.zeros((6, 6))
    for k, (stiffness, friction) in enumerate([(0.5, 0.0002), (1.0, 0.00002), (2.0, 0.000002)]):
        A[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = [[0, 1], [-stiffness, -friction]]
    row = np.array([[1.0, 0, 1, 0, 1, 0]])
    norm, frequency = hinf_norm(A, row.T, row)
    assert norm == pytest.approx(500000.0001, rel=1e-9)
    assert frequency == pytest.approx(1.414213562, abs=1e-9)


@pytest.mark.parametrize(
    ("system", "norm"),
    [
        (([[-1]], [[1]], [[-2]], [[1]]), 1.0),  # (s - 1)/(s + 1): all-pass
        (([[-1]], [[1]], [[-1]], [[1]]), 1.0),  # s/(s + 1): only at infinity
        (([[-3]], [[1]], [[1]], [[0]]), 1 / 3),  # 1/(s + 3): at zero
        (([[-1]], [[1]], [[9]], [[1]]), 10.0),  # (s + 10)/(s + 1)
        (([[0, 1], [-1, -2]], [[0], [1]], [[0, 1]], [[0]]), 0.5),  # s/(s + 1)^2: at 1 rad/s
        (([[-1, 0], [0, -1]], np.eye(2), np.eye(2), np.zeros((2, 2))), 1.0),  # two equal lags
        (([[-1, 1], [0, -1]], [[0], [1]], [[1, 0]], [[0]]), 1.0),  # a defective pole: 1/(s + 1)^2
        (([[-1]], [[0]], [[1]], [[0]]), 0.0),
        (([[-1, 0], [0, -2]], [[1], [0]], [[0, 1]], [[0]]), 0.0),  # not zero by an entry, but as a response
        (([[0, 1], [-1, -1]], [[0], [1]], [[1, 0], [0, 1]], [[0], [0]]), math.sqrt(1 + 2 / math.sqrt(3))),
    ],
)  # fmt: skip
def test_small_systems(system, norm):
    # closed forms; the last one: max (1 + x)/((1 - x)^2 + x) over x = w^2 is at x = sqrt(3) - 1
    assert hinf_norm(*system)[0] == pytest.approx(norm, rel=1e-9, abs=1e-300)
    assert hinf_enclosure(*system).upper >= norm * (1 - 1e-15)


@pytest.mark.parametrize("count", [2, 3, 5])
def test_equal_modes_side_by_side(count):
    # law: copies of a system have its norm, and sqrt(count) times its H2 norm
    A, B, C = (np.kron(np.eye(count), np.asarray(M, dtype=float)) for M in resonance(1.0, 1e-3))
    one = resonance(1.0, 1e-3)
    assert hinf_norm(A, B, C)[0] == pytest.approx(hinf_norm(*one)[0], rel=1e-9)
    assert h2_norm(A, B, C) == pytest.approx(math.sqrt(count) * h2_norm(*one), rel=1e-9)


@pytest.mark.parametrize("pole", [0.5, -0.9, 0.999999, 1 - 1e-12])
def test_a_pole_in_discrete_time(pole):
    # closed forms of 1/(z - a): 1/(1 - |a|) at 0 or pi rad a sample, and 1/sqrt(1 - a^2)
    room = float(1 - Fraction(abs(pole)))
    norm, frequency = hinf_norm([[pole]], [[1]], [[1]], sample=0.1)
    assert norm == pytest.approx(1 / room, rel=1e-9)
    assert frequency == pytest.approx(0 if pole > 0 else 10 * math.pi, abs=1e-3)
    assert h2_norm([[pole]], [[1]], [[1]], sample=0.1) == pytest.approx(1 / math.sqrt(room * (1 + abs(pole))), rel=1e-9)


@pytest.mark.parametrize("a", [(0.5, 0.3), (1.2, -0.6), (-0.4, 0.1)])
def test_the_variance_of_an_autoregression(a):
    # closed form (Box, Jenkins): y = a1 y' + a2 y'' + e has variance (1 - a2)/((1 + a2)((1 - a2)^2 - a1^2))
    expected = (1 - a[1]) / ((1 + a[1]) * ((1 - a[1]) ** 2 - a[0] ** 2))
    assert h2_norm([[a[0], a[1]], [1, 0]], [[1], [0]], [[1, 0]], sample=1.0) == pytest.approx(
        math.sqrt(expected), rel=1e-12
    )


def test_a_moving_average_in_discrete_time():
    # closed forms of (1 + 1/z)/2: 1 at zero, sqrt(1/4 + 1/4)
    assert hinf_norm([[0]], [[1]], [[0.5]], [[0.5]], sample=1.0) == (pytest.approx(1.0), 0.0)
    assert h2_norm([[0]], [[1]], [[0.5]], [[0.5]], sample=1.0) == pytest.approx(math.sqrt(0.5), rel=1e-15)


@pytest.mark.parametrize("seed", range(6))
def test_discrete_norms_agree_with_python_control(seed):
    # independent implementation: control.norm of a discrete system, to its tolerance
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((3, 3))
    A *= 0.9 / np.abs(np.linalg.eigvals(A)).max()
    B, C, D = rng.standard_normal((3, 2)), rng.standard_normal((2, 3)), rng.standard_normal((2, 2))
    other = control.ss(A, B, C, D, 0.1)
    assert hinf_norm(A, B, C, D, sample=0.1)[0] == pytest.approx(control.norm(other, "inf", method="scipy"), rel=1e-5)
    assert h2_norm(A, B, C, D, sample=0.1) == pytest.approx(control.norm(other, 2, method="scipy"), rel=1e-9)


@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(-40, 40))
@settings(max_examples=30)
def test_both_ends_hold_whatever_the_units(seed, states, shift):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((states, states))
    A -= (np.linalg.eigvals(A).real.max() + 10.0 ** rng.uniform(-6, 0)) * np.eye(states)
    B, C = rng.standard_normal((states, 2)), rng.standard_normal((2, states))
    # law: another unit of time multiplies A and B
    unit = 2.0**shift
    one, two = hinf_enclosure(A, B, C), hinf_enclosure(A * unit, B * unit, C)
    assert one.lower <= two.upper and two.lower <= one.upper
    grid = np.append(np.geomspace(1e-8, 1e3, 400), one.frequency)
    gains = [np.linalg.norm(C @ np.linalg.solve(1j * w * np.eye(states) - A, B), 2) for w in grid]
    assert max(gains) <= one.upper * (1 + 1e-9)
    square = h2_enclosure(A, B, C)
    assert square.lower * (1 - 1e-9) <= h2_norm(A, B, C) <= square.upper * (1 + 1e-9)


@pytest.mark.parametrize(
    ("A", "sample"),
    [
        ([[1e-300]], None), ([[0.0]], None), ([[0, 1], [-1, 0]], None), ([[0, 1], [-1, 1e-18]], None),
        ([[1.0]], 1.0), ([[-1.0]], 1.0), ([[0, 1], [-1, 0]], 1.0), ([[1 + 2.3e-16]], 1.0),
    ],
)  # fmt: skip
def test_a_system_that_is_not_stable_has_no_norm(A, sample):
    n = len(A)
    for call in (hinf_norm, h2_norm):
        with pytest.raises((InputError, ComputationError)):
            call(A, np.ones((n, 1)), np.ones((1, n)), sample=sample)


@pytest.mark.parametrize(
    "arguments",
    [{"tolerance": 0.0}, {"tolerance": math.nan}, {"sample": 0.0}, {"sample": -1.0}, {"sample": math.nan}],
)
def test_bad_settings_are_refused(arguments):
    with pytest.raises(InputError):
        hinf_norm([[-0.5]], [[1]], [[1]], **arguments)


@pytest.mark.parametrize("rate", [5e-324, 1e-310])
def test_a_norm_beyond_doubles_is_refused(rate):
    # 1/(s + rate): the norm is 1/rate, above the largest double
    with pytest.raises(ComputationError, match="double precision"):
        hinf_norm([[-rate]], [[1.0]], [[1.0]])
