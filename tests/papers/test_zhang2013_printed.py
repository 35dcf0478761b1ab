"""What the formulas of zhang2013 print, against a second reading of the paper made apart from them."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from gainsay.tables import Case, read_case
from papers.zhang2013 import derivations, statements
from papers.zhang2013.plant import Spacecraft
from tests.papers.latex_cells import computed, spelled

ROOT = Path(__file__).resolve().parents[2]
SECOND = Path(__file__).with_name("zhang2013_second_reading")
SHAPES = {
    **dict.fromkeys(("P11", "Q11", "Q21", "R1", "P21"), (2, 2)),
    **dict.fromkeys(("P12", "Q12", "Q22", "R2", "P22"), (1, 1)),
}


@pytest.fixture(scope="module")
def case() -> Case:
    return read_case(ROOT, "zhang2013")


def second_reading(name: str) -> list[list[str]]:
    with (SECOND / f"{name}.csv").open(newline="") as file:
        return list(csv.reader(file))


def test_every_numbered_item_of_the_paper_stands_in_a_table(case):
    places = [row.where for row in (*case.claims.values(), *case.errata.values(), *case.not_checked)]
    found = {int(number) for place in places for number in re.findall(r"\((\d+)[ab]?\)", place)}
    assert found >= set(range(1, 27))  # the last numbered equation is (26)
    for item in (
        "Theorem 1",
        "Theorem 2",
        "Lemma 1",
        "Figure 1",
        "Figure 2",
        "Figure 3",
        "Numerical example",
        "Abstract",
    ):
        assert any(item in place for place in places), item


def test_every_claim_and_erratum_has_its_own_witness(case):
    # a witness is a quantity that is declared, or a certificate that synthesis or audit makes
    made = {path.stem for path in (ROOT / "papers" / "zhang2013").glob("*.py")}
    sources = "".join((ROOT / "papers" / "zhang2013" / f"{name}.py").read_text() for name in made)
    for erratum in case.errata.values():
        for witness in erratum.witness.split():
            block = re.fullmatch(r"eq23-block-\d-\d", witness)
            sign = re.fullmatch(r"lambda1-sign-(printed|corrected)", witness)
            equation = re.fullmatch(r"eq(17|18|19|22)", witness)
            assert witness in case.quantities or block or sign or equation or f'"{witness}"' in sources, witness


def define(table: str, names: dict) -> dict:
    for name, text in second_reading(table):
        names[re.sub(r"_\{(\w+)\}$", r"_\1", name)] = spelled(text, names)
    return names


def assembled(cells: list[list[str]], names: dict, sizes: list[int]) -> np.ndarray:
    """Matrix from its upper triangle of LaTeX cells."""
    ends = np.cumsum([0, *sizes])
    whole = np.zeros((ends[-1], ends[-1]))
    for i, row in enumerate(cells):
        for j, text in enumerate(row):
            if text in ("*", "0"):
                assert (text == "*") == (j < i)
                continue
            block = spelled(text, names)
            block = np.eye(sizes[i]) * block if np.ndim(block) == 0 else block
            if block.shape == (1, 1) and sizes[i] == sizes[j] > 1:
                block = block * np.eye(sizes[i])
            whole[ends[i] : ends[i + 1], ends[j] : ends[j + 1]] = block
            whole[ends[j] : ends[j + 1], ends[i] : ends[i + 1]] = block.T
    return whole


@pytest.fixture(scope="module")
def setting(case) -> dict:
    """Data of the plant as printed, and scalars other than those of the example."""
    craft = Spacecraft.of(case)
    plant = {name: np.asarray(getattr(craft, name), dtype=float) for name in ("A", "B", "C1", "C2", "Cd1", "Cd2")}
    return plant | {"g": 1.7**2, "d_M": 0.4, "mu": 0.3, "l1": 0.6, "l2": 0.8}


UNKNOWNS = {**statements.UNKNOWNS_23, **statements.UNKNOWNS_26}


def random_values(seed: int = 3) -> dict:
    rng = np.random.default_rng(seed)
    values = {}
    for name, unknown in UNKNOWNS.items():
        if name in ("l1", "l2"):
            continue
        value = rng.normal(size=(unknown.rows, unknown.columns))
        values[name] = value + value.T if unknown.structure == "symmetric" else value
    return values


def indexed(values: dict) -> dict:
    """Values under the names of the second reading: hats and bars do not tell unknowns apart."""
    names = {"I": 1.0}
    for name, value in values.items():
        letter, below = name[0], name[1:]
        for spelling in (letter, rf"\hat{{{letter}}}", rf"\bar{{{letter}}}"):
            names[f"{spelling}_{below}" if below else spelling] = value
    return names


def names_of(setting: dict, values: dict) -> dict:
    """Values of data, scalars and unknowns under the names of the second reading."""
    scalars = {r"\lambda_1": 0.6, r"\lambda_2": 0.8, r"\gamma": 1.7, r"\mu": 0.3, "d_M": 0.4}
    matrices = {name: value for name, value in setting.items() if name[0] in "ABC"}
    return {**indexed({**matrices, **values}), **scalars}


SIZES = list(statements.SIZES.values())


@pytest.mark.parametrize("part", ["a", "b"])
def test_printed_theorem_2_is_what_the_second_reading_spells(setting, part):
    values = random_values()
    # the hat of P21 is the unknown X
    names = names_of(setting, {**values, "P21": values["X"]})
    expected = assembled(second_reading(f"eq23{part}"), define("pi23", names), SIZES)
    np.testing.assert_allclose(
        computed(statements.equation_23(part).formula, {**setting, **values}), expected, atol=1e-12
    )


@pytest.mark.parametrize("part", ["a", "b"])
def test_printed_26_is_what_the_second_reading_spells(setting, part):
    values = random_values()
    # Pi44, Pi66, Pi881, Pi882 are those of (23), which have the same letters
    names = define("pi23", names_of(setting, {**values, "P21": values["X"]})) | names_of(setting, values)
    for name, text in second_reading("pi26"):
        # Pi_221 and Pi_222 print R1, which does not fit; R2 is read there, as statements.equation_26 says
        text = text.replace("R_1", "R_2") if name in (r"\Pi_{221}", r"\Pi_{222}") else text
        names[name.replace("{", "").replace("}", "")] = spelled(text, names)
    expected = assembled(second_reading(f"eq26{part}"), names, SIZES)
    np.testing.assert_allclose(
        computed(statements.equation_26(part).formula, {**setting, **values}), expected, atol=1e-12
    )


#: what the derivation of Theorem 1 prints: statement, its second reading, sizes of its rows
THEOREM_1 = {
    "eq9a": (statements.equation_9("a", {}), [3, 3, 3, 3, 2, 1]),
    "eq9b": (statements.equation_9("b", {}), [3, 3, 3, 3, 2, 1]),
    "eq15": (derivations.jensen("(15)", "3", "1"), [3, 3, 3]),
    "eq16": (derivations.jensen("(16)", "1", "3"), [3, 3, 3]),
    "eq17": (derivations.EQUATION_17, [3, 3, 3, 3]),
    "eq22": (derivations.EQUATION_22, [3, 3, 3, 3, 2]),
}


@pytest.mark.parametrize("name", THEOREM_1)
def test_theorem_1_and_its_proof_are_what_the_second_reading_spells(name):
    statement, sizes = THEOREM_1[name]
    rng = np.random.default_rng(7)
    unknowns = {}
    for letter in ("P1", "P2", "P3", "Q1", "Q2", "R"):
        value = rng.normal(size=(3, 3))
        unknowns[letter] = value if letter in ("P2", "P3") else value + value.T
    shapes = {"A_bar": (3, 3), "A_d": (3, 3), "B_bar": (3, 2), "C_z": (1, 3), "C_d": (1, 2)}
    data = {letter: rng.normal(size=shape) for letter, shape in shapes.items()}
    d_M = 1.0 if name in ("eq15", "eq16") else 0.4  # derived in units of time in which d_M = 1
    scalars = {r"\mu": 0.3, r"\gamma": 1.7, "d_M": d_M}
    printed = {"A": data["A_bar"], "Ad": data["A_d"], "B": data["B_bar"], "C": data["C_z"], "Cd": data["C_d"]}
    names = define("omega", {**indexed({**unknowns, **printed}), **scalars})
    # Omega_23 is not defined in the text (erratum omega23): it is the block (2, 3) of (9)
    names[r"\Omega_23"] = unknowns["P3"].T @ data["A_d"]
    values = {**unknowns, **data, "d_M": d_M, "mu": 0.3, "g": 1.7**2}
    expected = assembled(second_reading(name), names, sizes)
    np.testing.assert_allclose(computed(statement.formula, values), expected, atol=1e-12)
