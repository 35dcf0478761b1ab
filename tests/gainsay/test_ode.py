import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from gainsay.errors import ComputationError
from gainsay.simulation import ode
from gainsay.simulation.ode import integrate, largest, last_crossing


def oscillator(t, x):
    return np.array([x[1], -x[0]])


def first(t, x):
    return x[:, 0]


@pytest.mark.parametrize("method", ["DOP853", "LSODA", "RK45"])
def test_a_linear_system_follows_its_matrix_exponential(method):
    A = np.array([[0.0, 1.0, 0.0], [-4.0, -0.4, 1.0], [0.0, 0.0, -2.0]])
    start = np.array([1.0, -1.0, 3.0])
    found = integrate(lambda t, x: A @ x, start, 7.0, rtol=1e-11, atol=1e-12, method=method)
    for time in (0.0, 0.1, 3.3, 7.0):
        np.testing.assert_allclose(found(time), expm(A * time) @ start, atol=1e-8)


def test_many_times_at_once_are_each_time_alone():
    found = integrate(oscillator, np.array([0.0, 1.0]), 10.0, kinks=(lambda t, x: x[0] - 0.5,))
    times = np.array([10.0, 0.0, 3.7, 3.7, 9.999, *found.ends])
    assert len(found.pieces) > 2
    np.testing.assert_array_equal(found(times), [found(float(t)) for t in times])
    assert found(np.array([2.0])).shape == (1, 2)
    assert found(2.0).shape == (2,)


def test_kinks_are_located_and_keep_the_accuracy():
    # Closed form of dx/dt = |cos t|: x = sin t up to pi/2, then 2 - sin t up to 3 pi/2, then 4 + sin t.
    found = integrate(lambda t, x: np.array([abs(math.cos(t))]), np.zeros(1), 7.0, kinks=(lambda t, x: math.cos(t),))
    np.testing.assert_allclose(found.ends, [0, math.pi / 2, 3 * math.pi / 2, 7.0], atol=1e-8)
    assert found(7.0)[0] == pytest.approx(4 + math.sin(7.0), abs=1e-11)
    assert found(2.0)[0] == pytest.approx(2 - math.sin(2.0), abs=1e-10)


@given(st.floats(0.1, 0.9), st.floats(0.5, 3.0))
@example(0.20626450303159705, 0.9464486267122048)  # a step that looked beyond the kink was off by 2.5e-8
@settings(max_examples=20)
def test_saturated_feedback_reaches_the_time_of_its_closed_form(limit, start):
    # dx/dt = -sat(x, limit): straight down to x = limit, then exponential.
    if start <= limit:
        start = limit + 0.5
    found = integrate(
        lambda t, x: -np.clip(x, -limit, limit), np.array([start]), 8.0, kinks=(lambda t, x: x[0] - limit,)
    )
    turn = (start - limit) / limit
    if turn < 8:
        assert found(8.0)[0] == pytest.approx(limit * math.exp(-(8 - turn)), rel=1e-8)
        assert found.ends[1] == pytest.approx(turn, abs=1e-7)
    else:
        assert found(8.0)[0] == pytest.approx(start - limit * 8, rel=1e-10)


def test_a_kink_at_the_very_start_or_end_does_no_harm():
    ends = (lambda t, x: x[0], lambda t, x: x[0] - 1.0)
    found = integrate(lambda t, x: np.array([1.0]), np.zeros(1), 1.0, kinks=ends)
    assert found(1.0)[0] == pytest.approx(1.0, abs=1e-12)
    assert found.ends[-1] == 1.0


def test_the_largest_value_is_located_between_steps():
    # sin t is largest at pi/2, exp(-t/10) sin t at atan(10); the dense output, of order 7, errs by some 1e-11.
    found = integrate(oscillator, np.array([0.0, 1.0]), 2.0)
    assert largest(found, first) == (pytest.approx(math.pi / 2, abs=1e-5), pytest.approx(1.0, abs=1e-10))
    damped = integrate(lambda t, x: np.array([x[1], -1.01 * x[0] - 0.2 * x[1]]), np.array([0.0, 1.0]), 20.0)
    peak = math.atan(10)
    assert largest(damped, first) == (
        pytest.approx(peak, abs=1e-5), pytest.approx(math.exp(-peak / 10) * math.sin(peak), abs=1e-10)
    )  # fmt: skip


def test_the_largest_value_at_an_end_of_the_time():
    falling = integrate(lambda t, x: -x, np.array([3.0]), 2.0)
    assert largest(falling, first) == (pytest.approx(0.0, abs=1e-6), pytest.approx(3.0, rel=1e-6))
    assert largest(falling, first)[1] == 3.0
    rising = integrate(lambda t, x: x, np.array([3.0]), 2.0)
    assert largest(rising, first)[1] == pytest.approx(3 * math.exp(2), rel=1e-10)


@pytest.mark.parametrize("growth", [1e-5, 1e-4, 1e-3, -1e-4])
@pytest.mark.parametrize("frequency", [0.7, 3.0, 11.3])
def test_of_peaks_that_are_nearly_equal_the_largest_is_found(frequency, growth):
    # exp(g t) cos(w t): peaks grow or shrink by a tiny part, less than sampling between steps can tell apart.
    found = integrate(
        lambda t, x: np.array([growth * x[0] - frequency * x[1], frequency * x[0] + growth * x[1]]),
        np.array([math.cos(1.0), math.sin(1.0)]), 40.0,
    )  # fmt: skip
    offset = math.atan2(growth, frequency)
    peaks = [t for k in range(-1, 200) if 0 <= (t := (2 * math.pi * k - 1.0 + offset) / frequency) <= 40]
    values = [math.exp(growth * t) * math.cos(frequency * t + 1.0) for t in (*peaks, 0.0, 40.0)]
    assert largest(found, first)[1] == pytest.approx(max(values), abs=1e-9)


@given(st.floats(0.2, 20.0), st.floats(0.0, 6.28), st.floats(-0.3, 0.3))
@settings(max_examples=25)
def test_no_sample_is_above_the_largest_value(frequency, phase, growth):
    def slope(t, x):
        return np.array([growth * x[0] - frequency * x[1], frequency * x[0] + growth * x[1]])

    found = integrate(slope, np.array([math.cos(phase), math.sin(phase)]), 5.0, rtol=1e-10, atol=1e-12)
    time, value = largest(found, first)
    dense = found(np.linspace(0, 5, 20001))[:, 0]
    assert value >= dense.max() - 1e-9
    assert value == pytest.approx(found(time)[0], abs=1e-12)


@pytest.mark.parametrize("level", [0.05, 0.1, 0.2, 0.3, 0.5])
def test_the_last_crossing_is_the_last(level):
    # exp(-t/10) |sin t| stays below a level from the last of its crossings on; found again by brute force.
    found = integrate(lambda t, x: np.array([x[1], -1.01 * x[0] - 0.2 * x[1]]), np.array([0.0, 1.0]), 60.0)
    time = last_crossing(found, lambda t, x: np.abs(x[:, 0]) - level)
    grid = np.linspace(0, 60, 600001)
    above = np.abs(np.exp(-grid / 10) * np.sin(grid)) >= level
    assert time == pytest.approx(grid[np.flatnonzero(above)[-1]], abs=2e-4)
    assert abs(math.exp(-time / 10) * math.sin(time)) == pytest.approx(level, abs=1e-9)


@pytest.mark.parametrize("level", [-1.0, 2.0])
def test_what_never_stays_below_or_never_was_above_has_no_crossing(level):
    found = integrate(lambda t, x: -x, np.array([1.0]), 3.0)
    with pytest.raises(ComputationError, match="does not pass"):
        last_crossing(found, lambda t, x: x[:, 0] - level)


def test_an_integration_that_gives_up_says_when():
    # x' = x^2 from 1 escapes to infinity at t = 1.
    with pytest.raises(ComputationError, match=r"gave up at t = (0\.99|1\.0)"):
        integrate(lambda t, x: x**2, np.array([1.0]), 2.0)


def test_a_right_hand_side_that_chatters_is_refused(monkeypatch):
    monkeypatch.setattr(ode, "_MAX_KINKS", 100)
    # Kinks that accumulate (x = -sign x sticks at 0) must end in an error, not in a loop without end.
    with pytest.raises(ComputationError, match="kinks before"):
        integrate(lambda t, x: -np.sign(x), np.array([1.0]), 10.0, kinks=(lambda t, x: x[0],))


def test_two_integrations_are_the_same_to_the_bit():
    one, two = (integrate(oscillator, np.array([0.3, 1.0]), 20.0, kinks=(lambda t, x: x[0] - 0.1,)) for _ in range(2))
    times = np.linspace(0, 20, 333)
    np.testing.assert_array_equal(one(times), two(times))


def test_the_largest_value_of_a_constant_output_is_that_constant():
    found = integrate(oscillator, np.array([0.0, 1.0]), 100.0)
    assert largest(found, lambda t, x: np.full(len(t), 3.0))[1] == 3.0
    assert largest(found, lambda t, x: np.minimum(x[:, 0], 0.5))[1] == 0.5


@pytest.mark.parametrize("second", [1e-12, 1e-9, 1e-6, 1.0, 1e6, 1e8, 1e10])
def test_kinks_peaks_and_crossings_do_not_depend_on_the_unit_of_time(second):
    # closed form: a spring four times as stiff on one side swings with the period 3/2 pi, to 1 and to -1/2
    def spring(t, x):
        return np.array([x[1], -x[0] if x[0] > 0 else -4 * x[0]]) / second

    end = 4 * 1.5 * np.pi * second
    found = integrate(spring, np.array([1.0, 0.0]), end, kinks=(lambda t, x: x[0],))
    np.testing.assert_allclose(found(end), [1.0, 0.0], atol=1e-10)
    assert largest(found, lambda t, x: -x[:, 0])[1] == pytest.approx(0.5, abs=1e-10)
    assert last_crossing(found, lambda t, x: 5.0 - t / second) / second == pytest.approx(5.0, abs=1e-10)


def test_a_crossing_between_two_samples_alone_is_the_last():
    # closed form: cos t is above 0.999999 within acos(0.999999) of its last turn, which no sample hits
    found = integrate(oscillator, np.array([1.0, 0.0]), 15.0, rtol=1e-6, atol=1e-9)
    assert not (np.cos(found.fine[0][found.fine[0] > 1]) > 0.999999).any()
    late = last_crossing(found, lambda t, x: np.cos(t) - 0.999999)
    assert late == pytest.approx(4 * np.pi + np.arccos(0.999999), abs=1e-9)
