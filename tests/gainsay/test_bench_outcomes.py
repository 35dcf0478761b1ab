"""Answers are counted as what they are: right, undecided, wrong."""

import numpy as np
import pytest

from gainsay.bench import outcomes
from gainsay.bench.outcomes import Known
from gainsay.lmi import Program, scalar


@pytest.mark.parametrize(
    ("found", "right", "counted"),
    [
        (True, True, "right"),
        (False, True, "wrong"),
        (None, True, "undecided"),
        (2.0, 2.0, "right"),
        (2.001, 2.0, "wrong"),
        (None, 2.0, "undecided"),
        (False, 2.0, "wrong"),
    ],
)
def test_an_answer_is_judged_by_what_is_known(found, right, counted):
    assert outcomes._judged(found, right) == counted


def test_a_wrong_known_outcome_is_counted_for_all(monkeypatch):
    # x > 0 is feasible; a family that says it is not makes every answer wrong
    x = scalar("x")
    family = [Known(Program(subject_to=[x > 0]), False), Known(Program(minimise=x, subject_to=[x >= 2]), 2.0)]
    monkeypatch.setattr(outcomes, "_families", lambda: iter([("two", family)]))
    (line,) = outcomes.rows()
    assert [part.split(maxsplit=1)[1] for part in line.split("   ") if part.split()[:1] in (["Clarabel"], ["SCS"])] == [
        "1, 0, 1",
        "1, 0, 1",
    ]
    assert "proved 1, 0, 1" in line


def test_the_truss_has_its_closed_form():
    # s - 6 sqrt(s) is least at s = 9
    assert outcomes._ours(outcomes._truss().program) == pytest.approx(-9, rel=1e-6)


@pytest.mark.parametrize("solver", ["CLARABEL", "SCS"])
def test_a_homogeneous_program_is_handed_over_at_the_scale_of_one(solver):
    # with eigenvalues of at least 1e-6 the tolerances of solvers (1e-4, 1e-8) decide in place of the program
    rng = np.random.default_rng(1)
    for outside in (True, False):
        assert outcomes._plain(solver)(outcomes._lyapunov(rng, outside)) is not outside
