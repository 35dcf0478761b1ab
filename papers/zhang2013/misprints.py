"""Certificates of what (23), (24) and (26) of zhang2013 print wrongly, against the congruence of (9) under (25)."""

from gainsay.proof import Certificate
from gainsay.proof.build import certificate
from papers.zhang2013.certificates import GAMMA, OFFSETS, PAPER, point_for, scalars
from papers.zhang2013.formulas import (
    NINE,
    PLANT,
    ROWS,
    STRUCTURE,
    UNKNOWNS23,
    corrected26,
    gains,
    joined,
    nine,
    printed23,
    printed26,
    size_of,
)


def corrected_form(case) -> Certificate:
    """(26) with its corrections is (9) under (25), whatever the unknowns, K, L, lambda1, lambda2."""
    unknowns = {name: raw for name, raw in UNKNOWNS23.items() if name not in ("X", "M", "N")}
    unknowns |= {"P21": {"shape": [2, 2]}, "K": {"shape": [1, 2]}, "L": {"shape": [1, 2]}}
    unknowns |= {"l1": {"shape": [1, 1]}, "l2": {"shape": [1, 1]}}
    loop = [(name, text) for name, text in gains("K", "L") if name != "K"]
    sides = [
        "diag(" + ", ".join(joined(form(part, GAMMA), rows) for part in "ab") + ")"
        for form, rows in ((nine, NINE), (corrected26, ROWS))
    ]
    return certificate(
        "identity",
        id="eq26-corrected",
        paper=PAPER,
        tables=case,
        statement="(26a), (26b) with five blocks corrected are (9a), (9b) under (25), identically in every unknown.",
        definitions=[*PLANT, *loop, *STRUCTURE],
        unknowns=unknowns,
        fields={"left": sides[0], "right": sides[1]},
        quantities={"identity": "theorem2.corrected_form"},
    )


def congruence_definitions() -> list[tuple[str, str]]:
    """T' (9) T for the two parts, as names Ca and Cb, from the unknowns of (23)."""
    original = [
        ("P21", "inverse(X)"),
        *((f"{name}_o", f"P21.T @ {name} @ P21") for name in ("P11", "Q11", "Q21", "R1")),
    ]
    loop = gains("M @ P21", "inverse(P22).T @ N")
    structure = [
        (name, text.replace("P11", "P11_o").replace("Q11", "Q11_o").replace("Q21", "Q21_o").replace("R1", "R1_o"))
        for name, text in STRUCTURE
    ]
    whole = [(f"C{part}", f"T.T @ {joined(nine(part, GAMMA), NINE)} @ T") for part in "ab"]
    return [*original, *loop, *structure, ("T", "diag(X, 1, X, 1, X, 1, X, 1, 1, 1, 1)"), *whole]


def differing_block(case, row: str, column: str) -> Certificate:
    """One block of the printed (23a) or (23b) is not that of T' (9) T."""
    i, j = ROWS.index(row) + 1, ROWS.index(column) + 1
    a, b = OFFSETS[row], OFFSETS[column]
    here = f"[{a}:{a + size_of(row)}, {b}:{b + size_of(column)}]"
    zero = f"zeros({size_of(row)}, {size_of(column)})"
    return certificate(
        "different",
        id=f"eq23-block-{i}-{j}",
        paper=PAPER,
        tables=case,
        statement=f"Block ({i},{j}) of (23a) as printed is not that of the congruence of (9a) under (25).",
        definitions=[*PLANT, *scalars("number('lambda1_corrected')"), *congruence_definitions()],
        unknowns=UNKNOWNS23,
        witness=point_for(UNKNOWNS23),
        fields={"left": printed23("a", GAMMA).get((row, column), zero), "right": f"Ca{here}"},
    )


def printed23_differs(case) -> Certificate:
    """(23a) as printed is not T' (9a) T under (25)."""
    return certificate(
        "different",
        id="eq23-printed",
        paper=PAPER,
        tables=case,
        statement="(23a) as printed is not the congruence of (9a) under (25), from which the paper derives it.",
        definitions=[*PLANT, *scalars("number('lambda1_corrected')"), *congruence_definitions()],
        unknowns=UNKNOWNS23,
        witness=point_for(UNKNOWNS23),
        fields={"left": joined(printed23("a", GAMMA), ROWS), "right": "Ca"},
        quantities={"identity": "eq23.identity"},
    )


def printed26_differs(case) -> Certificate:
    """(26a) as printed, R1 in Pi221 read as R2, is not (9a) under (25)."""
    unknowns = {name: raw for name, raw in UNKNOWNS23.items() if name not in ("X", "M", "N")}
    unknowns |= {"P21": {"shape": [2, 2]}, "K": {"shape": [1, 2]}, "L": {"shape": [1, 2]}}
    loop = [(name, text) for name, text in gains("K", "L") if name != "K"]
    return certificate(
        "different",
        id="eq26-printed",
        paper=PAPER,
        tables=case,
        statement="(26a) as printed is not (9a) under (25).",
        definitions=[*PLANT, *scalars("number('lambda1_corrected')"), *loop, *STRUCTURE],
        unknowns=unknowns,
        witness=point_for(unknowns),
        fields={"left": joined(printed26("a", GAMMA), ROWS), "right": joined(nine("a", GAMMA), NINE)},
        quantities={"identity": "eq26.identity"},
    )


def wrong_sizes(case) -> list[Certificate]:
    """Misprints that do not even fit: R1 in Pi_221, Q12 among the hats, P21hat as P21bar^-1, A without bar in (7)."""
    symmetric = {name: UNKNOWNS23[name] for name in ("R1", "R2", "Q12", "Q21")}
    inverse = {"X": {"shape": [2, 2]}, "M": {"shape": [1, 2]}}
    loop = [*PLANT, *gains("printed('K')", "printed('L')")]
    return [
        certificate(
            "different",
            id=name,
            paper=PAPER,
            tables=case,
            statement=statement,
            definitions=definitions,
            unknowns=unknowns,
            witness=point_for(unknowns),
            fields={"left": left, "right": right},
        )
        for name, statement, left, right, unknowns, definitions in (
            ("eq26-r1", "R1 is 2 x 2, the block Pi_221 a number.", "R1", "R2", symmetric, ()),
            ("hats-q12", "Q12 is a number, the block of Q21hat 2 x 2.", "Q12", "Q21", symmetric, ()),
            (
                "eq24-inverse",
                "With P21hat = P21bar^-1 read literally, (24) and (23) disagree on K.",
                "M @ inverse(inverse(X))",
                "M @ inverse(X)",
                inverse,
                (),
            ),
            ("eq7-bars", "A of (3) is 2 x 2; z of (7) has three entries.", "A", "A_bar", {}, loop),
        )
    ]
