import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from gainsay.dynamics.relative_orbit import (
    KeplerOrbit,
    clohessy_wiltshire,
    differential_gravity,
    mean_motion,
    relative_acceleration,
    thrust_input,
)

MU = 398600.4418e9  # m^3/s^2, Earth
NEAR_CIRCULAR = KeplerOrbit(MU, 6728.14e3 / 0.99, 0.01)
ECCENTRIC = KeplerOrbit(MU, 26600e3, 0.6)
MASS = 200.0


def thrust(t: float) -> np.ndarray:
    """Return a smooth thrust profile along the rotating axes, N."""
    return np.array([20 * math.cos(0.003 * t), -10.0, 5 * math.sin(0.01 * t)])


def axes(r: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the LVLH unit vectors as rows, from an inertial state."""
    x, z = r / np.linalg.norm(r), np.cross(r, v)
    z = z / np.linalg.norm(z)
    return np.array([x, np.cross(z, x), z])


def rotating_frame(orbit: KeplerOrbit, anomaly: float, start: np.ndarray, end: float) -> np.ndarray:
    """Integrate in the rotating frame with the library's acceleration; return the relative position at the end, m."""

    def slope(t, s):
        free = relative_acceleration(orbit, s[6], tuple(s[:3]), tuple(s[3:6]))
        return [*s[3:6], *(np.array(free) + thrust(t) / MASS), orbit.frame_motion(s[6])[1]]

    size = [1.0] * 3 + [1e-3] * 3 + [1e-6]
    found = solve_ivp(slope, (0, end), [*start, anomaly], "DOP853", rtol=1e-13, atol=1e-11 * np.array(size))
    return found.y[:3, -1]


def inertial_frame(orbit: KeplerOrbit, anomaly: float, start: np.ndarray, end: float) -> np.ndarray:
    """Do the same from Newton's law of gravitation alone.

    The target is integrated too; the chaser is carried as the exact difference of the two inertial states, in extended
    precision, so that the 7000 km of the orbit do not swallow the micrometres of the relative motion.
    """
    r, v = (np.array(x, dtype=np.longdouble) for x in orbit.inertial_state(anomaly))
    frame = axes(r, v).astype(np.longdouble)
    spin = np.cross(r, v) / (r @ r)
    offset = frame.T @ start[:3].astype(np.longdouble)
    drift = frame.T @ start[3:].astype(np.longdouble) + np.cross(spin, offset)
    mu = np.longdouble(orbit.gravitational_parameter)

    def gravity(position):
        return -mu * position / np.sqrt(position @ position) ** 3

    def slope(t, s):
        r, v, d, w = s[:3], s[3:6], s[6:9], s[9:]
        push = axes(r, v).T @ thrust(float(t)) / np.longdouble(MASS)
        return np.concatenate([v, gravity(r), w, gravity(r + d) - gravity(r) + push])

    state = np.concatenate([r, v, offset, drift])
    steps = int(end / 2.0)
    h = np.longdouble(end) / steps
    # the classical method of order 4, extrapolated to order 5 from two step sizes
    coarse, fine = (_rk4(slope, state, n, h * steps / n) for n in (steps, 2 * steps))
    state = fine + (fine - coarse) / 15
    return (axes(state[:3], state[3:6]) @ state[6:9]).astype(float)


def _rk4(slope, state, steps, h):
    t = np.longdouble(0)
    for _ in range(steps):
        a = slope(t, state)
        b = slope(t + h / 2, state + h / 2 * a)
        c = slope(t + h / 2, state + h / 2 * b)
        d = slope(t + h, state + h * c)
        state, t = state + h / 6 * (a + 2 * b + 2 * c + d), t + h
    return state


@pytest.mark.parametrize(
    ("orbit", "anomaly"), [(NEAR_CIRCULAR, 0.0), (NEAR_CIRCULAR, 2.0), (ECCENTRIC, 0.0), (ECCENTRIC, 3.0)]
)
def test_rotating_frame_agrees_with_newtons_law_in_the_inertial_frame(orbit, anomaly):
    # Oracle: two-body motion of both spacecraft in inertial axes, thrust turned into them; no formula of the module.
    start = np.array([3000.0, -4000.0, 20.0, -3.0, 4.0, -0.02])
    here = rotating_frame(orbit, anomaly, start, 1500.0)
    there = inertial_frame(orbit, anomaly, start, 1500.0)
    assert np.linalg.norm(here) > 1000
    np.testing.assert_allclose(here, there, rtol=0, atol=1e-6)


@given(
    st.floats(0, 0.7), st.floats(-math.pi, math.pi),
    st.tuples(*[st.floats(-1e4, 1e4)] * 3),
)  # fmt: skip
@settings(max_examples=100)
def test_differential_gravity_is_the_difference_of_two_gravities(eccentricity, anomaly, d):
    # Oracle: the plain difference, which loses some 1e-16 mu/r^2 to cancellation.
    radius = KeplerOrbit(MU, 3e7, eccentricity).radius(anomaly)
    target = np.array([radius, 0, 0])
    chaser = target + d
    plain = -MU * chaser / np.linalg.norm(chaser) ** 3 + MU * target / radius**3
    np.testing.assert_allclose(differential_gravity(MU, radius, *d), plain, rtol=1e-9, atol=4e-15 * MU / radius**2)


def test_differential_gravity_keeps_its_digits_close_to_the_target():
    # Closed form to first order in d: mu/r^3 (2 x, -y, -z); the second order is smaller by d/r = 1e-13.
    r = 7e6
    found = differential_gravity(MU, r, 1e-6, 2e-6, -3e-6)
    np.testing.assert_allclose(found, MU / r**3 * np.array([2e-6, -2e-6, 3e-6]), rtol=1e-11)


def test_at_the_target_and_at_rest_nothing_pulls():
    assert relative_acceleration(ECCENTRIC, 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)) == pytest.approx((0, 0, 0), abs=0)


def test_small_distances_on_a_circular_orbit_are_clohessy_wiltshire():
    # Linearisation: 1 m away the quadratic terms are of the order d/r = 1e-7.
    circular = KeplerOrbit(MU, 7e6, 0.0)
    A = clohessy_wiltshire(circular.mean_motion)
    for i in range(6):
        unit = np.zeros(6)
        unit[i] = 1.0 if i < 3 else 1e-3
        found = relative_acceleration(circular, 0.3, tuple(unit[:3]), tuple(unit[3:]))
        np.testing.assert_allclose(found, (A @ unit)[3:], rtol=1e-6, atol=1e-12)


def test_clohessy_wiltshire_moves_in_its_closed_form():
    # Clohessy and Wiltshire 1960: closed solution with s = sin nt, c = cos nt.
    n, t = 1.1e-3, 777.0
    s, c = math.sin(n * t), math.cos(n * t)
    x, y, z, vx, vy, vz = start = np.array([100.0, -200.0, 30.0, 0.1, -0.2, 0.05])
    closed = [
        (4 - 3 * c) * x + s / n * vx + 2 / n * (1 - c) * vy,
        6 * (s - n * t) * x + y - 2 / n * (1 - c) * vx + (4 * s - 3 * n * t) / n * vy,
        c * z + s / n * vz,
    ]
    np.testing.assert_allclose((expm(clohessy_wiltshire(n) * t) @ start)[:3], closed, rtol=1e-11)


def test_a_chaser_on_the_same_circular_orbit_stays_where_it_is():
    # Closed form: two points on one circular orbit keep their angle, so the relative position stands still.
    r, angle = 7e6, 0.01
    circular = KeplerOrbit(MU, r, 0.0)
    d = (r * (math.cos(angle) - 1), r * math.sin(angle), 0.0)
    found = relative_acceleration(circular, 1.0, d, (0.0, 0.0, 0.0))
    np.testing.assert_allclose(found, 0, atol=1e-14 * MU / r**2)


def test_a_chaser_on_an_inclined_circular_orbit_oscillates_at_the_mean_motion():
    # Closed form: a circular motion in its own inclined plane, seen from the rotating frame of another of equal period.
    r, inclination, t = 7e6, 1e-3, 900.0
    circular = KeplerOrbit(MU, r, 0.0)
    n = circular.mean_motion

    def slope(t, s):
        return [*s[3:], *relative_acceleration(circular, 0.0, tuple(s[:3]), tuple(s[3:]))]

    start = [0, 0, 0, 0, r * n * (math.cos(inclination) - 1), r * n * math.sin(inclination)]
    found = solve_ivp(slope, (0, t), start, "DOP853", rtol=1e-13, atol=1e-9).y[:3, -1]
    u = n * t
    inertial = r * np.array([math.cos(u), math.sin(u) * math.cos(inclination), math.sin(u) * math.sin(inclination)])
    turned = np.array([[math.cos(u), math.sin(u), 0], [-math.sin(u), math.cos(u), 0], [0, 0, 1]]) @ inertial
    np.testing.assert_allclose(found, turned - [r, 0, 0], atol=1e-6)


@given(st.floats(0, 0.9), st.floats(-math.pi, math.pi))
def test_kepler_orbit_conserves_energy_and_angular_momentum(eccentricity, anomaly):
    # Laws of Kepler's motion: v^2/2 - mu/r = -mu/2a, |r x v| = h; rates as derivatives of r and of the angle.
    orbit = KeplerOrbit(MU, 1e7, eccentricity)
    r, v = orbit.inertial_state(anomaly)
    assert v @ v / 2 - MU / np.linalg.norm(r) == pytest.approx(-MU / 2e7, rel=1e-11, abs=1e-9 * MU / 1e7)
    assert np.cross(r, v)[2] == pytest.approx(orbit.angular_momentum, rel=1e-12)
    radius, rate, spin = orbit.frame_motion(anomaly)
    assert radius == pytest.approx(np.linalg.norm(r), rel=1e-12)
    step = 1e-5
    ahead, behind = (orbit.frame_motion(anomaly + x)[1] for x in (step, -step))
    assert spin == pytest.approx((ahead - behind) / (2 * step) * rate, rel=1e-6, abs=1e-6 * rate**2)


def test_mean_motion_and_input():
    # Kepler's third law: a geostationary orbit, 42164.17 km, turns once a sidereal day, 86164.1 s.
    assert 2 * math.pi / mean_motion(MU, 42164.17e3) == pytest.approx(86164.1, rel=1e-6)
    B = thrust_input(200.0)
    np.testing.assert_array_equal(B[:3], 0)
    np.testing.assert_array_equal(B[3:], np.eye(3) * 0.005)
