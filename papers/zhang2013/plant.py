"""Plant of zhang2013: rigid body with two flexible modes, one axis, delayed torque; design model and spacecraft.

Matrices are kept as exact fractions of the printed digits; floats are made where computing in floats begins.
Equation numbers are those of the paper.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from gainsay.errors import InputError
from gainsay.systems.delay import DelaySystem
from gainsay.tables import Case

#: rows of exact numbers or doubles
Rows = Sequence[Sequence[Any]] | np.ndarray
MODES = ("paper", "all", "no_observer")
"""What the delay acts on: K x alone as in (6), the whole input, or K x with no observer in the loop."""


def exact(rows: Rows) -> np.ndarray:
    """Object array of fractions from nested sequences of exact numbers."""
    return np.array([[Fraction(v) for v in row] for row in rows], dtype=object)


@dataclass(frozen=True)
class Spacecraft:
    """What the numerical example prints, as fractions in SI units.

    Attributes
    ----------
    inertia : Fraction
        J, kg m^2.
    coupling : tuple of Fraction
        F1, F2, sqrt(kg) m.
    frequency, damping : tuple of Fraction
        Modal frequencies (rad/s) and damping ratios.
    C1, C2, Cd1, Cd2 : ndarray of Fraction
        Output weights of (8), shapes (1, 2), (1, 1), (1, 1), (1, 1).
    """

    inertia: Fraction
    coupling: tuple[Fraction, ...]
    frequency: tuple[Fraction, ...]
    damping: tuple[Fraction, ...]
    C1: np.ndarray
    C2: np.ndarray
    Cd1: np.ndarray
    Cd2: np.ndarray

    @classmethod
    def of(cls, case: Case) -> "Spacecraft":
        """Read the tables of the paper."""
        return cls(
            inertia=case.exact("J"),
            coupling=tuple(case.printed("F").exact[0]),
            frequency=(case.exact("omega1"), case.exact("omega2")),
            damping=(case.exact("xi1"), case.exact("xi2")),
            C1=exact(case.printed("C1").exact),
            C2=exact([[case.exact("C2")]]),
            Cd1=exact([[case.exact("Cd1")]]),
            Cd2=exact([[case.exact("Cd2")]]),
        )

    def __post_init__(self) -> None:
        if self.rigid_inertia <= 0:
            raise InputError("J - F F'", value=float(self.rigid_inertia), expected="above 0 kg m^2")

    @property
    def rigid_inertia(self) -> Fraction:
        """J - F F' of (2), kg m^2."""
        return self.inertia - sum(f * f for f in self.coupling)

    @property
    def A(self) -> np.ndarray:
        """A of (3), shape (2, 2)."""
        return exact([[0, 1], [0, 0]])

    @property
    def B(self) -> np.ndarray:
        """B of (3), shape (2, 1)."""
        return exact([[0], [1 / self.rigid_inertia]])

    @property
    def vibration(self) -> np.ndarray:
        """Row that gives w2 = F (C_m eta' + Lambda eta) from (eta1, eta2, eta1', eta2'), shape (1, 4), N m."""
        stiffness = [f * w * w for f, w in zip(self.coupling, self.frequency, strict=True)]
        damping = [2 * f * z * w for f, z, w in zip(self.coupling, self.damping, self.frequency, strict=True)]
        return exact([stiffness + damping])

    def flexible(self) -> tuple[np.ndarray, np.ndarray]:
        """A and B of (1) in the state (theta, theta', eta1, eta2, eta1', eta2'), shapes (6, 6) and (6, 1)."""
        b, f = 1 / self.rigid_inertia, self.coupling
        A = exact(np.zeros((6, 6)))
        A[0, 1] = Fraction(1)
        A[1, 2:] = b * self.vibration[0]
        for i in range(2):
            A[2 + i, 4 + i] = Fraction(1)
            # eta'' = -C_m eta' - Lambda eta - F' theta''
            A[4 + i, 2:] = -f[i] * A[1, 2:]
            A[4 + i, 2 + i] -= self.frequency[i] ** 2
            A[4 + i, 4 + i] -= 2 * self.damping[i] * self.frequency[i]
        B = exact([[0], [b], [0], [0], [-f[0] * b], [-f[1] * b]])
        return A, B

    def augmented(self, K: Rows, L: Rows) -> dict[str, np.ndarray]:
        """Abar, Ad, Bbar, C, Cd of (7) and (8) for gains of shape (1, 2); state z = [x; e], input [w1; w2']."""
        K, L = exact(K), exact(L)
        A, B = self.A, self.B
        LB, O = L @ B, exact(np.zeros((2, 1)))  # noqa: E741
        return {
            "A": np.block([[A, B], [exact(np.zeros((1, 2))), -LB]]),
            "Ad": np.block([[B @ K, O], [exact(np.zeros((1, 3)))]]),
            "B": np.block([[B, O], [-LB, exact([[1]])]]),
            "C": np.block([[self.C1, self.C2]]),
            "Cd": np.block([[self.Cd1, self.Cd2]]),
        }

    def design_loop(self, K: Rows, L: Rows) -> DelaySystem:
        """Return (7) and (8) with a constant delay, as a delay system."""
        loop = self.augmented(K, L)
        Bd = np.vstack([self.B, exact([[0]])])
        Cd = np.hstack([exact(K), exact([[0]])])
        return DelaySystem(loop["A"], Bd, Cd, loop["B"], loop["C"], loop["Cd"])

    def flexible_loop(self, K: Rows, L: Rows, mode: str) -> DelaySystem:
        """Loop of (1), (4), (6) on the flexible plant; input w1, output (w2, w2hat).

        State (theta, theta', eta1, eta2, eta1', eta2', w2hat). With the observer fed the torque that is applied, (4)
        gives w2hat' = L B (w1 + w2 - w2hat) exactly, whatever the torque.

        Parameters
        ----------
        K, L : array_like, shape (1, 2)
        mode : str
            One of `MODES`; without observer the state ends with eta2' and the output is w2 alone.

        Raises
        ------
        InputError
            For another mode.
        """
        if mode not in MODES:
            raise InputError("delay mode", value=mode, expected=", ".join(MODES))
        K = exact(K)
        A6, B6 = self.flexible()
        w2 = np.hstack([exact([[0, 0]]), self.vibration])
        if mode == "no_observer":
            return DelaySystem(A6, B6, np.hstack([K, exact(np.zeros((1, 4)))]), B6, w2)
        LB = (exact(L) @ self.B)[0, 0]
        B7, one = np.vstack([B6, exact([[0]])]), exact([[0, 0, 0, 0, 0, 0, 1]])
        A = np.block([[A6, exact(np.zeros((6, 1)))], [LB * w2, exact([[-LB]])]])
        Kx = np.hstack([K, exact(np.zeros((1, 5)))])
        if mode == "paper":
            A, delayed = A - B7 @ one, Kx
        else:
            delayed = Kx - one
        return DelaySystem(A, B7, delayed, B7 + LB * one.T, np.vstack([np.hstack([w2, exact([[0]])]), one]))
