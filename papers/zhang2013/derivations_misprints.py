"""Certificates of what (23), (24) and (26) of zhang2013 print wrongly, against the congruence of (9) under (25)."""

from gainsay.proof import Certificate
from gainsay.statements import Statement, differing, identical, matrix
from gainsay.tables import Case
from papers.zhang2013.statements import (
    LAMBDAS,
    OFFSETS,
    PARTS,
    PLANT,
    PRINTED_LOOP,
    ROWS,
    SIZES,
    STRUCTURE,
    UNKNOWNS_23,
    UNKNOWNS_26,
    corrected_26,
    design_loop,
    equation_9,
    equation_23,
    equation_26,
)

#: (7) for gains that are unknown
ANY_LOOP = {name: text for name, text in design_loop("K", "L").items() if name != "K"}


def both(equation: object) -> str:
    """Parts a and b side by side."""
    assert callable(equation)
    return "diag(" + ", ".join(equation(part).formula for part in PARTS) + ")"


def _nine(part: str) -> Statement:
    return equation_9(part, {})


def corrected_form(case: Case) -> Certificate:
    """(26) with its corrections is (9) under (25), whatever the unknowns, K, L, lambda1, lambda2."""
    return identical(
        case,
        "theorem2.corrected_form",
        "(26a), (26b) with five blocks corrected are (9a), (9b) under (25), identically in every unknown.",
        both(_nine),
        both(corrected_26),
        UNKNOWNS_26,
        id="eq26-corrected",
        definitions={**ANY_LOOP, **STRUCTURE},
    )


def congruence_definitions() -> dict[str, str]:
    """T' (9) T for the two parts, as names Ca and Cb, from the unknowns of (23)."""
    hats = ("P11", "Q11", "Q21", "R1")
    original = {"P21": "inverse(X)", **{f"{name}_o": f"P21.T @ {name} @ P21" for name in hats}}
    structure = dict(STRUCTURE)
    for name in hats:
        structure = {key: text.replace(name, f"{name}_o") for key, text in structure.items()}
    loop = design_loop("M @ P21", "inverse(P22).T @ N")
    whole = {f"C{part}": f"T.T @ {equation_9(part, {}).formula} @ T" for part in PARTS}
    return {**PLANT, **LAMBDAS, **original, **loop, **structure, "T": "diag(X, 1, X, 1, X, 1, X, 1, 1, 1, 1)", **whole}


def differing_block(case: Case, row: str, column: str) -> Certificate:
    """One block of the printed (23a) or (23b) is not that of T' (9) T."""
    i, j = ROWS.index(row) + 1, ROWS.index(column) + 1
    a, b = OFFSETS[row], OFFSETS[column]
    here = f"[{a}:{a + SIZES[row]}, {b}:{b + SIZES[column]}]"
    return differing(
        case,
        "",
        f"Block ({i},{j}) of (23a) as printed is not that of the congruence of (9a) under (25).",
        equation_23("a").block(row, column) or f"zeros({SIZES[row]}, {SIZES[column]})",
        f"Ca{here}",
        UNKNOWNS_23,
        id=f"eq23-block-{i}-{j}",
        definitions=congruence_definitions(),
    )


def printed_23_differs(case: Case) -> Certificate:
    """(23a) as printed is not T' (9a) T under (25)."""
    return differing(
        case,
        "eq23.identity",
        "(23a) as printed is not the congruence of (9a) under (25), from which the paper derives it.",
        equation_23("a").formula,
        "Ca",
        UNKNOWNS_23,
        id="eq23-printed",
        definitions=congruence_definitions(),
    )


def printed_26_differs(case: Case) -> Certificate:
    """(26a) as printed, R1 in Pi221 read as R2, is not (9a) under (25)."""
    unknowns = {name: unknown for name, unknown in UNKNOWNS_26.items() if name not in LAMBDAS}
    return differing(
        case,
        "eq26.identity",
        "(26a) as printed is not (9a) under (25).",
        equation_26("a").formula,
        equation_9("a", {}).formula,
        unknowns,
        id="eq26-printed",
        definitions={**ANY_LOOP, **LAMBDAS, **STRUCTURE},
    )


def wrong_sizes(case: Case) -> list[Certificate]:
    """Misprints that do not even fit: R1 in Pi_221, Q12 among the hats, P21hat as P21bar^-1, A without bar in (7)."""
    two = {name: UNKNOWNS_23[name] for name in ("R1", "R2")}
    hats = {name: UNKNOWNS_23[name] for name in ("Q12", "Q21")}
    inverse = {"X": matrix(2, 2), "M": matrix(1, 2)}
    return [
        differing(case, "", "R1 is 2 x 2, the block Pi_221 a number.", "R1", "R2", two, id="eq26-r1"),
        differing(case, "", "Q12 is a number, the block of Q21hat 2 x 2.", "Q12", "Q21", hats, id="hats-q12"),
        differing(
            case,
            "",
            "With P21hat = P21bar^-1 read literally, (24) and (23) disagree on K.",
            "M @ inverse(inverse(X))",
            "M @ inverse(X)",
            inverse,
            id="eq24-inverse",
        ),
        differing(
            case,
            "",
            "A of (3) is 2 x 2; z of (7) has three entries.",
            "A",
            "A_bar",
            {},
            id="eq7-bars",
            definitions=PRINTED_LOOP,
        ),
    ]
