"""Rigid body with flexible modes: energy, elimination of the modes, mode frequencies, refusals."""

import numpy as np
import pytest
from scipy.linalg import expm

from gainsay.dynamics.flexible import FlexibleBody
from gainsay.errors import InputError

J = np.diag([20.0, 30.0, 25.0])
F = np.array([[0.5, -0.3, 0.8], [0.2, 0.9, -0.4]])
W, ZETA = np.array([0.7, 1.3]), np.array([0.01, 0.05])


def energy(body, state):
    # kinetic, elastic and stiffness energy of (q, q', eta, eta')
    m = body.modes
    q, rate = state[:3], np.concatenate([state[3:6], state[6 + m :]])
    G = np.zeros((3, 3)) if body.stiffness is None else body.stiffness
    return 0.5 * (rate @ body.mass_matrix() @ rate + np.sum((body.frequency * state[6 : 6 + m]) ** 2) + q @ G @ q)


def test_energy_is_kept_without_damping():
    body = FlexibleBody(J, F, W, 0 * ZETA, stiffness=np.diag([1.0, 2.0, 3.0]))
    A, _ = body.state_space()
    x = np.random.default_rng(0).standard_normal(10)
    # law: no damping, no torque
    assert energy(body, expm(7.0 * A) @ x) == pytest.approx(energy(body, x), rel=1e-11)


def test_damping_takes_energy():
    body = FlexibleBody(J, F, W, ZETA)
    A, _ = body.state_space()
    x = np.random.default_rng(1).standard_normal(10)
    assert energy(body, expm(5.0 * A) @ x) < energy(body, x)


def test_rigid_momentum():
    # law: without D, G and N the momentum J q' + F' eta' changes by the torque alone
    body = FlexibleBody(J, F, W, ZETA)
    A, B = body.state_space()
    momentum = np.hstack([np.zeros((3, 3)), J, np.zeros((3, 2)), F.T])
    assert np.abs(momentum @ A).max() < 1e-12
    assert np.allclose(momentum @ B, np.eye(3), atol=1e-13)


def test_equations_of_motion():
    # identity: both equations hold for a random state and torque
    rng = np.random.default_rng(2)
    D, G, N = rng.standard_normal((3, 3, 3))
    body = FlexibleBody(J, F, W, ZETA, D, G, N)
    A, B = body.state_space()
    x, u = rng.standard_normal(10), rng.standard_normal(3)
    q, v, eta, rate = x[:3], x[3:6], x[6:8], x[8:]
    dx = A @ x + B @ u
    acc, modal = dx[3:6], dx[8:]
    assert np.allclose(J @ acc + D @ v + G @ q + F.T @ modal, u)
    assert np.allclose(modal + 2 * ZETA * W * rate + W**2 * eta + F @ (acc + N @ v), 0)
    assert np.allclose(dx[:3], v) and np.allclose(dx[6:8], rate)


def test_free_frequencies_rise():
    # law: clamped modes (rigid body of infinite inertia) are w; a free body has higher ones
    heavy = FlexibleBody(1e9 * J, F, W, 0 * ZETA).state_space()[0]
    assert np.allclose(np.sort(np.abs(np.linalg.eigvals(heavy).imag))[-4::2], np.sort(W), rtol=1e-6)
    free = FlexibleBody(J, F, W, 0 * ZETA).state_space()[0]
    assert np.all(np.sort(np.abs(np.linalg.eigvals(free).imag))[-4::2] > np.sort(W))


def test_refusals():
    with pytest.raises(InputError, match="mass matrix"):
        FlexibleBody(J, 10 * F, W, ZETA)
    with pytest.raises(InputError, match="damping"):
        FlexibleBody(J, F, W, ZETA[:1])
    with pytest.raises(InputError, match="coupling"):
        FlexibleBody(J, F.T, W, ZETA)
