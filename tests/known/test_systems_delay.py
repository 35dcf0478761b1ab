"""Roots and norms of delay systems against closed forms: no root is dropped, no turn lost."""

import math

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import block_diag
from scipy.special import lambertw

from gainsay.errors import ComputationError, InputError
from gainsay.systems.delay import DelaySystem
from gainsay.systems.delay_spectrum import (
    gain_stays_below,
    hinf_norm,
    rightmost_roots,
    spectral_abscissa,
    unstable_root_count,
)
from gainsay.systems.level_proofs import level_not_reached
from gainsay.systems.pencils import DelayPencil, turning


def scalar(a: float, b: float) -> DelaySystem:
    """x' = -a x - b x(t - d) + w, y = x."""
    return DelaySystem([[-a]], [[-b]], [[1]], [[1]], [[1]])


def beside(modes: np.ndarray, gain: float = 0.3) -> DelaySystem:
    """x' = -gain x(t - d) beside undelayed modes, every state an input and an output."""
    n = 1 + len(modes)
    first = np.eye(n)[:, :1]
    return DelaySystem(block_diag([[0.0]], modes), -first, gain * first.T, np.eye(n), np.eye(n))


def mode(real: float, rate: float) -> np.ndarray:
    return np.array([[real, rate], [-rate, real]])


@pytest.mark.parametrize("rate", [6.0, 60.0, 600.0, 6e4])
@pytest.mark.parametrize("real", [0.01, -0.01])
def test_a_fast_mode_beside_a_delayed_loop(rate, real):
    # block diagonal: the roots are those of x' = -0.3 x(t - 1), W_0(-0.3), and real +- j rate
    system = beside(mode(real, rate))
    assert spectral_abscissa(system, 1.0) == pytest.approx(max(real, lambertw(-0.3).real), rel=1e-9)
    assert unstable_root_count(system, 1.0) == (2 if real > 0 else 0)
    if real > 0:
        with pytest.raises(InputError, match="unstable"):
            hinf_norm(system, 1.0)


def test_the_norm_sees_a_fast_light_mode():
    # block diagonal, every state an input and an output: the largest gain is 1/0.01, of the mode, at its frequency
    peak = hinf_norm(beside(mode(-0.01, 60.0)), 1.0)
    assert peak.value == pytest.approx(100.0, rel=1e-9)
    assert peak.frequency == pytest.approx(60.0, rel=1e-9)
    assert peak.value <= peak.upper <= 100.001


@pytest.mark.parametrize("copies", [1, 2, 3])
@pytest.mark.parametrize("damping", [1e-6, -1e-6])
@pytest.mark.parametrize("delay", [0.0, 0.5])
def test_equal_light_modes_are_counted_each(copies, damping, delay):
    # closed form: s^2 + 2 z s + 1 has both roots on the side of -z; the delayed loop beside is stable at 0.5 s
    system = beside(np.kron(np.eye(copies), [[0, 1], [-1, -2 * damping]]))
    assert unstable_root_count(system, delay) == (0 if damping > 0 else 2 * copies)


@pytest.mark.parametrize("delay", [0.1, 1.5, 1.6, 7.8, 7.9, 14.2, 30.0])
def test_roots_cross_one_pair_after_the_other(delay):
    # closed form: x' = -x(t - d) gains a pair at d = pi/2 + 2 pi k
    expected = 2 * max(0, math.floor((delay - math.pi / 2) / (2 * math.pi)) + 1)
    assert unstable_root_count(scalar(0, 1), delay) == expected
    assert (spectral_abscissa(scalar(0, 1), delay) > 0) == (expected > 0)


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9])
def test_roots_close_to_the_axis(distance):
    # closed form: the margin is pi/2
    assert unstable_root_count(scalar(0, 1), math.pi / 2 * (1 - distance)) == 0
    assert unstable_root_count(scalar(0, 1), math.pi / 2 * (1 + distance)) == 2


@pytest.mark.parametrize("delay", [0.05, 0.3, 1.0, 3.0, 20.0])
def test_the_abscissa_is_a_branch_of_lambert_w(delay):
    # s = -e^{-sd}: s = W_0(-d)/d (Corless et al., Adv. Comput. Math. 5, 1996)
    assert spectral_abscissa(scalar(0, 1), delay) == pytest.approx((lambertw(-delay) / delay).real, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("copies", [2, 3])
def test_equal_delayed_loops_have_multiple_roots(copies):
    # copies of x' = -x(t - 1): each root as often as there are copies
    eye = np.eye(copies)
    found = rightmost_roots(DelaySystem(0 * eye, -eye, eye), 1.0, 2 * copies)
    root = complex(lambertw(-1))
    assert len(found) == 2 * copies
    assert np.abs(np.abs(found.imag) + 1j * found.real - (abs(root.imag) + 1j * root.real)).max() < 1e-8


def test_a_double_root():
    # x' = -x(t - d)/e at d = 1: s = -1 twice, where W_0 and W_{-1} meet
    assert spectral_abscissa(scalar(0, math.exp(-1)), 1.0) == pytest.approx(-1, abs=2e-7)


@pytest.mark.parametrize("delay", [0.4, 1.0, 1.4])
def test_the_norm_of_a_delayed_integrator_loop(delay):
    # closed form: 1/|jw + e^{-jwd}|, and |.|^2 = 1 + w^2 - 2 w sin(w d), its least value by a fine grid
    w = np.linspace(0, 3, 3_000_001)
    expected = 1 / math.sqrt((1 + w**2 - 2 * w * np.sin(w * delay)).min())
    peak = hinf_norm(scalar(0, 1), delay)
    assert peak.value == pytest.approx(expected, rel=1e-9)
    assert expected <= peak.upper * (1 + 1e-12)
    assert peak.upper <= expected * (1 + 2e-5)


@given(st.integers(0, 10_000), st.floats(0.05, 2.0))
@settings(max_examples=25)
def test_the_count_is_that_of_the_roots_right_of_the_axis(seed, delay):
    # law: two methods, the argument principle on the axis and the roots one by one
    rng = np.random.default_rng(seed)
    system = DelaySystem(rng.normal(size=(3, 3)), rng.normal(size=(3, 1)), rng.normal(size=(1, 3)))
    try:
        found, count = rightmost_roots(system, delay, 8), unstable_root_count(system, delay)
    except ComputationError:
        return
    assert count == (found.real > 0).sum() or found[-1].real > 0


@pytest.mark.parametrize(
    ("delay", "level"), [(fmpq(-1), fmpq(2)), (fmpq(1), fmpq(0)), (fmpq(1), fmpq(-2)), (fmpq(-1, 1000), fmpq(100))]
)
def test_a_proof_about_a_negative_level_or_delay_is_refused(delay, level):
    with pytest.raises(InputError, match=r"delay|level"):
        gain_stays_below(scalar(1, 0.5), delay, level)


@pytest.mark.parametrize("height", [0.04, 1e-3, 1e-8])
def test_no_turn_is_lost_beside_a_root_of_high_multiplicity(height):
    # closed form: det = s^8, whose argument is 8 arg s
    pencil = DelayPencil(np.eye(8), ((np.zeros((8, 8)), 0.0),))
    expected = 8 * (2 * math.atan(height) - math.pi)
    assert turning(pencil, [-1 + 1j * height, 1 + 1j * height]) == pytest.approx(expected, abs=1e-9)


def test_a_level_below_the_gain_at_infinity_is_not_proved():
    # y = 1/(s + 1 + 0.5 e^{-s}) w + w: the gain at infinity is 1
    system = DelaySystem([[-1]], [[-0.5]], [[1]], [[1]], [[1]], [[1]])
    assert not level_not_reached(system, 1.0, 0.5) and not level_not_reached(system, 1.0, 1.0)
    assert level_not_reached(system, 1.0, 10.0)


def test_a_root_on_the_axis_is_refused():
    for delay in (0.0, 1.0):
        with pytest.raises(ComputationError):
            unstable_root_count(beside(mode(0.0, 1.0)), delay)


@pytest.mark.parametrize("delay", [-1.0, math.nan, math.inf])
def test_a_bad_delay_is_refused(delay):
    for call in (rightmost_roots, spectral_abscissa, unstable_root_count, hinf_norm):
        with pytest.raises(InputError, match="delay"):
            call(scalar(0, 1), delay)


@pytest.mark.parametrize("power", [-100, -27, 27, 100])
def test_the_unit_of_time_changes_nothing(power):
    # law: t in other units, a power of two, multiplies rates and frequencies and leaves counts and norms
    A, Bd, Cd = np.array([[-0.2, 1.0], [-1.5, -0.4]]), np.array([[0.3], [-0.8]]), np.array([[1.0, 0.5]])
    unit = 2.0**power
    one, other = DelaySystem(A, Bd, Cd, Bd, Cd), DelaySystem(unit * A, unit * Bd, Cd, unit * Bd, Cd)
    for delay in (0.0, 0.3, 2.0):
        assert spectral_abscissa(other, delay / unit) == pytest.approx(unit * spectral_abscissa(one, delay), rel=1e-9)
        assert unstable_root_count(other, delay / unit) == unstable_root_count(one, delay)
    assert hinf_norm(other, 0.3 / unit).value == pytest.approx(hinf_norm(one, 0.3).value, rel=1e-9)
    assert hinf_norm(other, 0.3 / unit).frequency == pytest.approx(unit * hinf_norm(one, 0.3).frequency, rel=1e-6)
