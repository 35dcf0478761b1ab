"""The inequalities of zhang2013 as printed and as they follow from each other, and the programs made of them."""

from collections.abc import Callable
from typing import Any

from gainsay.statements import Stated, Statement, matrix, positive, read_constraint, scalar, symmetric
from gainsay.statements.statement import Constraint
from gainsay.statements.unknowns import Unknown

#: weights of R/d_M on the two intervals, by part: (23a), (9a), (26a) weigh the first by 3
PARTS = {"a": (3, 1), "b": (1, 3)}
PLUS, MINUS = "number('lambda1_corrected')", "number('lambda1')"
#: bound on the modulus of every entry of every unknown where a margin is maximised
ENTRY_BOUND = 1e4

#: data of (3), (8) and of the example
PLANT = {
    "J_e": "number('J') - printed('F') @ printed('F').T",
    "A": "[[0, 1], [0, 0]]",
    "B": "[[0], [1 / J_e]]",
    "C1": "printed('C1')",
    "C2": "number('C2')",
    "Cd1": "number('Cd1')",
    "Cd2": "number('Cd2')",
    "d_M": "number('d_M')",
    "mu": "number('mu')",
    "g": "number('gamma') ** 2",
}
#: (1) in the state (theta, theta', eta1, eta2, eta1', eta2')
FLEXIBLE = {
    **PLANT,
    "F": "printed('F')",
    "Lambda": "diag(number('omega1') ** 2, number('omega2') ** 2)",
    "C_m": "diag(2 * number('xi1') * number('omega1'), 2 * number('xi2') * number('omega2'))",
    "V": "row(F @ Lambda, F @ C_m)",
    "A_f": "[[A, col(zeros(1, 4), V / J_e)], [zeros(2, 2), row(zeros(2, 2), eye(2))], "
    "[zeros(2, 2), -row(Lambda, C_m) - F.T @ V / J_e]]",
    "B_f": "col(B, zeros(2, 1), -F.T / J_e)",
}


def design_loop(K: str, L: str) -> dict[str, str]:
    """Plant, and (7), (8) for formulas of K and L."""
    return {
        **PLANT,
        "K": K,
        "LB": f"({L}) @ B",
        "A_bar": "[[A, B], [zeros(1, 2), -LB]]",
        "A_d": "[[B @ K, zeros(2, 1)], [zeros(1, 2), 0]]",
        "B_bar": "[[B, zeros(2, 1)], [-LB, 1]]",
        "C_z": "row(C1, C2)",
        "C_d": "row(Cd1, Cd2)",
    }


def flexible_loop(K: str, L: str, mode: str = "paper") -> dict[str, str]:
    """Flexible plant and loop, state ending with w2hat, input w1, output w2 - w2hat.

    In mode "paper" K x alone is delayed, in mode "all" the whole input.
    """
    now, late = ("-B_f", "zeros(6, 1)") if mode == "paper" else ("zeros(6, 1)", "-B_f")
    return {
        **FLEXIBLE,
        "K": K,
        "LB": f"({L}) @ B",
        "A_bar": f"[[A_f, {now}], [LB @ row(zeros(1, 2), V), -LB]]",
        "A_d": f"[[B_f @ row(K, zeros(1, 4)), {late}], [zeros(1, 6), 0]]",
        "B_bar": "col(B_f, LB)",
        "C_z": "row(zeros(1, 2), V, -eye(1))",
        "C_d": "zeros(1, 1)",
    }


#: the loop with the printed gains
PRINTED_LOOP = design_loop("printed('K')", "printed('L')")


def functional(size: int) -> dict[str, Unknown]:
    """Return the unknowns of Theorem 1 for a state of `size` entries."""
    free = {name: matrix(size, size) for name in ("P2", "P3")}
    return {**{name: symmetric(size) for name in ("P1", "Q1", "Q2", "R")}, **free}


def equation_9(part: str, loop: dict[str, str], size: int = 3, inputs: int = 2) -> Statement:
    """(9a) or (9b) of Theorem 1."""
    c, o = PARTS[part]
    return Statement(
        f"(9{part})",
        "Theorem 1",
        ("z", "z'", "z_d", "z_M", "w", "y"),
        {
            ("z", "z"): f"sym(P2.T @ A_bar) + Q1 + Q2 - {c} * R / d_M",
            ("z", "z'"): "P1 - P2.T + A_bar.T @ P3",
            ("z", "z_d"): f"P2.T @ A_d + {c} * R / d_M",
            ("z", "w"): "P2.T @ B_bar",
            ("z", "y"): "C_z.T",
            ("z'", "z'"): "-sym(P3) + d_M * R",
            ("z'", "z_d"): "P3.T @ A_d",
            ("z'", "w"): "P3.T @ B_bar",
            ("z_d", "z_d"): "-(1 - mu) * Q2 - 4 * R / d_M",
            ("z_d", "z_M"): f"{o} * R / d_M",
            ("z_M", "z_M"): f"-Q1 - {o} * R / d_M",
            ("w", "w"): f"-g * eye({inputs})",
            ("w", "y"): "C_d.T",
            ("y", "y"): "-eye(1)",
        },
        unknowns=functional(size),
        where=loop,
    )


def without_slack(part: str, loop: dict[str, str], size: int = 3, inputs: int = 2) -> Statement:
    """(9) with z' eliminated instead of the slack P2, P3: the same set of P1, Q1, Q2, R.

    With P2 = P1 and P3 = d_M R the rows z' of (9) are these rows R; and the inequality is what (9) says on the
    subspace z' = Abar z + Ad z_d + Bbar w, where the slack drops out.
    """
    c, o = PARTS[part]
    return Statement(
        f"(9{part}) without slack",
        "Theorem 1",
        ("z", "z_d", "z_M", "w", "R", "y"),
        {
            ("z", "z"): f"sym(P1 @ A_bar) + Q1 + Q2 - {c} * R / d_M",
            ("z", "z_d"): f"P1 @ A_d + {c} * R / d_M",
            ("z", "w"): "P1 @ B_bar",
            ("z", "R"): "d_M * A_bar.T @ R",
            ("z", "y"): "C_z.T",
            ("z_d", "z_d"): "-(1 - mu) * Q2 - 4 * R / d_M",
            ("z_d", "z_M"): f"{o} * R / d_M",
            ("z_d", "R"): "d_M * A_d.T @ R",
            ("z_M", "z_M"): f"-Q1 - {o} * R / d_M",
            ("w", "w"): f"-g * eye({inputs})",
            ("w", "R"): "d_M * B_bar.T @ R",
            ("w", "y"): "C_d.T",
            ("R", "R"): "-d_M * R",
            ("y", "y"): "-eye(1)",
        },
        unknowns={name: symmetric(size) for name in ("P1", "Q1", "Q2", "R")},
        where=loop,
    )


#: symmetric unknowns of (23) that the theorem asks to be positive definite; P11, Q11, Q21, R1 carry hats in the paper
SIGNED = {
    "P11": symmetric(2),
    "P12": symmetric(1),
    "Q11": symmetric(2),
    "Q21": symmetric(2),
    "Q12": symmetric(1),
    "Q22": symmetric(1),
    "R1": symmetric(2),
    "R2": symmetric(1),
}
#: unknowns of (23) without structure; X stands for P21-bar and P21-hat, K = M X^-1, L = P22^-T N
UNKNOWNS_23 = {**SIGNED, "X": matrix(2, 2), "M": matrix(1, 2), "N": matrix(1, 2), "P22": matrix(1, 1)}
ROWS = ("x", "e", "x'", "e'", "x_d", "e_d", "x_M", "e_M", "w1", "w2'", "y")
#: entries of the block rows
SIZES = {"x": 2, "e": 1, "x'": 2, "e'": 1, "x_d": 2, "e_d": 1, "x_M": 2, "e_M": 1, "w1": 1, "w2'": 1, "y": 1}
OFFSETS = {row: sum(list(SIZES.values())[:i]) for i, row in enumerate(ROWS)}
#: how (23) writes what the formulas name
NOTATION_23 = {
    **{name: rf"\hat{{{name[0]}}}_{{{name[1:]}}}" for name in ("P11", "Q11", "Q21", "R1")},
    "X": r"\hat{P}_{21}",
    "l1": r"\lambda_{1}",
    "l2": r"\lambda_{2}",
    "g": r"\gamma^{2}",
}
LAMBDAS = {"l1": PLUS, "l2": "number('lambda2')"}


def alike(part: str) -> dict[tuple[str, str], str]:
    """Cells that (23) and (26) print alike: (26) refers to the Pi's of (23)."""
    _, o = PARTS[part]
    return {
        ("e", "w2'"): "P22.T",
        ("e", "y"): "C2.T",
        ("e'", "e'"): "-l2 * sym(P22) + d_M * R2",
        ("e'", "w2'"): "l2 * P22.T",
        ("x_d", "x_d"): "-(1 - mu) * Q21 - 4 * R1 / d_M",
        ("x_d", "x_M"): f"{o} * R1 / d_M",
        ("e_d", "e_d"): "-(1 - mu) * Q22 - 4 * R2 / d_M",
        ("e_d", "e_M"): f"{o} * R2 / d_M",
        ("x_M", "x_M"): f"Q11 - {o} * R1 / d_M",
        ("e_M", "e_M"): f"Q12 - {o} * R2 / d_M",
        ("w1", "w1"): "-g",
        ("w2'", "w2'"): "-g",
        ("w1", "y"): "Cd1.T",
        ("w2'", "y"): "Cd2.T",
        ("y", "y"): "-eye(1)",
    }


def corrections(part: str) -> dict[tuple[str, str], str]:
    """Cells of (23) and (26) alike as (9) and (25) give them."""
    c, o = PARTS[part]
    return {
        ("e", "e_d"): f"{c} * R2 / d_M",
        ("x_M", "x_M"): f"-Q11 - {o} * R1 / d_M",
        ("e_M", "e_M"): f"-Q12 - {o} * R2 / d_M",
    }


def equation_23(part: str) -> Statement:
    """(23a) or (23b) of Theorem 2 as printed, "R2hat" read as R2 and "P21hat" as P21bar (here X)."""
    c, _ = PARTS[part]
    return Statement(
        f"(23{part})",
        "Theorem 2",
        ROWS,
        {
            **alike(part),
            ("x", "x"): f"sym(A @ X) + Q11 + Q21 - {c} * R1 / d_M",
            ("x", "e"): "B",
            ("x", "x'"): "P11 - X + l1 * X.T @ A.T",
            ("x", "x_d"): f"B @ M + {c} * R1 / d_M",
            ("x", "w1"): "B",
            ("x", "y"): "X.T @ C1.T",
            ("e", "e"): f"-sym(N @ B) + Q12 + Q22 - {c} * R2 / d_M",
            ("e", "x'"): "l1 * B.T",
            ("e", "e'"): "P12 - P22.T - l2 * (N @ B).T",
            ("e", "w1"): "N @ B",
            ("x'", "x'"): "-l1 * sym(X) + d_M * R1",
            ("x'", "x_d"): f"l1 * B @ M + {c} * R1 / d_M",
            ("x'", "w1"): "l1 * B",
            ("e'", "w1"): "-l2 * N @ B",
        },
        unknowns=UNKNOWNS_23,
        where={**PLANT, **LAMBDAS},
        notation=NOTATION_23,
    )


def corrected_23(part: str) -> Statement:
    """(23a) or (23b) as (9) and (25) give them: five cells."""
    return equation_23(part).corrected({**corrections(part), ("e", "w1"): "-N @ B", ("x'", "x_d"): "l1 * B @ M"})


def without_block_26(part: str) -> Statement:
    """Corrected (23) with block (2,6) alone left out, as the paper leaves it out."""
    return corrected_23(part).corrected({("e", "e_d"): ""}, edition="without (2,6)")


FORMS: dict[str, Callable[[str], Statement]] = {
    "printed": equation_23,
    "corrected": corrected_23,
    "without (2,6)": without_block_26,
}
#: what the errata follow from
EDITIONS = tuple(corrected_23(part) for part in PARTS)
UNKNOWNS_26 = {
    **SIGNED,
    "P21": matrix(2, 2),
    "P22": matrix(1, 1),
    "K": matrix(1, 2),
    "L": matrix(1, 2),
    "l1": scalar(),
    "l2": scalar(),
}


def equation_26(part: str) -> Statement:
    """(26a) or (26b) as printed, with the Pi's defined above it; not affine in its unknowns."""
    c, _ = PARTS[part]
    return Statement(
        f"(26{part})",
        "proof of Theorem 2",
        ROWS,
        {
            **alike(part),
            ("x", "x"): f"P21.T @ A + A.T @ P21 + Q11 + Q21 - {c} * R1 / d_M",
            ("x", "e"): "P21.T @ B",
            ("x", "x'"): "P11 - P21.T + l1 * A.T @ P21",
            ("x", "x_d"): f"P21.T @ B @ K + {c} * R1 / d_M",
            ("x", "w1"): "P21.T @ B",
            ("x", "y"): "C1.T",
            # Pi221 and Pi222 print R1 (2 x 2) where only a number fits: R2 is read
            ("e", "e"): f"-P22.T @ L @ B - B.T @ L.T @ P22 + Q12 + Q22 - {c} * R2 / d_M",
            ("e", "x'"): "l1 * B.T @ P21",
            ("e", "e'"): "P12 - P22.T - l2 * B.T @ L.T @ P22",
            ("e", "w1"): "P22.T @ L @ B",
            ("x'", "x'"): "-l1 * sym(P21) + d_M * R1",
            ("x'", "x_d"): f"l1 * P21.T @ B @ K + {c} * R1 / d_M",
            ("x'", "w1"): "l1 * P21.T @ B",
            ("e'", "w1"): "-l2 * P22.T @ L @ B",
        },
        unknowns=UNKNOWNS_26,
        where=PLANT,
    )


def corrected_26(part: str) -> Statement:
    """(26a) or (26b) as (9) and (25) give them: the same five cells as in (23)."""
    return equation_26(part).corrected(
        {**corrections(part), ("e", "w1"): "-P22.T @ L @ B", ("x'", "x_d"): "l1 * P21.T @ B @ K"}
    )


#: (25)
STRUCTURE = {
    "P1": "diag(P11, P12)",
    "P2": "diag(P21, P22)",
    "P3": "diag(l1 * P21, l2 * P22)",
    "Q1": "diag(Q11, Q12)",
    "Q2": "diag(Q21, Q22)",
    "R": "diag(R1, R2)",
}


#: sign conditions of Theorem 1
SIGNS_1 = ("P1 > 0", "Q1 > 0", "Q2 > 0", "R > 0")
#: gamma^2 as an unknown, for programs that define g by it
GAMMA_SQUARED = {"gamma2": positive()}


def positive_definite(level: str = "0") -> list[Constraint]:
    """Sign conditions of Theorem 2: each matrix above `level` times the identity."""
    sides = {name: "0" if level == "0" else f"{level} * eye({unknown.rows})" for name, unknown in SIGNED.items()}
    return [read_constraint(f"{name} > {side}", f"{name} > 0") for name, side in sides.items()]


def theorem_1(case: Any, loop: dict[str, str], size: int = 3, inputs: int = 2, **texts: str) -> Stated:
    """(9a) < 0, (9b) < 0, P1, Q1, Q2, R > 0; `texts` are definitions that take the place of those of the loop."""
    held = [equation_9(part, {**loop, **texts}, size, inputs) < 0 for part in PARTS]
    return Stated(case, [*held, SIGNS_1], unknowns={**functional(size), **GAMMA_SQUARED}, label="(9)")


def reduced_theorem_1(case: Any, loop: dict[str, str], size: int = 3, inputs: int = 2, **texts: str) -> Stated:
    """The same without slack."""
    held = [without_slack(part, {**loop, **texts}, size, inputs) < 0 for part in PARTS]
    return Stated(case, [*held, SIGNS_1], unknowns={**functional(size), **GAMMA_SQUARED}, label="(9)")


def structured_theorem_1(case: Any, loop: dict[str, str], **texts: str) -> Stated:
    """Theorem 1 under (25): block diagonal unknowns, P3 = diag(lambda1 P21, lambda2 P22)."""
    unknowns = {**SIGNED, "P21": matrix(2, 2), "P22": matrix(1, 1)}
    where = {**loop, **LAMBDAS, **texts}
    held = [equation_9(part, where).defining(STRUCTURE, unknowns=unknowns) < 0 for part in PARTS]
    return Stated(case, [*held, positive_definite()], unknowns={**unknowns, **GAMMA_SQUARED}, label="(9), (25)")


def theorem_2(case: Any, edition: str = "corrected", level: str = "0", **texts: str) -> Stated:
    """(23a), (23b) and the sign conditions, each by a level; `texts` define l1, M, N, ... otherwise."""
    side: Any = 0 if level == "0" else f"-{level} * eye(15)"
    held = [FORMS[edition](part).defining(texts) < side for part in PARTS]
    more = {**UNKNOWNS_23, **GAMMA_SQUARED, "t": scalar()}
    unknowns = {name: unknown for name, unknown in more.items() if name not in texts}
    return Stated(case, [*held, positive_definite(level)], unknowns=unknowns, label=f"(23) {edition}")


def for_gains(K: str, L: str) -> dict[str, Any]:
    """Definitions of M and N of (24) for formulas of K and L."""
    return {"M": f"{K} @ X", "N": f"P22.T @ {L}"}


def margin_program(case: Any, edition: str, **texts: str) -> Stated:
    """Largest t <= 1 with (23) at level t and bounded entries; the objective is -t. With M, N defined: for gains."""
    stated = theorem_2(case, edition, "t", **texts)
    bounds = {name: ENTRY_BOUND for name in stated.unknowns if name != "t"}
    limits = ["t <= 1", f"t >= -{ENTRY_BOUND:g}"]
    return stated.changed(
        subject_to=[stated.constraints, limits], minimise="-t", bounds=bounds, label=f"margin of {stated.label}"
    )


def least_squares_program(case: Any, level: str = "1e-3", **texts: str) -> Stated:
    """Least sum of squared entries of all unknowns of the corrected (23), at a level."""
    entries = ", ".join(
        f"{name}[{i}, 0:{unknown.columns}]" for name, unknown in UNKNOWNS_23.items() for i in range(unknown.rows)
    )
    count = sum(unknown.rows * unknown.columns for unknown in UNKNOWNS_23.values())
    squares = Statement(
        "sum of squares",
        "",
        ("total", "entries"),
        {("total", "total"): "total", ("total", "entries"): f"row({entries})", ("entries", "entries"): f"eye({count})"},
        unknowns={**UNKNOWNS_23, "total": scalar()},
        where={**PLANT, **LAMBDAS},
    ).defining(texts)
    held = theorem_2(case, level=level, **texts)
    return Stated(case, [held.constraints, squares > 0], "total", held.unknowns, held.where, label="(23) least squares")


def fast_program(case: Any, level: str = "1e-4", bound: float = 100.0, **texts: str) -> Stated:
    """Least gamma^2 of the corrected (23), at a level and with entries within a bound."""
    stated = theorem_2(case, level=level, g="gamma2", **texts)
    bounds = {name: bound for name in stated.unknowns if name != "gamma2"}
    return stated.changed(minimise="gamma2", bounds=bounds, label="(23) least gamma")


def unsound_program(case: Any, edition: str, **texts: str) -> Stated:
    """(23) with N B <= -1: block (4,4) makes P22 > 0, so that L B < 0 and the observer is unstable."""
    held = theorem_2(case, edition, **texts)
    bounds = dict.fromkeys(held.unknowns, ENTRY_BOUND)
    wrong = ["N @ B <= -1", f"N @ B >= -{ENTRY_BOUND:g}"]
    return held.changed(subject_to=[held.constraints, wrong], bounds=bounds, label="(23), unstable observer")


def least_gamma_program(stated: Stated) -> Stated:
    """Least gamma^2 for which a program of (9) holds."""
    return stated.changed(minimise="gamma2", label=f"{stated.label} least gamma")
