"""One certificate for all three requirements of the paper at a gain variation delta_m, for printed gains and our own.

Disk for constant variations by arcs (`papers.li2021.arcs`), norm and torque for variations of any speed, each with a
Lyapunov matrix and multipliers of its own (`papers.li2021.robust`).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from gainsay.errors import ComputationError
from gainsay.lmi import Solved, solve
from gainsay.proof import Certificate, build
from papers.li2021 import arcs, plant, robust
from papers.li2021.proofs import PLANT, UNCERTAIN, symmetric

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
    ("V", "row(Acl + a*eye(12), H) / b"),
    ("U", "row(eye(12), zeros(12, 27))"),
    ("Z", "row(Cz, Dw)"),
    ("Zd", "row(Cz, Dw, Dd)"),
)  # fmt: skip
PRINTED = (("Af", "printed('Af')"), ("Bf", "printed('Bf')"), ("Cf", "printed('Cf')"))
COMPARISON = (("Af", "printed('Af39')"), ("Bf", "printed('Bf39')"), ("Cf", "printed('Cf39')"))
FAITH = (
    "That (10) with (9), Delta J, Delta D and Delta G is the linear fractional form given, |Delta| <= 1.",
    "Generalised Kalman-Yakubovich-Popov lemma: on the arc cut off by a chord the inequality gives M* D M < D; as "
    "the arcs join from angle 0 to pi and the data are real, no pole meets the circle for any constant Delta.",
    "S-procedure for the norm and the torque, with d~ = 0 for the torque as in Lemma 4.",
)


def of_design(name: str) -> tuple[tuple[str, str], ...]:
    """Formulas of the gains of a design of ours."""
    return tuple((f"{letter}f", f"design('{name}', '{letter}')") for letter in "ABC")


@dataclass(frozen=True)
class Evidence:
    """Floating-point solutions behind a certificate, in the coordinates of the paper.

    Attributes
    ----------
    delta_m : float
    chain : list of arcs.Arc
        Arcs from angle 0 to pi, or one entry of weight zero: one P for the whole circle.
    form : robust.Loop
        The balanced loop that the arcs belong to.
    norm, torque : tuple of ndarray
        P and the 25 multipliers of the norm and of the torque condition.
    """

    delta_m: float
    chain: list
    form: robust.Loop
    norm: tuple[np.ndarray, np.ndarray]
    torque: tuple[np.ndarray, np.ndarray]


def start_state(case) -> np.ndarray:
    """xi(0) = (x(0), 0)."""
    return np.concatenate([case.matrix("x0").ravel(), np.zeros(6)])


def torque_output(gains, delta_m: float) -> np.ndarray:
    """(1 + delta_m) [0 C_f]."""
    return (1 + delta_m) * np.hstack([np.zeros((3, 6)), gains.C])


def norm_evidence(case, gains, delta_m: float) -> tuple[np.ndarray, np.ndarray]:
    """P and multipliers of the norm condition at the paper's gamma, from scalings and a Riccati equation."""
    form = robust.loop(plant.constants(case), gains, delta_m).balanced()
    gamma = case.number("gamma") * 0.9995
    value, logs = robust.norm_scaling(form, gamma)
    if value >= 1:
        raise ComputationError("norm", f"scaled norm {value:.4f} at delta_m {delta_m}, below 1 expected")
    P, d = robust.norm_riccati(form, logs, gamma)
    return back(form, P, d)


def torque_evidence(case, gains, delta_m: float) -> tuple[tuple[np.ndarray, np.ndarray], float]:
    """P and multipliers of the torque condition, and the bound on the torque that they give, N m."""
    form = robust.prepared(robust.loop(plant.constants(case), gains, delta_m), case.number("gamma") * 0.9995)
    start = np.linalg.solve(form.T, start_state(case))
    found = solve(robust.torque_program(form, torque_output(gains, delta_m) @ form.T, start))
    if not isinstance(found, Solved):
        raise found.error if hasattr(found, "error") else ComputationError("torque", "no Lyapunov matrix")
    return robust.original(form, found.values), float(np.sqrt(found.objective))


def back(form: robust.Loop, P: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """P and multipliers in the coordinates of the paper."""
    return robust.original(form, {"P": P, **{f"d{i}": x for i, x in enumerate(d)}})


def gather(case, gains, delta_m: float, one_matrix: bool = False) -> Evidence:
    """Solve all three conditions at a gain variation; raises ComputationError where one cannot be met.

    With ``one_matrix`` the disk is shown by one P and one D for the whole circle.
    """
    form = robust.loop(plant.constants(case), gains, delta_m).balanced()
    a, b = case.number("disk_centre"), case.number("disk_radius")
    if one_matrix:
        responses = np.array([form.response(-a + b * np.exp(1j * t)) for t in np.linspace(0, np.pi, 61)])
        ends = (arcs.node(0.0), arcs.node(np.pi))
        chain = [arcs.certify(form, a, b, ends, robust.shared_scaling(responses)[1], weights=(0,))]
        if chain[0] is None:
            raise ComputationError("disk region", f"no single P at delta_m {delta_m}")
    else:
        chain = arcs.cover(form, a, b)
    torque, bound = torque_evidence(case, gains, delta_m)
    if bound >= case.number("u_max"):
        raise ComputationError("torque", f"bound {bound:.4f} N m at delta_m {delta_m}, u_max expected")
    return Evidence(delta_m, chain, form, norm_evidence(case, gains, delta_m), torque)


def _spread(name: str) -> str:
    return f"diag({name}[0:12, 0:12], {name}[12, 12] * eye(3), {name}[13:25, 13:25])"


def _diagonal(values: np.ndarray) -> np.ndarray:
    return np.diag(values)


def certificate(
    case, name: str, gains, formulas, evidence: Evidence, *, quantity: str, claims=(), statement: str
) -> Certificate:
    """All three requirements at evidence.delta_m, exactly; concludes quantity >= delta_m.

    Parameters
    ----------
    case : gainsay.tables.Case
    name, statement : str
        Of the certificate.
    gains : namespace with A, B, C
    formulas : pairs
        Formulas of Af, Bf, Cf.
    evidence : Evidence
    quantity : str
    claims : tuple of str
    """
    a, b = case.number("disk_centre"), case.number("disk_radius")
    loop = plant.closed_loop(plant.rigid(plant.constants(case)), gains)
    moved = (loop + a * np.eye(12)) / b
    definitions: list[tuple[str, str]] = [*PLANT, *UNCERTAIN, *formulas, *CHANNELS]
    unknowns: dict[str, Mapping] = {"dm": {}, **symmetric(S0=12, Pn=12, Pt=12)}
    multipliers = {"shape": [25, 25], "structure": "diagonal"}
    point = {
        "dm": evidence.delta_m,
        "S0": solve_discrete_lyapunov(moved.T, np.eye(12)),
        "Pn": evidence.norm[0],
        "mn": _diagonal(evidence.norm[1]),
        "Pt": evidence.torque[0],
        "mt": _diagonal(evidence.torque[1]),
    }
    unknowns |= {"mn": multipliers, "mt": multipliers}
    definitions += [
        ("Dn", _spread("mn")), ("Dt", _spread("mt")),
        ("Vn", "row(Acl, H, Bcl)"), ("Un", "row(eye(12), zeros(12, 30))"), ("Vt", "row(Acl, H)"),
        ("k", "(1 + dm) * row(zeros(3, 6), Cf)"), ("x0", "col(printed('x0'), zeros(6, 1))"),
    ]  # fmt: skip
    constraints = [
        ["poles without variation", "(Acl + a*eye(12)).T @ S0 @ (Acl + a*eye(12)) - b**2 * S0 < 0"],
        ["S0", "S0 > 0"],
        ["norm", "sym(Un.T @ Pn @ Vn) + Zd.T @ Dn @ Zd + diag(Ccl.T @ Ccl, -Dn, -number('gamma')**2 * eye(3)) < 0"],
        ["norm, P", "Pn > 0"], ["norm, D", "mn > 0"],
        ["torque", "sym(U.T @ Pt @ Vt) + Z.T @ Dt @ Z - diag(zeros(12, 12), Dt) < 0"],
        ["torque, P", "Pt - k.T @ k >= 0"], ["torque, D", "mt > 0"],
        ["torque, start", "x0.T @ Pt @ x0 <= number('u_max')**2"],
    ]  # fmt: skip
    for i, arc in enumerate(evidence.chain):
        if len(evidence.chain) == 1 and arc.weight == 0:
            P, d = arc.original(evidence.form)
            point |= {"m0": _diagonal(d), "Pd": P.real}
            unknowns |= {"m0": multipliers, **symmetric(Pd=12)}
            definitions.append(("Da0", _spread("m0")))
            constraints += [
                ["disk", "V.T @ Pd @ V - U.T @ Pd @ U + Z.T @ Da0 @ Z - diag(zeros(12, 12), Da0) < 0"],
                ["disk, P", "Pd > 0"], ["disk, D", "m0 > 0"],
            ]  # fmt: skip
            break
        P, d = arc.original(evidence.form)
        point |= {f"m{i}": _diagonal(d), f"w{i}": arc.weight, f"P{i}": P.real, f"R{i}": P.imag}
        unknowns |= {f"m{i}": multipliers, f"w{i}": {}, **symmetric(**{f"P{i}": 12})}
        unknowns[f"R{i}"] = {"shape": [12, 12], "structure": "skew"}
        definitions += _arc_definitions(i, arc)
        constraints += [[f"arc {i}", f"[[Nr{i}, -Ni{i}], [Ni{i}, Nr{i}]] < 0"], [f"arc {i}, D", f"m{i} > 0"],
                        [f"arc {i}, w", f"w{i} >= 0"]]  # fmt: skip
    return build.feasible_point(
        id=name,
        paper=case.name,
        tables=case,
        claims=claims,
        statement=statement,
        definitions=definitions,
        unknowns=unknowns,
        fields={"constraints": constraints, "maximise": "dm"},
        point=point,
        quantities={"objective": quantity},
        faith=FAITH,
        digits=(9, 12, 17),
    )


def _arc_definitions(i: int, arc: arcs.Arc) -> list[tuple[str, str]]:
    def ends(number: int, place) -> list[tuple[str, str]]:
        t, mirrored = place
        sign = "-" if mirrored else ""
        return [
            (f"t{number}_{i}", str(t)),
            (f"c{number}_{i}", f"{sign}(1 - t{number}_{i}**2) / (1 + t{number}_{i}**2)"),
            (f"s{number}_{i}", f"2*t{number}_{i} / (1 + t{number}_{i}**2)"),
        ]

    return [
        *ends(0, arc.first),
        *ends(1, arc.last),
        (f"al{i}", f"c0_{i} + c1_{i}"),
        (f"be{i}", f"s0_{i} + s1_{i}"),
        (f"lv{i}", f"al{i}*c1_{i} + be{i}*s1_{i}"),
        (f"Da{i}", _spread(f"m{i}")),
        (f"Q{i}", f"w{i} * Cz.T @ Da{i} @ Cz"),
        (f"Y{i}", f"V.T @ Q{i} @ U"),
        (
            f"Nr{i}",
            f"V.T @ P{i} @ V - U.T @ P{i} @ U + Z.T @ Da{i} @ Z - diag(zeros(12, 12), Da{i}) + al{i} * sym(Y{i}) "
            f"- 2*lv{i} * U.T @ Q{i} @ U",
        ),
        (f"Ni{i}", f"V.T @ R{i} @ V - U.T @ R{i} @ U + be{i} * (Y{i} - Y{i}.T)"),
    ]
