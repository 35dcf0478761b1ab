"""The inequalities of li2021 as printed, e, W0 and E without their rows and columns of zeros.

Rows 1a and 1b are the two halves of the first block row of (13), 5a and 5b those of the fifth. The matrices of (13)
and (17) are lost in the text; (13) is rebuilt from (15), (16) and Lemma 1, with eps2 in one of two places.
"""

from gainsay.statements import Statement, matrix, positive, scalar, symmetric

#: (10): the matrices with a tilde and a bar, gains with their variation (Ad, Bd, Cd for A_Delta_f, ...)
LOOP = {
    "A_t": "[[A, B1 @ Cd], [Bd @ C, Ad]]",
    "B_t": "col(B2, zeros(6, 3))",
    "E_t": "col(E, zeros(6, 3))",
    "C_t": "row(C, zeros(3, 6))",
    "W_t": "row(W0, zeros(3, 6))",
}
#: matrices of (10) as unknowns: what is derived of them holds for every plant and all gains
LOOP_UNKNOWNS = {
    "A_t": matrix(12, 12),
    "B_t": matrix(12, 3),
    "E_t": matrix(12, 3),
    "C_t": matrix(3, 12),
    "W_t": matrix(3, 12),
}
PLANT_UNKNOWNS = {
    "A": matrix(6, 6),
    "B1": matrix(6, 3),
    "B2": matrix(6, 3),
    "C": matrix(3, 6),
    "E": matrix(6, 3),
    "W0": matrix(3, 6),
    "Ad": matrix(6, 6),
    "Bd": matrix(6, 3),
    "Cd": matrix(3, 6),
}
#: (1)-(10) with the corrected Gamma_D and Gamma_G; E and W0 without their rows and columns of zeros
PLANT = (
    ("n", "number('orbital_rate')"),
    ("a", "number('disk_centre')"),
    ("b", "number('disk_radius')"),
    ("r", "b**2 / a"),
    ("J1", "number('J10')"),
    ("J2", "number('J20')"),
    ("J3", "number('J30')"),
    ("d1", "number('inertia_share_1') * J1"),
    ("d2", "number('inertia_share_2') * J2"),
    ("d3", "number('inertia_share_3') * J3"),
    ("F", "printed('F')"),
    ("J0", "diag(J1, J2, J3)"),
    ("M", "inverse(J0 - F.T @ F)"),
    ("G0", "n**2 * diag(4*(J2 - J3), 3*(J1 - J3), J2 - J1)"),
    ("turn", "[[0, 0, -1], [0, 0, 0], [1, 0, 0]]"),
    ("D0", "n * (J1 + J3 - J2) * turn"),
    ("A0", "[[zeros(3, 3), eye(3)], [-M @ G0, -M @ (D0 - n * F.T @ F @ turn)]]"),
    ("B", "col(zeros(3, 3), M)"),
    ("C", "row(eye(3), zeros(3, 3))"),
    ("XJ", "diag(d1, d2, d3)"),
)
FACTORS = (
    ("XD", "n * [[0, -d1, 0, -d3, 0, -d2], [0, 0, 0, 0, 0, 0], [d1, 0, d3, 0, d2, 0]]"),
    ("XG", "n**2 * [[d2, 0, 0, 0, -4*d3, 0], [0, 0, 3*d1, 3*d3, 0, 0], [0, d2, 0, 0, 0, -d1]]"),
)
UNCERTAIN = (
    *FACTORS,
    ("L", "[[zeros(3, 6), zeros(3, 6)], [-M @ XG, -M @ XD]]"),
    ("K", "diag(printed('GammaG'), printed('GammaD'))"),
    ("W", "row(zeros(3, 3), XJ)"),
)

#: names of the statements in the tables: B1 = B2 = B, and the rows of E that are not zero are those of B
TABLES = {
    **dict(PLANT),
    **dict(UNCERTAIN),
    "B1": "B",
    "B2": "B",
    "E": "B",
    "W0": "W",
    "g": "number('gamma')**2",
    "lam": "number('lambda')",
    "eps1": "number('eps1')",
    "eps2": "number('eps2')",
    "dm": "number('delta_m')",
}
#: unknowns of Theorem 1, and its plant
THEOREM_1 = {"S": symmetric(6), "N": symmetric(6), "Fa": matrix(6, 6), "Fb": matrix(6, 3), "Cf": matrix(3, 6)}
UNCERTAIN_UNKNOWNS = {
    "A0": matrix(6, 6),
    "B1": matrix(6, 3),
    "B2": matrix(6, 3),
    "C": matrix(3, 6),
    "E": matrix(6, 3),
    "W0": matrix(3, 6),
    "L": matrix(6, 12),
    "K": matrix(12, 6),
}
SCALARS = {name: positive() for name in ("a", "r", "lam", "g")}
#: how (12) writes what the formulas name
NOTATION = {
    **{f"{letter}_t": rf"\tilde{{{letter}}}" for letter in "ABCE"},
    "W_t": r"\bar{W}_{0}",
    "r": r"\frac{b^{2}}{a}",
    "g": r"\gamma^{2}",
}

EQ12 = Statement(
    "(12)",
    "Lemma 3",
    ("1", "2", "3", "4", "5", "6"),
    {
        ("1", "1"): "-r * P",
        ("1", "2"): "-P @ E_t",
        ("1", "3"): "P @ B_t",
        ("1", "4"): "lam * A_t.T @ W_t.T",
        ("1", "5"): "C_t.T",
        ("1", "6"): "(A_t + a * eye(12)).T @ P",
        ("2", "2"): "-lam**2 * eye(3)",
        ("2", "4"): "-lam * E_t.T @ W_t.T",
        ("3", "3"): "-g * eye(3)",
        ("3", "4"): "lam * B_t.T @ W_t.T",
        ("4", "4"): "-eye(3)",
        ("5", "5"): "-eye(3)",
        ("6", "6"): "-a * P",
    },
    unknowns={"P": symmetric(12), **LOOP_UNKNOWNS, **SCALARS},
    notation=NOTATION,
)
#: erratum `lemma-3`: with e = Delta W xi' in (1,2) and (2,6) as the disk needs it
EQ12_CORRECTED = EQ12.corrected({("1", "2"): "", ("2", "6"): "-E_t.T @ P"})
#: entry (3,2) of the rotation (2), and entry (3,3) of G0, as printed and as rotation and (6) have them
ROTATION_32 = Statement(
    "entry (3,2) of (2)",
    "Section II.A",
    ("entry",),
    {("entry", "entry"): "-sf*cp + cf*st*cp"},
    unknowns={f"{function}{angle}": scalar() for function in "sc" for angle in "ftp"},
    notation={
        f"{function}{angle}": rf"{function}\{letter}"
        for function in "sc"
        for angle, letter in (("f", "phi"), ("t", "theta"), ("p", "psi"))
    },
)
ROTATION_32_CORRECTED = ROTATION_32.corrected({("entry", "entry"): "-sf*cp + cf*st*sp"})
G0_33 = Statement(
    "entry (3,3) of G0",
    "Section II.B",
    ("entry",),
    {("entry", "entry"): "n**2 * J2 - J1"},
    unknowns={},
    where=dict(PLANT),
    notation={"J1": "J_{10}", "J2": "J_{20}"},
)
G0_33_CORRECTED = G0_33.corrected({("entry", "entry"): "n**2 * (J2 - J1)"})
#: what the errata follow from
EDITIONS = (EQ12_CORRECTED, ROTATION_32_CORRECTED, G0_33_CORRECTED)
EQ_A1 = Statement(
    "(A.1)",
    "Appendix I",
    ("1",),
    {("1", "1"): "(A_t + a * eye(12)).T @ P @ (A_t + a * eye(12)) / a - r * P"},
    unknowns={"P": symmetric(12), "A_t": matrix(12, 12), "a": positive(), "r": positive()},
)
#: blocks that (A.4) and (A.5) share
COMMON_A = {
    ("1", "2"): "-P @ E_t - lam**2 * A_t.T @ W_t.T @ W_t @ E_t",
    ("1", "3"): "P @ B_t + lam**2 * A_t.T @ W_t.T @ W_t @ B_t",
    ("2", "2"): "lam**2 * E_t.T @ W_t.T @ W_t @ E_t - lam**2 * eye(3)",
    ("2", "3"): "-lam**2 * E_t.T @ W_t.T @ W_t @ B_t",
    ("3", "3"): "lam**2 * B_t.T @ W_t.T @ W_t @ B_t - g * eye(3)",
}
CORNER_A = "A_t.T @ P + P @ A_t + lam**2 * A_t.T @ W_t.T @ W_t @ A_t + C_t.T @ C_t"
EQ_A4 = Statement("(A.4)", "Appendix I", ("1", "2", "3"), {("1", "1"): CORNER_A, **COMMON_A}, unknowns=EQ12.unknowns)
EQ_A5 = Statement(
    "(A.5)",
    "Appendix I",
    ("1", "2", "3"),
    {("1", "1"): f"A_t.T @ P @ A_t / a + (a - r) * P + {CORNER_A}", **COMMON_A},
    unknowns=EQ12.unknowns,
)
EQ15 = Statement(
    "(15)",
    "proof of Theorem 1",
    ("1a", "1b", "2", "3", "4", "5a", "5b"),
    {
        ("1a", "1a"): "-r * S + C.T @ C",
        ("1a", "1b"): "-r * S + C.T @ C",
        ("1b", "1b"): "-r * Y + C.T @ C",
        ("1a", "2"): "-S @ E",
        ("1b", "2"): "-Y @ E",
        ("1a", "3"): "S @ B2",
        ("1b", "3"): "Y @ B2",
        ("1a", "4"): "lam * A.T @ W0.T + lam * Cd.T @ B1.T @ W0.T",
        ("1b", "4"): "lam * A.T @ W0.T",
        ("1a", "5a"): "A.T @ S + Cd.T @ B1.T @ S + a * S",
        ("1a", "5b"): "A.T @ Y + C.T @ Bd.T @ N + Cd.T @ B1.T @ Y + Ad.T @ N + a * S",
        ("1b", "5a"): "A.T @ S + a * S",
        ("1b", "5b"): "A.T @ Y + C.T @ Bd.T @ N + a * Y",
        ("2", "2"): "-lam**2 * eye(3)",
        ("2", "4"): "-lam * E.T @ W0.T",
        ("3", "3"): "-g * eye(3)",
        ("3", "4"): "lam * B2.T @ W0.T",
        ("4", "4"): "-eye(3)",
        ("5a", "5a"): "-a * S",
        ("5a", "5b"): "-a * S",
        ("5b", "5b"): "-a * Y",
    },
    unknowns={"S": symmetric(6), "N": symmetric(6), **PLANT_UNKNOWNS, **SCALARS},
    where={"Y": "S - N"},
)
INPUT = {"P": symmetric(12), "u_max": positive(), "theta": positive()}
EQ_B2 = Statement(
    "(B.2)",
    "Appendix II",
    ("u", "xi"),
    {("u", "u"): "-u_max**2 * eye(3)", ("u", "xi"): "-K_t", ("xi", "xi"): "-P / theta"},
    unknowns={**INPUT, "K_t": matrix(3, 12)},
)
EQ_B3 = Statement(
    "(B.3)",
    "Appendix II",
    ("u", "a", "b"),
    {
        ("u", "u"): "-u_max**2 * eye(3)",
        ("u", "a"): "-Cd",
        ("a", "a"): "-S / theta",
        ("a", "b"): "-S / theta",
        ("b", "b"): "-(S - N) / theta",
    },
    unknowns={"S": symmetric(6), "N": symmetric(6), "Cd": matrix(3, 6), "u_max": positive(), "theta": positive()},
)
EQ19 = Statement(
    "(19)",
    "Lemma 4",
    ("u", "a", "b", "F3"),
    {
        ("u", "u"): "-u_max**2 * eye(3) + eps3 * dm**2 * eye(3)",
        ("u", "a"): "-Cf",
        ("a", "a"): "-S / theta",
        ("a", "b"): "-S / theta",
        ("a", "F3"): "Cf.T",
        ("b", "b"): "-(S - N) / theta",
        ("F3", "F3"): "-eps3 * eye(3)",
    },
    unknowns={
        "S": symmetric(6),
        "N": symmetric(6),
        "Cf": matrix(3, 6),
        **{name: positive() for name in ("u_max", "theta", "eps3", "dm")},
    },
)
EQ20 = Statement(
    "(20)",
    "Lemma 4",
    ("t", "a", "b"),
    {
        ("t", "t"): "-theta",
        ("t", "a"): "-x0.T",
        ("t", "b"): "-x0.T",
        ("a", "a"): "-S",
        ("a", "b"): "-S",
        ("b", "b"): "-(S - N)",
    },
    unknowns={"S": symmetric(6), "N": symmetric(6), "x0": matrix(6, 1), "theta": positive()},
)
EQ_B5 = Statement(
    "(B.5)",
    "Appendix II",
    ("t", "xi"),
    {("t", "t"): "-theta", ("t", "xi"): "-xi0.T", ("xi", "xi"): "-P"},
    unknowns={"P": symmetric(12), "xi0": matrix(12, 1), "theta": positive()},
)


def equation_13(divided: bool) -> Statement:
    """(13) as rebuilt, borders in the order Delta H, F1, F2, F3.

    Parameters
    ----------
    divided : bool
        Where eps2 stands: False, it multiplies psi_3; True, it multiplies psi_4 and psi_5.
    """
    first, second = ("", "eps2 * ") if divided else ("eps2 * ", "")
    inner = ("F1_in", "F2_in", "F3_in", "F1_out", "F2_out", "F3_out")
    return Statement(
        "(13)",
        "Theorem 1",
        ("1a", "1b", "2", "3", "4", "5a", "5b", "H_in", "H_out", *inner),
        {
            ("1a", "1a"): "-r * S + C.T @ C",
            ("1a", "1b"): "-r * S + C.T @ C",
            ("1b", "1b"): "-r * (S - N) + C.T @ C",
            ("1a", "2"): "-S @ E",
            ("1b", "2"): "-(S - N) @ E",
            ("1a", "3"): "S @ B2",
            ("1b", "3"): "(S - N) @ B2",
            ("1a", "4"): "lam * A0.T @ W0.T + lam * Cf.T @ B1.T @ W0.T",
            ("1b", "4"): "lam * A0.T @ W0.T",
            ("1a", "5a"): "A0.T @ S + Cf.T @ B1.T @ S + a * S",
            ("1a", "5b"): "A0.T @ (S - N) + C.T @ Fb.T + Cf.T @ B1.T @ (S - N) + Fa.T + a * S",
            ("1b", "5a"): "A0.T @ S + a * S",
            ("1b", "5b"): "A0.T @ (S - N) + C.T @ Fb.T + a * (S - N)",
            ("2", "2"): "-lam**2 * eye(3)",
            ("2", "4"): "-lam * E.T @ W0.T",
            ("3", "3"): "-g * eye(3)",
            ("3", "4"): "lam * B2.T @ W0.T",
            ("4", "4"): "-eye(3)",
            ("5a", "5a"): "-a * S",
            ("5a", "5b"): "-a * S",
            ("5b", "5b"): "-a * (S - N)",
            ("1a", "H_in"): "eps1 * K.T",
            ("1b", "H_in"): "eps1 * K.T",
            ("4", "H_out"): "lam * W0 @ L",
            ("5a", "H_out"): "S @ L",
            ("5b", "H_out"): "(S - N) @ L",
            ("H_in", "H_in"): "-eps1 * eye(12)",
            ("H_out", "H_out"): "-eps1 * eye(12)",
            ("1a", "F1_in"): f"{first}eye(6)",
            ("1a", "F2_in"): f"{first}C.T",
            ("1a", "F3_in"): f"{first}Cf.T",
            ("1b", "F2_in"): f"{first}C.T",
            ("5b", "F1_out"): f"{second}dm * Fa",
            ("5b", "F2_out"): f"{second}dm * Fb",
            ("4", "F3_out"): f"{second}dm * lam * W0 @ B1",
            ("5a", "F3_out"): f"{second}dm * S @ B1",
            ("5b", "F3_out"): f"{second}dm * (S - N) @ B1",
            **{(row, row): f"-eps2 * eye({6 if '1' in row else 3})" for row in inner},
        },
        unknowns={**THEOREM_1, **UNCERTAIN_UNKNOWNS, **SCALARS, **{n: positive() for n in ("eps1", "eps2", "dm")}},
    )


def equation_17(divided: bool, thin: bool) -> Statement:
    """(17) as rebuilt: (13) without its terms in C_f'B1'S and C_f'B1'(S - N), which Lemma 2 carries in a row.

    Parameters
    ----------
    divided : bool
        As in (13).
    thin : bool
        The split of Lemma 2: C_f' against [S B1; (S - N) B1] (True), or C_f'B1' against [S; S - N].
    """
    eq13 = equation_13(divided)
    left, right, size = ("Cf.T", " @ B1", 3) if thin else ("Cf.T @ B1.T", "", 6)
    carried = {
        ("1a", "5a"): "A0.T @ S + a * S",
        ("1a", "5b"): "A0.T @ (S - N) + C.T @ Fb.T + Fa.T + a * S",
        ("1a", "lemma 2"): f"{left} / lam1",
        ("5a", "lemma 2"): f"lam1 * S{right}",
        ("5b", "lemma 2"): f"lam1 * (S - N){right}",
        ("lemma 2", "lemma 2"): f"-2 * eye({size})",
    }
    return Statement(
        "(17)", "Theorem 2", (*eq13.rows, "lemma 2"), {**eq13.blocks, **carried}, {**eq13.unknowns, "lam1": positive()}
    )


#: of (12) for all gains, in the place of S, N, Fa and C_f: X = S^-1, Y = S - N, Ch = C_f X and a free block Ah
ALL_GAINS = {"X": symmetric(6), "Y": symmetric(6), "Ah": matrix(6, 6), "Fb": matrix(6, 3), "Ch": matrix(3, 6)}


def all_gains(uncertain: bool = False) -> Statement:
    """(12) for all gains at once, linear in X, Y, Ah, Fb, Ch (change of variables of Scherer, Gahinet, Chilali, 1997).

    Rows 1a and 1b, 5a and 5b are rows 1 and 6 of (12) times [[X, I], [V', 0]], where P = [[Y, U], [U', .]] has the
    inverse [[X, V], [V', .]].

    Parameters
    ----------
    uncertain : bool
        Whether A0 varies by L Delta H K, which borders the matrix as in (13).
    """
    border = ("H_in", "H_out") if uncertain else ()
    blocks = {
        ("1a", "1a"): "-r * X",
        ("1a", "1b"): "-r * eye(6)",
        ("1b", "1b"): "-r * Y",
        ("1a", "2"): "-E",
        ("1b", "2"): "-Y @ E",
        ("1a", "3"): "B2",
        ("1b", "3"): "Y @ B2",
        ("1a", "4"): "lam * (A0 @ X + B1 @ Ch).T @ W0.T",
        ("1b", "4"): "lam * A0.T @ W0.T",
        ("1a", "output"): "X @ C.T",
        ("1b", "output"): "C.T",
        ("1a", "5a"): "(A0 @ X + B1 @ Ch + a * X).T",
        ("1a", "5b"): "(Ah + a * eye(6)).T",
        ("1b", "5a"): "(A0 + a * eye(6)).T",
        ("1b", "5b"): "(A0 + a * eye(6)).T @ Y + C.T @ Fb.T",
        ("2", "2"): "-lam**2 * eye(3)",
        ("2", "4"): "-lam * E.T @ W0.T",
        ("3", "3"): "-g * eye(3)",
        ("3", "4"): "lam * B2.T @ W0.T",
        ("4", "4"): "-eye(3)",
        ("output", "output"): "-eye(3)",
        ("5a", "5a"): "-a * X",
        ("5a", "5b"): "-a * eye(6)",
        ("5b", "5b"): "-a * Y",
    }
    if uncertain:
        blocks |= {
            ("1a", "H_in"): "eps1 * X @ K.T",
            ("1b", "H_in"): "eps1 * K.T",
            ("4", "H_out"): "lam * W0 @ L",
            ("5a", "H_out"): "L",
            ("5b", "H_out"): "Y @ L",
            **{(row, row): "-eps1 * eye(12)" for row in border},
        }
    rows = ("1a", "1b", "2", "3", "4", "output", "5a", "5b", *border)
    unknowns = {**ALL_GAINS, **UNCERTAIN_UNKNOWNS, **SCALARS, "eps1": positive()}
    return Statement("(12)", "Lemma 3", rows, blocks, unknowns)


def linear_13(divided: bool) -> Statement:
    """What rows 1a, 1b, 2, 5a, 5b and F3_in of (13) say of X = S^-1, Y = S - N, Fb, Ch = C_f X and a free block Ah.

    Rows 1a and 5a are multiplied by X, and C'C is its Schur complement, the row "output": (12) for all gains without
    its rows 3 and 4, with a row for F3. So the condition is linear, and its infeasibility is that of (13), nonlinear
    as that is, whatever gamma, eps1 and delta_m.
    """
    free = all_gains().sub("1a", "1b", "2", "output", "5a", "5b")
    third = {("1a", "F3_in"): "Ch.T" if divided else "eps2 * Ch.T", ("F3_in", "F3_in"): "-eps2 * eye(3)"}
    return Statement(
        "(13)", "Theorem 1", (*free.rows, "F3_in"), {**free.blocks, **third}, {**free.unknowns, "eps2": positive()}
    )
