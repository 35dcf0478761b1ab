"""Errata of inequalities follow from their editions, whose differing cells were typed by hand a second time here.

What was typed spells cells in LaTeX, the editions in the language of formulas; both are evaluated on random matrices.
"""

import ast
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from gainsay.errors import InputError
from gainsay.statements import Statement
from gainsay.steps.editions import with_texts
from gainsay.tables import read_case
from papers.li2021 import statements as li
from papers.pinheiro2013 import statements as pinheiro
from papers.wan2014 import statements as wan
from papers.zhang2013 import statements as zhang
from tests.papers.latex_cells import computed, spelled

ROOT = Path(__file__).resolve().parents[2]
Cells = dict[tuple[str, str], tuple[str, str]]
IN_BLOCK = re.compile(r"(?:\$(?P<before>[^$]*)\$|(?P<zero>\b0)) in block \((?P<row>\d),(?P<column>\d)\)")
BLOCK = re.compile(r"block \((?P<row>\d),(?P<column>\d)\) \$(?P<after>[^$]*)\$")
RNG = np.random.default_rng(5)
#: the errata of inequalities as they were typed by hand, from the papers and their derivations
TYPED = {
    "li2021": {
        "lemma-3": (
            r"$-P\tilde{E}$ in block (1,2) and 0 in block (2,6)",
            r"0 in block (1,2) and $-\tilde{E}^\top P$ in block (2,6)",
        ),
    },
    "pinheiro2013": {
        "eq21-gamma-sign": (
            r"block (3,3) $\gamma^2 I$",
            r"$-\gamma^2 I$",
        ),
    },
    "wan2014": {
        "eq14-input-twice": (
            r"two input columns, $(Y^\top, -Y^\top)$ and $(-Y^\top, Y^\top)$, each against $-R^{-1}$",
            r"one column $(Y^\top, -Y^\top)$ against $-R^{-1}$",
        ),
        "eq14-empty-row": (
            r"a fourth block row with $-\varepsilon I$ and zeros",
            "no such row",
        ),
        "eq29-sign": (
            r"$\begin{bmatrix}\rho & \xi^\top(0)\\ \star & -\bar{P}\end{bmatrix} < 0$",
            r"$\begin{bmatrix}-\rho & \xi^\top(0)\\ \star & -\bar{P}^{-1}\end{bmatrix} < 0$",
        ),
    },
    "zhang2013": {
        "eq23-block-2-6": (
            "0",
            "$(3/d_M) R_2$ in (a), $(1/d_M) R_2$ in (b)",
        ),
        "eq23-block-2-9": (
            "$N B$",
            "$-N B$",
        ),
        "eq23-block-3-5": (
            r"$\lambda_1 B M + (3/d_M)\hat{R}_1$ in (a), $\lambda_1 B M + (1/d_M)\hat{R}_1$ in (b)",
            r"$\lambda_1 B M$",
        ),
        "eq23-block-7-7": (
            r"$\hat{Q}_{11} - (1/d_M) \hat{R}_{1}$ in (a), $\hat{Q}_{11} - (3/d_M) \hat{R}_{1}$ in (b)",
            r"$-\hat{Q}_{11} - (1/d_M) \hat{R}_{1}$ in (a), $-\hat{Q}_{11} - (3/d_M) \hat{R}_{1}$ in (b)",
        ),
        "eq23-block-8-8": (
            "$Q_{12} - (1/d_M) R_{2}$ in (a), $Q_{12} - (3/d_M) R_{2}$ in (b)",
            "$-Q_{12} - (1/d_M) R_{2}$ in (a), $-Q_{12} - (3/d_M) R_{2}$ in (b)",
        ),
    },
}


def of(unknowns: dict, **more) -> dict:
    """Random matrices for unknowns, symmetric where they are."""
    values = {}
    for name, unknown in unknowns.items():
        value = RNG.normal(size=(unknown.rows, unknown.columns))
        values[name] = (
            value + value.T if unknown.structure == "symmetric" else np.abs(value) if unknown.positive else value
        )
    return {**values, **more}


@dataclass(frozen=True)
class Edition:
    """An edition, its rows of the errata, how they spell cells, and values under the names of both languages."""

    paper: str
    name: str
    statement: Statement
    errata: tuple[str, ...]
    cells: Callable[[str, str, str], Cells]
    values: dict
    latex: dict


def blocks(statement: Statement) -> Callable[[str, str, str], Cells]:
    """Cells of texts such as "$-P$ in block (1,2) and 0 in block (2,6)", or "block (3,3) $-I$" and "$I$"."""

    def read(id: str, printed: str, corrected: str) -> Cells:
        both = []
        for text in (printed, corrected):
            found = {(m["row"], m["column"]): m["before"] or m["zero"] for m in IN_BLOCK.finditer(text)}
            both.append(found or {(m["row"], m["column"]): m["after"] for m in BLOCK.finditer(text)})
        first, second = both
        second = second or {place: corrected.strip("$") for place in first}
        assert set(first) == set(second), id
        rows = statement.rows
        return {(rows[int(i) - 1], rows[int(j) - 1]): (first[i, j], second[i, j]) for i, j in first}

    return read


def by_id(part: str) -> Callable[[str, str, str], Cells]:
    """The cell that an id such as eq23-block-2-6 names; texts may differ between (a) and (b)."""

    def read(id: str, printed: str, corrected: str) -> Cells:
        row, column = (zhang.ROWS[int(i) - 1] for i in id.split("-")[2:])
        texts = []
        for text in (printed, corrected):
            parts = {m[2]: m[1] for m in re.finditer(r"\$([^$]*)\$ in \((\w)\)", text)}
            texts.append(parts.get(part, text.strip("$")))
        return {(row, column): (texts[0], texts[1])}

    return read


def matrices(id: str, printed: str, corrected: str) -> Cells:
    """Cells of two bordered matrices [[rho, .], [., -P]] that differ; the second row stands for x and e alike."""
    first, second = (re.search(r"\{bmatrix\}(.*?)&.*?&(.*?)\\end", text) for text in (printed, corrected))
    corner, lower = ((first[i].strip(), second[i].strip()) for i in (1, 2))
    return {("rho", "rho"): corner, ("x", "x"): lower, ("e", "e"): lower}


def columns(id: str, printed: str, corrected: str) -> Cells:
    """Columns (a, b) against c: one as printed, and a second one that the corrected edition has not."""
    pairs = [re.findall(r"\$\(([^,$]+), ([^$]+)\)\$", text) for text in (printed, corrected)]
    (against, still) = (re.search(r"against \$([^$]+)\$", text)[1] for text in (printed, corrected))
    assert pairs[0][:1] == pairs[1] and against == still
    again = pairs[0][1]
    return {
        ("x", "u again"): (again[0], "0"),
        ("e", "u again"): (again[1], "0"),
        ("u again", "u again"): (against, "0"),
    }


def columns_and_row(id: str, printed: str, corrected: str) -> Cells:
    """The same, and the row that holds one block, without which the corrected edition does."""
    if id != "eq14-empty-row":
        return columns(id, printed, corrected)
    assert corrected == "no such row"
    return {("0", "0"): (re.search(r"row with \$([^$]*)\$", printed)[1], "0")}


def editions() -> list[Edition]:
    size = {"states": 2, "inputs": 1, "disturbances": 4, "errors": 3, "costs": 3}
    twenty_one = pinheiro.corrected_21(size, {}, "g2")
    P, E_t = of({"P": li.EQ12.unknowns["P"]})["P"], RNG.normal(size=(12, 3))
    loop = of(li.EQ12.unknowns, P=P, E_t=E_t)
    printed = of({**wan.THEOREM, **wan.PROOF}, R=np.diag([1.0, 2.0, 3.0]))
    found = [
        Edition("li2021", "EQ12_CORRECTED", li.EQ12_CORRECTED, ("lemma-3",), blocks(li.EQ12), loop,
                {"P": P, r"\tilde{E}": E_t}),
        Edition("pinheiro2013", "corrected_21", twenty_one, ("eq21-gamma-sign",), blocks(twenty_one), {"gamma2": 2.25},
                {r"\gamma": 1.5, "I": np.eye(3)}),
        Edition("wan2014", "EQ29_CORRECTED", wan.EQ29_CORRECTED, ("eq29-sign",), matrices, printed,
                {r"\rho": printed["rho"].item(), r"\bar{P}": printed["P"]}),
        Edition("wan2014", "EQ14_CORRECTED", wan.EQ14_CORRECTED, ("eq14-input-twice", "eq14-empty-row"),
                columns_and_row, printed,
                {**{name: printed[name] for name in "YR"}, r"\varepsilon": printed["eps"].item(), "I": np.eye(6)}),
    ]  # fmt: skip
    plant = {"A": RNG.normal(size=(2, 2)), "B": RNG.normal(size=(2, 1)), "d_M": 0.4, "mu": 0.3, "l1": 0.6, "l2": 0.8}
    values = of(zhang.UNKNOWNS_23, **plant)
    hats = {rf"\hat{{{name[0]}}}_{name[1:]}": values[name] for name in ("P11", "Q11", "Q21", "R1")}
    latex = {**hats, **{f"{name[0]}_{name[1:]}": values[name] for name in ("P12", "Q12", "Q22", "R2")}, "d_M": 0.4,
             r"\lambda_1": 0.6, **{name: values[name] for name in "ABMN"}}  # fmt: skip
    errata = tuple(f"eq23-block-{i}-{j}" for i, j in ((2, 6), (2, 9), (3, 5), (7, 7), (8, 8)))
    return [*found, *(Edition("zhang2013", "corrected_23", zhang.corrected_23(part), errata, by_id(part), values, latex)
                      for part in "ab")]  # fmt: skip


EDITIONS = editions()


def disagreements(edition: Edition, table: dict[str, tuple[str, str]]) -> list[str]:
    """In what the rows of the errata and the differing cells of the edition do not say the same."""
    cells: Cells = {}
    for id in edition.errata:
        cells |= edition.cells(id, *table[id])
    differing = {(c.row, c.column): (c.printed, c.corrected) for c in edition.statement.differences}
    found = [f"{place} stands in one of both" for place in set(cells) ^ set(differing)]
    for place in set(cells) & set(differing):
        for latex, formula in zip(cells[place], differing[place], strict=True):
            ours = computed(formula, edition.values) if formula else 0.0
            if not np.allclose(spelled(latex, edition.latex) * np.ones_like(ours), ours, atol=1e-9):
                found.append(f"{place}: {latex} is not {formula}")
    return found


def noticed(edition: Edition, table: dict[str, tuple[str, str]]) -> bool:
    try:
        return bool(disagreements(edition, table))
    except AssertionError:  # the texts cannot be read as two editions at all
        return True


@pytest.mark.parametrize("edition", EDITIONS, ids=lambda e: e.statement.label)
def test_the_errata_are_the_cells_in_which_the_editions_differ(edition):
    assert not disagreements(edition, TYPED[edition.paper])


@pytest.mark.parametrize("edition", EDITIONS, ids=lambda e: e.statement.label)
def test_another_sign_or_cell_in_either_is_noticed(edition):
    table = TYPED[edition.paper]
    for id in edition.errata:
        printed, corrected = table[id]
        for other in ((printed, printed), (corrected, printed)):
            assert noticed(edition, {**table, id: other}), id


def made_of_cells(module: object) -> set[str]:
    """Names at the top of a module whose value, or what they return, is an edition named `corrected`."""
    names = set()
    for node in ast.parse(Path(module.__file__).read_text()).body:
        calls = [c for c in ast.walk(node) if isinstance(c, ast.Call) and getattr(c.func, "attr", "") == "corrected"]
        if any(not any(k.arg == "edition" for k in call.keywords) for call in calls):
            names |= {node.name} if isinstance(node, ast.FunctionDef) else {target.id for target in node.targets}
    return names


@pytest.mark.parametrize("module", [li, pinheiro, wan, zhang])
def test_every_corrected_edition_is_held_against_the_errata(module):
    paper = Path(module.__file__).parent.name
    # of the equations before a congruence the same cells differ; entries of matrices are not inequalities
    same = {"corrected_26", "EQ25_CORRECTED"} | {n for n in made_of_cells(module) if n.startswith(("ROTATION", "G0"))}
    assert made_of_cells(module) - same == {e.name for e in EDITIONS if e.paper == paper}


def test_25_differs_from_its_edition_in_cells_of_14():
    cells = [{(c.row, c.column) for c in form.differences} for form in (wan.EQ25_CORRECTED, wan.EQ14_CORRECTED)]
    assert cells[0] == cells[1] - {("0", "0")}


@pytest.mark.parametrize("module", [li, pinheiro, wan, zhang])
def test_the_table_says_of_inequalities_what_their_editions_say_and_nothing_else(module):
    paper = Path(module.__file__).parent.name
    case = read_case(ROOT, paper)
    of_table, filled = case.errata, with_texts(case).errata
    for edition in EDITIONS:
        for id in edition.errata if edition.paper == paper else ():
            assert (of_table[id].printed, of_table[id].corrected) == ("", "")
    for id, row in filled.items():
        assert row.printed and row.corrected and row.printed != row.corrected, id


def test_texts_of_an_erratum_are_typeset_from_the_cells():
    # Expected: (21) of the paper, its block (3,3) as printed and with the sign of the bounded real lemma.
    row = with_texts(read_case(ROOT, "pinheiro2013")).errata["eq21-gamma-sign"]
    assert (row.printed, row.corrected) == (r"$\gamma^{2} I$ in block (3,3)", r"$-\gamma^{2} I$ in block (3,3)")


@pytest.mark.parametrize(
    ("named", "said"),
    [
        ("(12) correct: (1,2) (2,6)", "(12) corrected"),
        ("(12) corrected: (1,2) (2,5)", "one of (1,2) (2,6)"),
        ("(12) corrected: (1,2)", "(12) corrected: (2,6), which no erratum names"),
        ("", "(12) corrected: (1,2), which no erratum names"),
    ],
)
def test_an_erratum_that_names_another_edition_or_cell_is_refused(named, said):
    case = read_case(ROOT, "li2021")
    row = case.errata["lemma-3"].model_copy(update={"edition": named})
    changed = replace(case, errata={**case.errata, "lemma-3": row})
    with pytest.raises(InputError, match=re.escape(said)):
        with_texts(changed)


def test_26_differs_from_its_edition_in_the_cells_of_23():
    """In the unknowns before the congruence the cells read otherwise; the rows name both equations."""
    for part in "ab":
        places = [
            {(c.row, c.column) for c in form(part).differences} for form in (zhang.corrected_23, zhang.corrected_26)
        ]
        assert places[0] == places[1]
    for id, row in read_case(ROOT, "zhang2013").errata.items():
        if id.startswith("eq23-block"):
            assert row.where == "(23), (26)"
