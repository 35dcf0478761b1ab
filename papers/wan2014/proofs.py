"""Certificates of the synthesis: what is proved of the paper's inequalities, its printed digits and the designs."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from gainsay.exact.rational import shorten
from gainsay.proof import Certificate, build
from gainsay.results import Results
from gainsay.statements import Stated, identical, matrix, optimum, scalar, symmetric
from gainsay.tables import Case
from papers.wan2014.plant import AXES
from papers.wan2014.statements import EQ14, EQ29, OBSERVER, SYSTEM, closed_loop, farkas_multipliers

GAIN = matrix(3, 6).entry()
SYMMETRIC_6 = symmetric(6).entry()


def infeasible_14(case: Case, solution: Mapping[str, Any], edition: str = "printed") -> Certificate:
    """Prove that (14) has no solution, for any e, m, Q, R; (15), (30), (31), (37) are not even needed.

    Its first two block rows and columns, in which the editions agree, have none.

    Parameters
    ----------
    solution : mapping
        V1, V2 (its first three rows), V3 of `statements.farkas_multipliers`, of any trace.
    edition : {"printed", "corrected"}
    """
    V1, V3 = solution["V1"], solution["V3"]
    V2 = np.vstack([solution["V2"], V1[3:]])
    V = np.block([[V1, V2], [V2.T, V3]])
    both = np.vstack([case.matrix("E1_over_e")] * 2)
    # mass and eccentricity are indeterminates here
    core = EQ14.sub("x", "e").defining(
        unknowns={"e": scalar(), "inverse_mass": scalar()},
        B="[[zeros(3,3)], [inverse_mass*eye(3)]]",
        E1="e*printed('E1_over_e')",
    )
    stated = Stated(case, [core < 0, "X > 0"], label="(14)")
    parts = stated.parts()
    A, Ac = (stated.floats().constant(text) for text in ("A", "A - L@C"))
    W = V1 @ A + A.T @ V1 + V3 @ Ac + Ac.T @ V3
    eps = [[float(np.trace(both.T @ V @ both))]]
    printed = edition == "printed"
    return build.farkas(
        id="eq14-infeasible" if printed else "eq14-corrected-infeasible",
        statement=f"No X > 0, Y and eps > 0 satisfy (14){'' if printed else ' with one input column'} with the printed "
        "L, whatever Q, R, m and e: its first two block rows and columns already have no solution.",
        **{**parts, "fields": {**parts["fields"], "congruences": {"eps > 0": "e"}}},
        multipliers={"(14)": V, "X > 0": W, "eps > 0": eps},
        quantities={"feasible": "eq14.feasible" if printed else "eq14_corrected.feasible"},
        faith=[
            "That the first two block rows and columns of a negative definite matrix are negative definite.",
            "That a program with (14) among its constraints, such as (38), has no solution where (14) has none.",
        ],
    )


def wrong_diagonal(case: Case) -> Certificate:
    """Prove that the printed X contradicts block (2,2) of (14): its entry in row 4 is positive for all its digits."""
    row = [x.value * case.exact("eccentricity") for x in case.printed("E1_over_e").rows[3]]
    square = sum(x * x for x in row)
    return build.certificate(
        "farkas",
        id="eq14-printed-diagonal",
        statement="No X that rounds to (43) and no eps > 0 make the diagonal of block (2,2) of (14) negative in row 4.",
        tables=case,
        definitions={**OBSERVER, "E1": "number('eccentricity')*printed('E1_over_e')"},
        unknowns={"X": SYMMETRIC_6, "eps": scalar().entry()},
        fields={
            "constraints": [["row 4", f"({EQ14.block('e', 'e')})[3,3] < 0"], ["eps", "eps > 0"]],
            "boxes": {"X": "X"},
        },
        witness={"row 4": "1", "eps": f"{square.numerator}/{square.denominator}"},
        quantities={"feasible": "eq14.printed_diagonal_negative"},
    )


def quadratic(case: Case, gain: str, solution: Mapping[str, Any], *, statement: str, fields: dict, **more: Any) -> Any:
    """Prove what a 12x12 Lyapunov matrix with one multiplier a channel says of every |Lambda_ii(t)| <= 1."""
    witness = {"P": solution["P"]} | {f"D{i + 1}": [[float(s)]] for i, s in enumerate(np.diagonal(solution["S"]))}
    return build.certificate(
        "quadratic_bound",
        tables=case,
        definitions=closed_loop(case, gain),
        fields=SYSTEM | fields,
        statement=statement,
        witness=witness,
        **more,
    )


def cost_certificate(
    case: Case, gain: str, solution: Mapping[str, Any], *, id: str, quantities: Mapping[str, str]
) -> Certificate:
    """Prove stability and a bound on J from xi(0); `solution` is that of `statements.cost_bound`."""
    start = case.matrix("x0").reshape(6, 1)
    xi0 = np.vstack([start, np.zeros((3, 1)), start[3:]])
    bound = float((xi0.T @ solution["P"] @ xi0)[0, 0])
    return quadratic(
        case,
        gain,
        solution,
        id=id,
        quantities=quantities,
        statement="J of (4) is at most this bound on model (1) with observer (7), for every |Lambda_ii(t)| <= 1.",
        fields={"Q": "weight", "cost": f"{bound * (1 + 1e-8):.10e}"},
    )


def thrust_certificate(
    case: Case, gain: str, solution: Mapping[str, Any], axis: int, *, id: str, quantity: str
) -> Certificate:
    """Prove a bound on the thrust along an axis from xi(0); `solution` is that of `statements.thrust_bound`."""
    bound = float(np.sqrt(solution["square"])) * (1 + 1e-7)
    return quadratic(
        case,
        gain,
        solution,
        id=id,
        quantities={"thrust": quantity},
        statement=f"|f_{AXES[axis]}| stays below this bound on model (1) with observer (7), if |Lambda_ii(t)| <= 1.",
        fields={"inputs": [{"of": "thrust", "row": f"k[{axis},0:12]", "bound": f"{bound:.10e}"}]},
    )


def input_counted_twice(case: Case) -> Certificate:
    """Prove that the two input columns of (14) give 2 K'RK where (24) has K'RK."""
    return identical(
        case,
        "eq14.input_counted_twice",
        "The Schur complement of the input columns of (14) is twice the term [K, -K]' R [K, -K] of (24).",
        "[[K.T, -K.T], [-K.T, K.T]] @ diag(R, R) @ [[K.T, -K.T], [-K.T, K.T]].T",
        "2*(column @ R @ column.T)",
        {"K": matrix(3, 6), "R": symmetric(3)},
        id="eq14-input-twice",
        definitions={"column": "[[K.T], [-K.T]]"},
    )


def infeasible_29(case: Case) -> Certificate:
    """Prove that (29) as printed has no solution: rho > 0 stands where -rho should."""
    stated = Stated(case, [EQ29 < 0], label="(29)")
    return build.certificate(
        "farkas",
        id="eq29-infeasible",
        statement="No rho > 0 and P satisfy (29) as printed: its first diagonal entry is rho.",
        witness={"(29)": [["1" if i == j == 0 else "0" for j in range(13)] for i in range(13)], "rho > 0": "1"},
        quantities={"feasible": "eq29.feasible"},
        **stated.parts(),
    )


def empty_row_14(case: Case) -> Certificate:
    """Prove that block row 4 of (14) says only eps > 0: beside -eps I it holds zeros."""
    stated = Stated(case, [EQ14 < 0])
    return identical(
        case,
        "eq14.row_4_empty",
        "In (14) block row 4 holds nothing but -eps I: its off-diagonal blocks are zero.",
        f"({EQ14.formula})[18:24,0:36]",
        "row(zeros(6,18), -eps*eye(6), zeros(6,12))",
        stated.unknowns,
        id="eq14-empty-row",
        definitions=stated.parts()["definitions"],
    )


def consistent_digits(case: Case, X: np.ndarray, K: np.ndarray) -> Certificate:
    """Prove that (43) and (44) agree: some X, Y and K within their printed digits satisfy Y = K X exactly."""
    exact_x = [[shorten(float(x), 12) for x in row] for row in (X + X.T) / 2]
    exact_k = [[shorten(float(x), 12) for x in row] for row in K]
    product = [
        [sum(k * x for k, x in zip(row, column, strict=True)) for column in zip(*exact_x, strict=True)]
        for row in exact_k
    ]
    return build.certificate(
        "linear_box",
        id="eq44-consistent",
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


def largest(results: Results, quantity: str, stated: Stated, formula: str, *, id: str, statement: str) -> Any:
    """Enclose the supremum of a formula over a program by a point below and multipliers above, each a certificate.

    Returns
    -------
    least : Infimum
        Of minus the formula.
    ends : dict
        Keys lower and upper, as `Results.quantity` takes them.
    """
    least = optimum(results, stated.changed(minimise=f"-({formula})"))
    parts = stated.parts()
    parts["fields"] = {**parts["fields"], "maximise": formula}
    parts["fields"].pop("minimise", None)
    labels = {constraint.label for constraint in stated.constraints}
    below = build.feasible_point(
        id=f"{id}-below",
        statement=f"{statement}: a point bounds it from below.",
        point={name: least.solved.values[name] for name in stated.unknowns},
        quantities={"objective": quantity},
        **parts,
    )
    above = build.dual_bound(
        id=f"{id}-above",
        statement=f"{statement}: multipliers bound it from above.",
        multipliers={n: np.atleast_2d(z) for n, z in least.multipliers.items() if n in labels},
        quantities={"objective": quantity},
        **parts,
    )
    for certificate in (below, above):
        results.certificate(certificate)
    return least, {end: float(c.conclusions[-1].value or "nan") for end, c in (("lower", below), ("upper", above))}


def margin(results: Results) -> Any:
    """Enclose the margin of the refutation of (14)."""
    return largest(
        results,
        "farkas.margin",
        farkas_multipliers(results.case),
        "level",
        id="farkas-margin",
        statement="Margin with which multipliers of trace one refute (14)",
    )
