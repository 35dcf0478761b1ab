import csv
import re
from fractions import Fraction
from pathlib import Path

import pytest

from gainsay.exact.digits import PrintedNumber
from gainsay.tables import Case, read_case

ROOT = Path(__file__).resolve().parents[2]
SECOND = Path(__file__).with_name("wan2014_second_reading")


@pytest.fixture(scope="module")
def case() -> Case:
    return read_case(ROOT, "wan2014")


def second_reading(name: str) -> list[list[str]]:
    with (SECOND / f"{name}.csv").open(newline="") as file:
        return list(csv.reader(file))


def texts(case: Case, name: str) -> list[list[str]]:
    return [[entry.text for entry in row] for row in case.printed(name).rows]


def product(term: str) -> tuple[Fraction, str, int]:
    """Split an entry such as ``2.5*n^2`` into coefficient, symbol and power; 0 has no symbol."""
    match = re.fullmatch(r"(?P<sign>-?)(?P<number>\d+(?:\.\d+)?)?\*?(?:(?P<symbol>[en])(?:\^(?P<power>\d))?)?", term)
    assert match and (match["number"] or match["symbol"]), term
    coefficient = Fraction(match["number"] or 1) * (-1 if match["sign"] else 1)
    return coefficient, match["symbol"] or "", int(match["power"] or 1) if match["symbol"] else 0


def test_second_readings_of_e1_and_e2_are_coefficient_times_power(case):
    for name, symbol in (("E1", "e"), ("E2", "n")):
        stem = {"E1": "E1_over_e", "E2": "E2_coefficient"}[name]
        powers = case.printed("E2_power").exact if name == "E2" else [[1] * 6] * 6
        for i, row in enumerate(second_reading(name)):
            for j, term in enumerate(row):
                coefficient, found, power = product(term)
                assert case.printed(stem).exact[i][j] == coefficient, (name, i, j)
                if coefficient:
                    assert (found, power) == (symbol, powers[i][j]), (name, i, j)
                else:
                    assert (found, power) == ("", 0)


def test_the_printed_x_is_symmetric_to_the_digit(case):
    rows = texts(case, "X")
    assert rows == [list(column) for column in zip(*rows, strict=True)]


def test_only_what_the_paper_leaves_out_is_assumed(case):
    left_out = {name for name, row in case.parameters.items() if row.status == "assumed"}
    assert {"gravitational_parameter", "observer_start", "thrust_model", "horizon"} <= left_out
    assert not left_out & {"mass", "eccentricity", "mean_motion", "perigee_radius", "x0", "K", "L", "X", "Y"}


def test_printed_numbers_have_the_units_of_the_paper(case):
    units = {"perigee_radius": "km", "mean_motion": "rad/s", "mass": "kg", "thrust_max_x": "N", "eccentricity": "1"}
    assert {name: case.parameters[name].unit for name in units} == units


def items(where: str) -> set[str]:
    """Return the equations, theorems, lemmas and figures that a `where` names; ``(33)-(36)`` names four."""
    found = set()
    for low, high in re.findall(r"\((\d+)\)(?:\s*(?:-|–|to)\s*\((\d+)\))?", where):
        found |= {f"({k})" for k in range(int(low), int(high or low) + 1)}
    for kind, numbers in re.findall(r"(Figure|Theorem|Lemma)s? (\d+(?:(?:, | and )\d+)*)", where):
        found |= {f"{kind} {number}" for number in re.findall(r"\d+", numbers)}
    return found


def test_places_are_read_as_meant():
    assert items("(12), (13), Lemma 1") == {"(12)", "(13)", "Lemma 1"}
    assert items("(33)-(36) and Figures 3 and 5") == {"(33)", "(34)", "(35)", "(36)", "Figure 3", "Figure 5"}
    assert items("Section 3.1") == set()


# The paper numbers its equations (1) to (44), has Lemma 1, Theorems 2 and 3 (one counter for all) and Figures 1 to 5.
FIGURES = [f"Figure {k}" for k in range(1, 6)]
NUMBERED = [*(f"({k})" for k in range(1, 45)), "Lemma 1", "Theorem 2", "Theorem 3", *FIGURES]


@pytest.mark.parametrize("item", NUMBERED)
def test_everything_numbered_is_claimed_corrected_or_set_aside_with_a_reason(case, item):
    rows = [*case.claims.values(), *case.errata.values(), *case.not_checked]
    assert any(item in items(row.where) for row in rows)


def test_every_matrix_of_section_4_is_claimed_corrected_or_set_aside(case):
    rows = [*case.claims.values(), *case.errata.values()]
    named = set().union(*(items(row.where) for row in rows))
    assert {"(39)", "(40)", "(41)", "(42)", "(43)", "(44)"} <= named


def test_a_contradiction_on_record_says_whether_ocr_could_be_to_blame(case):
    for claim in case.claims.values():
        if claim.expected == "contradicted" and claim.kind != "trajectory":
            assert claim.note, claim.id


def test_claims_of_digits_publish_the_digits_of_the_paper(case):
    # A published number that the tables hold too must be the same text.
    assert case.claims["mean-motion"].published == case.parameters["mean_motion"].value
    for claim in case.claims.values():
        if claim.comparator in ("equal", "at_most", "at_least"):
            for end in claim.published.split(".."):  # a threshold that the paper does not print is a range
                PrintedNumber(end)
