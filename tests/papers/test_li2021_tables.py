"""Tables of li2021: coverage of the numbered items, refusals."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from gainsay.errors import InputError
from gainsay.systems.norms import hinf_norm
from gainsay.tables import read_case
from papers.li2021 import audit, plant

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "li2021")


def test_every_numbered_item_is_covered(case):
    """Equations (1)-(20), theorems, lemmas, remarks, tables and figures stand in a claim, an erratum or not_checked."""
    places = [row.where for row in (*case.claims.values(), *case.errata.values(), *case.not_checked)]
    covered = set()
    for place in places:
        for first, last in re.findall(r"\((\d+)\)-\((\d+)\)", place):
            covered |= {f"({i})" for i in range(int(first), int(last) + 1)}
        covered |= set(re.findall(r"\(\d+\)", place))
        for kind, numbers in re.findall(
            r"(Theorem|Lemma|Remark|Figure|Table|Assumption)s? ((?:\d+(?:, | and )?)+)", place
        ):
            covered |= {f"{kind} {i}" for i in re.findall(r"\d+", numbers)}
    wanted = {f"({i})" for i in range(1, 21)} | {f"Figure {i}" for i in range(1, 10)} | {"Table 1", "Assumption 1"}
    wanted |= (
        {f"Theorem {i}" for i in (1, 2, 3)}
        | {f"Lemma {i}" for i in (1, 2, 3, 4)}
        | {f"Remark {i}" for i in range(1, 6)}
    )
    assert wanted - covered == set()


def test_gains_of_another_shape_are_refused():
    eye = plant.Gains(A=np.eye(6), B=np.zeros((6, 3)), C=np.zeros((3, 6)))
    with pytest.raises(InputError, match=r"B_f.*6x3"):
        plant.Gains(eye.A, eye.B.T, eye.C)
    with pytest.raises(InputError, match=r"A_f.*6x6"):
        plant.Gains(np.eye(5), eye.B, eye.C)
    with pytest.raises(InputError, match="finite"):
        plant.Gains(eye.A, eye.B, np.full((3, 6), np.inf))


def test_unstable_loop_has_no_norm(case):
    gains = plant.controller(case, "proposed")
    reversed_sign = SimpleNamespace(A=gains.A, B=gains.B, C=-gains.C)
    with pytest.raises(InputError, match="unstable"):
        hinf_norm(*audit.reduced_loop(case, reversed_sign))


def test_unknown_controller_is_refused(case):
    with pytest.raises(InputError, match="proposed, comparison or a design"):
        plant.controller(case, "other")
