import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import ComputationError, InputError
from gainsay.verdicts.scan import Plausible, corners, fractions, sample, scan

X = Plausible("x", "m", 0.0, 10.0)
Y = Plausible("y", "1", 0.01, 100.0, logarithmic=True)
WORD = Plausible("word", values=("small", "large"))


def run(evaluate, holds, **options):
    return scan("claim", "value", [X, Y, WORD], evaluate, holds, criterion="a test", **options)


def test_boundary_of_a_known_threshold_is_located():
    # Closed form: x y < 3 turns at x = 3/y along x and at y = 3/x along y.
    found = run(lambda p: p["x"] * p["y"], lambda v: v < 3, width=1e-6)
    assert found.outcome == "depends"
    other = "y" if found.boundary.input == "x" else "x"
    turning = 3 / found.boundary.at[other]
    assert found.boundary.holds == pytest.approx(turning, rel=1e-3)
    assert found.boundary.holds * found.boundary.at[other] < 3 <= found.boundary.fails * found.boundary.at[other]
    points = [*sample([X, Y, WORD], 256, 0), *corners([X, Y, WORD])]
    assert found.holding == sum(p["x"] * p["y"] < 3 for p in points)
    assert found.samples == 256 + 8


def test_a_choice_can_be_the_boundary():
    found = run(lambda p: float(p["word"] == "large"), lambda v: v == 0)
    assert (found.boundary.input, found.boundary.holds, found.boundary.fails) == ("word", "small", "large")
    assert found.witness.startswith("depends on word: holds at small, fails at large")


@pytest.mark.parametrize(("limit", "outcome"), [(-1.0, "fails"), (11.0, "holds")])
def test_outcomes_without_a_boundary(limit, outcome):
    found = run(lambda p: p["x"], lambda v: v < limit)
    assert found.outcome == outcome
    assert found.boundary is None
    assert (found.witness == "") == (outcome == "holds")
    assert 0 <= found.least[0] < 0.2
    assert 9.8 < found.greatest[0] <= 10
    assert json.loads(json.dumps(found.to_json()))["outcome"] == outcome


def test_same_seed_same_result_other_seed_other_points():
    evaluate = lambda p: p["x"]  # noqa: E731
    assert run(evaluate, bool).to_json() == run(evaluate, bool).to_json()
    assert sample([X], 5, 1) != sample([X], 5, 2)


@given(st.integers(1, 8), st.integers(0, 1000))
@settings(max_examples=30, deadline=None)
def test_points_fill_the_cube_evenly(dimensions, seed):
    source = fractions(dimensions, seed)
    points = [next(source) for _ in range(1024)]
    # Law of a low-discrepancy sequence: each sixteenth of each axis holds close to its share of 64 points; of random
    # points, each with a standard deviation of 8, the worst of 16 strays by about 16.
    for axis in range(dimensions):
        shares = [sum(int(16 * p[axis]) == k for p in points) for k in range(16)]
        assert max(abs(s - 64) for s in shares) <= 8
        assert all(0 <= p[axis] < 1 for p in points)


@given(st.floats(0, 1))
def test_fraction_inverts_at(fraction):
    for p in (X, Y):
        assert p.fraction(p.at(fraction)) == pytest.approx(fraction, abs=1e-12)


def test_only_admissible_points_are_evaluated():
    def evaluate(p):
        assert p["x"] > 5
        return p["x"] - p["y"]

    found = run(evaluate, lambda v: v > 0, admissible=lambda p: p["x"] > 5)
    assert found.outcome == "depends"
    with pytest.raises(InputError, match="hardly any"):
        run(evaluate, bool, admissible=lambda p: False)


def test_a_corner_alone_can_break_a_claim():
    # The share of the cube where x > 9.99 and y > 99 is below 1e-6: scattered points miss it, the corner does not.
    found = run(lambda p: float(p["x"] > 9.99 and p["y"] > 99), lambda v: v == 0)
    assert (found.outcome, found.samples - found.holding) == ("depends", 2)


def test_a_broken_sample_breaks_the_scan():
    with pytest.raises(ComputationError, match="claim: scan broke at"):
        run(lambda p: math.nan, bool)

    def refuse(p):
        raise InputError("no such design")

    with pytest.raises(ComputationError, match="no such design"):
        run(refuse, bool)


def test_too_few_samples_and_empty_ranges_are_refused():
    with pytest.raises(InputError, match="199: expected at least 200"):
        run(lambda p: 1.0, bool, samples=199)
    with pytest.raises(InputError, match="low < high"):
        Plausible("x", low=1.0, high=1.0)
    with pytest.raises(InputError, match="positive range"):
        Plausible("x", low=0.0, high=1.0, logarithmic=True)


def test_points_evaluated_together_give_the_same_scan_and_a_boundary_as_narrow():
    def evaluate(p):
        return p["x"] - 0.01 * p["y"]

    one = run(evaluate, lambda v: v > 4.2)
    calls = []

    def together(points):
        calls.append(len(points))
        return [evaluate(p) for p in points]

    all_ = run(evaluate, lambda v: v > 4.2, together=together)
    assert (all_.outcome, all_.holding, all_.least, all_.greatest) == (
        one.outcome,
        one.holding,
        one.least,
        one.greatest,
    )
    assert calls[0] == all_.samples and len(calls) < 8
    edge = all_.boundary
    side = {**edge.at, edge.input: edge.fails}
    assert evaluate(edge.at) > 4.2 >= evaluate(side)
    assert abs(edge.holds - edge.fails) <= 2e-3 * 100  # a thousandth of the wider range
    with pytest.raises(ComputationError, match="not a number"):
        run(evaluate, bool, together=lambda points: [math.nan] * len(points))
