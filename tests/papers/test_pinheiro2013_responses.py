import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gainsay.simulation.linear import Response
from papers.pinheiro2013 import response as responses
from papers.pinheiro2013.conditions import h2_design, limit_gain
from papers.pinheiro2013.plant import Satellite, generalized_plant, linear_model

SATELLITE = Satellite((12.0, 11.0, 9.0), 1.0e-3)
K = h2_design(generalized_plant(SATELLITE, "all")).K
TORQUE = responses.Disturbance(1e-5, 3e-5, 300.0, 900.0, 3)


def test_disturbed_response_agrees_with_an_integrator():
    found = responses.Disturbed(SATELLITE, "all", K, TORQUE, 1500.0)
    A, B = linear_model(SATELLITE, "all")
    time, states = found.samples()
    assert time[0] == 0 and time[-1] == 1500
    assert np.all(np.diff(time) > 0)

    def slope(t, x):
        return (A - B @ K) @ x + B @ np.full(3, TORQUE.torque(t, SATELLITE.n))

    state, begin = np.zeros(6), 0.0
    for end in (300.0, 900.0, 1500.0):
        # Independent method: an adaptive integrator, restarted where the step switches.
        state = solve_ivp(slope, (begin, end - 1e-9), state, rtol=1e-11, atol=1e-16).y[:, -1]
        assert states[time == end][0] == pytest.approx(state, rel=1e-6, abs=1e-14)
        begin = end


def test_torque_of_25_by_hand():
    # By hand at t = 500 s, n = 1e-3: sines of 0.5, 1.0 and 1.5, the step on.
    assert TORQUE.torque(500.0, 1e-3) == pytest.approx(1e-5 * (np.sin(0.5) + np.sin(1) + np.sin(1.5)) + 3e-5)
    assert TORQUE.torque(900.0, 1e-3) == pytest.approx(1e-5 * (np.sin(0.9) + np.sin(1.8) + np.sin(2.7)))


def test_small_nonlinear_motion_is_linear():
    A = responses.loop_matrix(SATELLITE, "all", K)
    start = np.array([0, 0, 0, 1e-4, -1e-4, 2e-4])
    linear = Response(A, start, 60.0, 60)
    found = responses.nonlinear(SATELLITE, K, start, 60.0)
    states = responses.angle_rates(found(linear.time), SATELLITE.n)
    # What is left is of second order: about the square of the largest angle.
    size = np.abs(linear.states[:, :3]).max()
    assert np.abs(states[:, :3] - linear.states[:, :3]).max() < 5 * size**2


def test_wheel_limit_bounds_the_torque_and_changes_the_motion():
    gain = limit_gain(generalized_plant(SATELLITE, "all"))
    start = np.array([0, 0, 0, 0.02, 0.02, 0.02])
    free, held = (responses.nonlinear(SATELLITE, gain, start, 30.0, limit=limit) for limit in (None, 0.05))
    times = np.linspace(0, 30, 301)
    assert len(held.ends) > 2
    assert np.abs(free(times)[:, :3]).max() < 0.5 * np.abs(held(times)[:, :3]).max()
    # Law: turning about pitch alone under full torque of one sign, the rate changes by limit/I a second.
    held = responses.nonlinear(SATELLITE, gain, np.array([0, 0, 0, 0, 0.02, 0]), 5.0, limit=0.05)
    early = responses.angle_rates(held(np.array([0.0, 0.5])), SATELLITE.n)
    assert (early[1, 4] - early[0, 4]) / 0.5 == pytest.approx(-0.05 / SATELLITE.moment("y"), rel=1e-3)


def test_difference_of_two_loops_is_that_of_their_responses():
    A = responses.loop_matrix(SATELLITE, "all", K)
    B = responses.loop_matrix(SATELLITE.changed((0.1, -0.1, 0.1)), "all", K)
    start = np.array([0, 0, 0, 1.0, 0, 0])
    both = responses.difference(A, B, start, 40.0, 80)
    assert both.states[:, :6] == pytest.approx(Response(A, start, 40.0, 80).states, abs=1e-12)
    assert both.states[:, 6:] == pytest.approx(Response(B, start, 40.0, 80).states, abs=1e-12)


def test_slow_mode_does_not_hide_the_peak_of_a_fast_one():
    # Closed form: e^(-b t) - e^(-a t) peaks at ln(a/b)/(a - b); a third mode lasts a hundred thousand times longer.
    a, b = 16.0, 2.0
    time = np.log(a / b) / (a - b)
    response = responses.Transient(np.diag([-a, -b, -1e-4]), np.ones(3))
    peak = response.peak(np.array([-1.0, 1.0, 0.0]))
    assert peak.time == pytest.approx(time, rel=1e-9)
    assert peak.value == pytest.approx(np.exp(-b * time) - np.exp(-a * time), rel=1e-12)
    # e^(-b t) falls below 2 % at ln(50)/b, the slow mode at ln(50)/1e-4.
    assert response.last_above(np.eye(3)[1], 0.02) == pytest.approx(np.log(50) / b, rel=1e-9)
    assert response.last_above(np.eye(3)[2], 0.02) == pytest.approx(np.log(50) / 1e-4, rel=1e-9)


def test_stages_cover_the_whole_length():
    A = np.diag([-16.0, -2.0, -1e-4])
    for length in (0.5, 10.0, 1e6):
        parts = responses.stages(np.linalg.eigvals(A), length, 10.0)
        assert sum(duration for duration, _ in parts) == pytest.approx(length, rel=1e-12)
        assert all(duration / steps <= 10.0 for duration, steps in parts)
