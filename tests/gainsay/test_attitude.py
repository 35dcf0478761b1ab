import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from gainsay.dynamics import attitude
from gainsay.errors import InputError

angles_ = st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2), st.floats(-3, 3))
INERTIA = (25.0, 24.0, 20.0)
RATE = 1.1e-3


def gravity_gradient_linear(angles):
    # the torque 3 n^2 a3 x (J a3) to first order in the angles, by hand
    Ix, Iy, Iz = INERTIA
    return 3 * RATE**2 * np.array([(Iz - Iy) * angles[0], (Iz - Ix) * angles[1], 0.0])


def jacobi_integral(state):
    # kinetic energy of the rate relative to LVLH, plus 3/2 n^2 a3'J a3, minus 1/2 n^2 a2'J a2
    J, C = np.diag(INERTIA), attitude.direction_cosines(state[:3])
    relative, n = state[3:6] + RATE * C[:, 1], RATE
    return 0.5 * (relative @ J @ relative + 3 * n**2 * C[:, 2] @ J @ C[:, 2] - n**2 * C[:, 1] @ J @ C[:, 1])


@given(angles_)
@settings(max_examples=50)
def test_direction_cosines_agree_with_scipy(angles):
    # Independent implementation: scipy's intrinsic ZYX rotation, transposed since it turns vectors, not axes.
    phi, theta, psi = angles
    other = Rotation.from_euler("ZYX", [psi, theta, phi]).as_matrix().T
    assert attitude.direction_cosines(angles) == pytest.approx(other, abs=1e-14)


@given(angles_, st.tuples(*[st.floats(-1, 1)] * 3))
@settings(max_examples=50)
def test_kinematics_are_the_derivative_of_the_rotation(angles, rates):
    # Identity: C' = -[omega]x C for the rate relative to LVLH, by a central difference.
    angles, rates, step = np.array(angles), np.array(rates), 1e-6
    slope = (attitude.direction_cosines(angles + step * rates) - attitude.direction_cosines(angles - step * rates)) / (
        2 * step
    )
    x, y, z = attitude.rate_matrix(angles) @ rates
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    assert slope == pytest.approx(-cross @ attitude.direction_cosines(angles), abs=1e-8)
    omega = attitude.rate_body(angles, rates, RATE)
    assert attitude.euler_rates(angles, omega, RATE) == pytest.approx(rates, abs=1e-12)


def test_linear_gravity_gradient_is_the_derivative_of_the_full_one():
    step = 1e-6
    for axis in range(3):
        turned = step * np.eye(3)[axis]
        slope = (
            attitude.gravity_gradient(INERTIA, turned, RATE) - attitude.gravity_gradient(INERTIA, -turned, RATE)
        ) / (2 * step)
        assert slope == pytest.approx(gravity_gradient_linear(np.eye(3)[axis]), abs=1e-15)


def test_free_motion_keeps_the_jacobi_integral_and_the_momentum():
    start = np.concatenate([[0.3, -0.2, 0.5], attitude.rate_body([0.3, -0.2, 0.5], [1e-3, 2e-3, -1e-3], RATE)])
    free = lambda n: lambda t, x: attitude.derivative(x, INERTIA, n, np.zeros(3))  # noqa: E731
    end = solve_ivp(free(RATE), (0, 3000), start, rtol=1e-11, atol=1e-13).y[:, -1]
    # Law: the Jacobi integral of a rigid body on a circular orbit.
    before, after = (jacobi_integral(x) for x in (start, end))
    assert after == pytest.approx(before, rel=1e-9)
    assert np.abs(end[:3] - start[:3]).max() > 0.1
    # Law: without an orbit the angular momentum in inertial components is constant.
    end = solve_ivp(free(0.0), (0, 3000), start, rtol=1e-11, atol=1e-13).y[:, -1]
    momenta = [attitude.direction_cosines(x[:3]).T @ (np.array(INERTIA) * x[3:]) for x in (start, end)]
    assert momenta[1] == pytest.approx(momenta[0], abs=1e-9 * np.linalg.norm(momenta[0]))


def test_full_matrix_and_principal_moments_agree():
    state, torque = np.array([0.1, 0.2, -0.3, 1e-3, -2e-3, 3e-3]), [1e-3, 0, -1e-3]
    assert attitude.derivative(state, np.diag(INERTIA), RATE, torque) == pytest.approx(
        attitude.derivative(state, INERTIA, RATE, torque), rel=1e-12
    )


def test_impossible_bodies_and_gimbal_lock_are_refused():
    with pytest.raises(InputError, match="none above the sum of the others"):
        attitude.inertia_matrix([1, 1, 3])
    with pytest.raises(InputError, match="gimbal lock"):
        attitude.euler_rates([0, np.pi / 2, 0], [0, 0, 0], RATE)
