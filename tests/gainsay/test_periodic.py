"""Periodic linear systems against adaptive integration, exact exponentials and closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from gainsay.errors import InputError
from gainsay.simulation.periodic import PeriodicSolution, magnus_step, piecewise, with_oscillators

RNG = np.random.default_rng(7)
BASE = RNG.standard_normal((5, 5)) - 2.5 * np.eye(5)
SLOPE = RNG.standard_normal((5, 5))


def varying(t):
    return BASE + 0.4 * np.sin(2 * np.pi * t) * SLOPE


def test_against_adaptive_integrator():
    start = np.arange(1.0, 6.0)
    found = PeriodicSolution(varying, 1.0, start, 6, steps=80)
    # oracle: DOP853 at 1e-11 (scipy)
    oracle = solve_ivp(
        lambda t, x: varying(t) @ x, (0, 6), start, t_eval=found.times, method="DOP853", rtol=1e-11, atol=1e-13
    )
    assert np.abs(found.states - oracle.y.T).max() < 2e-7
    # between nodes too
    dense = solve_ivp(lambda t, x: varying(t) @ x, (0, 2.3456), start, method="DOP853", rtol=1e-11, atol=1e-13)
    assert np.abs(found.state(2.3456) - dense.y[:, -1]).max() < 2e-7


def test_order_four():
    # law: the error of fourth-order Magnus steps falls by 16 when the step is halved
    start = np.ones(5)
    fine = PeriodicSolution(varying, 1.0, start, 1, steps=640).states[-1]
    errors = [np.linalg.norm(PeriodicSolution(varying, 1.0, start, 1, steps=n).states[-1] - fine) for n in (10, 20, 40)]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(rates - 4) < 0.4)


def test_liouville():
    # closed form: det of the monodromy matrix is exp of the integral of the trace; the sine integrates to zero
    found = PeriodicSolution(varying, 1.0, np.ones(5), 1, steps=20)
    assert np.linalg.det(found.monodromy) == pytest.approx(np.exp(np.trace(BASE)), rel=1e-12)


@settings(max_examples=20)
@given(st.floats(0.0, 3.0), st.floats(0.0, 2.0))
def test_constant_matrix_is_exact(t, h):
    # closed form: the exponential
    assert np.allclose(magnus_step(lambda s: BASE, t, h), expm(h * BASE), rtol=1e-12, atol=1e-12)


def test_oscillators_are_exact():
    # closed form: x' = -x + 2 cos wt + 3 sin wt + 5, x(0) = 0
    w, t = 0.7, 4.0
    whole = with_oscillators(np.array([[-1.0]]), np.array([[2.0, 3.0, 5.0]]), w)
    got = (expm(whole * t) @ [0, 1, 0, 1])[0]
    p, q = (2 - 3 * w) / (1 + w * w), (3 + 2 * w) / (1 + w * w)
    assert got == pytest.approx(p * np.cos(w * t) + q * np.sin(w * t) + 5 - (p + 5) * np.exp(-t), rel=1e-13)


def test_located_peak_and_exit():
    # closed form: x = sin t, peak 1 at pi/2 between nodes; |x| leaves 0.5 for the last time before 2 pi at 11 pi / 6
    A = np.array([[0.0, 1.0], [-1.0, 0.0]])
    found = PeriodicSolution(lambda t: A, 1.0, np.array([0.0, 1.0]), 6, steps=3)
    peak = found.largest(lambda t, x: x[..., 0])
    assert peak.value == pytest.approx(1.0, abs=1e-12)
    assert peak.time == pytest.approx(np.pi / 2, abs=1e-6)
    assert found.last_exit(lambda t, x: np.abs(x[..., 0]), 0.5) == pytest.approx(11 * np.pi / 6, abs=1e-8)


def test_largest_after():
    # closed form: exp(-t) is largest at the first time asked for
    found = PeriodicSolution(lambda t: np.array([[-1.0]]), 1.0, np.array([1.0]), 5, steps=4)
    assert found.largest(lambda t, x: x[..., 0], after=2.0).value == pytest.approx(np.exp(-2.0), rel=1e-12)


def test_held_gains():
    # identity: with the same matrix in every interval it is one exponential
    times, states = piecewise(np.repeat(BASE[None], 4, axis=0), 0.3, np.ones(5), inner=3)
    assert np.allclose(times, 0.1 * np.arange(13))
    assert np.allclose(states[-1], expm(1.2 * BASE) @ np.ones(5), rtol=1e-11)
    # and with two it is their product in order of time
    pair = np.stack([BASE, SLOPE])
    assert np.allclose(piecewise(pair, 0.2, np.ones(5))[1][-1], expm(0.2 * SLOPE) @ expm(0.2 * BASE) @ np.ones(5))


@pytest.mark.parametrize("size", [1e-9, 0.3, 3.0, 40.0, 1e3])
def test_held_gains_of_many_runs(size):
    # oracle: SciPy's exponentials, run by run; 1e3 is too long for a series
    generator = np.random.default_rng(8)
    units = 10.0 ** np.arange(-2, 3)
    loops = size * (generator.standard_normal((4, 3, 5, 5)) - 6 * np.eye(5)) * units / units[:, None]
    start = generator.standard_normal((3, 5)) / units
    times, states = piecewise(loops, 0.5, start)
    assert states.shape == (5, 3, 5) and times.tolist() == [0, 0.5, 1, 1.5, 2]
    for run in range(3):
        expected = [start[run]]
        for k in range(4):
            expected.append(expm(0.5 * loops[k, run]) @ expected[-1])
        assert np.abs((states[:, run] - expected) * units).max() < 1e-12
        assert np.allclose(states[:, run] * units, piecewise(loops[:, run], 0.5, start[run])[1] * units, atol=1e-12)
    several = piecewise(loops[:1], 0.5, start, inner=2)[1]
    assert np.abs((several[-1] - states[1]) * units).max() < 1e-12
    with pytest.raises(InputError):
        piecewise(loops, 0.5, start[:2])


def test_bad_input():
    with pytest.raises(InputError):
        PeriodicSolution(varying, 0.0, np.ones(5), 1)
    with pytest.raises(InputError):
        piecewise(BASE[None], -1.0, np.ones(5))
    with pytest.raises(InputError):
        with_oscillators(BASE, np.zeros((4, 3)), 1.0)
    with pytest.raises(InputError):
        PeriodicSolution(varying, 1.0, np.ones(5), 1).state(2.0)


@pytest.mark.parametrize("seed", [140, 147, 151, 191])
@pytest.mark.parametrize("offset", [0.0, -2.0, 7.0])
def test_the_largest_of_two_tones_wherever_their_zero_lies(seed, offset):
    # oracle: the closed form on a fine grid; with 147 and 191 the peak lies before the first node or after the last
    rates, first = np.array([1.0, np.sqrt(2)]), np.random.default_rng(seed).uniform(0, 2 * np.pi, 2)
    A = np.kron(np.diag(rates), [[0, -1], [1, 0]])
    start = np.column_stack([np.cos(first), np.sin(first)]).ravel()
    found = PeriodicSolution(lambda t: A, 2 * np.pi, start, 3, steps=20)
    t = np.linspace(0, 6 * np.pi, 100_001)
    highest = np.cos(t[:, None] * rates + first).sum(axis=1).max()
    peak = found.largest(lambda t, x: x[..., 0] + x[..., 2] - highest + offset)
    assert peak.value == pytest.approx(offset, abs=1e-7)


@pytest.mark.parametrize("second", [1e-12, 1e-6, 1.0, 1e9])
def test_a_peak_does_not_depend_on_the_unit_of_time(second):
    # closed form: cos(t - 0.1) reaches 1
    A = np.array([[0, -1], [1, 0]]) / second
    found = PeriodicSolution(lambda t: A, 2 * np.pi * second, np.array([1.0, 0.0]), 2, steps=20)
    assert found.largest(lambda t, x: x[..., 0] * np.cos(0.1) + x[..., 1] * np.sin(0.1)).value == pytest.approx(
        1, abs=1e-12
    )
    late = found.largest(lambda t, x: x[..., 1], after=np.pi * second)  # sin(t)
    assert late.time / second == pytest.approx(2.5 * np.pi, abs=1e-6)


@pytest.mark.parametrize("steps", [8, 11, 40])
def test_a_level_that_is_passed_between_nodes_alone_is_left_last_there(steps):
    # closed form: cos(t - 1) is above 0.9999 within acos(0.9999) of every turn
    found = PeriodicSolution(lambda t: np.array([[0, -1.0], [1, 0]]), 2 * np.pi, np.array([1.0, 0]), 2, steps=steps)
    late = found.last_exit(lambda t, x: x[..., 0] * np.cos(1) + x[..., 1] * np.sin(1), 0.9999)
    assert late == pytest.approx(1 + 2 * np.pi + np.arccos(0.9999), abs=1e-7)
    assert found.last_exit(lambda t, x: x[..., 0] * np.cos(1) + x[..., 1] * np.sin(1), 1.0001) == 0.0
