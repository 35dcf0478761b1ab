"""What the tables and formulas of zhang2013 print, against a second reading of the paper made apart from them."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from gainsay.tables import Case, read_case
from papers.zhang2013 import statements
from papers.zhang2013.plant import Spacecraft

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


@pytest.mark.parametrize("name", ["K", "L", "F", "C1"])
def test_two_readings_of_a_printed_matrix_agree_digit_for_digit(case, name):
    assert [[entry.text for entry in row] for row in case.printed(name).rows] == second_reading(name)


def test_two_readings_of_the_numbers_agree_digit_for_digit(case):
    for name, text in second_reading("example"):
        assert case.parameters[name].value == text, name


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


SYMBOL = re.compile(
    r"\\frac\{(?P<up>\d)\}\{d_M\}|\((?P<bracket>[^()]*)\)|(?P<number>\d+)|\\(?P<greek>lambda_\d|mu|gamma\^2)|"
    r"(?P<delay>d_M)|\\(?P<accent>hat|bar)\{(?P<accented>\\?[A-Za-z]+)\}(?:_(?P<below>\{\w+\}|\w))?|"
    r"\\(?P<capital>Pi|Omega)_(?P<index>\{\w+\}|\w)|(?P<letter>[A-Z])(?:_(?P<sub>\{\w+\}|\w))?"
)


def latex(text: str, names: dict) -> np.ndarray | float:
    """Value of a sum of products as the paper writes it, juxtaposition being the product."""
    total, term, sign, position = 0.0, None, 1.0, 0
    text = text.strip()
    while position < len(text):
        if text[position] in "+- ":
            if text[position] in "+-":
                total, term = total + (0.0 if term is None else sign * term), None
                sign = 1.0 if text[position] == "+" else -1.0
            position += 1
            continue
        found = SYMBOL.match(text, position)
        assert found, text[position:]
        position = found.end()
        transposed = text[position:].startswith(r"^{\top}")
        position += len(r"^{\top}") * transposed
        value = factor(found, names)
        value = value.T if transposed else value
        if term is None:
            term = value
        else:
            scalar = np.ndim(term) == 0 or np.ndim(value) == 0
            term = term * value if scalar else term @ value
    return total + sign * term


def factor(found: re.Match, names: dict) -> np.ndarray | float:
    """Value of one factor; hats and bars of the paper are dropped from names except for Pi and Omega."""
    if found["up"]:
        return float(found["up"]) / names["d_M"]
    if found["bracket"]:
        return latex(found["bracket"], names)
    if found["number"]:
        return float(found["number"])
    if found["greek"]:
        return names[found["greek"]]
    if found["delay"]:
        return names["d_M"]
    if found["capital"]:
        return names[f"{found['capital']}_{found['index'].strip('{}')}"]
    if found["accent"]:
        below = (found["below"] or "").strip("{}")
        if found["accented"].startswith("\\"):
            return names[f"hat{found['accented'][1:]}_{below}"]
        return names[("bar" if found["accent"] == "bar" else "") + found["accented"] + below]
    return names[found["letter"] + (found["sub"] or "").strip("{}")]


def define(table: str, names: dict) -> dict:
    for name, text in second_reading(table):
        found = SYMBOL.match(name)
        key = f"hat{found['accented'][1:]}_" if found["accent"] else f"{found['capital']}_"
        names[key + (found["below"] or found["index"]).strip("{}")] = latex(text, names)
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
            block = latex(text, names)
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


def names_of(setting: dict, values: dict) -> dict:
    """Values under the names of the second reading."""
    renamed = {"l1": "lambda_1", "l2": "lambda_2", "g": "gamma^2"}
    return {**values, "I": np.eye(1), **{renamed.get(name, name): value for name, value in setting.items()}}


SIZES = list(statements.SIZES.values())


@pytest.mark.parametrize("part", ["a", "b"])
def test_printed_theorem_2_is_what_the_second_reading_spells(setting, part):
    values = random_values()
    names = names_of(setting, values)
    names["P21"] = values["X"]  # the hat of P21 is the unknown X
    expected = assembled(second_reading(f"eq23{part}"), define("pi23", names), SIZES)
    found = evaluate(statements.equation_23(part).formula, setting, values)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_printed_26_is_what_the_second_reading_spells(case, setting):
    values = random_values()
    # Pi_221 prints R1, which does not fit; R2 is read there, as statements.equation_26 says
    names = names_of(setting, values)
    for name, text in second_reading("pi26"):
        if "221" in name or "222" in name:
            text = text.replace("R_1", "R_2")
        names["Pi_" + name[name.index("{") :].strip("{}")] = latex(text, names)
    # Pi44, Pi66, Pi881 are those of (23), which have the same letters
    names |= {
        key: value
        for key, value in define("pi23", {**names, "P21": values["X"]}).items()
        if key in ("hatPi_44", "hatPi_66", "hatPi_881")
    }
    expected = assembled(second_reading("eq26a"), names, SIZES)
    found = evaluate(statements.equation_26("a").formula, setting, values)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def evaluate(text: str, setting: dict, values: dict) -> np.ndarray:
    """Value of a certificate's formula at floats, by the checker's own evaluator."""
    from fractions import Fraction

    from gainsay.exact.matrix import Matrix
    from gainsay.exact.rational import rational_matrix
    from gainsay.proof import formulas as language

    exact = {name: np.atleast_2d(value) for name, value in {**setting, **values}.items()}
    matrices = {
        name: Matrix(rational_matrix([[Fraction(float(x)) for x in row] for row in np.asarray(value).tolist()]))
        for name, value in exact.items()
    }
    value = language.evaluate(text, matrices, None)
    return np.array([[int(x.p) / int(x.q) for x in row] for row in value.rows()])


@pytest.mark.parametrize("part", ["a", "b"])
def test_theorem_1_is_what_the_second_reading_spells(part):
    rng = np.random.default_rng(7)
    unknowns = {}
    for name in ("P1", "P2", "P3", "Q1", "Q2", "R"):
        value = rng.normal(size=(3, 3))
        unknowns[name] = value if name in ("P2", "P3") else value + value.T
    shapes = {"barA": (3, 3), "barA_d": (3, 3), "barB": (3, 2), "C": (1, 3), "Cd": (1, 2)}
    data = {name: rng.normal(size=shape) for name, shape in shapes.items()}
    names = {**unknowns, **data, "I": np.eye(1), "d_M": 0.4, "mu": 0.3, "gamma^2": 2.89}
    names["barAd"] = names["barA_d"]
    cells = second_reading(f"eq9{part}")
    expected = assembled(cells, define("omega", names), [3, 3, 3, 3, 2, 1])
    loop = {"A_bar": data["barA"], "A_d": data["barA_d"], "B_bar": data["barB"], "C_z": data["C"], "C_d": data["Cd"]}
    found = evaluate(statements.equation_9(part, {}).formula, {"d_M": 0.4, "mu": 0.3, "g": 2.89}, {**loop, **unknowns})
    np.testing.assert_allclose(found, expected, atol=1e-12)
