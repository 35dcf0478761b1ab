"""Theorem 1 of zhang2013: the analysis inequalities (9a), (9b) for given gains."""

from dataclasses import dataclass, field

import numpy as np

from gainsay.lmi import BlockMatrix, Variable, matrix, sym, symmetric

PARTS = {"a": 3.0, "b": 1.0}
"""The weight c of R/d_M between z(t) and z(t - d): 3 in (9a), 1 in (9b); the other interval gets 4 - c."""
ROWS = ("z", "z'", "z_d", "z_M", "w", "y")


@dataclass(frozen=True)
class Delayed:
    """Data of (7)-(8) and of the theorems, in floats.

    Attributes
    ----------
    A, Ad, B, C, Cd : ndarray
        Matrices of (7) and (8) with bars.
    d_M : float
        s.
    mu : float
        Bound on d'(t).
    """

    A: np.ndarray
    Ad: np.ndarray
    B: np.ndarray
    C: np.ndarray
    Cd: np.ndarray
    d_M: float
    mu: float

    @classmethod
    def of(cls, craft, K, L, d_M: float, mu: float) -> "Delayed":
        """Floats of `Spacecraft.augmented`."""
        floats = {name: np.asarray(value, dtype=float) for name, value in craft.augmented(K, L).items()}
        return cls(**floats, d_M=d_M, mu=mu)


@dataclass(frozen=True)
class Functional:
    """The unknowns of Theorem 1."""

    size: int
    P1: Variable = field(init=False)
    P2: Variable = field(init=False)
    P3: Variable = field(init=False)
    Q1: Variable = field(init=False)
    Q2: Variable = field(init=False)
    R: Variable = field(init=False)

    def __post_init__(self) -> None:
        for name in ("P1", "Q1", "Q2", "R"):
            object.__setattr__(self, name, symmetric(name, self.size))
        for name in ("P2", "P3"):
            object.__setattr__(self, name, matrix(name, self.size, self.size))

    @property
    def positive(self) -> tuple:
        """P1 > 0, Q1 > 0, Q2 > 0, R > 0."""
        return tuple((v > 0).named(f"{v.name} > 0") for v in (self.P1, self.Q1, self.Q2, self.R))


def theorem1(loop: Delayed, v: Functional, gamma_squared: object, part: str) -> BlockMatrix:
    """Left side of (9a) (part "a") or (9b) (part "b"); affine in the unknowns and in gamma^2."""
    A, Ad, B, C, Cd = loop.A, loop.Ad, loop.B, loop.C, loop.Cd
    c, R = PARTS[part], v.R / loop.d_M
    F = BlockMatrix(f"(9{part})", *ROWS)
    F["z", "z"] = sym(v.P2.T @ A) + v.Q1 + v.Q2 - c * R
    F["z", "z'"] = v.P1 - v.P2.T + A.T @ v.P3
    F["z", "z_d"] = v.P2.T @ Ad + c * R
    F["z", "w"] = v.P2.T @ B
    F["z", "y"] = C.T
    F["z'", "z'"] = -v.P3 - v.P3.T + loop.d_M * v.R
    F["z'", "z_d"] = v.P3.T @ Ad
    F["z'", "w"] = v.P3.T @ B
    F["z_d", "z_d"] = -(1 - loop.mu) * v.Q2 - 4 * R
    F["z_d", "z_M"] = (4 - c) * R
    F["z_M", "z_M"] = -v.Q1 - (4 - c) * R
    F["w", "w"] = -(gamma_squared * np.eye(B.shape[1]))
    F["w", "y"] = Cd.T
    F["y", "y"] = -np.eye(C.shape[0])
    return F


def without_slack(loop: Delayed, v: Functional, gamma_squared: object, part: str) -> BlockMatrix:
    """(9) with z' eliminated instead of the slack P2, P3: the same set of P1, Q1, Q2, R.

    With P2 = P1 and P3 = d_M R the rows z' of (9) are these rows R; and the inequality is what (9) says on the
    subspace z' = Abar z + Ad z_d + Bbar w, where the slack drops out.
    """
    A, Ad, B, C, Cd = loop.A, loop.Ad, loop.B, loop.C, loop.Cd
    c, R = PARTS[part], v.R / loop.d_M
    F = BlockMatrix(f"(9{part}) without slack", "z", "z_d", "z_M", "w", "R", "y")
    F["z", "z"] = sym(v.P1 @ A) + v.Q1 + v.Q2 - c * R
    F["z", "z_d"] = v.P1 @ Ad + c * R
    F["z", "w"] = v.P1 @ B
    F["z", "y"] = C.T
    F["z_d", "z_d"] = -(1 - loop.mu) * v.Q2 - 4 * R
    F["z_d", "z_M"] = (4 - c) * R
    F["z_M", "z_M"] = -v.Q1 - (4 - c) * R
    for row, side in (("z", A), ("z_d", Ad), ("w", B)):
        F[row, "R"] = loop.d_M * side.T @ v.R
    F["R", "R"] = -loop.d_M * v.R
    F["w", "w"] = -(gamma_squared * np.eye(B.shape[1]))
    F["w", "y"] = Cd.T
    F["y", "y"] = -np.eye(C.shape[0])
    return F


def channel_blocks(A: np.ndarray, Bd: np.ndarray, Cd: np.ndarray, d_M: float, mu: float) -> tuple:
    """Stability part of (9) for x' = A x + Bd v(t - d), v = Cd x, with Q1, Q2, R of the delayed signal v alone.

    (9) without slack at Q = Cd' q Cd and R = Cd' r Cd, to which small positive definite terms can be added: a delay
    proved by these blocks is proved by Theorem 1, of which they are a cheaper and at most more conservative form.

    Returns
    -------
    tuple of Affine
        Every matrix that is to be positive definite.
    """
    n, r = Bd.shape
    P1, Q1, Q2, R = symmetric("P1", n), symmetric("Q1", r), symmetric("Q2", r), symmetric("R", r)
    found = []
    for part, c in PARTS.items():
        F = BlockMatrix(f"(9{part}) of the delayed signal", "x", "v_d", "v_M", "R")
        F["x", "x"] = sym(P1 @ A) + Cd.T @ (Q1 + Q2 - (c / d_M) * R) @ Cd
        F["x", "v_d"] = P1 @ Bd + (c / d_M) * (Cd.T @ R)
        F["v_d", "v_d"] = -(1 - mu) * Q2 - (4 / d_M) * R
        F["v_d", "v_M"] = ((4 - c) / d_M) * R
        F["v_M", "v_M"] = -Q1 - ((4 - c) / d_M) * R
        F["x", "R"] = d_M * ((Cd @ A).T @ R)
        F["v_d", "R"] = d_M * ((Cd @ Bd).T @ R)
        F["R", "R"] = -d_M * R
        found.append(-F.assembled)
    return (*found, P1, Q1, Q2, R)
