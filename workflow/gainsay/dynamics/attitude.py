"""Rigid attitude dynamics on a circular orbit, in Euler 3-2-1 angles from the LVLH frame to the body frame.

The LVLH frame: first axis along the velocity, third axis towards the Earth, second axis against the orbit normal; it
turns at -n about its second axis. Angles are (roll, pitch, yaw) = (phi, theta, psi).

References
----------
B. Wie, Space Vehicle Dynamics and Control, AIAA, 1998, section 6.10.
"""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from gainsay.errors import InputError
from gainsay.exact.floats import real_array, real_number, real_row

#: numbers in a row
Vector = Sequence[float] | np.ndarray


def _cosine_and_sine(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle in rad; not a number where the angle is none, such as that of a step that fails."""
    angle = float(angle)
    return (math.cos(angle), math.sin(angle)) if math.isfinite(angle) else (math.nan, math.nan)


def direction_cosines(angles: Vector) -> np.ndarray:
    """Rotation from LVLH to body components for yaw, pitch, roll turned in this order.

    Parameters
    ----------
    angles : array_like, shape (3,)
        phi, theta, psi in rad.

    Returns
    -------
    ndarray, shape (3, 3)
        Columns are the LVLH axes in body components.
    """
    (cf, sf), (ct, st), (cp, sp) = map(_cosine_and_sine, real_row(angles, 3, "angles"))
    return np.array(
        [
            [ct * cp, ct * sp, -st],
            [sf * st * cp - cf * sp, sf * st * sp + cf * cp, sf * ct],
            [cf * st * cp + sf * sp, cf * st * sp - sf * cp, cf * ct],
        ]
    )


def rate_matrix(angles: Vector) -> np.ndarray:
    """Matrix from Euler angle rates to the body components of the rate relative to LVLH, shape (3, 3).

    Parameters
    ----------
    angles : array_like, shape (3,)
        phi, theta, psi in rad.
    """
    (cf, sf), (ct, st) = map(_cosine_and_sine, real_row(angles, 3, "angles")[:2])
    return np.array([[1, 0, -st], [0, cf, sf * ct], [0, -sf, cf * ct]])


def rate_body(angles: Vector, angle_rates: Vector, n: float) -> np.ndarray:
    """Inertial angular rate in body components from Euler angles and their rates.

    Parameters
    ----------
    angles, angle_rates : array_like, shape (3,)
        rad and rad/s.
    n : float
        Orbital rate, rad/s.

    Returns
    -------
    ndarray, shape (3,)
        rad/s.
    """
    orbital = real_number(n, "n") * direction_cosines(angles)[:, 1]
    return rate_matrix(angles) @ real_row(angle_rates, 3, "angle_rates") - orbital


def euler_rates(angles: Vector, omega: Vector, n: float) -> np.ndarray:
    """Rates of the Euler angles from the inertial rate in body components, the inverse of `rate_body`.

    Parameters
    ----------
    angles, omega : array_like, shape (3,)
        rad and rad/s.
    n : float
        Orbital rate, rad/s.

    Raises
    ------
    InputError
        Within 1e-9 rad of gimbal lock, pitch at 90 deg.
    """
    angles = real_row(angles, 3, "angles")
    (cf, sf), (ct, st) = map(_cosine_and_sine, angles[:2])
    if abs(ct) < 1e-9:
        raise InputError("Euler angles at gimbal lock", field="theta", value=float(angles[1]), expected="not 90 deg")
    orbital = real_number(n, "n") * direction_cosines(angles)[:, 1]
    x, y, z = (real_row(omega, 3, "omega") + orbital).tolist()
    # the rows of `rate_matrix` solved from below
    yaw = (y * sf + z * cf) / ct
    return np.array([x + st * yaw, y * cf - z * sf, yaw])


def inertia_matrix(inertia: ArrayLike) -> np.ndarray:
    """Inertia matrix from three principal moments or from itself, kg m^2.

    Raises
    ------
    InputError
        If it is not symmetric positive definite or violates the triangle inequality of a rigid body.
    """
    J = real_array(inertia, "inertia")
    J = np.diag(J) if J.ndim == 1 else J
    if J.shape != (3, 3) or not np.allclose(J, J.T, rtol=1e-12, atol=0):
        raise InputError("inertia", value=J.shape, expected="three principal moments or a symmetric 3x3 matrix")
    moments = np.linalg.eigvalsh(J)
    if moments[0] <= 0 or moments[2] / 2 > (moments[0] / 2 + moments[1] / 2) * (1 + 1e-12):
        raise InputError(
            "inertia", value=moments.tolist(), expected="positive moments, none above the sum of the others"
        )
    return J


@lru_cache(maxsize=64)
def _require_body(packed: bytes, shape: tuple[int, ...]) -> None:
    """Refuse what is no inertia, once for each: a right-hand side asks thousands of times."""
    inertia_matrix(np.frombuffer(packed).reshape(shape))


def _body(inertia: ArrayLike) -> np.ndarray:
    """Principal moments (3,) or inertia matrix (3, 3), kg m^2; InputError where `inertia_matrix` refuses it."""
    J = inertia if isinstance(inertia, np.ndarray) and inertia.dtype == float else real_array(inertia, "inertia")
    _require_body(J.tobytes(), J.shape)
    return J


def cross(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Cross product of two vectors, shape (3,): a tenth of the time of numpy's for many."""
    (a, b, c), (x, y, z) = first.tolist(), second.tolist()
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def gravity_gradient(inertia: ArrayLike, angles: Vector, n: float) -> np.ndarray:
    """Gravity-gradient torque 3 n^2 a3 x (J a3) in body components, N m, without small-angle approximation.

    Parameters
    ----------
    inertia : array_like, shape (3,) or (3, 3)
        kg m^2.
    angles : array_like, shape (3,)
        rad.
    n : float
        Orbital rate, rad/s.

    Raises
    ------
    InputError
        If it is no inertia of a rigid body.
    """
    J = _body(inertia)
    nadir = direction_cosines(angles)[:, 2]
    return 3 * real_number(n, "n") ** 2 * cross(nadir, (J * nadir) if J.ndim == 1 else J @ nadir)


def derivative(
    state: Vector,
    inertia: ArrayLike,
    n: float,
    torque: Vector,
    gradient: Callable = gravity_gradient,
) -> np.ndarray:
    """Right-hand side of the nonlinear attitude motion.

    Parameters
    ----------
    state : array_like, shape (6,)
        phi, theta, psi (rad) and the inertial rate in body components (rad/s).
    inertia : array_like, shape (3,) or (3, 3)
        kg m^2.
    n : float
        Orbital rate, rad/s.
    torque : array_like, shape (3,)
        Control and disturbance in body components, N m.
    gradient : callable
        (inertia, angles, n) -> gravity-gradient torque.

    Returns
    -------
    ndarray, shape (6,)

    Raises
    ------
    InputError
        If it is no inertia of a rigid body, a count is wrong or an entry is a text; nan gives nan.
    """
    state, torque = real_row(state, 6, "state"), real_row(torque, 3, "torque")
    angles, omega = state[:3], state[3:]
    J = _body(inertia)
    momentum = J * omega if J.ndim == 1 else J @ omega
    moment = gradient(inertia, angles, n) + torque - cross(omega, momentum)
    return np.concatenate([euler_rates(angles, omega, n), moment / J if J.ndim == 1 else np.linalg.solve(J, moment)])
