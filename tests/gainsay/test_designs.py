"""Designs are data: written by a search, read like a printed matrix, refused where they are anything else."""

import json
from fractions import Fraction

import numpy as np
import pytest

from gainsay.errors import InputError
from gainsay.tables.designs import FoundDesign, read_design, read_designs, rounded, write_design


def found(**changes):
    """A design with one 2x2 gain."""
    given = {
        "asked": "a gain",
        "method": "picked",
        "matrices": {"K": np.array([[1 / 3, -2.0], [1e-9, 40.0]])},
        "converged": True,
        "outcome": {"norm": 1.5},
        "effort": {"evaluations": 7},
        "seed": 3,
    }
    return FoundDesign(**{**given, **changes})


def test_a_design_comes_back_as_the_decimals_it_was_written_with(tmp_path):
    path = write_design(tmp_path, "robust", found())
    design = read_design(path)
    assert design.name == "robust" and design.file.seed == 3 and design.file.converged
    assert design.exact("K")[0] == (Fraction(333333333333, 10**12), Fraction(-2))
    np.testing.assert_array_equal(design["K"], rounded(found().matrices["K"]))
    with pytest.raises(ValueError, match="read-only"):
        design["K"][0, 0] = 1.0
    with pytest.raises(InputError, match="one of K"):
        design["L"]


@pytest.mark.parametrize("change", [
    {"matrices": {"K": np.array([[np.nan]])}},
    {"outcome": {"norm": np.inf}},
])  # fmt: skip
def test_what_is_not_finite_is_not_written(tmp_path, change):
    with pytest.raises(InputError, match="not finite"):
        write_design(tmp_path, "robust", found(**change))
    assert not list(tmp_path.rglob("*.json"))


@pytest.mark.parametrize("damage", [
    lambda text: text.replace('"0.333333333333"', "0.333333333333"),
    lambda text: text.replace('"0.333333333333"', '"nan"'),
    lambda text: text.replace('"0.333333333333"', '"1_0"'),
    lambda text: text.replace('"converged": true', '"converged": 1'),
    lambda text: text.replace('"seed": 3', '"seed": 3, "seed": 3'),
    lambda text: text.replace('"asked"', '"wished"'),
    lambda text: text[:-10],
    lambda text: "[" * 100_000,
])  # fmt: skip
def test_damaged_designs_are_refused_in_one_line(tmp_path, damage):
    path = write_design(tmp_path, "robust", found())
    path.write_text(damage(path.read_text()))
    with pytest.raises(InputError, match=r"robust\.json") as refused:
        read_design(path, tmp_path)
    assert len(str(refused.value)) < 400


def test_ragged_gains_are_refused(tmp_path):
    path = write_design(tmp_path, "robust", found())
    content = json.loads(path.read_text())
    content["matrices"]["K"][0].pop()
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match="rows of one length"):
        read_design(path)


def test_a_design_that_paper_toml_does_not_name_is_refused(tmp_path):
    write_design(tmp_path, "robust", found())
    assert list(read_designs(tmp_path, {"robust": "a gain"})) == ["robust"]
    with pytest.raises(InputError, match=r"paper\.toml names"):
        read_designs(tmp_path, {"other": "a gain"})
