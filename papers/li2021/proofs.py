"""Formulas of the paper over its tables, for certificates, and the certificates of the paper's own conditions."""

from collections.abc import Mapping

import numpy as np

from gainsay.proof import Certificate, build
from gainsay.statements import Stated, scalar
from papers.li2021 import plant
from papers.li2021.statements import EQ12, LOOP, PLANT, TABLES, UNCERTAIN


def blocks(names: tuple[str, ...], entries: Mapping[tuple[str, str], str]) -> str:
    """Formula of a symmetric block matrix from its blocks on and above the diagonal; the others are zero."""
    rows = []
    for i, row in enumerate(names):
        cells = []
        for j, column in enumerate(names):
            key = (row, column) if j >= i else (column, row)
            cells.append("0" if key not in entries else entries[key] if j >= i else "...")
        rows.append("[" + ", ".join(cells) + "]")
    return "[" + ", ".join(rows) + "]"


def symmetric(**sizes: int) -> dict:
    """Declare symmetric unknowns by size."""
    return {name: {"shape": [size, size], "structure": "symmetric"} for name, size in sizes.items()}


def full(**shapes: tuple[int, int]) -> dict:
    """Declare unknowns without structure by shape."""
    return {name: {"shape": list(shape)} for name, shape in shapes.items()}


def disk_block(case, S: np.ndarray | None = None) -> Certificate:
    """(17) fails for all its scalars: multipliers of its rows 1a and 5a, which no scalar and no other unknown enters.

    V11 = V with (A0 + aI) V (A0 + aI)' > b^2 V exists because no open-loop pole lies in D(a, b).
    """
    from scipy.linalg import solve_discrete_lyapunov

    a, b = case.number("disk_centre"), case.number("disk_radius")
    A = plant.rigid(plant.constants(case)).A + a * np.eye(6)
    inverse = np.linalg.inv(A)
    V = solve_discrete_lyapunov(b * inverse, inverse @ inverse.T)
    V = (V + V.T) / 2
    # slack keeps the multiplier inside the cone, and what multiplies S non-negative
    room = 1e-4 * np.linalg.eigvalsh(A @ V @ A.T - b**2 * V)[0]
    Z = np.block([[V, V @ A.T / a], [A @ V / a, A @ V @ A.T / a**2 + room * np.eye(6)]])
    W = (A @ V @ A.T - b**2 * V) / a - a * room * np.eye(6)
    entries = {
        ("1a", "1a"): "-r*S + C.T @ C", ("1a", "5a"): "(A0 + a*eye(6)).T @ S", ("5a", "5a"): "-a*S",
    }  # fmt: skip
    return build.farkas(
        id="eq17-infeasible",
        paper=case.name,
        tables=case,
        statement="Rows 1a and 5a of (17), [[-(b^2/a) S + C'C, (A0 + aI)'S], [., -aS]] < 0, have no solution S > 0: "
        "they ask for the open-loop poles in D(a, b). No scalar of (17) and no other unknown enters them.",
        definitions=PLANT,
        unknowns=symmetric(S=6),
        fields={"constraints": [["rows 1a, 5a", f"{blocks(('1a', '5a'), entries)} < 0"], ["S", "S > 0"]]},
        multipliers={"rows 1a, 5a": Z, "S": W},
        quantities={"feasible": "eq17.feasible"},
        faith=(
            "That the terms of (1,5) in C_f are those that Lemma 2 takes out of the lost matrix Xi, so that row 1a, "
            "column 5a of (17) is A0'S + aS; with C_f left there the inequality would not be linear.",
        ),
    )


def lemma3_blocks(lam: str, gamma: str) -> str:
    """(12) after the change of variables, as `lmis.lemma3_synthesis`, nominal A; gamma stands for its square."""
    names = ("y", "x", "e", "d", "w", "o", "py", "px")
    entries = {
        ("y", "y"): "-r*Y", ("y", "x"): "-r*eye(6)", ("x", "x"): "-r*X",
        ("y", "e"): "-B", ("x", "e"): "-X @ B", ("y", "d"): "B", ("x", "d"): "X @ B",
        ("y", "w"): f"{lam} * (W @ (A0 @ Y + B @ Ch)).T", ("x", "w"): f"{lam} * (W @ A0).T",
        ("y", "o"): "Y @ C.T", ("x", "o"): "C.T",
        ("y", "py"): "(A0 @ Y + B @ Ch + a*Y).T", ("y", "px"): "(Ah + a*eye(6)).T",
        ("x", "py"): "(A0 + a*eye(6)).T", ("x", "px"): "(X @ A0 + Bh @ C + a*X).T",
        ("e", "e"): f"-({lam})**2 * eye(3)", ("e", "w"): f"-{lam} * (W @ B).T",
        ("d", "d"): f"-{gamma} * eye(3)", ("d", "w"): f"{lam} * (W @ B).T",
        ("w", "w"): "-eye(3)", ("o", "o"): "-eye(3)",
        ("py", "py"): "-a*Y", ("py", "px"): "-a*eye(6)", ("px", "px"): "-a*X",
    }  # fmt: skip
    return blocks(names, entries)


def lemma3_uncertain_blocks(lam: str, gamma: str, eps1: str) -> str:
    """The same with the border of the uncertainty Delta A = L Delta H K."""
    inner = lemma3_blocks(lam, gamma)
    border = (
        f"[[{eps1} * Y @ K.T, zeros(6, 12)], [{eps1} * K.T, zeros(6, 12)], [zeros(6, 12), zeros(6, 12)], "
        f"[zeros(3, 12), {lam} * W @ L], [zeros(3, 12), zeros(3, 12)], [zeros(6, 12), L], [zeros(6, 12), X @ L]]"
    )
    return f"[[{inner}, {border}], [..., -{eps1} * eye(24)]]"


LEMMA3_UNKNOWNS = {**symmetric(X=6, Y=6), **full(Ah=(6, 6), Bh=(6, 3), Ch=(3, 6)), "g2": {}}


def lemma3_point(case, name: str, values: Mapping, lam: str, *, quantity: str, uncertain=False) -> Certificate:
    """Gains exist with (12) at lambda: a point; its g2 bounds the square of the least gamma from above."""
    form = lemma3_uncertain_blocks(lam, "g2", "number('eps1')") if uncertain else lemma3_blocks(lam, "g2")
    return build.feasible_point(
        id=name,
        paper=case.name,
        tables=case,
        statement=f"(12) has a solution over all gains at lambda = {lam} with gamma^2 = g2.",
        definitions=(*PLANT, *UNCERTAIN),
        unknowns=LEMMA3_UNKNOWNS,
        fields={"constraints": [["(12)", f"{form} < 0"]], "minimise": "g2"},
        point=dict(values),
        quantities={"objective": quantity},
    )


def lemma3_bound(case, name: str, multiplier: np.ndarray, lam: str, *, quantity: str, uncertain=False) -> Certificate:
    """No gains satisfy (12) at lambda with a smaller gamma^2, by multipliers."""
    form = lemma3_uncertain_blocks(lam, "g2", "number('eps1')") if uncertain else lemma3_blocks(lam, "g2")
    return build.dual_bound(
        id=name,
        paper=case.name,
        tables=case,
        statement=f"Whatever the gains, (12) at lambda = {lam} needs gamma^2 of at least the bound.",
        definitions=(*PLANT, *UNCERTAIN),
        unknowns=LEMMA3_UNKNOWNS,
        fields={"constraints": [["(12)", f"{form} < 0"]], "minimise": "g2"},
        multipliers={"(12)": multiplier},
        quantities={"objective": quantity},
    )


def lemma4_against_lemma3(case, multipliers: Mapping[str, np.ndarray]) -> Certificate:
    """(19) with the printed C_f, and (12) at lambda = 1 in the structure of Theorem 1, exclude each other."""
    top = {("a", "a"): "-r*S", ("a", "b"): "-r*S", ("b", "b"): "-r*Y", ("a", "e"): "-S @ M", ("b", "e"): "-Y @ M",
           ("e", "e"): "-number('lambda')**2 * eye(3)"}  # fmt: skip
    bottom = {
        ("u", "u"): "-(number('u_max')**2 - number('eps3') * number('delta_m')**2) * eye(3)",
        ("u", "a"): "-printed('Cf')[0:3, 3:6]",
        ("a", "a"): "-S / theta", ("a", "b"): "-S / theta", ("b", "b"): "-Y / theta",
        ("a", "f"): "printed('Cf')[0:3, 3:6].T", ("f", "f"): "-number('eps3') * eye(3)",
    }  # fmt: skip
    return build.farkas(
        id="eq19-against-eq12",
        paper=case.name,
        tables=case,
        statement="No S and Y = S - N satisfy both (19) with the printed C_f and rows 1 and 2 of (12) at lambda = 1 "
        "with the structured P of Theorem 1: already the rows of the rates exclude each other.",
        definitions=(*PLANT, ("theta", "number('theta')")),
        unknowns=symmetric(S=3, Y=3),
        fields={
            "constraints": [
                ["(12), rows 1 and 2", f"{blocks(('a', 'b', 'e'), top)} < 0"],
                ["(19)", f"{blocks(('u', 'a', 'b', 'f'), bottom)} <= 0"],
            ]
        },
        multipliers=multipliers,
        quantities={"feasible": "eq19.feasible_with_eq12"},
    )


#: (10) with the printed gains and nominal A
PRINTED_LOOP = {
    "Af": "printed('Af')", "Bf": "printed('Bf')", "Cf": "printed('Cf')", "A": "A0", "Ad": "Af", "Bd": "Bf", "Cd": "Cf",
}  # fmt: skip


def printed_gains(case, *, fails: bool) -> Stated:
    """(12) with the printed gains: at lambda = 1 without its row of d~, or with the least gamma^2 at lambda = 3."""
    texts = {**TABLES, **PRINTED_LOOP, **LOOP}
    if fails:
        rows = [row for row in EQ12.rows if row != "3"]
        return Stated(case, [EQ12.sub(*rows).defining(**texts) < 0], label="(12)")
    texts |= {"lam": "number('lambda_pass')", "g": "g2"}
    return Stated(case, [EQ12.defining(unknowns={"g2": scalar()}, **texts) < 0], minimise="g2", label="(12)")


def printed_gains_fail(case, multiplier: np.ndarray) -> Certificate:
    """The printed gains violate (12) at the paper's lambda for every P and every gamma."""
    return build.farkas(
        id="eq12-printed-infeasible",
        paper=case.name,
        statement="With the printed gains and the paper's lambda, (12) has no solution even without its row of d~.",
        multipliers={"(12)": multiplier},
        quantities={"feasible": "eq12.printed_feasible"},
        **printed_gains(case, fails=True).parts(),
    )


def printed_gains_pass(case, P: np.ndarray, square: float) -> Certificate:
    """The printed gains satisfy (12) at lambda = 3."""
    return build.feasible_point(
        id="eq12-printed-feasible",
        paper=case.name,
        statement="With the printed gains, nominal A and lambda = 3, (12) holds with gamma^2 = g2.",
        point={"P": P, "g2": square},
        quantities={"objective": "lemma3.printed_gamma_min_squared"},
        **printed_gains(case, fails=False).parts(),
    )


def printed_gains_bound(case, multiplier: np.ndarray) -> Certificate:
    """Least gamma^2 of the printed gains in (12) at lambda = 3, from below."""
    return build.dual_bound(
        id="eq12-printed-bound",
        paper=case.name,
        statement="With the printed gains, nominal A and lambda = 3, (12) needs gamma^2 of at least the bound.",
        multipliers={"(12)": multiplier},
        quantities={"objective": "lemma3.printed_gamma_min_squared"},
        **printed_gains(case, fails=False).parts(),
    )


def lemma3_feasible(case, name: str, values: Mapping, lam: str, end: str) -> Certificate:
    """(12) has a solution over all gains at the paper's gamma and a lambda near an end of the band."""
    unknowns = {key: value for key, value in LEMMA3_UNKNOWNS.items() if key != "g2"}
    return build.feasible_point(
        id=name,
        paper=case.name,
        tables=case,
        statement=f"(12) has a solution over all gains at lambda = {lam} and the paper's gamma.",
        definitions=(*PLANT, *UNCERTAIN),
        unknowns={**unknowns, "lam": {}},
        fields={
            "constraints": [["(12)", f"{lemma3_blocks('lam', 'number(' + repr('gamma') + ')**2')} < 0"]],
            "minimise" if end == "low" else "maximise": "lam",
        },
        point={**{key: values[key] for key in unknowns}, "lam": float(lam)},
        quantities={"objective": f"lemma3.lambda_{end}"},
    )


def lemma3_infeasible(case, name: str, multiplier: np.ndarray, lam: str, quantity: str) -> Certificate:
    """(12) has no solution over all gains at the paper's gamma and one lambda outside the band."""
    unknowns = {key: value for key, value in LEMMA3_UNKNOWNS.items() if key != "g2"}
    return build.farkas(
        id=name,
        paper=case.name,
        tables=case,
        statement=f"(12) has no solution over all gains at lambda = {lam} and the paper's gamma.",
        definitions=(*PLANT, *UNCERTAIN),
        unknowns=unknowns,
        fields={"constraints": [["(12)", f"{lemma3_blocks(lam, 'number(' + repr('gamma') + ')**2')} < 0"]]},
        multipliers={"(12)": multiplier},
        quantities={"feasible": quantity},
    )
