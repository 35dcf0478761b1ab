"""Rigid body with flexible modes, linear about an attitude that is held."""

from dataclasses import dataclass

import numpy as np

from gainsay.dynamics.attitude import inertia_matrix
from gainsay.errors import InputError
from gainsay.exact.floats import real_array


@dataclass(frozen=True)
class FlexibleBody:
    """J q'' + D q' + G q + F^T eta'' = u,  eta'' + 2 diag(zeta w) eta' + diag(w^2) eta + F (q'' + N q') = 0.

    Parameters
    ----------
    inertia : ndarray, shape (3, 3)
        J, kg m^2.
    coupling : ndarray, shape (m, 3)
        Rigid-elastic coupling F, sqrt(kg) m, for mass-normalised modes.
    frequency : ndarray, shape (m,)
        Modal frequencies w, rad/s.
    damping : ndarray, shape (m,)
        Damping ratios zeta.
    gyroscopic, stiffness : ndarray, shape (3, 3), optional
        D (N m s/rad) and G (N m/rad); zero where left out.
    frame_rate : ndarray, shape (3, 3), optional
        N (rad/s): to first order the inertial rate changes by q'' + N q'; zero where left out.

    Raises
    ------
    gainsay.errors.InputError
        Where shapes do not fit, an entry is not finite, J is not the inertia of a rigid body, a frequency is not
        positive, a damping ratio is negative, or the mass matrix [[J, F^T], [F, I]] is not positive definite.

    References
    ----------
    S. Di Gennaro, Passive attitude control of flexible spacecraft from quaternion measurements, J. Optim. Theory
    Appl. 116 (2003), 41-60.
    """

    inertia: np.ndarray
    coupling: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray
    gyroscopic: np.ndarray | None = None
    stiffness: np.ndarray | None = None
    frame_rate: np.ndarray | None = None

    def __post_init__(self) -> None:
        if np.ndim(self.frequency) != 1:
            raise InputError(field="frequency", value=np.shape(self.frequency), expected="one number a mode")
        modes = np.shape(self.frequency)[0]
        shapes = {"inertia": (3, 3), "coupling": (modes, 3), "frequency": (modes,), "damping": (modes,)}
        shapes |= {f: (3, 3) for f in ("gyroscopic", "stiffness", "frame_rate") if getattr(self, f) is not None}
        for field, expected in shapes.items():
            if np.shape(getattr(self, field)) != expected:
                raise InputError(field=field, value=np.shape(getattr(self, field)), expected=f"shape {expected}")
            object.__setattr__(self, field, real_array(getattr(self, field), field))
        inertia_matrix(self.inertia)
        for field, floor, expectation in (("frequency", 5e-324, "above 0 rad/s"), ("damping", 0.0, "at least 0")):
            if np.any(np.asarray(getattr(self, field)) < floor):
                raise InputError(field=field, value=np.asarray(getattr(self, field)).tolist(), expected=expectation)
        if np.linalg.eigvalsh(self.mass_matrix())[0] <= 0:
            raise InputError("the mass matrix is not positive definite", field="coupling", expected="J - F^T F > 0")

    @property
    def modes(self) -> int:
        """Number of flexible modes."""
        return len(self.frequency)

    def mass_matrix(self) -> np.ndarray:
        """Mass matrix [[J, F^T], [F, I]], shape (3 + m, 3 + m)."""
        return np.block([[self.inertia, self.coupling.T], [self.coupling, np.eye(self.modes)]])

    def state_space(self) -> tuple[np.ndarray, np.ndarray]:
        """A and B of x' = A x + B u in the state x = (q, q', eta, eta').

        Returns
        -------
        A : ndarray, shape (6 + 2 m, 6 + 2 m)
        B : ndarray, shape (6 + 2 m, 3)
        """
        m, zero = self.modes, np.zeros((3, 3))
        D, G, N = (zero if a is None else a for a in (self.gyroscopic, self.stiffness, self.frame_rate))
        # right-hand sides of the two equations of motion, columns ordered as (q, q', eta, eta')
        w, zeta = np.asarray(self.frequency, dtype=float), np.asarray(self.damping, dtype=float)
        force = np.block(
            [
                [-G, -D, np.zeros((3, 2 * m))],
                [np.zeros((m, 3)), -self.coupling @ N, -np.diag(w**2), -np.diag(2 * zeta * w)],
            ]
        )
        acceleration = np.linalg.solve(self.mass_matrix(), force)
        A = np.zeros((6 + 2 * m, 6 + 2 * m))
        A[:3, 3:6] = np.eye(3)
        A[3:6] = acceleration[:3]
        A[6 : 6 + m, 6 + m :] = np.eye(m)
        A[6 + m :] = acceleration[3:]
        push = np.linalg.solve(self.mass_matrix(), np.vstack([np.eye(3), np.zeros((m, 3))]))
        B = np.zeros((6 + 2 * m, 3))
        B[3:6], B[6 + m :] = push[:3], push[3:]
        return A, B
