"""Programs of the statements, and certificates whose points or multipliers are made here rather than by the solver."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from gainsay.proof import Certificate, build
from gainsay.statements import Stated, Statement, scalar
from papers.li2021 import plant
from papers.li2021.statements import EQ12, EQ15, EQ19, LOOP, TABLES, THEOREM_1, all_gains, equation_13

#: scalars at which (13) holds: those of Table 1, but for these two
EPS2, DELTA_M = "0.0001", "0.000001"
REBUILT = "That (13), which is lost, reads as rebuilt: a condition that gives (15), as Lemma 1 says."


def lemma_3(case: Any, uncertain: bool = False, **texts: str | None) -> Stated:
    """(12) for all gains at Table 1's scalars, or others given as texts, None for one that is unknown.

    The least gamma^2 unless g is given.
    """
    given = {**TABLES, "g": "g2", **texts}
    known = {name: text for name, text in given.items() if text is not None}
    held = all_gains(uncertain).defining(known, unknowns={"g2": scalar()}) < 0
    return Stated(case, [held], minimise=None if "g" in texts else "g2", label="(12), all gains")


#: (10) with the printed gains and nominal A
PRINTED_LOOP = {
    "Af": "printed('Af')",
    "Bf": "printed('Bf')",
    "Cf": "printed('Cf')",
    "A": "A0",
    "Ad": "Af",
    "Bd": "Bf",
    "Cd": "Cf",
}


def printed_gains(case: Any, *rows: str, **texts: str) -> Stated:
    """The named rows of (12), or all, for the printed gains and nominal A; the least gamma^2 where row 3 is there.

    Definitions otherwise than by Table 1 are given as texts.
    """
    texts = {**TABLES, "g": "g2", **PRINTED_LOOP, **LOOP, **texts}
    statement = EQ12.sub(*rows or EQ12.rows).defining(texts, unknowns={"g2": scalar()})
    return Stated(case, [statement < 0], minimise="g2" if "3" in statement.rows else None, label="(12), printed gains")


def input_bound(case: Any) -> Stated:
    """Return the rows of the rates of (19), printed C_f, and of rows 1a, 1b, 2 of (15), which (12) gives.

    The rows of the angles are left out: S and N enter those with one sign alone, so that no proof gives them weight.
    """
    scalars = {name: f"number('{name}')" for name in ("u_max", "theta", "eps3")}
    eq19 = EQ19.defining({"Cf": "printed('Cf')", "dm": TABLES["dm"], **scalars})
    eq15 = EQ15.sub("1a", "1b", "2").defining(TABLES)
    rate = "col(zeros(3, 3), eye(3))"

    def part(of: Statement, rows: str) -> Statement:
        return replace(of, rows=("rates",), blocks={("rates", "rates"): f"({rows}).T @ {of.formula} @ {rows}"})

    held = [part(eq15, f"diag({rate}, {rate}, eye(3))") < 0, part(eq19, f"diag(eye(3), {rate}, {rate}, eye(3))") <= 0]
    return Stated(case, held, label="(19) with (12)")


def open_loop_in_disk(case: Any, rows: Statement) -> Certificate:
    """(17) fails for all its scalars: multipliers of its rows 1a and 5a, which no scalar and no other unknown enters.

    V11 = V with (A0 + aI) V (A0 + aI)' > b^2 V exists because no open-loop pole lies in D(a, b).
    """
    a, b = case.number("disk_centre"), case.number("disk_radius")
    A = plant.rigid(plant.constants(case)).A + a * np.eye(6)
    inverse = np.linalg.inv(A)
    V = solve_discrete_lyapunov(b * inverse, inverse @ inverse.T)
    V = (V + V.T) / 2
    # slack keeps the multiplier inside the cone, and what multiplies S non-negative
    room = 1e-4 * np.linalg.eigvalsh(A @ V @ A.T - b**2 * V)[0]
    Z = np.block([[V, V @ A.T / a], [A @ V / a, A @ V @ A.T / a**2 + room * np.eye(6)]])
    W = (A @ V @ A.T - b**2 * V) / a - a * room * np.eye(6)
    return build.farkas(
        id="eq17-infeasible",
        statement="Rows 1a and 5a of (17), [[-(b^2/a) S + C'C, (A0 + aI)'S], [., -aS]] < 0, have no solution S > 0: "
        "they ask for the open-loop poles in D(a, b). No scalar of (17) and no other unknown enters them.",
        multipliers={"(17)": Z, "S > 0": W},
        quantities={"feasible": "eq17.feasible"},
        faith=(
            "That the terms of (1,5) in C_f are those that Lemma 2 takes out of the lost matrix Xi, so that row 1a, "
            "column 5a of (17) is A0'S + aS; with C_f left there the inequality would not be linear.",
        ),
        **Stated(case, [rows.defining(TABLES) < 0, "S > 0"]).parts(),
    )


def theorem_1_unknowns(case: Any, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """S, N, Fa, Fb, Cf of Theorem 1 from the unknowns of (12) for all gains."""
    nominal = plant.rigid(plant.constants(case))
    S, Y = np.linalg.inv(values["X"]), values["Y"]
    S, Cf, Fb = (S + S.T) / 2, values["Ch"] @ S, values["Fb"]
    Fa = values["Ah"] @ S - (Y @ nominal.A + Fb @ nominal.C + Y @ nominal.B @ Cf)
    return {"S": S, "N": S - Y, "Fa": Fa, "Fb": Fb, "Cf": Cf}


def solution_of_13(case: Any, values: Mapping[str, np.ndarray]) -> Certificate:
    """A solution of (13), in the reading in which eps2 multiplies psi_3; 1/eps2 serves the other reading."""
    eq13 = equation_13(divided=False).defining(TABLES, eps2=EPS2, dm=DELTA_M)
    return build.feasible_point(
        id="eq13-feasible-elsewhere",
        statement=f"(13) has a solution at Table 1's lambda, gamma and eps1 with eps2 = {EPS2}, delta_m = {DELTA_M}.",
        point=theorem_1_unknowns(case, values),
        quantities={"feasible": "eq13.feasible_elsewhere"},
        faith=(REBUILT,),
        **Stated(case, [eq13 < 0, "S > 0", "N < 0"], unknowns=THEOREM_1).parts(),
    )


def end_of_band(case: Any, values: Mapping[str, np.ndarray], inside: float, end: str) -> Certificate:
    """(12) has a solution over all gains at the paper's gamma and a lambda near an end of the band."""
    parts = lemma_3(case, g=TABLES["g"], lam=None).parts()
    return build.feasible_point(
        id=f"eq12-lambda-{end}",
        statement=f"(12) has a solution over all gains at lambda = {inside!r} and the paper's gamma.",
        point={**{name: value for name, value in values.items() if name in parts["unknowns"]}, "lam": inside},
        quantities={"objective": f"lemma3.lambda_{end}"},
        **{**parts, "fields": {**parts["fields"], "minimise" if end == "low" else "maximise": "lam"}},
    )
