"""One certificate for all three requirements of the paper at a gain variation delta_m, for printed gains and our own.

Disk for constant variations by arcs (`conditions_arcs`), norm and torque for variations of any speed, each with a
Lyapunov matrix and multipliers of its own (`conditions_robust`). The checker concludes all three by itself
(`gainsay.proof.kinds.level`).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from gainsay.errors import ComputationError
from gainsay.proof import Certificate, build
from gainsay.tables import Case
from papers.li2021 import conditions_arcs as arcs
from papers.li2021 import conditions_robust as robust
from papers.li2021 import plant
from papers.li2021.statements import PLANT, UNCERTAIN

#: (10) in linear fractional form; dm is the bound on the gain variation
CHANNELS = (
    ("Acl", "[[A0, B @ Cf], [Bf @ C, Af]]"),
    ("Bcl", "col(B, zeros(6, 3))"),
    ("Ccl", "row(C, zeros(3, 6))"),
    ("H", "row(col(zeros(6, 6), Af), col(zeros(6, 3), Bf), Bcl, -Bcl, col(L, zeros(6, 12)))"),
    ("Wcl", "row(zeros(3, 3), XJ, zeros(3, 6))"),
    ("Cz", "col(dm * row(zeros(6, 6), eye(6)), dm * Ccl, dm * row(zeros(3, 6), Cf), Wcl @ Acl, row(K, zeros(12, 6)))"),
    ("Dw", "col(zeros(12, 27), Wcl @ H, zeros(12, 27))"),
    ("Dd", "col(zeros(12, 3), Wcl @ Bcl, zeros(12, 3))"),
    ("k", "(1 + dm) * row(zeros(3, 6), Cf)"),
    ("x0", "col(printed('x0'), zeros(6, 1))"),
)
#: formulas of Af, Bf, Cf
Formulas = tuple[tuple[str, str], ...]
PRINTED: Formulas = (("Af", "printed('Af')"), ("Bf", "printed('Bf')"), ("Cf", "printed('Cf')"))
COMPARISON: Formulas = (("Af", "printed('Af39')"), ("Bf", "printed('Bf39')"), ("Cf", "printed('Cf39')"))
#: channels of the linear fractional form as blocks
BLOCKS = (*[["repeated", 1]] * 12, ["full", 3, 3], *[["repeated", 1]] * 12)
FAITH = (
    "That (10) with (9), Delta J, Delta D and Delta G is the linear fractional form given, |Delta| <= 1.",
    "That the norm of k xi is no smaller than that of the torque (I + F3) C_f x_f, with d~ = 0 as in Lemma 4.",
)


def of_design(name: str) -> Formulas:
    """Formulas of the gains of a design of ours."""
    return tuple((f"{letter}f", f"design('{name}', '{letter}')") for letter in "ABC")


@dataclass(frozen=True)
class Evidence:
    """Floating-point solutions behind a certificate, in the coordinates of the paper.

    Attributes
    ----------
    delta_m : float
    ends : list of float
        Of the arcs, from 0 to 1 in parts of the half circle; empty where one P is for the whole circle.
    P : ndarray, shape (12, 12)
        For the disk: of the loop without variation, or the one P.
    scales : ndarray, shape (arcs, 25)
        Multipliers of the disk; one row with one P.
    norm, torque : tuple of ndarray
        P and the 25 multipliers of the norm and of the torque condition.
    """

    delta_m: float
    ends: list[float]
    P: np.ndarray
    scales: np.ndarray
    norm: tuple[np.ndarray, np.ndarray]
    torque: tuple[np.ndarray, np.ndarray]


def start_state(case: Case) -> np.ndarray:
    """xi(0) = (x(0), 0)."""
    return np.concatenate([case.matrix("x0").ravel(), np.zeros(6)])


def torque_output(gains: plant.Gains, delta_m: float) -> np.ndarray:
    """(1 + delta_m) [0 C_f]."""
    return (1 + delta_m) * np.hstack([np.zeros((3, 6)), gains.C])


def norm_evidence(case: Case, form: robust.Loop) -> tuple[np.ndarray, np.ndarray]:
    """P and multipliers of the norm condition at the paper's gamma, from scalings and a Riccati equation.

    Both in the coordinates of the loop, which is to be balanced.
    """
    gamma = case.number("gamma") * 0.9995
    value, logs = robust.norm_scaling(form, gamma, robust.ENOUGH)
    if value >= 1:
        raise ComputationError("norm", f"scaled norm {value:.4f}, below 1 expected")
    return robust.norm_riccati(form, logs, gamma)


def torque_evidence(
    case: Case, gains: plant.Gains, delta_m: float, form: robust.Loop, norm: tuple[np.ndarray, np.ndarray]
) -> tuple[tuple[np.ndarray, np.ndarray], float]:
    """P and multipliers of the torque condition, and the bound on the torque that they give, N m.

    Those of the norm condition times one number, all in the coordinates of the loop: with d~ = 0 they say that
    xi' P xi falls, and P only has to lie above k' k. The least bound is lower; any below u_max will do.
    """
    P, multipliers = norm
    output = torque_output(gains, delta_m) @ form.T
    size = 1.001 * float(np.linalg.eigvalsh(output @ np.linalg.solve(P, output.T))[-1])
    start = np.linalg.solve(form.T, start_state(case))
    return (size * P, size * multipliers), float(np.sqrt(size * start @ P @ start))


def back(form: robust.Loop, P: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """P and multipliers in the coordinates of the paper."""
    return robust.original(form, {"P": P, **{f"d{i}": x for i, x in enumerate(d)}})


def gather(case: Case, gains: plant.Gains, delta_m: float, one_matrix: bool = False) -> Evidence:
    """Solve all three conditions at a gain variation; raises ComputationError where one cannot be met.

    With ``one_matrix`` the disk is shown by one P and one D for the whole circle.
    """
    form = robust.loop(plant.constants(case), gains, delta_m).balanced()
    a, b = case.number("disk_centre"), case.number("disk_radius")
    if one_matrix:
        responses = np.array([form.response(-a + b * np.exp(1j * t)) for t in np.linspace(0, np.pi, 181)])
        ends: list[float] = []
        shared = robust.shared_scaling(responses, stop=robust.ENOUGH)[1]
        P, d = back(form, *arcs.one_matrix(form, a, b, shared))
        scales = d[None]
    else:
        ends, logs = arcs.cover(form, a, b)
        moved = (plant.closed_loop(plant.rigid(plant.constants(case)), gains) + a * np.eye(12)) / b
        P = solve_discrete_lyapunov(moved.T, np.eye(12))
        scales = np.array([back(form, P, np.exp(2 * x))[1] for x in logs])
    norm = norm_evidence(case, form)
    torque, bound = torque_evidence(case, gains, delta_m, form, norm)
    if bound >= case.number("u_max"):
        raise ComputationError("torque", f"bound {bound:.4f} N m at delta_m {delta_m}, u_max expected")
    return Evidence(delta_m, ends, P, scales, back(form, *norm), back(form, *torque))


def _witness(part: str, P: np.ndarray, multipliers: np.ndarray) -> dict:
    return {f"{part}.P": (P + P.T) / 2} | {f"{part}.D{i}": [[float(x)]] for i, x in enumerate(multipliers, start=1)}


def certificate(
    case: Case, name: str, formulas: Formulas, evidence: Evidence, *, quantity: str, statement: str
) -> Certificate:
    """All three requirements at evidence.delta_m, exactly; concludes quantity >= delta_m.

    Parameters
    ----------
    case : gainsay.tables.Case
    name, statement : str
        Of the certificate.
    formulas : Formulas
    evidence : Evidence
    quantity : str
    """
    channels = {"H": "H", "Cz": "Cz", "Dw": "Dw", "blocks": list(BLOCKS)}
    disk = {"A": "Acl", **channels, "shift": "a", "radius": "b"}
    norm = {"A": "Acl", "B": "Bcl", "C": "Ccl", **channels, "Dd": "Dd", "gamma": "number('gamma')"}
    limit = {"of": "torque", "row": "k", "bound": "number('u_max')"}
    torque = {"A": "Acl", **channels, "x0": "x0", "inputs": [limit]}
    if evidence.ends:
        disk |= {"arcs": [f"{t:.6g}" for t in evidence.ends]}
        witness = {"disk.P": (evidence.P + evidence.P.T) / 2, "disk.d": evidence.scales}
    else:
        witness = _witness("disk", evidence.P, evidence.scales[0])
    witness |= _witness("norm", *evidence.norm) | _witness("torque", *evidence.torque)
    return build.certificate(
        "level",
        id=name,
        tables=case,
        statement=statement,
        definitions=[("dm", repr(evidence.delta_m)), *PLANT, *UNCERTAIN, *formulas, *CHANNELS],
        fields={
            "level": "dm",
            "parts": [
                {"name": "disk", "kind": "contour" if evidence.ends else "robust_disk", "fields": disk},
                {"name": "norm", "kind": "robust_norm", "fields": norm},
                {"name": "torque", "kind": "quadratic_bound", "fields": torque},
            ],
        },
        witness=witness,
        quantities={"level": quantity},
        faith=FAITH,
        digits=(9, 12, 17),
    )
