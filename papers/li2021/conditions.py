"""The matrix inequalities of the paper, block names as printed; e, W0 and E are taken without their rows of zeros.

Rows 1a and 1b are the two halves of the first block row of (13), 5a and 5b those of the fifth. The printed forms of
(13), (15) and (17) are lost in part; what is missing is rebuilt from the congruence that leads to them, and where
the text allows more than one reading each is built.
"""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from gainsay.lmi import Affine, BlockMatrix, Program, affine, matrix, positive, scalar, symmetric
from papers.li2021 import plant

EYE3, EYE6 = np.eye(3), np.eye(6)


@dataclass(frozen=True)
class Model:
    """Matrices of (7) in floats and the disk D(a, b); E and W0 hold their three rows and columns that are not zero."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    E: np.ndarray
    W: np.ndarray
    L: np.ndarray
    K: np.ndarray
    a: float
    b: float

    @classmethod
    def of(cls, case) -> "Model":
        """Model of the paper's tables."""
        k = plant.constants(case)
        nominal, factors = plant.rigid(k), plant.uncertain(k)
        return cls(
            nominal.A, nominal.B, nominal.C, factors.E[:, 3:], factors.W0[3:], factors.L, factors.K,
            case.number("disk_centre"), case.number("disk_radius"),
        )  # fmt: skip


def lemma3_synthesis(model: Model, lam: float, gamma: float | None = None, eps1: float | None = None) -> Program:
    """(12) for all gains at once, by the change of variables of Scherer, Gahinet and Chilali (1997).

    With P and its inverse partitioned as [[X, .], [., .]] and [[Y, .], [., .]], the congruence by [[Y, I], [V', 0]]
    makes (12) linear in X, Y and transformed gains Ah, Bh, Ch. Nominal A; with eps1 the uncertainty
    Delta A = L Delta H K borders the matrix as in (13).

    Parameters
    ----------
    model : Model
    lam : float
        lambda.
    gamma : float, optional
        Where None, its square is minimised.
    eps1 : float, optional
        Multiplier of the uncertainty Delta A; nominal A where None.
    """
    A, B, C, E, W, a = model.A, model.B, model.C, model.E, model.W, model.a
    X, Y = symmetric("X", 6), symmetric("Y", 6)
    Ah, Bh, Ch = matrix("Ah", 6, 6), matrix("Bh", 6, 3), matrix("Ch", 3, 6)
    square = positive("g2") if gamma is None else affine(np.array([[gamma**2]]))
    ratio = model.b**2 / a
    border = ("uncertainty_in", "uncertainty_out") if eps1 else ()
    F = BlockMatrix("(12)", "y", "x", "e", "d", "W0", "output", "pole_y", "pole_x", *border)
    F["y", "y"], F["y", "x"], F["x", "x"] = -ratio * Y, -ratio * EYE6, -ratio * X
    F["y", "e"], F["x", "e"] = -E, -(X @ E)
    F["y", "d"], F["x", "d"] = B, X @ B
    F["y", "W0"], F["x", "W0"] = lam * (W @ (A @ Y + B @ Ch)).T, lam * (W @ A).T
    F["y", "output"], F["x", "output"] = Y @ C.T, C.T
    F["y", "pole_y"], F["y", "pole_x"] = (A @ Y + B @ Ch + a * Y).T, (Ah + a * EYE6).T
    F["x", "pole_y"], F["x", "pole_x"] = (A + a * EYE6).T, (X @ A + Bh @ C + a * X).T
    F["e", "e"], F["e", "W0"] = -(lam**2) * EYE3, -lam * (W @ E).T
    F["d", "d"], F["d", "W0"] = -square * EYE3, lam * (W @ B).T
    F["W0", "W0"], F["output", "output"] = -EYE3, -EYE3
    F["pole_y", "pole_y"], F["pole_y", "pole_x"], F["pole_x", "pole_x"] = -a * Y, -a * EYE6, -a * X
    if eps1:
        F["y", "uncertainty_in"], F["x", "uncertainty_in"] = eps1 * (Y @ model.K.T), eps1 * model.K.T
        F["W0", "uncertainty_out"] = lam * W @ model.L
        F["pole_y", "uncertainty_out"], F["pole_x", "uncertainty_out"] = model.L, X @ model.L
        for row in border:
            F[row, row] = -eps1 * np.eye(12)
    return Program(minimise=square if gamma is None else None, subject_to=[F < 0], label="(12), all gains")


def lemma3_analysis(model: Model, gains, lam: float, T: np.ndarray, gamma: float | None = None) -> Program:
    """(12) for given gains and nominal A, in a full P and in the coordinates xi = T xi_b (P_b = T'PT).

    gamma^2 is minimised where gamma is None; gamma = inf leaves the row of d~ out.
    """
    loop = np.block([[model.A, model.B @ gains.C], [gains.B @ model.C, gains.A]])
    A = np.linalg.solve(T, loop @ T)
    B = np.linalg.solve(T, np.vstack([model.B, np.zeros((6, 3))]))
    E = np.linalg.solve(T, np.vstack([model.E, np.zeros((6, 3))]))
    W = np.hstack([model.W, np.zeros((3, 6))])
    P = symmetric("P", 12)
    bounded = gamma is None or np.isfinite(gamma)
    F = BlockMatrix("(12)", "state", "e", *(("d",) if bounded else ()), "W0", "output", "pole")
    F["state", "state"] = -(model.b**2 / model.a) * P
    F["state", "e"] = -(P @ E)
    F["state", "W0"] = lam * (W @ loop @ T).T
    F["state", "output"] = (np.hstack([model.C, np.zeros((3, 6))]) @ T).T
    F["state", "pole"] = (A + model.a * np.eye(12)).T @ P
    F["e", "e"], F["e", "W0"] = -(lam**2) * EYE3, -lam * (model.W @ model.E).T
    square = None
    if bounded:
        square = positive("g2") if gamma is None else affine(np.array([[gamma**2]]))
        F["state", "d"], F["d", "d"] = P @ B, -square * EYE3
        F["d", "W0"] = lam * (model.W @ model.B).T
    F["W0", "W0"], F["output", "output"], F["pole", "pole"] = -EYE3, -EYE3, -model.a * P
    return Program(minimise=square if gamma is None else None, subject_to=[F < 0], label="(12), given gains")


def theorem2_unknowns() -> tuple:
    """S, Y = S - N, Fa, Fb, Cf of (17)."""
    return symmetric("S", 6), symmetric("Y", 6), matrix("Fa", 6, 6), matrix("Fb", 6, 3), matrix("Cf", 3, 6)


def theorem2(model: Model, scalars: SimpleNamespace, unknowns: tuple, divided: bool, thin: bool) -> BlockMatrix:
    """(17) as rebuilt: (13) without its terms in C_f'B1'S and C_f'B1'(S - N), which Lemma 2 carries.

    Parameters
    ----------
    model : Model
    scalars : namespace
        eps1, eps2, lam, lam1, gamma, delta_m.
    unknowns : tuple
        Of `theorem2_unknowns`.
    divided : bool
        Where eps2 stands: False, it multiplies psi_3; True, it multiplies psi_4 and psi_5.
    thin : bool
        The split of Lemma 2: C_f' against [S B1; (S - N) B1] (True), or C_f'B1' against [S; S - N].
    """
    A, B, C, a, s = model.A, model.B, model.C, model.a, scalars
    S, Y, Fa, Fb, Cf = unknowns
    F = theorem1_frame(model, s, "(17)", S, Y, ("lemma_2",))
    F["1a", "4"] = s.lam * (model.W @ A).T + s.lam * Cf.T @ (model.W @ B).T
    F["1a", "5a"] = (A + a * EYE6).T @ S
    F["1a", "5b"] = (A + a * EYE6).T @ Y + C.T @ Fb.T + Fa.T
    F["1b", "5a"] = (A + a * EYE6).T @ S
    F["1b", "5b"] = (A + a * EYE6).T @ Y + C.T @ Fb.T
    first, second = (1, s.eps2) if divided else (s.eps2, 1)
    for row, blocks in (("1a", (EYE6, C.T, Cf.T)), ("1b", (None, C.T, None))):
        for name, block in zip(("F1_in", "F2_in", "F3_in"), blocks, strict=True):
            if block is not None:
                F[row, name] = first * block
    F["4", "F3_out"] = second * s.lam * s.delta_m * model.W @ B
    F["5a", "F3_out"] = second * s.delta_m * (S @ B)
    for name, block in (("F1_out", Fa), ("F2_out", Fb), ("F3_out", Y @ B)):
        F["5b", name] = second * s.delta_m * block
    if thin:
        F["1a", "lemma_2"] = Cf.T / s.lam1
        F["5a", "lemma_2"], F["5b", "lemma_2"] = s.lam1 * (S @ B), s.lam1 * (Y @ B)
    else:
        F["1a", "lemma_2"] = Cf.T @ B.T / s.lam1
        F["5a", "lemma_2"], F["5b", "lemma_2"] = s.lam1 * S, s.lam1 * Y
    F["lemma_2", "lemma_2"] = -2 * np.eye(3 if thin else 6)
    for name, size in (("F1", 6), ("F2", 3), ("F3", 3)):
        F[f"{name}_in", f"{name}_in"] = F[f"{name}_out", f"{name}_out"] = -s.eps2 * np.eye(size)
    return F


def theorem1_frame(model: Model, s: SimpleNamespace, label: str, S: Affine, Y: Affine, extra: tuple) -> BlockMatrix:
    """Blocks of (13) that every reading shares, with Y = S - N."""
    ratio, lam, a = model.b**2 / model.a, s.lam, model.a
    inner = ("F1_in", "F2_in", "F3_in", "F1_out", "F2_out", "F3_out")
    F = BlockMatrix(label, "1a", "1b", "2", "3", "4", "5a", "5b", "H_in", "H_out", *inner, *extra)
    square = model.C.T @ model.C
    F["1a", "1a"], F["1a", "1b"], F["1b", "1b"] = -ratio * S + square, -ratio * S + square, -ratio * Y + square
    F["1a", "2"], F["1b", "2"] = -(S @ model.E), -(Y @ model.E)
    F["1a", "3"], F["1b", "3"] = S @ model.B, Y @ model.B
    F["1b", "4"] = lam * (model.W @ model.A).T
    F["2", "2"], F["2", "4"] = -(lam**2) * EYE3, -lam * (model.W @ model.E).T
    F["3", "3"], F["3", "4"] = -(s.gamma**2) * EYE3, lam * (model.W @ model.B).T
    F["4", "4"] = -EYE3
    F["5a", "5a"], F["5a", "5b"], F["5b", "5b"] = -a * S, -a * S, -a * Y
    F["1a", "H_in"] = F["1b", "H_in"] = s.eps1 * model.K.T
    F["4", "H_out"], F["5a", "H_out"], F["5b", "H_out"] = lam * model.W @ model.L, S @ model.L, Y @ model.L
    F["H_in", "H_in"] = F["H_out", "H_out"] = -s.eps1 * np.eye(12)
    return F


def lemma4_against_lemma3(model: Model, Cf: np.ndarray, s: SimpleNamespace) -> Program:
    """(19) with given C_f and rows 1 and 2 of (12) in the structure P = [Y N; N -N], of both the rows of the rates.

    The unknowns are the blocks of S and Y = S - N that belong to the rates, 3x3 each.
    """
    S, Y = symmetric("S", 3), symmetric("Y", 3)
    ratio, E = model.b**2 / model.a, model.E[3:]
    G = BlockMatrix("(19)", "u", "1a", "1b", "F3")
    G["u", "u"], G["u", "1a"] = -(s.u_max**2 - s.eps3 * s.delta_m**2) * EYE3, -Cf[:, 3:]
    G["1a", "1a"], G["1a", "1b"], G["1b", "1b"] = -S / s.theta, -S / s.theta, -Y / s.theta
    G["1a", "F3"], G["F3", "F3"] = Cf[:, 3:].T, -s.eps3 * EYE3
    F = BlockMatrix("(12), rows 1 and 2", "1a", "1b", "2")
    F["1a", "1a"], F["1a", "1b"], F["1b", "1b"] = -ratio * S, -ratio * S, -ratio * Y
    F["1a", "2"], F["1b", "2"], F["2", "2"] = -(S @ E), -(Y @ E), -(s.lam**2) * EYE3
    return Program(subject_to=[F < 0, G <= 0], label="(19) with (12)")


def table1(case) -> SimpleNamespace:
    """Scalars of Table 1."""
    names = ("eps1", "eps2", "eps3", "gamma", "delta_m", "u_max", "theta")
    return SimpleNamespace(
        lam=case.number("lambda"), lam1=case.number("lambda1"), **{name: case.number(name) for name in names}
    )


def pushed(program: Program) -> Program:
    """The constraints of a program pushed up together: F_j >= t I with t < 1 maximised.

    Always feasible; where its infimum -t is above zero the program is not, and its multipliers are those of a
    Farkas proof.
    """
    t = scalar("t")
    constraints = []
    for constraint in program.constraints:
        size = constraint.expression.shape[0]
        constraints.append((constraint.expression - t * np.eye(size) > 0).named(constraint.label))
    return Program(minimise=-t, subject_to=[*constraints, (1 - t > 0).named("t < 1")], label=program.label)
