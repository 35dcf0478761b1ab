"""Several delays, commensurate or not: roots, counts, norms and matrix inequalities against closed forms and others.

Two loops x' = a x + b x(t - d) seen in mixed states have the roots of both, which Lambert's W gives each; in the mixed
states every delay acts on every state.
"""

import math

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import lambertw

from gainsay.errors import ComputationError, GainsayError, InputError
from gainsay.lmi import Definite, Program, find_point
from gainsay.systems.delay import DelaySystem
from gainsay.systems.delay_bounds import bessel_legendre, proved_delay
from gainsay.systems.delay_spectrum import (
    gain_stays_below,
    hinf_norm,
    rightmost_roots,
    spectral_abscissa,
    unstable_root_count,
)

MIXED = np.array([[1, 2, 0], [0, 1, -1], [1, 2, 1]])  # of determinant one: its inverse is whole too
MIXED_INVERSE = np.array([[3, -2, -2], [-1, 1, 1], [-1, 0, 1]])


def lambert_roots(a, b, d):
    """Roots of s = a + b e^{-sd}: (s - a) d e^{(s - a) d} = b d e^{-ad}."""
    return np.array([lambertw(b * d * np.exp(-a * d), k) / d + a for k in range(-8, 9)])


def mixed(a, b):
    """Loops x_i' = a_i x_i + b_i x_i(t - d_i) in mixed states."""
    return DelaySystem(MIXED @ np.diag(a) @ MIXED_INVERSE, MIXED @ np.diag(b), MIXED_INVERSE)


def two(first, second, pole=0.0):
    """x' = pole x + first x(t - d1) + second x(t - d2) + w, y = x."""
    return DelaySystem([[pole]], [[first, second]], [[1], [1]], [[1]], [[1]])


LOOPS = [
    ((0.25, -1.0, -0.5), (-1.0, -2.0, -0.25), (0.6, math.sqrt(2) / 3, 2.5)),
    ((0.5, 0.0, -1.0), (-1.0, -1.0, -3.0), (0.5, 1.0, 1.5)),
    ((0.0, 0.0, 0.0), (-1.0, -0.5, -2.0), (1.5, 2.9, 0.1)),
    ((-1.0, -4.0, 0.125), (0.5, 2.0, -0.75), (7.0, 0.01, 0.3)),
]


@pytest.mark.parametrize(("a", "b", "d"), LOOPS)
def test_mixed_loops_have_the_roots_of_each(a, b, d):
    every = np.concatenate([lambert_roots(*loop) for loop in zip(a, b, d, strict=True)])
    found = rightmost_roots(mixed(a, b), d, 6)
    assert len(found) == 6
    assert found.real == pytest.approx(np.sort(every.real)[::-1][:6], abs=1e-9)
    assert max(np.abs(every - root).min() for root in found) < 1e-9
    assert unstable_root_count(mixed(a, b), d) == (every.real > 0).sum()


@pytest.mark.parametrize("angle", [0.9, 1.1, 1.3, 1.5])
@pytest.mark.parametrize("off", [-1e-2, -1e-6, 1e-6, 1e-2])
def test_commensurate_delays_cross_where_the_equation_says(angle, off):
    # x' = -x(t - h) - b x(t - 2 h): s = jw, wh = angle needs cos + b cos 2 = 0, and w = sin + b sin 2; with b > 0 the
    # first crossing from no delay is at the least such angle, since b < 1 or the angle below pi/2
    b = -math.cos(angle) / math.cos(2 * angle)
    h = angle / (math.sin(angle) + b * math.sin(2 * angle)) * (1 + off)
    count = unstable_root_count(two(-1, -b), [h, 2 * h])
    assert count == (0 if off < 0 else 2)
    assert (spectral_abscissa(two(-1, -b), [h, 2 * h]) > 0) == (off > 0)


# Two neurons, x1' = -x1 - a g(2 x1(t - 12.7)) + 15/29 g(1.2 x2(t - 20.2)), x2' likewise, g'(0) = 1.
# DDEBifurcationKit.jl, documentation, tutorial "(Another) Neuron model": Hopf points of the equilibrium 0 along a, each
# within a bracket, where two roots cross.
HOPF = [(0.29853073, 0.29890362), (0.34523499, 0.34537483), (0.36662946, 0.36830746)]


@pytest.mark.parametrize(("number", "bracket"), list(enumerate(HOPF)))
def test_the_hopf_points_of_two_neurons(number, bracket):
    def count(a):
        cross = 15 / 29 * 1.2
        Bd = [[-2 * a, 0, cross, 0], [0, -2 * a, 0, cross]]
        system = DelaySystem(-np.eye(2), Bd, [[1, 0], [0, 1], [0, 1], [1, 0]])
        return unstable_root_count(system, [12.7, 12.7, 20.2, 20.2])

    assert [count(a) for a in bracket] == [2 * number, 2 * number + 2]


@given(st.floats(0.5, 3), st.floats(0.05, 0.45), st.floats(0.05, 0.45), st.floats(0, 3), st.floats(1e-6, 3))
@settings(max_examples=8)
def test_the_norm_of_a_positive_system_is_its_static_gain(a, first, second, d1, d2):
    # x' = -a (x - first x(t - d1) - second x(t - d2)) + w is positive: |G| is largest at w = 0, whatever the delays
    peak = hinf_norm(two(a * first, a * second, -a), [d1, d2])
    assert peak.value == pytest.approx(1 / (a * (1 - first - second)), rel=1e-9)
    assert peak.value <= peak.upper <= peak.value * (1 + 2e-5)


@pytest.mark.parametrize("delay", [(0.5, 1.1), (1.0, 0.0)])
def test_the_norm_of_an_integrator_under_two_delays(delay):
    # 1/|jw + (e^{-jw d1} + e^{-jw d2})/2|, its peak by a fine grid
    w = np.linspace(0, 4, 2_000_001)
    expected = (1 / np.abs(1j * w + sum(np.exp(-1j * w * d) for d in delay) / 2)).max()
    peak = hinf_norm(two(-0.5, -0.5), delay)
    assert peak.value == pytest.approx(expected, rel=1e-9)
    assert expected <= peak.upper * (1 + 1e-12)


def test_a_gain_is_proved_below_a_level_and_not_below_its_peak():
    peak = hinf_norm(two(-0.5, -0.5), [0.5, 1.25]).value
    delays = [fmpq(1, 2), fmpq(5, 4)]
    assert gain_stays_below(two(-0.5, -0.5), delays, fmpq(int(1001 * peak), 1000))
    assert not gain_stays_below(two(-0.5, -0.5), delays, fmpq(int(999 * peak), 1000))


@given(st.integers(0, 10_000), st.floats(0.05, 2.0), st.floats(0.05, 2.0))
@settings(max_examples=15)
def test_laws_of_several_delays(seed, d1, d2):
    rng = np.random.default_rng(seed)
    A, Bd, Cd = rng.normal(size=(3, 3)), rng.normal(size=(3, 2)), rng.normal(size=(2, 3))
    system, swapped = DelaySystem(A, Bd, Cd), DelaySystem(A, Bd[:, ::-1], Cd[::-1])
    try:
        found, count = rightmost_roots(system, [d1, d2], 8), unstable_root_count(system, [d1, d2])
    except ComputationError:
        return
    # two methods: the argument principle on the axis, and the roots one by one
    assert count == (found.real > 0).sum() or found[-1].real > 0
    for root in found:
        M = system.characteristic_matrix(root, [d1, d2])
        assert np.linalg.svd(M)[1][-1] < 1e-10 * (1 + np.abs(M).max())
    # the order of the signals, and the unit of time, change nothing; equal delays are one delay
    assert unstable_root_count(swapped, [d2, d1]) == count
    assert unstable_root_count(DelaySystem(A / 1024, Bd / 1024, Cd), [1024 * d1, 1024 * d2]) == count
    assert unstable_root_count(system, [d1, d1]) == unstable_root_count(system, d1)
    # an undelayed signal is a part of A
    closed = DelaySystem(A + Bd[:, 1:] @ Cd[1:], Bd[:, :1], Cd[:1])
    assert unstable_root_count(system, [d1, 0]) == unstable_root_count(closed, d1)


def test_delayed_terms_that_cancel_under_one_delay_alone():
    # x' = -x + 2 x(t - d1) - 2 x(t - d2): at equal delays the root is -1 alone; else s + 1 = 2 (e^{-s d1} - e^{-s d2})
    assert rightmost_roots(two(2, -2, -1), 1.0) == pytest.approx([-1])
    roots = rightmost_roots(two(2, -2, -1), [1, 2], 4)
    assert np.abs(roots + 1 - 2 * (np.exp(-roots) - np.exp(-2 * roots))).max() < 1e-12
    assert unstable_root_count(two(2, -2, -1), [1, 2]) == (roots.real > 0).sum() == 2


def test_delays_that_do_not_matter():
    # triangular: the roots are those of A, however large the delays
    system = DelaySystem([[-1, 0], [0, -2]], [[0, 0], [1, 1]], [[1, 0], [1, 0]], np.eye(2), np.eye(2))
    assert rightmost_roots(system, [1, 2]) == pytest.approx([-1, -2])


def test_a_delay_far_below_every_time_constant():
    # the limit is the undelayed signal: x' = -x/2 - x(t - 1)/2
    limit = spectral_abscissa(DelaySystem([[-0.5]], [[-0.5]], [[1]]), 1.0)
    for small in (1e-300, 1e-14, 1e-9):
        assert spectral_abscissa(two(-0.5, -0.5), [small, 1.0]) == pytest.approx(limit, abs=1e-8)


@pytest.mark.parametrize("delay", [[1e3, 1.0], [1e9, 1e-9]])
def test_far_delays_are_answered_or_refused(delay):
    # |0.4| + |0.4| < 1: stable for all delays
    for call in (spectral_abscissa, unstable_root_count):
        try:
            assert call(two(-0.4, -0.4, -1), delay) <= 0
        except ComputationError as refused:
            assert "\n" not in str(refused)


def test_a_product_of_factors_is_exact():
    # (1 + e)(1 - e) - 1 = -e^2, of which doubles leave nothing
    e = 2.0**-30
    system = DelaySystem([[0]], [[1 + e, 1]], [[1 - e], [-1]])
    assert system.A1[0, 0] == system.terms(1.0)[1][0][0, 0] == -(e**2)


def test_products_beyond_doubles_are_refused():
    for A, Bd, Cd in (([[0]], [[1e200]], [[1e200]]), ([[10**400]], [[1]], [[1]]), ([[0]], [[10**400]], [[1]])):
        with pytest.raises(InputError, match="doubles"):
            DelaySystem(A, Bd, Cd)


@pytest.mark.parametrize(
    "delay", [[1], [1, 2, 3], [-1, 1], [math.nan, 1], [math.inf, 1], [[1, 2]], "1", None, 1j, [1, None]]
)
def test_delays_that_are_none_are_refused(delay):
    for call in (rightmost_roots, spectral_abscissa, unstable_root_count, hinf_norm):
        with pytest.raises(InputError, match="delay"):
            call(two(-0.5, -0.5), delay)
    with pytest.raises(InputError, match="delay"):
        bessel_legendre(np.zeros((1, 1)), np.array([[-0.5, -0.5]]), np.ones((2, 1)), delay, 1)
    with pytest.raises(InputError, match="delay"):
        gain_stays_below(two(-0.5, -0.5), delay, fmpq(3))


@pytest.mark.parametrize(("degree", "least"), [(0, math.sqrt(2) * 0.998), (1, 1.56), (2, 1.569)])
def test_matrix_inequalities_of_two_delays(degree, least):
    # x1' = -x1(t - h), x2' = -2 x2(t - h/3) in mixed states: the first loses stability at pi/2, the second at 3 pi/4;
    # Jensen's inequality (degree 0) proves sqrt(2) of the first alone (Gu, Kharitonov and Chen, 2003)
    T = np.array([[1.0, 1], [1, 2]])
    parts = np.zeros((2, 2)), -T @ np.diag([1.0, 2]), np.linalg.inv(T)
    proved, _ = proved_delay(lambda h: bessel_legendre(*parts, [h, h / 3], degree).blocks, 2.0, 1e-3)
    assert least <= proved < math.pi / 2


@given(st.integers(0, 10_000))
@settings(max_examples=10)
def test_matrix_inequalities_prove_no_unstable_loop(seed):
    rng = np.random.default_rng(seed)
    A, Bd, Cd = rng.normal(size=(2, 2)) - np.eye(2), rng.normal(size=(2, 2)), rng.normal(size=(2, 2))
    delay = rng.uniform(0.1, 1.5, 2)
    try:
        unstable = unstable_root_count(DelaySystem(A, Bd, Cd), delay)
    except GainsayError:
        return
    blocks = [Definite(f"block {i}", b) for i, b in enumerate(bessel_legendre(A, Bd, Cd, delay, 1).blocks)]
    if find_point(Program(subject_to=blocks)) is not None:
        assert unstable == 0


def test_the_example_of_the_documentation():
    # law: a root of s + (e^{-s} + e^{-2s})/2 = 0, and the one in the docstring
    root = rightmost_roots(two(-0.5, -0.5), [1, 2], 2)[0]
    assert abs(root + (np.exp(-root) + np.exp(-2 * root)) / 2) < 1e-12
    assert f"{root.real:.6f}+{root.imag:.6f}j" in (rightmost_roots.__doc__ or "")
