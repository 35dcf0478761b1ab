"""Theorem 2 of zhang2013: the design inequalities (23a), (23b), as printed and as they follow from (9) and (25)."""

from dataclasses import dataclass, field

import numpy as np

from gainsay.lmi import BlockMatrix, Variable, matrix, sym, symmetric
from papers.zhang2013.theorem1 import PARTS

ROWS = ("x", "e", "x'", "e'", "x_d", "e_d", "x_M", "e_M", "w1", "w2'", "y")
SYMMETRIC = {"P11": 2, "P12": 1, "Q11": 2, "Q21": 2, "Q12": 1, "Q22": 1, "R1": 2, "R2": 1}
"""Symmetric unknowns and their sizes; P11, Q11, Q21, R1 carry hats in the paper."""
FREE = {"X": (2, 2), "M": (1, 2), "N": (1, 2), "P22": (1, 1)}
"""Unknowns without structure; X stands for the paper's P21-bar and P21-hat, K = M X^-1, L = P22^-T N."""


@dataclass(frozen=True)
class Setting:
    """Data of Theorem 2, in floats.

    Attributes
    ----------
    A, B, C1, C2, Cd1, Cd2 : ndarray
        Of (3) and (8).
    gamma, d_M, mu, lambda1, lambda2 : float
        Scalars given to the theorem; d_M in s.
    """

    A: np.ndarray
    B: np.ndarray
    C1: np.ndarray
    C2: np.ndarray
    Cd1: np.ndarray
    Cd2: np.ndarray
    gamma: float
    d_M: float
    mu: float
    lambda1: float
    lambda2: float

    @classmethod
    def of(cls, craft, case, **changes: float) -> "Setting":
        """Read the numbers of the example, with lambda1 = +0.12 unless told otherwise."""
        data = {name: np.asarray(getattr(craft, name), dtype=float) for name in ("A", "B", "C1", "C2", "Cd1", "Cd2")}
        data |= {name: case.number(name) for name in ("gamma", "d_M", "mu", "lambda2")}
        return cls(**(data | {"lambda1": case.number("lambda1_corrected")} | changes))


@dataclass(frozen=True)
class Unknowns:
    """The decision variables of (23)."""

    P11: Variable = field(init=False)
    P12: Variable = field(init=False)
    Q11: Variable = field(init=False)
    Q21: Variable = field(init=False)
    Q12: Variable = field(init=False)
    Q22: Variable = field(init=False)
    R1: Variable = field(init=False)
    R2: Variable = field(init=False)
    X: Variable = field(init=False)
    M: Variable = field(init=False)
    N: Variable = field(init=False)
    P22: Variable = field(init=False)

    def __post_init__(self) -> None:
        for name, size in SYMMETRIC.items():
            object.__setattr__(self, name, symmetric(name, size))
        for name, shape in FREE.items():
            object.__setattr__(self, name, matrix(name, *shape))

    @property
    def signed(self) -> tuple[Variable, ...]:
        """The unknowns that the theorem asks to be positive definite."""
        return tuple(getattr(self, name) for name in SYMMETRIC)

    @property
    def every(self) -> tuple[Variable, ...]:
        """All unknowns."""
        return (*self.signed, *(getattr(self, name) for name in FREE))


def printed(s: Setting, v: Unknowns, part: str) -> BlockMatrix:
    """Left side of (23a) or (23b) as printed, "R2hat" read as R2 and "P21hat" as P21bar."""
    A, B, l1, l2 = s.A, s.B, s.lambda1, s.lambda2
    c, o = PARTS[part], 4 - PARTS[part]
    R1, R2, NB = v.R1 / s.d_M, v.R2 / s.d_M, v.N @ s.B
    F = BlockMatrix(f"(23{part}) printed", *ROWS)
    F["x", "x"] = sym(A @ v.X) + v.Q11 + v.Q21 - c * R1
    F["x", "e"] = B
    F["x", "x'"] = v.P11 - v.X + l1 * (v.X.T @ A.T)
    F["x", "x_d"] = B @ v.M + c * R1
    F["x", "w1"] = B
    F["x", "y"] = v.X.T @ s.C1.T
    F["e", "e"] = -sym(NB) + v.Q12 + v.Q22 - c * R2
    F["e", "x'"] = l1 * B.T
    F["e", "e'"] = v.P12 - v.P22.T - l2 * NB.T
    F["e", "w1"] = NB
    F["e", "w2'"] = v.P22.T
    F["e", "y"] = s.C2.T
    F["x'", "x'"] = -l1 * (v.X + v.X.T) + s.d_M * v.R1
    F["x'", "x_d"] = l1 * (B @ v.M) + c * R1
    F["x'", "w1"] = l1 * B
    F["e'", "e'"] = -l2 * (v.P22 + v.P22.T) + s.d_M * v.R2
    F["e'", "w1"] = -l2 * NB
    F["e'", "w2'"] = l2 * v.P22.T
    F["x_d", "x_d"] = -(1 - s.mu) * v.Q21 - 4 * R1
    F["x_d", "x_M"] = o * R1
    F["e_d", "e_d"] = -(1 - s.mu) * v.Q22 - 4 * R2
    F["e_d", "e_M"] = o * R2
    F["x_M", "x_M"] = v.Q11 - o * R1
    F["e_M", "e_M"] = v.Q12 - o * R2
    F["w1", "w1"] = F["w2'", "w2'"] = -(s.gamma**2) * np.eye(1)
    F["w1", "y"] = s.Cd1.T
    F["w2'", "y"] = s.Cd2.T
    F["y", "y"] = -np.eye(1)
    return F


def corrected(s: Setting, v: Unknowns, part: str) -> BlockMatrix:
    """Left side of (23a) or (23b) as T' (9) T gives it under (25); equal to `congruence` for every value.

    The change of variables is X = P21^-1, M = K X, N = P22' L, and X' S X for P11, Q11, Q21, R1.
    """
    A, B, l1, l2 = s.A, s.B, s.lambda1, s.lambda2
    c, o = PARTS[part], 4 - PARTS[part]
    R1, R2, NB = v.R1 / s.d_M, v.R2 / s.d_M, v.N @ s.B
    F = BlockMatrix(f"(23{part})", *ROWS)
    F["x", "x"] = sym(A @ v.X) + v.Q11 + v.Q21 - c * R1
    F["x", "e"] = B
    F["x", "x'"] = v.P11 - v.X + l1 * (v.X.T @ A.T)
    F["x", "x_d"] = B @ v.M + c * R1
    F["x", "w1"] = B
    F["x", "y"] = v.X.T @ s.C1.T
    F["e", "e"] = -sym(NB) + v.Q12 + v.Q22 - c * R2
    F["e", "x'"] = l1 * B.T
    F["e", "e'"] = v.P12 - v.P22.T - l2 * NB.T
    F["e", "e_d"] = c * R2
    F["e", "w1"] = -NB
    F["e", "w2'"] = v.P22.T
    F["e", "y"] = s.C2.T
    F["x'", "x'"] = -l1 * (v.X + v.X.T) + s.d_M * v.R1
    F["x'", "x_d"] = l1 * (B @ v.M)
    F["x'", "w1"] = l1 * B
    F["e'", "e'"] = -l2 * (v.P22 + v.P22.T) + s.d_M * v.R2
    F["e'", "w1"] = -l2 * NB
    F["e'", "w2'"] = l2 * v.P22.T
    F["x_d", "x_d"] = -(1 - s.mu) * v.Q21 - 4 * R1
    F["x_d", "x_M"] = o * R1
    F["e_d", "e_d"] = -(1 - s.mu) * v.Q22 - 4 * R2
    F["e_d", "e_M"] = o * R2
    F["x_M", "x_M"] = -v.Q11 - o * R1
    F["e_M", "e_M"] = -v.Q12 - o * R2
    F["w1", "w1"] = F["w2'", "w2'"] = -(s.gamma**2) * np.eye(1)
    F["w1", "y"] = s.Cd1.T
    F["w2'", "y"] = s.Cd2.T
    F["y", "y"] = -np.eye(1)
    return F


EDITIONS = {"printed": printed, "corrected": corrected}


def congruence(s: Setting, values: dict, part: str) -> np.ndarray:
    """T' (9) T under (25) at a point, from the original P21 = X^-1, K = M X^-1, L = P22^-T N; shape (15, 15).

    Parameters
    ----------
    s : Setting
    values : mapping
        Matrices of every name of `SYMMETRIC` and `FREE`; X and P22 invertible.
    part : str
        "a" or "b".
    """
    from papers.zhang2013.theorem1 import Delayed, Functional, theorem1

    X, P22 = values["X"], values["P22"]
    P21 = np.linalg.inv(X)
    K, L = values["M"] @ P21, np.linalg.inv(P22).T @ values["N"]
    zero = np.zeros
    loop = Delayed(
        A=np.block([[s.A, s.B], [zero((1, 2)), -L @ s.B]]),
        Ad=np.block([[s.B @ K, zero((2, 1))], [zero((1, 3))]]),
        B=np.block([[s.B, zero((2, 1))], [-L @ s.B, np.eye(1)]]),
        C=np.block([[s.C1, s.C2]]),
        Cd=np.block([[s.Cd1, s.Cd2]]),
        d_M=s.d_M,
        mu=s.mu,
    )

    def original(hat: str, plain: str) -> np.ndarray:
        return np.block([[P21.T @ values[hat] @ P21, zero((2, 1))], [zero((1, 2)), values[plain]]])

    given = {"P1": original("P11", "P12"), "Q1": original("Q11", "Q12"), "Q2": original("Q21", "Q22")}
    given["R"] = original("R1", "R2")
    given["P2"] = np.block([[P21, zero((2, 1))], [zero((1, 2)), P22]])
    given["P3"] = np.block([[s.lambda1 * P21, zero((2, 1))], [zero((1, 2)), s.lambda2 * P22]])
    T = np.eye(15)
    for i in range(0, 12, 3):
        T[i : i + 2, i : i + 2] = X
    return T.T @ theorem1(loop, Functional(3), s.gamma**2, part).value(given) @ T


def differing_blocks(s: Setting) -> tuple[tuple[int, int], ...]:
    """Block positions (i, j), i <= j, counted from 1, in which printed and corrected (23a) or (23b) differ."""
    v = Unknowns()
    found = {
        (ROWS.index(row) + 1, ROWS.index(column) + 1)
        for part in PARTS
        for row, column, _ in printed(s, v, part).differences(corrected(s, v, part), 1e-12)
    }
    return tuple(sorted(found))
