"""Certificates of the synthesis: what is proved of the paper's inequalities, its printed digits and the designs."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from gainsay.exact.rational import shorten
from gainsay.proof import Certificate, build
from gainsay.tables import Case
from papers.wan2014.formulas import (
    EQUATION_14,
    EQUATION_14_CORRECTED,
    GAIN,
    SUBPROBLEM_14,
    SYMMETRIC_6,
    SYSTEM,
    closed_loop,
    model,
)
from papers.wan2014.plant import AXES


def infeasible_14(case: Case, solution: Mapping[str, Any]) -> Certificate:
    """Prove that (14) has no solution, for any e, m, Q, R; (15), (30), (31), (37) are not even needed.

    Parameters
    ----------
    solution : mapping
        V1, V2 (its first three rows), V3 of `lmis.farkas_multipliers`, of any trace.
    """
    V1, V3 = solution["V1"], solution["V3"]
    V2 = np.vstack([solution["V2"], V1[3:]])
    V = np.zeros((36, 36))
    V[:12, :12] = np.block([[V1, V2], [V2.T, V3]])
    definitions = model(case)
    for free in ("Rinverse", "Qinverse", "x0"):
        del definitions[free]
    # mass and eccentricity are indeterminates here
    definitions["B"] = "[[zeros(3,3)], [inverse_mass*eye(3)]]"
    definitions["E1"] = "e*printed('E1_over_e')"
    E1 = case.matrix("E1_over_e")
    A, Ac = _floats(case)
    W = V1 @ A + A.T @ V1 + V3 @ Ac + Ac.T @ V3
    both = np.vstack([E1, E1])
    return build.farkas(
        id="eq14-infeasible",
        paper=case.name,
        statement="No X > 0, Y and eps > 0 satisfy (14) with the printed L, whatever Q, R, m and e.",
        tables=case,
        definitions=definitions,
        unknowns={
            "X": SYMMETRIC_6,
            "Y": GAIN,
            "eps": {},
            "e": {},
            "inverse_mass": {},
            "Rinverse": {"shape": [3, 3], "structure": "symmetric"},
            "Qinverse": SYMMETRIC_6,
        },
        fields={
            "constraints": [["(14)", f"{EQUATION_14} < 0"], ["X", "X > 0"], ["eps", "eps > 0"]],
            "congruences": {"eps": "e"},
        },
        multipliers={"(14)": V, "X": W, "eps": [[float(np.trace(both.T @ V[:12, :12] @ both))]]},
        quantities={"feasible": "eq14.feasible"},
        faith=["That a program with (14) among its constraints, such as (38), has no solution where (14) has none."],
    )


def _floats(case: Case) -> tuple[np.ndarray, np.ndarray]:
    from papers.wan2014.lmis import Problem

    problem = Problem(case)
    return problem.model.A, problem.observer


def wrong_diagonal(case: Case) -> Certificate:
    """Prove that the printed X contradicts block (2,2) of (14): its entry in row 4 is positive for all its digits."""
    return build.certificate(
        "farkas",
        id="eq14-printed-diagonal",
        paper=case.name,
        statement="No X that rounds to (43) and no eps > 0 make the diagonal of block (2,2) of (14) negative in row 4.",
        tables=case,
        definitions={k: v for k, v in model(case).items() if k in ("n", "A", "E1", "Ac")},
        unknowns={"X": SYMMETRIC_6, "eps": {}},
        fields={
            "constraints": [["row 4", "(sym(Ac@X) + eps*E1@E1.T)[3,3] < 0"], ["eps", "eps > 0"]],
            "boxes": {"X": "X"},
        },
        witness={"row 4": "1", "eps": _square_of_row(case)},
        quantities={"feasible": "eq14.printed_diagonal_negative"},
    )


def _square_of_row(case: Case) -> str:
    row = [x.value * case.exact("eccentricity") for x in case.printed("E1_over_e").rows[3]]
    total = sum(x * x for x in row)
    return f"{total.numerator}/{total.denominator}"


def subproblem_constraints(saturated: bool) -> list[list[str]]:
    """Return the constraints of `lmis.state_feedback`, in its order and under its labels."""
    rows = [["(14)", f"{SUBPROBLEM_14} < 0"], ["(30)", "[[-1, x0.T], [..., -X]] < 0"]]
    for i, axis in enumerate(AXES if saturated else ""):
        rows.append([f"(31) {axis}", f"[[-X, Y[{i},0:6].T], [..., -number('thrust_max_{axis}')**2/2]] < 0"])
    return [*rows, ["eps", "eps > 0"], ["rho", "rho > 0"]]


def _subproblem(case: Case, which: str, saturated: bool) -> dict[str, Any]:
    sentence = "with (30) at e(0) = 0" + (" and (31)" if saturated else ", without (31)")
    return {
        "paper": case.name,
        "tables": case,
        "definitions": model(case),
        "unknowns": {"X": SYMMETRIC_6, "Y": GAIN, "eps": {}, "rho": {}},
        "fields": {"constraints": subproblem_constraints(saturated), "minimise": "rho"},
        "quantities": {"objective": f"subproblem.{which}"},
        "faith": ["That X <- rho X, Y <- rho Y, eps <- rho eps turns (14), (30), (31) into the constraints here."],
        "sentence": f"block rows 1, 3, 5, 7 of (14) {sentence}",
    }


def subproblem_above(case: Case, point: Mapping[str, Any], which: str, saturated: bool) -> Certificate:
    """Bound the infimum of rho from above by a point."""
    parts = _subproblem(case, which, saturated)
    sentence = parts.pop("sentence")
    return build.feasible_point(
        id=f"subproblem-{which.replace('_', '-')}-above",
        statement=f"A point satisfies {sentence}; its rho bounds the infimum from above.",
        point={name: point[name] for name in ("X", "Y", "eps", "rho")},
        **parts,
    )


def subproblem_below(case: Case, multipliers: Mapping[str, Any], which: str, saturated: bool) -> Certificate:
    """Bound the infimum of rho from below by multipliers, labelled as in `lmis.state_feedback`."""
    parts = _subproblem(case, which, saturated)
    sentence = parts.pop("sentence")
    renamed = {"(14) 1,3,5,7": "(14)", "eps > 0": "eps", "rho > 0": "rho"}
    return build.dual_bound(
        id=f"subproblem-{which.replace('_', '-')}-below",
        statement=f"No point of {sentence} has a smaller rho.",
        multipliers={renamed.get(name, name): value for name, value in multipliers.items()},
        **parts,
    )


def cost_certificate(
    case: Case,
    gain: str,
    solution: Mapping[str, Any],
    *,
    id: str,
    quantity: str,
    stable: str | None = None,
) -> Certificate:
    """Prove stability and a bound on J from xi(0), for every |Lambda_ii| <= 1, also time-varying.

    Parameters
    ----------
    gain : str
        Formula of K.
    solution : mapping
        P (12x12) and S (diagonal) of `lmis.cost_bound`.
    """
    xi0 = _xi0(case)
    bound = float((xi0.T @ solution["P"] @ xi0)[0, 0])
    quantities = {"cost": quantity} | ({"stable": stable} if stable else {})
    return build.certificate(
        "quadratic_bound",
        id=id,
        paper=case.name,
        statement="J of (4) is at most this bound on model (1) with observer (7), for every |Lambda_ii(t)| <= 1.",
        tables=case,
        definitions=closed_loop(case, gain),
        fields=SYSTEM | {"Q": "weight", "cost": f"{bound * (1 + 1e-8):.10e}"},
        witness=_quadratic_witness(solution),
        quantities=quantities,
    )


def thrust_certificate(
    case: Case, gain: str, solution: Mapping[str, Any], axis: int, *, id: str, quantity: str
) -> Certificate:
    """Prove a bound on the thrust along an axis from xi(0); `solution` is that of `lmis.thrust_bound`."""
    bound = float(np.sqrt(solution["square"])) * (1 + 1e-7)
    return build.certificate(
        "quadratic_bound",
        id=id,
        paper=case.name,
        statement=f"|f_{AXES[axis]}| stays below this bound on model (1) with observer (7), if |Lambda_ii(t)| <= 1.",
        tables=case,
        definitions=closed_loop(case, gain),
        fields=SYSTEM | {"inputs": [{"of": "thrust", "row": f"k[{axis},0:12]", "bound": f"{bound:.10e}"}]},
        witness=_quadratic_witness(solution),
        quantities={"thrust": quantity},
    )


def _xi0(case: Case) -> np.ndarray:
    x0 = case.matrix("x0").reshape(6, 1)
    return np.vstack([x0, np.zeros((3, 1)), x0[3:]])


def _quadratic_witness(solution: Mapping[str, Any]) -> dict[str, Any]:
    return {"P": solution["P"]} | {f"D{i + 1}": [[float(s)]] for i, s in enumerate(np.diagonal(solution["S"]))}


def corrected_14(case: Case, solution: Mapping[str, Any]) -> Certificate:
    """Prove that (14) stays infeasible where the misprint of its input columns is corrected; see `infeasible_14`."""
    printed = infeasible_14(case, solution)
    rows = [line[:33] for line in printed.witness["(14)"][:33]]
    draft = printed.changed(
        id="eq14-corrected-infeasible",
        statement="(14) with one input column [Y'; -Y'] has no solution either, whatever Q, R, m and e.",
        fields={
            **printed.fields,
            "constraints": [["(14)", f"{EQUATION_14_CORRECTED} < 0"], *printed.fields["constraints"][1:]],
        },
        witness={**printed.witness, "(14)": rows},
        conclusions=(),
    )
    return build.finish(draft, case, {"feasible": "eq14_corrected.feasible"})


def input_counted_twice(case: Case) -> Certificate:
    """Prove that the two input columns of (14) give 2 K'RK where (24) has K'RK."""
    return build.certificate(
        "identity",
        id="eq14-input-twice",
        paper=case.name,
        statement="The Schur complement of the input columns of (14) is twice the term [K, -K]' R [K, -K] of (24).",
        tables=case,
        unknowns={"K": GAIN, "R": {"shape": [3, 3], "structure": "symmetric"}},
        definitions={"column": "[[K.T], [-K.T]]"},
        fields={
            "left": "[[K.T, -K.T], [-K.T, K.T]] @ diag(R, R) @ [[K.T, -K.T], [-K.T, K.T]].T",
            "right": "2*(column @ R @ column.T)",
        },
        quantities={"identity": "eq14.input_counted_twice"},
    )


def infeasible_29(case: Case) -> Certificate:
    """Prove that (29) as printed has no solution: rho > 0 stands where -rho should."""
    return build.certificate(
        "farkas",
        id="eq29-infeasible",
        paper=case.name,
        statement="No rho > 0 and P satisfy (29) as printed: its first diagonal entry is rho.",
        tables=case,
        definitions={"x0": "printed('x0')", "xi0": "[[x0], [zeros(6,1)]]"},
        unknowns={"P": SYMMETRIC_6, "rho": {}},
        fields={"constraints": [["(29)", "[[rho, xi0.T], [..., -diag(P, P)]] < 0"], ["rho", "rho > 0"]]},
        witness={"(29)": [["1" if i == j == 0 else "0" for j in range(13)] for i in range(13)], "rho": "1"},
        quantities={"feasible": "eq29.feasible"},
    )


def empty_row_14(case: Case) -> Certificate:
    """Prove that block row 4 of (14) says only eps > 0: beside -eps I it holds zeros."""
    return build.certificate(
        "identity",
        id="eq14-empty-row",
        paper=case.name,
        statement="In (14) block row 4 holds nothing but -eps I: its off-diagonal blocks are zero.",
        tables=case,
        definitions={k: v for k, v in model(case).items() if k not in ("Rinverse", "Qinverse", "x0")},
        unknowns={
            "X": SYMMETRIC_6,
            "Y": GAIN,
            "eps": {},
            "Rinverse": {"shape": [3, 3], "structure": "symmetric"},
            "Qinverse": SYMMETRIC_6,
        },
        fields={
            "left": f"({EQUATION_14})[18:24,0:36]",
            "right": "row(zeros(6,18), -eps*eye(6), zeros(6,12))",
        },
        quantities={"identity": "eq14.row_4_empty"},
    )


def consistent_digits(case: Case, X: np.ndarray, K: np.ndarray) -> Certificate:
    """Prove that (43) and (44) agree: some X, Y and K within their printed digits satisfy Y = K X exactly."""
    exact_x = [[shorten(float(x), 12) for x in row] for row in (X + X.T) / 2]
    exact_k = [[shorten(float(x), 12) for x in row] for row in K]
    product = [[sum(k * x for k, x in zip(row, column, strict=True)) for column in zip(*exact_x, strict=True)]
               for row in exact_k]  # fmt: skip
    return build.certificate(
        "linear_box",
        id="eq44-consistent",
        paper=case.name,
        statement="X and Y that round to (43) and K that rounds to (44) satisfy K X = Y.",
        tables=case,
        unknowns={"X": SYMMETRIC_6, "Y": GAIN, "K": GAIN},
        fields={
            "constraints": [["(44)", "Y - K@X == zeros(3,6)"]],
            "boxes": {"X": "X", "Y": "Y", "K": "K"},
            "answer": "holds",
        },
        witness={"X": exact_x, "Y": product, "K": exact_k},
        quantities={"feasible": "eq44.consistent"},
    )


def box_point(case: Case, point: Mapping[str, Any]) -> Certificate:
    """Prove that some X and Y that round to (43) satisfy the sub-problem; `point` is one of `lmis.printed_box`."""
    saturation = [
        [f"(31) {axis}", f"[[-X, Y[{i},0:6].T], [..., -number('thrust_max_{axis}')**2/2*inverse_rho]] < 0"]
        for i, axis in enumerate(AXES)
    ]
    equation = SUBPROBLEM_14.replace("rho*", "")
    return build.feasible_point(
        id="subproblem-printed-digits",
        paper=case.name,
        statement="X and Y that round to (43) satisfy block rows 1, 3, 5, 7 of (14), (30) at e(0) = 0 and (31).",
        tables=case,
        definitions=model(case),
        unknowns={"X": SYMMETRIC_6, "Y": GAIN, "eps": {}, "inverse_rho": {}},
        fields={
            "constraints": [
                ["(14)", f"{equation} < 0"],
                ["(30)", "[[-inverse_rho, inverse_rho*x0.T], [..., -X]] < 0"],
                *saturation,
            ],
            "boxes": {"X": "X", "Y": "Y"},
        },
        point={name: point[name] for name in ("X", "Y", "eps", "inverse_rho")},
        quantities={"feasible": "box.feasible"},
    )


def _margin(case: Case) -> dict[str, Any]:
    """Return what both proofs about `farkas.margin` share; its constraints are those of `lmis.farkas_multipliers`."""
    velocities = "[[zeros(3,3), zeros(3,3)], [zeros(3,3), eye(3)]]"
    full = f"[[eye(3)], [zeros(3,3)]]@V2 + {velocities}@V1"
    return {
        "paper": case.name,
        "tables": case,
        "definitions": {k: v for k, v in model(case).items() if k in ("n", "A", "Ac")},
        "unknowns": {"V1": SYMMETRIC_6, "V2": GAIN, "V3": SYMMETRIC_6, "level": {}},
        "fields": {
            "constraints": [
                ["V", f"[[V1, {full}], [..., V3]] >= 0"],
                ["W", "sym(V1@A) + sym(V3@Ac) - level*eye(6) >= 0"],
                ["trace V", "trace(V1) + trace(V3) == 1"],
            ],
            "maximise": "level",
        },
        "quantities": {"objective": "farkas.margin"},
    }


def margin_above(case: Case, multipliers: Mapping[str, Any]) -> Certificate:
    """Bound the margin of the refutation from above by multipliers of `lmis.farkas_multipliers`."""
    return build.dual_bound(
        id="farkas-margin-above",
        statement="No multipliers of trace one refute (14) with a larger margin.",
        multipliers={name: np.atleast_2d(value) for name, value in multipliers.items()},
        **_margin(case),
    )


def margin_below(case: Case, point: Mapping[str, Any]) -> Certificate:
    """Bound the margin of the refutation from below by a point of `lmis.farkas_multipliers`."""
    return build.feasible_point(
        id="farkas-margin-below",
        statement="Multipliers of trace one refute (14) with at least this margin.",
        point={name: point[name] for name in ("V1", "V2", "V3", "level")},
        **_margin(case),
    )
