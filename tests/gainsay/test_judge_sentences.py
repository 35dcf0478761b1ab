"""Sentences without a threshold, that say "can", or that can be read in several ways."""

from dataclasses import replace

import pytest

from gainsay.scans.outcome import outcome
from gainsay.tables.sentences import of_sentence, worst
from gainsay.verdicts.evidence import Evidence
from gainsay.verdicts.judge import judge
from tests.gainsay.judge_example import Tables, at_least, at_most, claim, evidence, number, scans, verdict

# --- thresholds that the paper does not print -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("comparator", "value", "expected"),
    # between 1 and 2 the outcome hangs on the reading, by hand
    [("at_most", 1.0, "reproduced"), ("at_most", 1.5, "undetermined"), ("at_most", 2.0, "undetermined"),
     ("at_most", 2.1, "contradicted"), ("at_least", 2.0, "reproduced"), ("at_least", 1.5, "undetermined"),
     ("at_least", 0.9, "contradicted")],
)  # fmt: skip
def test_a_range_of_thresholds_decides_where_all_of_them_agree(comparator, value, expected):
    judged = judge(Tables(), claim(comparator, "1..2", "ordering"), evidence(value=number(value)), {})
    assert judged.verdict == expected
    assert (f"turns at q = {value}" in judged.witness) == (expected == "undetermined")


def test_an_error_bound_across_one_end_of_the_thresholds_is_undecided():
    of = claim("at_most", "1..2", "ordering")
    assert verdict(of, evidence(value=number(1.0, 0.9, 1.1))) == "undecided"
    assert verdict(of, evidence(value=number(1.5, 1.4, 1.6))) == "undetermined"


@pytest.mark.parametrize(
    ("values", "expected", "turns"),
    [((0.5, 0.9), "reproduced", ""), ((2.5, 3.0), "contradicted", ""),
     ((1.2, 1.7), "undetermined", "holds everywhere from 1.7 m, nowhere below 1.2 m"),
     ((0.5, 3.0), "undetermined", "holds everywhere from 3 m, nowhere below 0.5 m")],
)  # fmt: skip
def test_a_scan_under_a_range_of_thresholds_names_the_turning_point(values, expected, turns):
    of = claim("at_most", "1..2", "ordering")
    judged = judge(Tables(), of, evidence(scans=scans(of, *values)), {})
    assert judged.verdict == expected
    assert turns in judged.witness


# --- sentences that say "can" -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "published", "expected"),
    [((1.0, 3.0), "2", "reproduced"), ((3.0, 4.0), "2", "undecided"), ((1.5, 3.0), "1..2", "undetermined"),
     ((0.5, 3.0), "1..2", "reproduced")],
)  # fmt: skip
def test_one_sample_bears_out_what_can_be_and_none_refutes_it(values, published, expected):
    of = claim("at_most", published, "ordering", holds_for="some")
    judged = judge(Tables(), of, evidence(value=number(values[-1]), scans=scans(of, *values)), {})
    assert judged.verdict == expected
    if expected == "reproduced":
        assert judged.witness == f"borne out by q = {values[0]:.5g} at x = 0" and "one is enough" in judged.note


def test_a_list_of_readings_none_of_which_can_be_refutes_it():
    of = claim("at_most", "2", "ordering", holds_for="some")
    inputs = [{"name": "x", "unit": "1", "values": ["a", "b"], "logarithmic": False}]
    scan = {"quantity": "q", "inputs": inputs, "values": [3.0, 4.0], "points": [["a"], ["b"]], "crossings": []}
    assert verdict(of, evidence(scans={"c": outcome(of, scan)})) == "contradicted"


@pytest.mark.parametrize(("value", "expected"), [(1.0, "reproduced"), (3.0, "undecided")])
def test_one_number_bears_out_what_can_be_and_does_not_refute_it(value, expected):
    of = claim("at_most", "2", "ordering", holds_for="some", given="start=far")
    judged = judge(Tables(left_out=("start",)), of, evidence(value=number(value)), {})
    assert judged.verdict == expected
    said = "borne out by q = 1.0 m at start=far" if expected == "reproduced" else "not borne out at start=far"
    assert said in judged.witness + judged.note


# by hand: q is at least 3 wherever x lies, so that no x bears out "at most 2"
@pytest.mark.parametrize(
    ("over", "read", "given", "kind", "expected"),
    [
        ({"x"}, set(), "", "norm-bound", "contradicted"),
        ({"x"}, {"mass"}, "", "norm-bound", "contradicted"),  # what the paper prints is no input left open
        ({"x"}, set(), "", "ordering", "contradicted"),
        (set(), set(), "", "norm-bound", "undecided"),  # proved of one number, which says nothing of others
        ({"x"}, {"y"}, "", "norm-bound", "undecided"),  # y has a value of ours in the formulas
        ({"x"}, set(), "y=1", "norm-bound", "undecided"),  # y has a value of ours in the condition
        ({"x"}, set(), "mass=1", "norm-bound", "contradicted"),
    ],
)
@pytest.mark.parametrize("sampled", [False, True])
def test_what_can_be_is_refuted_by_a_proof_over_all_that_is_left_out(over, read, given, kind, expected, sampled):
    of = claim("at_most", "2", kind, holds_for="some", given=given)
    proof = replace(at_least(3), over=frozenset(over))
    samples = {"scans": scans(of, 3.5, 4.0)} if sampled else {}
    on = evidence(proof, value=number(3.5), read={"cert": read}, **samples)
    judged = judge(Tables(left_out=("x", "y"), printed=("mass",)), of, on, {})
    assert judged.verdict == expected
    assert ("refutes nothing" in judged.note or "does not say" in judged.note) == (expected == "undecided")
    if expected == "contradicted":
        assert judged.witness and judged.certificate == "cert"


def test_a_proof_over_a_box_that_does_not_reach_the_threshold_leaves_what_can_be_undecided():
    of = claim("at_most", "2", "norm-bound", holds_for="some")
    proof = replace(at_least(1), over=frozenset({"x"}))
    assert judge(Tables(left_out=("x",)), of, evidence(proof, scans=scans(of, 3.5)), {}).verdict == "undecided"


def test_samples_that_a_proof_excludes_are_no_verdict():
    of = claim("at_most", "2", "norm-bound")
    assert verdict(of, evidence(at_least(3), scans=scans(of, 1.0, 1.5))) == "failed"
    assert verdict(of, evidence(at_most(1), scans=scans(of, 3.0, 3.5))) == "failed"
    assert verdict(of, evidence(at_most(2), scans=scans(of, 1.0, 1.5))) == "reproduced"


# --- parts and readings of one sentence -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("judged", "expected"),
    [("reproduced contradicted", "undetermined"), ("contradicted contradicted", "contradicted"),
     ("reproduced reproduced", "reproduced"), ("contradicted undetermined", "undetermined"),
     ("contradicted undecided", "undecided"), ("reproduced undecided", "undecided"),
     ("contradicted undecided reproduced", "undetermined"), ("contradicted failed reproduced", "failed"),
     ("contradicted uncheckable", "uncheckable"), ("reproduced uncheckable", "uncheckable")],
)  # fmt: skip
def test_readings_that_differ_leave_a_sentence_undetermined(judged, expected):
    readings = [(claim(as_read=f"reading {i}"), v) for i, v in enumerate(judged.split())]
    assert of_sentence(readings) == expected
    # A part that holds changes nothing, one that does not decides whatever the readings are.
    assert of_sentence([*readings, (claim(), "reproduced")]) == expected
    assert of_sentence([(claim(), "contradicted"), *readings]) == worst(["contradicted", expected])


def test_claims_read_alike_make_one_reading():
    strict = [(claim(as_read="strict"), "reproduced"), (claim(as_read="strict"), "contradicted")]
    assert of_sentence(strict) == "contradicted"
    assert of_sentence([*strict, (claim(as_read="mild"), "reproduced")]) == "undetermined"


def test_a_claim_that_joins_readings_joins_them_as_a_sentence_does():
    readings = claim(id="one", as_read="one"), claim(id="other", as_read="other")
    of = claim("all_of", "", quantity="one other")
    verdicts = {"one": "reproduced", "other": "contradicted"}
    assert judge(Tables(*readings), of, Evidence(), verdicts).verdict == "undetermined"
