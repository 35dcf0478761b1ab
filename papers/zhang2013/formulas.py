"""The inequalities of zhang2013 as formulas over its tables, for certificates; printed and corrected side by side.

A block matrix is a mapping from (row, column) of the upper triangle to a formula; `joined` writes it as one formula.
"""

from collections.abc import Mapping

NINE = ("z", "z'", "z_d", "z_M", "w", "y")
ROWS = ("x", "e", "x'", "e'", "x_d", "e_d", "x_M", "e_M", "w1", "w2'", "y")
SIZES = {"z": 3, "w": 2, "x": 2, "e": 1, "w1": 1, "w2'": 1, "y": 1}
WEIGHTS = {"a": ("3", "1"), "b": ("1", "3")}
"""(23a), (9a), (26a) weigh R/d_M by 3 and 1, the others by 1 and 3."""

PLANT: tuple[tuple[str, str], ...] = (
    ("J_e", "number('J') - printed('F') @ printed('F').T"),
    ("A", "[[0, 1], [0, 0]]"),
    ("B", "[[0], [1 / J_e]]"),
    ("C1", "printed('C1')"),
    ("C2", "number('C2')"),
    ("Cd1", "number('Cd1')"),
    ("Cd2", "number('Cd2')"),
    ("d_M", "number('d_M')"),
    ("mu", "number('mu')"),
)
"""Data of (3), (8) and of the example."""

FLEXIBLE: tuple[tuple[str, str], ...] = (
    *PLANT,
    ("F", "printed('F')"),
    ("Lambda", "diag(number('omega1') ** 2, number('omega2') ** 2)"),
    ("C_m", "diag(2 * number('xi1') * number('omega1'), 2 * number('xi2') * number('omega2'))"),
    ("V", "row(F @ Lambda, F @ C_m)"),
    (
        "A_f",
        "[[A, col(zeros(1, 4), V / J_e)], [zeros(2, 2), row(zeros(2, 2), eye(2))], "
        "[zeros(2, 2), -row(Lambda, C_m) - F.T @ V / J_e]]",
    ),
    ("B_f", "col(B, zeros(2, 1), -F.T / J_e)"),
)
"""(1) in the state (theta, theta', eta1, eta2, eta1', eta2')."""


def gains(K: str, L: str) -> tuple[tuple[str, str], ...]:
    """Definitions of (7): Abar, Ad, Bbar, C, Cd for formulas of K and L; `PLANT` comes before."""
    return (
        ("K", K),
        ("LB", f"({L}) @ B"),
        ("A_bar", "[[A, B], [zeros(1, 2), -LB]]"),
        ("A_d", "[[B @ K, zeros(2, 1)], [zeros(1, 2), 0]]"),
        ("B_bar", "[[B, zeros(2, 1)], [-LB, 1]]"),
        ("C_z", "row(C1, C2)"),
        ("C_d", "row(Cd1, Cd2)"),
    )


def flexible_loop(K: str, L: str, mode: str = "paper") -> tuple[tuple[str, str], ...]:
    """Definitions of the flexible loop, state ending with w2hat, input w1, output w2 - w2hat; `FLEXIBLE` comes before.

    In mode "paper" K x alone is delayed, in mode "all" the whole input.
    """
    now, late = ("-B_f", "zeros(6, 1)") if mode == "paper" else ("zeros(6, 1)", "-B_f")
    return (
        ("K", K),
        ("LB", f"({L}) @ B"),
        ("A_bar", f"[[A_f, {now}], [LB @ row(zeros(1, 2), V), -LB]]"),
        ("A_d", f"[[B_f @ row(K, zeros(1, 4)), {late}], [zeros(1, 6), 0]]"),
        ("B_bar", "col(B_f, LB)"),
        ("C_z", "row(zeros(1, 2), V, -eye(1))"),
        ("C_d", "zeros(1, 1)"),
    )


def nine(part: str, gamma_squared: str, size: int = 3, inputs: int = 2) -> dict[tuple[str, str], str]:
    """Blocks of (9a) or (9b)."""
    c, o = WEIGHTS[part]
    return {
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
        ("w", "w"): f"-({gamma_squared}) * eye({inputs})",
        ("w", "y"): "C_d.T",
        ("y", "y"): "-eye(1)",
    }


def printed23(part: str, gamma_squared: str) -> dict[tuple[str, str], str]:
    """Blocks of (23a) or (23b) as printed, "R2hat" read as R2 and "P21hat" as P21bar (here X)."""
    c, o = WEIGHTS[part]
    return {
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
        ("e", "w2'"): "P22.T",
        ("e", "y"): "C2.T",
        ("x'", "x'"): "-l1 * sym(X) + d_M * R1",
        ("x'", "x_d"): f"l1 * B @ M + {c} * R1 / d_M",
        ("x'", "w1"): "l1 * B",
        ("e'", "e'"): "-l2 * sym(P22) + d_M * R2",
        ("e'", "w1"): "-l2 * N @ B",
        ("e'", "w2'"): "l2 * P22.T",
        ("x_d", "x_d"): "-(1 - mu) * Q21 - 4 * R1 / d_M",
        ("x_d", "x_M"): f"{o} * R1 / d_M",
        ("e_d", "e_d"): "-(1 - mu) * Q22 - 4 * R2 / d_M",
        ("e_d", "e_M"): f"{o} * R2 / d_M",
        ("x_M", "x_M"): f"Q11 - {o} * R1 / d_M",
        ("e_M", "e_M"): f"Q12 - {o} * R2 / d_M",
        ("w1", "w1"): f"-({gamma_squared})",
        ("w2'", "w2'"): f"-({gamma_squared})",
        ("w1", "y"): "Cd1.T",
        ("w2'", "y"): "Cd2.T",
        ("y", "y"): "-eye(1)",
    }


def corrected23(part: str, gamma_squared: str) -> dict[tuple[str, str], str]:
    """Blocks of (23a) or (23b) as (9) and (25) give them."""
    c, o = WEIGHTS[part]
    return printed23(part, gamma_squared) | {
        ("e", "e_d"): f"{c} * R2 / d_M",
        ("e", "w1"): "-N @ B",
        ("x'", "x_d"): "l1 * B @ M",
        ("x_M", "x_M"): f"-Q11 - {o} * R1 / d_M",
        ("e_M", "e_M"): f"-Q12 - {o} * R2 / d_M",
    }


def printed26(part: str, gamma_squared: str) -> dict[tuple[str, str], str]:
    """Blocks of (26a) or (26b) as printed, with the Pi's defined above it."""
    c, o = WEIGHTS[part]
    return {
        ("x", "x"): f"P21.T @ A + A.T @ P21 + Q11 + Q21 - {c} * R1 / d_M",
        ("x", "e"): "P21.T @ B",
        ("x", "x'"): "P11 - P21.T + l1 * A.T @ P21",
        ("x", "x_d"): f"P21.T @ B @ K + {c} * R1 / d_M",
        ("x", "w1"): "P21.T @ B",
        ("x", "y"): "C1.T",
        # Pi221 and Pi222 print R1 (2 x 2) where only a number fits: see `corrected26`
        ("e", "e"): f"-P22.T @ L @ B - B.T @ L.T @ P22 + Q12 + Q22 - {c} * R2 / d_M",
        ("e", "x'"): "l1 * B.T @ P21",
        ("e", "e'"): "P12 - P22.T - l2 * B.T @ L.T @ P22",
        ("e", "w1"): "P22.T @ L @ B",
        ("e", "w2'"): "P22.T",
        ("e", "y"): "C2.T",
        ("x'", "x'"): "-l1 * sym(P21) + d_M * R1",
        ("x'", "x_d"): f"l1 * P21.T @ B @ K + {c} * R1 / d_M",
        ("x'", "w1"): "l1 * P21.T @ B",
        ("e'", "e'"): "-l2 * sym(P22) + d_M * R2",
        ("e'", "w1"): "-l2 * P22.T @ L @ B",
        ("e'", "w2'"): "l2 * P22.T",
        ("x_d", "x_d"): "-(1 - mu) * Q21 - 4 * R1 / d_M",
        ("x_d", "x_M"): f"{o} * R1 / d_M",
        ("e_d", "e_d"): "-(1 - mu) * Q22 - 4 * R2 / d_M",
        ("e_d", "e_M"): f"{o} * R2 / d_M",
        ("x_M", "x_M"): f"Q11 - {o} * R1 / d_M",
        ("e_M", "e_M"): f"Q12 - {o} * R2 / d_M",
        ("w1", "w1"): f"-({gamma_squared})",
        ("w2'", "w2'"): f"-({gamma_squared})",
        ("w1", "y"): "Cd1.T",
        ("w2'", "y"): "Cd2.T",
        ("y", "y"): "-eye(1)",
    }


def corrected26(part: str, gamma_squared: str) -> dict[tuple[str, str], str]:
    """Blocks of (26a) or (26b) as (9) and (25) give them."""
    c, o = WEIGHTS[part]
    return printed26(part, gamma_squared) | {
        ("e", "e_d"): f"{c} * R2 / d_M",
        ("e", "w1"): "-P22.T @ L @ B",
        ("x'", "x_d"): "l1 * P21.T @ B @ K",
        ("x_M", "x_M"): f"-Q11 - {o} * R1 / d_M",
        ("e_M", "e_M"): f"-Q12 - {o} * R2 / d_M",
    }


STRUCTURE: tuple[tuple[str, str], ...] = (
    ("P1", "diag(P11, P12)"),
    ("P2", "diag(P21, P22)"),
    ("P3", "diag(l1 * P21, l2 * P22)"),
    ("Q1", "diag(Q11, Q12)"),
    ("Q2", "diag(Q21, Q22)"),
    ("R", "diag(R1, R2)"),
)
"""(25)."""


def size_of(row: str, sizes: Mapping[str, int] = SIZES) -> int:
    """Rows of a block row; primes and delays keep the size of their signal."""
    return sizes.get(row) or sizes[row.rstrip("'").split("_")[0]]


def joined(blocks: Mapping[tuple[str, str], str], rows: tuple[str, ...], sizes: Mapping[str, int] = SIZES) -> str:
    """Write a block matrix as one formula: unset blocks zero, the lower half by symmetry."""
    lines = []
    for i, row in enumerate(rows):
        cells = []
        for j, column in enumerate(rows):
            if j < i:
                cells.append("...")
            else:
                zero = f"zeros({size_of(row, sizes)}, {size_of(column, sizes)})"
                cells.append(blocks.get((row, column), zero))
        lines.append("[" + ", ".join(cells) + "]")
    return "[" + ", ".join(lines) + "]"


UNKNOWNS23 = {
    **{name: {"shape": [2, 2], "structure": "symmetric"} for name in ("P11", "Q11", "Q21", "R1")},
    **{name: {"shape": [1, 1], "structure": "symmetric"} for name in ("P12", "Q12", "Q22", "R2")},
    "X": {"shape": [2, 2], "structure": "full"},
    "M": {"shape": [1, 2], "structure": "full"},
    "N": {"shape": [1, 2], "structure": "full"},
    "P22": {"shape": [1, 1], "structure": "full"},
}
UNKNOWNS9 = {
    **{name: {"shape": [3, 3], "structure": "symmetric"} for name in ("P1", "Q1", "Q2", "R")},
    **{name: {"shape": [3, 3], "structure": "full"} for name in ("P2", "P3")},
}
SIGNED = ("P11", "P12", "Q11", "Q21", "Q12", "Q22", "R1", "R2")
