import math
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm, solve_continuous_lyapunov

from gainsay.dynamics.relative_orbit import clohessy_wiltshire, relative_acceleration
from gainsay.tables import Case, read_case
from papers.wan2014 import plant
from papers.wan2014.plant import ANOMALY, COST, DELTA_V, ESTIMATE, POSITION, SQUARED_ERROR, VELOCITY, ClosedLoop
from tests.papers.wan2014_model import model_of, uncertainty

ROOT = Path(__file__).resolve().parents[2]
CASE = read_case(ROOT, "wan2014")
PRINTED = ClosedLoop(CASE, CASE.matrix("K"), CASE.matrix("L"))


def with_parameters(case: Case, **values: str) -> Case:
    """Return the case with other values of some parameters."""
    rows = dict(case.parameters)
    for name, value in values.items():
        rows[name] = rows[name].model_copy(update={"value": value})
    return replace(case, parameters=MappingProxyType(rows))


# --- the design model -----------------------------------------------------------------------------------------------

RATIONALS = st.fractions(Fraction(-3), Fraction(3), max_denominator=50)


@given(RATIONALS, RATIONALS, RATIONALS, RATIONALS)
def test_delta_a_is_e1_lambda_e2_as_polynomials(e, n, sine, cosine):
    # Identity (3) over the rationals: sin M and cos M are two free symbols, Delta A is typed in again from (2).
    E1 = [[e * x for x in row] for row in CASE.printed("E1_over_e").exact]
    powers = CASE.printed("E2_power").exact
    coefficients = CASE.printed("E2_coefficient").exact
    E2 = [[coefficients[i][j] * n ** int(powers[i][j]) for j in range(6)] for i in range(6)]
    channel = [sine, -sine, cosine, cosine, -cosine / 2, cosine]
    found = [[sum(E1[i][k] * channel[k] * E2[k][j] for k in range(6)) for j in range(6)] for i in range(6)]
    s, c = e * sine, e * cosine
    delta = [[Fraction(0)] * 6 for _ in range(6)]
    delta[3][0], delta[3][1], delta[3][4] = 10 * n**2 * c, -2 * n**2 * s, 4 * n * c
    delta[4][0], delta[4][1], delta[4][3] = 2 * n**2 * s, n**2 * c, -4 * n * c
    delta[5][2] = -3 * n**2 * c
    assert found == delta


@given(st.floats(-10, 10))
def test_the_modules_own_matrices_satisfy_the_identity_too(anomaly):
    model = model_of(CASE)
    e, n = CASE.number("eccentricity"), CASE.number("mean_motion")
    product = model.E1 @ uncertainty(anomaly) @ model.E2
    np.testing.assert_allclose(product, plant.noncircular_part(e, n, anomaly), rtol=1e-12, atol=1e-20)


def test_design_model_is_clohessy_wiltshire_with_the_printed_n():
    model = model_of(CASE)
    np.testing.assert_array_equal(model.A, clohessy_wiltshire(1.13e-3))
    np.testing.assert_array_equal(model.B[3:], np.eye(3) / 200)
    # (42) at n = 1.13e-3, by hand: row 3 holds 2.5 n^2, n^2, n; row 4 holds 0.25 n^2 and -n
    n = 1.13e-3
    np.testing.assert_allclose(model.E2[2], [2.5 * n**2, 0, n**2, 0, n, 0], rtol=1e-15)
    np.testing.assert_allclose(model.E2[3], [0, 0.25 * n**2, 0, -n, 0, 0], rtol=1e-15)
    assert np.count_nonzero(model.E2) == 9
    np.testing.assert_allclose(model.E1[3], [0, 0.02, 0.04, 0, 0.08, 0], rtol=1e-15)


@pytest.mark.parametrize("eccentricity", [1e-3, 1e-2])
@pytest.mark.parametrize("mean_anomaly", [0.0, 0.7, 2.5, 4.0])
def test_the_linear_plant_is_the_two_body_plant_to_first_order_in_e(eccentricity, mean_anomaly):
    # Expansion of Kepler's motion: what A + Delta A leaves out is of second order in e, in units of n.
    case = with_parameters(CASE, eccentricity=str(eccentricity))
    orbit = plant.target_orbit(case)
    n = orbit.mean_motion
    anomaly = plant.true_anomaly(mean_anomaly, eccentricity)
    scale = np.array([1, 1, 1, n, n, n])
    columns = []
    for unit in np.diag(scale):
        high = relative_acceleration(orbit, anomaly, tuple(unit[:3]), tuple(unit[3:]))
        low = relative_acceleration(orbit, anomaly, tuple(-unit[:3]), tuple(-unit[3:]))
        columns.append((np.array(high) - low) / 2)
    exact = np.array(columns).T / n**2
    A = clohessy_wiltshire(n)
    linear = (A + plant.noncircular_part(eccentricity, n, mean_anomaly))[3:] * scale / n**2
    assert np.abs(exact - linear).max() < 40 * eccentricity**2
    assert np.abs(exact - A[3:] * scale / n**2).max() > 0.5 * eccentricity


@given(st.floats(-20, 20), st.floats(0, 0.6))
@settings(deadline=None)
def test_true_anomaly_solves_keplers_equation_and_counts_turns(mean_anomaly, eccentricity):
    # Oracle: back from the true anomaly through E to M by Kepler's equation.
    nu = plant.true_anomaly(mean_anomaly, eccentricity)
    E = 2 * math.atan2(math.sqrt(1 - eccentricity) * math.sin(nu / 2), math.sqrt(1 + eccentricity) * math.cos(nu / 2))
    back = E - eccentricity * math.sin(E)
    assert math.remainder(back - mean_anomaly, 2 * math.pi) == pytest.approx(0, abs=1e-9)
    assert abs(nu - mean_anomaly) < 2.5  # the equation of the centre stays below 2 e + ... < 2.5 rad for e <= 0.6


# --- the closed loop ------------------------------------------------------------------------------------------------


def inertial_run(loop: ClosedLoop, estimate: np.ndarray, end: float) -> np.ndarray:
    """Integrate both spacecraft in inertial axes with the observer beside them; return the relative position, m."""
    orbit, case = plant.target_orbit(loop.case), loop.case
    mu, mass, n = orbit.gravitational_parameter, case.number("mass"), case.number("mean_motion")
    A, C = clohessy_wiltshire(n), np.eye(3, 6)
    B = np.vstack([np.zeros((3, 3)), np.eye(3) / mass])
    r, v = orbit.inertial_state(0.0)
    x0 = case.matrix("x0").ravel()
    spin = np.cross(r, v) / (r @ r)

    def axes(r, v):
        x, z = r / np.linalg.norm(r), np.cross(r, v)
        z = z / np.linalg.norm(z)
        return np.array([x, np.cross(z, x), z])

    def gravity(p):
        return -mu * p / np.linalg.norm(p) ** 3

    def slope(t, s):
        r, v, d, w, xhat = s[:3], s[3:6], s[6:9], s[9:12], s[12:]
        frame = axes(r, v)
        u = -loop.K @ xhat
        relative = gravity(r + d) - gravity(r) + frame.T @ u / mass
        return np.concatenate([v, gravity(r), w, relative, A @ xhat + B @ u + loop.L @ (frame @ d - C @ xhat)])

    frame = axes(r, v)
    offset = frame.T @ x0[:3]
    start = np.concatenate([r, v, offset, frame.T @ x0[3:] + np.cross(spin, offset), estimate])
    s = solve_ivp(slope, (0, end), start, "DOP853", rtol=1e-13, atol=1e-12).y[:, -1]
    return axes(s[:3], s[3:6]) @ s[6:9]


@pytest.mark.parametrize("start", ["measured_position", "zero"])
def test_the_two_body_loop_agrees_with_an_inertial_integration(start):
    # Oracle: Newton's law for both spacecraft, written anew; 1e-6 m after 200 s of feedback.
    estimate = plant.observer_start(CASE, start)
    found = PRINTED.simulate(estimate, 200.0, rtol=1e-12)(200.0)[POSITION]
    np.testing.assert_allclose(found, inertial_run(PRINTED, estimate, 200.0), rtol=0, atol=1e-6)


def test_the_linear_loop_on_a_circular_orbit_is_a_matrix_exponential():
    # With e = 0 plant (1), observer (7) and law (10) are one linear system with constant coefficients.
    case = with_parameters(CASE, eccentricity="0")
    loop = ClosedLoop(case, CASE.matrix("K"), CASE.matrix("L"), linear=True)
    model, K, L, C = loop.model, loop.K, loop.L, CASE.matrix("C")
    system = np.block([[model.A, -model.B @ K], [L @ C, model.A - model.B @ K - L @ C]])
    estimate = plant.observer_start(CASE, "measured_position")
    start = np.concatenate([CASE.matrix("x0").ravel(), estimate])
    found = loop.simulate(estimate, 300.0)
    for time in (1.0, 30.0, 300.0):
        np.testing.assert_allclose(found(time)[:12], expm(system * time) @ start, rtol=1e-7, atol=1e-6)
    # Lyapunov: with S' P + P S + W = 0 the integral of z' W z over 0..T is z(0)' P z(0) - z(T)' P z(T)
    W = np.zeros((12, 12))
    W[:6, :6], W[6:, 6:] = np.eye(6), K.T @ K
    P = solve_continuous_lyapunov(system.T, -W)
    last = expm(system * 300.0) @ start
    assert found(300.0)[COST] == pytest.approx(start @ P @ start - last @ P @ last, rel=1e-8)


def test_an_estimate_that_starts_right_stays_right_on_the_design_model_itself():
    case = with_parameters(CASE, eccentricity="0")
    loop = ClosedLoop(case, CASE.matrix("K"), CASE.matrix("L"), linear=True)
    found = loop.simulate(plant.observer_start(case, "exact"), 500.0)
    last = found(500.0)
    assert last[SQUARED_ERROR] < 1e-12
    np.testing.assert_allclose(last[ESTIMATE], last[:6], atol=1e-6)


@pytest.mark.parametrize("clipped", [False, True])
def test_integrals_of_a_run_agree_with_a_quadrature_of_its_states(clipped):
    # Oracle: Gauss-Legendre with 8 points on every step of the integrator, integrands written anew from (4) and (8).
    loop = replace(PRINTED, clipped=clipped)
    found = loop.simulate(np.zeros(6), 150.0)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = np.unique(np.concatenate([found.steps, found.ends]))
    cost = delta_v = squared = 0.0
    for low, high in pairwise(edges):
        times = (high + low) / 2 + (high - low) / 2 * nodes
        states = found(times)
        force = -states[:, ESTIMATE] @ CASE.matrix("K").T
        if clipped:
            force = np.clip(force, [-40, -40, -20], [40, 40, 20])
        error = states[:, :6] - states[:, ESTIMATE]
        weight = weights * (high - low) / 2
        cost += weight @ ((states[:, :6] ** 2).sum(1) + (force**2).sum(1))
        delta_v += weight @ np.linalg.norm(force, axis=1) / 200.0
        squared += weight @ (error**2).sum(1)
    last = found(150.0)
    assert last[COST] == pytest.approx(cost, rel=1e-9)
    assert last[DELTA_V] == pytest.approx(delta_v, rel=1e-8)
    assert last[SQUARED_ERROR] == pytest.approx(squared, rel=1e-9)


def test_without_thrust_the_chaser_keeps_its_energy_and_angular_momentum():
    # Conservation laws of the two-body problem, in inertial axes.
    free = ClosedLoop(CASE, np.zeros((3, 6)), np.zeros((6, 3)))
    found = free.simulate(np.zeros(6), 6000.0)
    orbit = plant.target_orbit(CASE)
    energies, momenta = [], []
    for time in (0.0, 1000.0, 2500.0, 6000.0):
        state = found(time)
        nu = state[ANOMALY]
        radius, rate, _ = orbit.frame_motion(nu)
        turn = np.array([[math.cos(nu), -math.sin(nu), 0], [math.sin(nu), math.cos(nu), 0], [0, 0, 1]])
        position = state[POSITION] + [radius, 0, 0]
        radial = orbit.inertial_state(nu)[1] @ turn[:, 0]
        velocity = state[VELOCITY] + [radial, 0, 0] + np.cross([0, 0, rate], position)
        energies.append(velocity @ velocity / 2 - orbit.gravitational_parameter / np.linalg.norm(position))
        momenta.append(turn @ np.cross(position, velocity))
    np.testing.assert_allclose(energies, energies[0], rtol=1e-11)
    np.testing.assert_allclose(momenta, [momenta[0]] * 4, rtol=0, atol=1e-10 * np.linalg.norm(momenta[0]))
    assert found(6000.0)[COST] > 0
    assert found(6000.0)[DELTA_V] == 0


def test_the_target_keeps_keplers_time():
    found = PRINTED.simulate(plant.observer_start(CASE, "exact"), 3000.0)
    n = plant.target_orbit(CASE).mean_motion
    assert found(3000.0)[ANOMALY] == pytest.approx(plant.true_anomaly(n * 3000.0, 0.01), abs=1e-10)


def test_target_orbit_has_its_perigee_where_the_paper_says():
    orbit = plant.target_orbit(CASE)
    assert orbit.radius(0.0) == pytest.approx(6728140.0, rel=1e-14)
    assert round(orbit.mean_motion, 5) == 1.13e-3


def test_starts_of_the_estimate():
    np.testing.assert_array_equal(plant.observer_start(CASE, "measured_position"), [3000, -4000, 20, 0, 0, 0])
    np.testing.assert_array_equal(plant.observer_start(CASE, "exact"), [3000, -4000, 20, -3, 4, -0.02])
    np.testing.assert_array_equal(plant.observer_start(CASE, "zero"), 0)
    np.testing.assert_array_equal(plant.observer_start(CASE), plant.observer_start(CASE, "measured_position"))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_peaks_are_above_every_sample_and_reached(axis):
    found = PRINTED.simulate(np.zeros(6), 100.0)
    time, peak = plant.peak_thrust(PRINTED, found, axis)
    samples = np.abs(found(np.linspace(0, 100, 50001))[:, ESTIMATE] @ CASE.matrix("K")[axis])
    assert peak >= samples.max() * (1 - 1e-12)
    assert peak == pytest.approx(abs(CASE.matrix("K")[axis] @ found(time)[ESTIMATE]), rel=1e-12)
    assert peak == pytest.approx(samples.max(), rel=1e-4)


def test_clipped_thrust_keeps_its_bounds_and_starts_and_ends_clipping_where_the_run_says():
    loop = replace(PRINTED, clipped=True)
    found = loop.simulate(np.zeros(6), 60.0)
    thrust = loop.thrust(found(np.linspace(0, 60, 20001))[:, ESTIMATE])
    assert np.all(np.abs(thrust) <= [40, 40, 20])
    assert np.any(np.abs(thrust) == 40)
    assert len(found.ends) > 2
    for instant in found.ends[1:-1]:
        commanded = np.abs(loop.K @ found(float(instant))[ESTIMATE]) / loop.limits
        assert np.abs(commanded - 1).min() < 1e-6


def test_capture_is_the_last_time_at_the_radius():
    found = PRINTED.simulate(plant.observer_start(CASE), 4000.0, rtol=1e-9)
    time = plant.capture_time(found, 100.0)
    after = found(np.linspace(time + 1e-6, 4000, 2000))
    assert np.linalg.norm(found(time)[POSITION]) == pytest.approx(100.0, abs=1e-6)
    assert np.linalg.norm(after[:, POSITION], axis=1).max() < 100
