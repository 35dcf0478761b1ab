import csv
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from gainsay.exact.digits import PrintedNumber
from gainsay.statements.floats import Floats
from papers.pinheiro2013 import statements
from papers.pinheiro2013.plant import Satellite, generalized_plant

SECOND = Path(__file__).with_name("pinheiro2013_second_reading")
FOLDER = Path(__file__).parents[2] / "papers" / "pinheiro2013"


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


PARAMETERS = {row["name"]: row for row in rows(FOLDER / "parameters.csv")}


def test_plant_is_the_printed_one_but_for_the_sign_of_the_torques():
    # Expected: (18) transcribed entry by entry; d and u enter with the sign of (12), erratum eq18-torque-sign.
    satellite = Satellite((7.0, 6.0, 5.0), 1e-3, 0.1, (0.2, 0.3, 0.7))
    values = {
        "n": 1e-3,
        "Ix": 7.0,
        "Iy": 6.0,
        "Iz": 5.0,
        "px": 0.7,
        "py": 0.6,
        "pz": 0.5,
        "Q1": 0.2,
        "Q2": 0.3,
        "R": 0.7,
    }
    with (SECOND / "eq18.csv").open() as file:
        printed = np.array([[eval(entry.replace("^", "**"), {}, values) for entry in row] for row in csv.reader(file)])
    for i in (1, 2):
        printed[i, 5:] *= -1
    plant = generalized_plant(satellite, "pitch")
    z2 = np.hstack([plant.C2, np.zeros((3, 4)), plant.D22])
    assert np.hstack([plant.A, plant.B1, plant.B2]) == pytest.approx(printed[:2], rel=1e-14)
    assert np.hstack([plant.C1, plant.D11, plant.D12]) == pytest.approx(printed[2:5], rel=1e-14)
    assert z2 == pytest.approx(printed[5:8])


class Tables:
    """Only what formulas read: parameters, exact; some may be changed."""

    def __init__(self, **changed):
        self.changed = changed

    def exact(self, name):
        if name in self.changed:
            return self.changed[name]
        unit = {"%": Fraction(1, 100)}.get(PARAMETERS[name]["unit"], 1)
        return PrintedNumber(PARAMETERS[name]["value"]).value * unit

    def number(self, name):
        return float(self.exact(name))


@pytest.mark.parametrize("name", ["a", "b"])
@pytest.mark.parametrize("group", ["pitch", "roll_yaw"])
def test_definitions_of_the_certificates_are_the_plant(name, group):
    # Identity: formulas over the tables, written out by hand, against the plant built block by block.
    case = Tables()
    satellite = Satellite(
        tuple(case.number(f"inertia_{name}_{axis}") for axis in "xyz"),
        case.number("orbital_rate"),
        case.number("inertia_change"),
        tuple(case.number(f"{what}_weight") for what in ("angle", "rate", "control")),
    )
    plant, found = generalized_plant(satellite, group), Floats(case, statements.PLANTS[group](name), {})
    for matrix in ("A", "B1", "B2", "C1", "D11", "D12", "C2", "D22"):
        assert found.constant(matrix) == pytest.approx(getattr(plant, matrix), rel=1e-13, abs=1e-18), matrix


@pytest.mark.parametrize("group", ["pitch", "roll_yaw"])
def test_the_box_contains_every_changed_loop(group):
    # Law: a matrix in the convex hull of the corners has every linear functional below the largest at a corner.
    # A fast orbit, so that the terms in n are not lost beside the gains.
    case, generator = Tables(orbital_rate=Fraction(1, 2)), np.random.default_rng(3)
    size = 1 if group == "pitch" else 2
    K = generator.standard_normal((size, 2 * size))
    case.design = lambda design, entry: K
    loops = statements.uncertain(case, "b_mixed", group, "number('inertia_change')")
    corners = loops.at_corners("varied").reshape(2 ** len(loops.ranges), -1)
    satellite = Satellite(tuple(case.number(f"inertia_b_{axis}") for axis in "xyz"), case.number("orbital_rate"))
    plant = generalized_plant(satellite, group)
    for _ in range(200):
        A, B = plant.uncertain(generator.uniform(-1, 1, 3))
        direction = generator.standard_normal(A.size)
        assert direction @ (A - B @ K).ravel() <= (corners @ direction).max() + 1e-12
        assert np.all(corners.min(axis=0) - 1e-12 <= (A - B @ K).ravel())
        assert np.all((A - B @ K).ravel() <= corners.max(axis=0) + 1e-12)


def test_claims_name_declared_quantities():
    declared = {row["id"] for row in rows(FOLDER / "quantities.csv")}
    assert len(declared) == len(rows(FOLDER / "quantities.csv"))
    for claim in rows(FOLDER / "claims.csv"):
        if claim["comparator"] not in ("", "all_of"):
            assert claim["quantity"] in declared, claim["id"]
