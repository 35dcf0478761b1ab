import json
import math
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import ComputationError, InputError
from gainsay.scans import Plausible, corners, fractions, sample, scan, scans
from gainsay.scans.outcome import outcome
from gainsay.scans.ranges import readings
from gainsay.tables.models import Claim

X = Plausible("x", "m", 0.0, 10.0)
Y = Plausible("y", "1", 0.01, 100.0, logarithmic=True)
WORD = Plausible("word", values=("small", "large"))


def claim(comparator, published, name="claim", quantity="value"):
    return Claim(
        id=name, where="(1)", kind="ordering", statement="s", comparator=comparator, quantity=quantity,
        published=published, unit="1", tolerance="", expected="reproduced", basis="b", note="",
    )  # fmt: skip


def scanned(evaluate, *claims, inputs=(X, Y, WORD), **options):
    return scan(SimpleNamespace(claims={c.id: c for c in claims}), "value", list(inputs), evaluate, **options)


def run(evaluate, comparator, published, **options):
    """A scan as it is read back from its file, under a claim."""
    of = claim(comparator, published)
    return outcome(of, json.loads(json.dumps(scanned(evaluate, of, **options).to_json())))


@given(st.sampled_from([X, Y]), st.floats(0, 1))
def test_a_sample_lies_within_its_range_where_its_fraction_says(one, fraction):
    value = one.at(fraction)
    assert one.low * (1 - 1e-12) <= value <= one.high * (1 + 1e-12)
    assert math.isclose(one.fraction(value), fraction, abs_tol=1e-12)


def test_boundary_of_a_known_threshold_is_located():
    # Closed form: x y <= 3 turns at x = 3/y along x and at y = 3/x along y.
    found = run(lambda p: p["x"] * p["y"], "at_most", "3", width=1e-6)
    assert found.outcome == "depends"
    other = "y" if found.boundary.input == "x" else "x"
    turning = 3 / found.boundary.at[other]
    assert found.boundary.holds == pytest.approx(turning, rel=1e-3)
    assert found.boundary.holds * found.boundary.at[other] <= 3 < found.boundary.fails * found.boundary.at[other]
    points = [*sample([X, Y, WORD], 256, 0), *corners([X, Y, WORD])]
    assert found.holding == sum(p["x"] * p["y"] <= 3 for p in points)
    assert found.samples == 256 + 8


def test_a_choice_can_be_the_boundary():
    found = run(lambda p: float(p["word"] == "large"), "equal", "0")
    assert (found.boundary.input, found.boundary.holds, found.boundary.fails) == ("word", "small", "large")
    assert found.witness.startswith("depends on word: holds at small, fails at large")


@pytest.mark.parametrize(("limit", "word"), [("-1", "fails"), ("11", "holds")])
def test_outcomes_without_a_boundary(limit, word):
    found = run(lambda p: p["x"], "at_most", limit)
    assert found.outcome == word
    assert found.boundary is None
    assert (found.witness == "") == (word == "holds")
    assert 0 <= found.least[0] < 0.2
    assert 9.8 < found.greatest[0] <= 10


def test_same_seed_same_result_other_seed_other_points():
    evaluate = lambda p: p["x"]  # noqa: E731
    assert scanned(evaluate).to_json() == scanned(evaluate).to_json()
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

    found = run(evaluate, "at_least", "0", admissible=lambda p: p["x"] > 5)
    assert found.outcome == "depends"
    with pytest.raises(InputError, match="hardly any"):
        scanned(evaluate, admissible=lambda p: False)


def test_a_corner_alone_can_break_a_claim():
    # The share of the cube where x > 9.99 and y > 99 is below 1e-6: scattered points miss it, the corner does not.
    found = run(lambda p: float(p["x"] > 9.99 and p["y"] > 99), "equal", "0")
    assert (found.outcome, found.samples - found.holding) == ("depends", 2)


def test_a_broken_sample_breaks_the_scan():
    with pytest.raises(ComputationError, match="value: scan broke at"):
        scanned(lambda p: math.nan)

    def refuse(p):
        raise InputError("no such design")

    with pytest.raises(ComputationError, match="no such design"):
        scanned(refuse)


def test_too_few_samples_and_empty_ranges_are_refused():
    with pytest.raises(InputError, match="199: expected at least 200"):
        scanned(lambda p: 1.0, samples=199)
    with pytest.raises(InputError, match="low < high"):
        Plausible("x", low=1.0, high=1.0)
    with pytest.raises(InputError, match="positive range"):
        Plausible("x", low=0.0, high=1.0, logarithmic=True)


def test_points_evaluated_together_give_the_same_scan_and_a_boundary_as_narrow():
    def evaluate(p):
        return p["x"] - 0.01 * p["y"]

    one = run(evaluate, "at_least", "4.2")
    calls = []

    def together(points):
        calls.append(len(points))
        return [evaluate(p) for p in points]

    all_ = run(None, "at_least", "4.2", together=together, parts=32)
    assert (all_.outcome, all_.holding, all_.least, all_.greatest) == (
        one.outcome,
        one.holding,
        one.least,
        one.greatest,
    )
    assert calls[0] == all_.samples and len(calls) < 8
    edge = all_.boundary
    side = {**edge.at, edge.input: edge.fails}
    assert evaluate(edge.at) >= 4.2 > evaluate(side)
    assert abs(edge.holds - edge.fails) <= 2e-3 * 100  # a thousandth of the wider range
    with pytest.raises(ComputationError, match="not a number"):
        scanned(None, together=lambda points: [math.nan] * len(points))


def test_scans_ask_for_what_they_need_next_in_one_list():
    def together(points):
        calls.append(len(points))
        return [{"of.x": point["x"], "of.y": point["x"] - 0.01 * point["y"]} for point in points]

    claims = {"of.x": claim("at_most", "4", quantity="of.x"), "of.y": claim("at_least", "4.2", quantity="of.y")}
    case, calls = SimpleNamespace(claims=claims), []
    found = scans(case, list(claims), (X, Y), together=together, parts=4)
    rounds = len(calls)
    for one in found:
        alone = scan(case, one.quantity, (X, Y), parts=4, together=lambda points, of=one.quantity: [
            row[of] for row in together(points)])  # fmt: skip
        assert one == alone and alone.crossings
    assert calls[0] == 256 + len(corners((X, Y))) and rounds < len(calls) - rounds
    with pytest.raises(ComputationError, match=r"of\.y: scan broke .* not a number"):
        scans(case, list(claims), (X, Y), lambda point: {"of.x": 1.0, "of.y": math.nan})


def test_what_a_scan_says_follows_the_threshold_of_the_claim_without_a_new_scan():
    # The value is x, uniform on 0..10: at most t holds for the points with x <= t, counted here.
    found = scanned(lambda p: p["x"], claim("at_most", "4")).to_json()
    xs = [row[0] for row in found["points"]]
    for limit in ("4", "7.5", "0.1"):
        assert outcome(claim("at_most", limit), found).holding == sum(x <= float(limit) for x in xs)
    assert outcome(claim("at_most", "4"), found).boundary.holds == pytest.approx(4, abs=0.01)
    assert outcome(claim("at_most", "7.5"), found).boundary is None  # nobody has looked there


def test_every_claim_on_a_quantity_says_where_to_look_closer():
    two = (claim("at_most", "4", "first"), claim("at_least", "7", "second"))
    found = scanned(lambda p: p["x"], *two, claim("less_than", "other", "third")).to_json()
    turns = [outcome(of, found).boundary.holds for of in two]
    assert turns == [pytest.approx(4, abs=0.01), pytest.approx(7, abs=0.01)]


def test_a_finite_list_of_readings_is_gone_through_one_by_one():
    other = Plausible("other", values=(1.0, 2.0, 4.0))
    found = scanned(lambda p: p["other"] * (2 if p["word"] == "large" else 1), inputs=(WORD, other)).to_json()
    assert [tuple(row) for row in found["points"]] == [(w, o) for w in ("small", "large") for o in (1.0, 2.0, 4.0)]
    said = outcome(claim("at_most", "2"), found)  # by hand: 1, 2 of the small ones and 2 of the large ones
    assert (said.holding, said.samples, said.evidence) == (3, 6, "sampled 6 of 6 readings")
    assert scanned(lambda p: p["other"], claim("at_most", "2"), inputs=(other,)).to_json()["closer"]["values"] == []
    assert said.note.startswith("holds at 3 of 6 readings")
    with pytest.raises(InputError, match="a list of values"):
        readings([WORD, X])


def test_the_few_that_decide_otherwise_are_looked_at_closer():
    """By hand: of a ramp 0..10, 2 of 200 samples and no corner lie below 0.07 but for x = 0 itself."""
    of = claim("at_least", "0.07")
    found = scanned(lambda p: p["x"], of, inputs=(X, Y)).to_json()
    few = sorted(value for value in found["values"] if value < 0.07)
    others = [value for value in found["values"] if value >= 0.07]
    assert 0 < len(few) < 5
    around = found["closer"]["values"]
    assert len(around) == 64 and few[0] <= min(around) and max(around) <= max(others)
    said = outcome(of, json.loads(json.dumps(found)))
    assert (said.closer, said.closer_holding) == (64, sum(value >= 0.07 for value in around))
    assert f"closer to the few that differ at {said.closer_holding} of 64" in said.note
    assert 0 < said.closer_holding < 64
    # where many decide either way, or all one way, there is nothing to look closer at; nor under a milder reading alone
    for published in ("5", "-1", "0.07..5"):
        assert (
            scanned(lambda p: p["x"], claim("at_least", published), inputs=(X, Y)).to_json()["closer"]["values"] == []
        )


def test_what_its_points_bear_out_is_part_of_a_scan():
    found = scanned(lambda p: p["x"], admissible=lambda p: p["x"] < 5, bears_out=("width",)).to_json()
    assert found["bears_out"] == ["width"] and max(found["values"]) < 5


def test_samples_that_are_the_same_are_counted_once():
    found = scanned(lambda p: p["x"], inputs=(X, WORD)).to_json()
    found["points"][1], found["values"][1] = found["points"][0], found["values"][0]
    assert outcome(claim("at_most", "2"), found).evidence == "sampled 260 (distinct 259)"


def test_quantities_of_one_computation_are_scanned_as_one_by_one_and_computed_once():
    seen = []

    def both(point):
        seen.append(point)
        return {"value": point["x"] * point["y"], "other": point["x"]}

    case = SimpleNamespace(claims={"claim": claim("at_most", "3")})
    alone = scan(case, "value", [X, Y], lambda p: p["x"] * p["y"])
    together = {found.quantity: found for found in scans(case, ["value", "other"], [X, Y], both)}
    assert together["value"] == alone
    assert [value for value, _ in together["other"].pairs] == [point["x"] for _, point in alone.pairs]
    assert len(seen) == len({tuple(point.items()) for point in seen})
    with pytest.raises(ComputationError, match="quantity of a scan 'valu': expected 'value'"):
        list(scans(case, ["valu"], [X, Y], both))
