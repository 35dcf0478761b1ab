"""The derivations of li2021 as implications that hold for every plant: Theorem 1, Appendices I and II."""

from gainsay.proof import Certificate
from gainsay.results import Results, task
from gainsay.statements import Step, implication, symmetric
from gainsay.statements.unknowns import matrix
from gainsay.tables import Case
from papers.li2021.statements import (
    EQ12,
    EQ15,
    EQ_A1,
    EQ_A4,
    EQ_A5,
    LOOP,
    PLANT_UNKNOWNS,
    all_gains,
    equation_13,
    linear_13,
)

#: P and Gamma_1 of the proof of Theorem 1
STRUCTURE = {"Y": "S - N", "P": "[[Y, N], [N, -N]]", "G1": "[[eye(6), eye(6)], [eye(6), zeros(6, 6)]]"}
G1_INVERSE = "[[zeros(6, 6), eye(6)], [eye(6), -eye(6)]]"
SN = {"S": symmetric(6), "N": symmetric(6)}


@task("Appendix I")
def appendix_1(case: Case, results: Results) -> None:
    """(A.1), (A.5) and (A.4) from (12)."""
    moved = "(A_t + a * eye(12)) / a"
    results.prove(
        implication(
            case,
            id="appendix1-a1",
            quantity="appendix1.a1",
            sentence="(12) gives (A.1), by the Schur complement of its last row.",
            given=[EQ12 < 0],
            then=EQ_A1 < 0,
            by=[
                Step(
                    "(12)",
                    f"col(eye(12), zeros(3, 12), zeros(3, 12), zeros(3, 12), zeros(3, 12), {moved})",
                    left_inverse="row(eye(12), zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 12))",
                )
            ],
        ),
        source="(A.1)",
    )
    schur = (
        "[[eye(12), zeros(12, 3), zeros(12, 3)], [zeros(3, 12), eye(3), zeros(3, 3)], "
        "[zeros(3, 12), zeros(3, 3), eye(3)], [lam * W_t @ A_t, -lam * W_t @ E_t, lam * W_t @ B_t], "
        f"[C_t, zeros(3, 3), zeros(3, 3)], [{moved}, zeros(12, 3), zeros(12, 3)]]"
    )
    first = (
        "[[eye(12), zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 12)], "
        "[zeros(3, 12), eye(3), zeros(3, 3), zeros(3, 3), zeros(3, 3), zeros(3, 12)], "
        "[zeros(3, 12), zeros(3, 3), eye(3), zeros(3, 3), zeros(3, 3), zeros(3, 12)]]"
    )
    results.prove(
        implication(
            case,
            id="appendix1-a5",
            quantity="appendix1.a5",
            sentence="(12) gives (A.5), by the Schur complement of its last three rows.",
            given=[EQ12 < 0],
            then=EQ_A5 < 0,
            by=[Step("(12)", schur, left_inverse=first)],
        ),
        source="(A.5)",
    )
    results.prove(
        implication(
            case,
            id="appendix1-a4",
            quantity="appendix1.a4",
            sentence="(A.5) and P > 0 give Phi_1 < 0, where b < a makes c = a - b^2/a positive.",
            given=[EQ_A5 < 0, "P > 0"],
            then=EQ_A4 < 0,
            positive=["c"],
            expand={"r": "a - c"},
            unknowns={"c": EQ12.unknowns["a"]},
            by=[
                Step("(A.5)", "eye(18)", left_inverse="eye(18)"),
                Step("P > 0", "row(A_t, zeros(12, 3), zeros(12, 3))", scale="1 / a"),
                Step("P > 0", "row(eye(12), zeros(12, 3), zeros(12, 3))", scale="c"),
            ],
        ),
        source="(A.4)",
    )
    results.say("Appendix I", "(A.1), (A.5), (A.4) follow from (12)")


@task("proof of Theorem 1")
def structure(case: Case, results: Results) -> None:
    """P > 0 if and only if S > 0 and N < 0; (15) from (12)."""
    results.prove(
        implication(
            case,
            id="theorem1-p-positive",
            quantity="theorem1.p_positive",
            sentence="S > 0 and N < 0 give P > 0.",
            given=["diag(S, -N) > 0"],
            then="P > 0",
            expand=STRUCTURE,
            unknowns=SN,
            by=[
                Step(
                    "diag(S, -N) > 0",
                    "[[eye(6), zeros(6, 6)], [eye(6), -eye(6)]]",
                    left_inverse="[[eye(6), zeros(6, 6)], [eye(6), -eye(6)]]",
                )
            ],
        ),
        source="Theorem 1",
    )
    results.prove(
        implication(
            case,
            id="theorem1-p-needs",
            quantity="theorem1.p_needs",
            sentence="P > 0 gives S > 0 and N < 0.",
            given=["P > 0"],
            then="diag(S, -N) > 0",
            expand=STRUCTURE,
            unknowns=SN,
            by=[
                Step(
                    "P > 0",
                    "[[eye(6), zeros(6, 6)], [eye(6), -eye(6)]]",
                    left_inverse="[[eye(6), zeros(6, 6)], [eye(6), -eye(6)]]",
                )
            ],
        ),
        source="Theorem 1",
    )
    factor = (
        "[[G1, zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 12)], "
        "[zeros(3, 12), eye(3), zeros(3, 3), zeros(3, 3), zeros(3, 12)], "
        "[zeros(3, 12), zeros(3, 3), eye(3), zeros(3, 3), zeros(3, 12)], "
        "[zeros(3, 12), zeros(3, 3), zeros(3, 3), eye(3), zeros(3, 12)], "
        "[C_t @ G1, zeros(3, 3), zeros(3, 3), zeros(3, 3), zeros(3, 12)], "
        "[zeros(12, 12), zeros(12, 3), zeros(12, 3), zeros(12, 3), G1]]"
    )
    back = (
        f"[[{G1_INVERSE}, zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 12)], "
        "[zeros(3, 12), eye(3), zeros(3, 3), zeros(3, 3), zeros(3, 3), zeros(3, 12)], "
        "[zeros(3, 12), zeros(3, 3), eye(3), zeros(3, 3), zeros(3, 3), zeros(3, 12)], "
        "[zeros(3, 12), zeros(3, 3), zeros(3, 3), eye(3), zeros(3, 3), zeros(3, 12)], "
        f"[zeros(12, 12), zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 3), {G1_INVERSE}]]"
    )
    results.prove(
        implication(
            case,
            id="eq15-congruence",
            quantity="eq15.congruence",
            sentence="With P of Theorem 1, (12) gives (15): Gamma_1 in rows 1 and 6, the Schur complement of row 5.",
            given=[EQ12 < 0],
            then=EQ15 < 0,
            expand={**STRUCTURE, **LOOP},
            unknowns=PLANT_UNKNOWNS,
            by=[Step("(12)", factor, left_inverse=back)],
        ),
        source="(15)",
    )
    results.certificate(to_all_gains(case))
    results.certificate(from_all_gains(case, uncertain=False))
    results.certificate(from_all_gains(case, uncertain=True))
    for divided, quantity in ((False, "eq13.eq15"), (True, "eq13.eq15_divided")):
        results.prove(bordered(case, divided, quantity), source="(13), (15), (16)")
    for divided, quantity in ((False, "eq13.linear"), (True, "eq13.linear_divided")):
        results.prove(linear(case, divided, quantity), source="(13)")
    results.say("proof of Theorem 1", "P > 0 if and only if S > 0 and N < 0; (15) follows from (12)")


GAINS = {name: PLANT_UNKNOWNS[name] for name in ("Ad", "Bd", "Cd")}


def to_all_gains(case: Case) -> Certificate:
    """(12) with any P and any gains gives its form for all gains."""
    return implication(
        case,
        id="eq12-to-all-gains",
        sentence="(12) gives its form for all gains, for every P = [[Y, U], [U', W]] of which U has an inverse, as it "
        "has after a small change of P.",
        given=[EQ12 < 0],
        then=all_gains() < 0,
        invertible=["X", "U", "W"],
        expand={
            "Y": "inverse(X) + U @ inverse(W) @ U.T",
            "P": "[[Y, U], [U.T, W]]",
            "A": "A0",
            **LOOP,
            "V_t": "-inverse(W) @ U.T @ X",
            "Fb": "U @ Bd",
            "Ch": "Cd @ V_t",
            "Ah": "Y @ A0 @ X + Y @ B1 @ Ch + Fb @ C @ X + U @ Ad @ V_t",
            "T": "[[X, eye(6)], [V_t, zeros(6, 6)]]",
            "T_back": "[[zeros(6, 6), -inverse(X) @ inverse(U.T) @ W], [eye(6), inverse(U.T) @ W]]",
        },
        unknowns={**GAINS, "U": matrix(6, 6), "W": symmetric(6)},
        by=[Step("(12)", "diag(T, eye(12), T)", left_inverse="diag(T_back, eye(12), T_back)")],
    )


def from_all_gains(case: Case, uncertain: bool) -> Certificate:
    """The form of (12) for all gains gives (12) with the P of Theorem 1 and gains, for every Delta H where bordered."""
    free = all_gains(uncertain)
    whole, square = "diag(T, eye(12), T)", "H @ H.T - eye(12) <= 0"
    border = {}
    if uncertain:
        kept = {row: 3 if row in ("2", "3", "4", "output") else 6 for row in free.rows[:-2]}
        for name, row in (("H_to", "H_in"), ("H_of", "H_out")):
            border[name] = _rows([[free.block(row, column) for column in kept]], [12], kept)
        by = [
            Step("(12)", "col(J, H_to @ J / eps1, H_of @ J / eps1)", left_inverse=f"row({whole}, zeros(36, 24))"),
            Step(square, "H_of @ J", scale="1 / eps1"),
            Step("", "(H_to - H.T @ H_of) @ J / eps1", scale="eps1"),
        ]
    else:
        by = [Step("(12)", "J", left_inverse=whole)]
    return implication(
        case,
        id=f"eq12-from-all-gains{'-uncertain' if uncertain else ''}",
        sentence="The form of (12) for all gains gives gains and a P with which (12) holds"
        + (", for every Delta H of norm at most one." if uncertain else "."),
        given=[free < 0, *([square] if uncertain else [])],
        then=EQ12 < 0,
        invertible=["X", "N"],
        expand={
            "Y": "inverse(X) - N",
            "P": "[[Y, N], [N, -N]]",
            "A": "A0 + L @ H @ K" if uncertain else "A0",
            "Cd": "Ch @ inverse(X)",
            "Bd": "inverse(N) @ Fb",
            "Ad": "inverse(N) @ (Ah @ inverse(X) - Y @ A0 - Y @ B1 @ Cd - Fb @ C)",
            **LOOP,
            "T": "[[X, eye(6)], [X, zeros(6, 6)]]",
            "J": "diag([[zeros(6, 6), inverse(X)], [eye(6), -eye(6)]], eye(12), "
            "[[zeros(6, 6), inverse(X)], [eye(6), -eye(6)]])",
            **border,
        },
        unknowns={"N": symmetric(6), **({"H": matrix(12, 12)} if uncertain else {})},
        by=by,
    )


def bordered(case: Case, divided: bool, quantity: str) -> Certificate:
    """(13) gives (15) for every Delta H and every gain variation, by two completed squares (Lemma 1)."""
    sizes = {"1a": 6, "1b": 6, "2": 3, "3": 3, "4": 3, "5a": 6, "5b": 6}
    inner, outer = {"F1_in": 6, "F2_in": 3, "F3_in": 3}, {"F1_out": 6, "F2_out": 3, "F3_out": 3}
    eq13 = equation_13(divided)

    def border(rows: dict[str, int]) -> str:
        """Transposed blocks of border rows against the rows of (15)."""
        return _rows([[eq13.block(row, place) for place in sizes] for row in rows], list(rows.values()), sizes)

    identity = _rows(
        [[f"eye({size})" if row == place else "" for place in sizes] for row, size in sizes.items()],
        list(sizes.values()),
        sizes,
    )
    whole = sum(sizes.values())
    definitions = {
        "Fa": "N @ Af",
        "Fb": "N @ Bf",
        "F": "diag(F1.T, F2.T, F3.T)",
        "Y": "S - N",
        "A": "A0 + L @ H @ K",
        "Cd": "Cf + F3 @ Cf",
        "Bd": "Bf + Bf @ F2",
        "Ad": "Af + Af @ F1",
        "H_to": border({"H_in": 12}),
        "H_of": border({"H_out": 12}),
        "F_to": border(inner),
        "F_of": border(outer),
    }
    # the variation enters (15) as F_to' F F_of over what eps2 and delta_m weigh these by
    weigh = "eps2 * dm"
    return implication(
        case,
        id=quantity.replace(".", "-").replace("_", "-"),
        quantity=quantity,
        sentence="(13) gives (15) for every Delta H of norm at most one and all F1, F2, F3 within delta_m.",
        given=[eq13 < 0, "H @ H.T - eye(12) <= 0", "F.T @ F - dm**2 * eye(12) <= 0"],
        then=EQ15 < 0,
        expand=definitions,
        invertible=["N"],
        unknowns={
            "H": matrix(12, 12),
            "F1": matrix(6, 6),
            "F2": matrix(3, 3),
            "F3": matrix(3, 3),
            "Af": matrix(6, 6),
            "Bf": matrix(6, 3),
        },
        by=[
            Step(
                "(13)",
                f"col({identity}, H_to / eps1, H_of / eps1, F_to / eps2, F_of / eps2)",
                left_inverse=f"row(eye({whole}), zeros({whole}, 48))",
            ),
            Step("H @ H.T - eye(12) <= 0", "H_of", scale="1 / eps1"),
            Step("", "H_to / eps1 - H.T @ H_of / eps1", scale="eps1"),
            Step("F.T @ F - dm**2 * eye(12) <= 0", "F_of / dm", scale="1 / eps2"),
            Step("", f"F_to / eps2 - F @ F_of / ({weigh})", scale="eps2"),
        ],
    )


def linear(case: Case, divided: bool, quantity: str) -> Certificate:
    """(13) gives the linear condition in which it is refuted."""
    eq13, goal = equation_13(divided), linear_13(divided)
    heights = {"1a": 6, "1b": 6, "2": 3, "3": 3, "4": 3, "5a": 6, "5b": 6, "H_in": 12, "H_out": 12}
    heights |= {"F1_in": 6, "F2_in": 3, "F3_in": 3, "F1_out": 6, "F2_out": 3, "F3_out": 3}
    widths = {row: heights.get(row, 3) for row in goal.rows}
    kept = {"1a": "X", "5a": "X", "1b": "eye(6)", "2": "eye(3)", "5b": "eye(6)", "F3_in": "eye(3)"}
    cells = [[kept[row] if row == column and row in kept else "" for column in widths] for row in heights]
    free = f"({eq13.block('1a', '5b')}).T @ X - a * eye(6)"
    return implication(
        case,
        id=quantity.replace(".", "-").replace("_", "-"),
        quantity=quantity,
        sentence="(13) gives a condition linear in X = S^-1, Y = S - N, Fb, Ch = C_f X and a free block.",
        given=[eq13 < 0],
        then=goal <= 0,
        invertible=["X"],
        expand={"S": "inverse(X)", "N": "inverse(X) - Y", "Ch": "Cf @ X", "Ah": free},
        by=[
            Step("(13)", _rows(cells, list(heights.values()), widths)),
            Step("", "row(C @ X, C, zeros(3, 3), -eye(3), zeros(3, 6), zeros(3, 6), zeros(3, 3))"),
        ],
    )


def _rows(cells: list[list[str]], heights: list[int], widths: dict[str, int]) -> str:
    """Block matrix as text, zeros of the right size where a cell is empty."""
    lines = [
        "["
        + ", ".join(cell or f"zeros({height}, {width})" for cell, width in zip(row, widths.values(), strict=True))
        + "]"
        for row, height in zip(cells, heights, strict=True)
    ]
    return "[" + ", ".join(lines) + "]"


TASKS = (appendix_1, structure)
