import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.exact.digits import PrintedNumber
from gainsay.tables.models import PROVED, VERDICTS, Claim
from gainsay.tables.sentences import SEVERITY
from gainsay.verdicts.evidence import Concluded, Evidence
from gainsay.verdicts.judge import contradictions, judge
from tests.gainsay.judge_example import (
    SAMPLED,
    Tables,
    at_least,
    at_most,
    claim,
    evidence,
    number,
    says,
    scans,
    verdict,
)

# --- what is printed against what is computed -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "expected"),
    # 1.50 is printed to 0.01: what rounds to it lies in 1.495 .. 1.505
    [
        (1.5, "reproduced"),
        (1.4951, "reproduced"),
        (1.5049, "reproduced"),
        (1.4949, "contradicted"),
        (1.51, "contradicted"),
    ],
)
def test_equal_means_within_half_a_unit_of_the_last_printed_digit(value, expected):
    assert verdict(claim(), evidence(value=number(value))) == expected


def test_an_enclosure_across_the_edge_decides_nothing():
    judged = judge(Tables(), claim(), evidence(value=number(1.5, 1.49, 1.5)), {})
    assert judged.verdict == "undecided"
    assert (judged.range_low, judged.range_high) == (1.49, 1.5)


@pytest.mark.parametrize(
    ("comparator", "published", "value", "expected"),
    [
        ("at_most", "2", 2.0, "reproduced"), ("at_most", "2", 2.0000001, "contradicted"),
        ("at_least", "2", 2.0, "reproduced"), ("at_least", "2", 1.9999999, "contradicted"),
        ("inside", "1..2", 1.0, "reproduced"), ("inside", "1..2", 2.0, "reproduced"),
        ("inside", "1..2", 0.999, "contradicted"), ("inside", "-2..-1", -1.5, "reproduced"),
    ],
)  # fmt: skip
def test_bounds_get_no_tolerance_from_their_digits(comparator, published, value, expected):
    assert verdict(claim(comparator, published), evidence(value=number(value))) == expected


def test_a_stated_tolerance_replaces_that_of_the_digits_and_is_in_the_claims_unit():
    on = evidence(value=number(1540.0))
    # 1.50 km +- 0.05 km holds 1540 m; its digits alone, +- 5 m, do not
    assert verdict(claim(unit="km", tolerance="0.05"), on) == "reproduced"
    assert verdict(claim(unit="km"), on) == "contradicted"
    judged = judge(Tables(), claim(unit="km", tolerance="0.05"), on, {})
    assert (judged.recomputed, judged.tolerance) == (1.54, 0.05)


def test_half_a_unit_of_the_digits_is_in_the_claims_unit():
    # 1.50 km stands for 1495 .. 1505 m
    assert verdict(claim(unit="km"), evidence(value=number(1504.0))) == "reproduced"
    assert verdict(claim(unit="km"), evidence(value=number(1506.0))) == "contradicted"


def test_units_are_converted_before_comparing():
    on = evidence(value=number(math.pi), quantity="angle")
    assert verdict(claim(published="180.0", unit="deg", quantity="angle"), on) == "reproduced"
    assert verdict(claim(published="3.1", unit="rad", quantity="angle"), on) == "reproduced"
    assert verdict(claim(published="180.0", unit="rad", quantity="angle"), on) == "contradicted"


def test_a_contradiction_carries_its_witness():
    judged = judge(Tables(), claim(), evidence(value=number(2.0)), {})
    assert judged.witness == "q = 2.0 m"
    judged = judge(Tables(), claim("at_most", "1", "norm-bound"), evidence(at_least(2)), {})
    assert judged.verdict == "contradicted"
    assert "2.0" in judged.witness
    judged = judge(Tables(), claim("feasible", "", "feasibility"), evidence(says("fails")), {})
    assert (judged.verdict, judged.witness) == ("contradicted", "a sentence")


def test_a_trajectory_without_an_error_bound_has_no_verdict():
    of = claim("at_most", "40", "trajectory")
    assert verdict(of, evidence(value=number(1.0))) == "failed"
    assert verdict(of, evidence(value=number(1.0, 0.9))) == "failed"
    assert verdict(of, evidence(value=number(1.0, 0.9, 1.1))) == "reproduced"
    assert verdict(of, evidence(value=number(40.0, 39.9, 40.1))) == "undecided"


@pytest.mark.parametrize("kind", ["parameter", "gain"])
def test_a_printed_number_without_an_enclosure_has_no_verdict(kind):
    of = claim("equal", "1.50", kind)
    assert verdict(of, evidence(value=number(1.5))) == "failed"
    assert verdict(of, evidence(value=number(1.51))) == "failed"  # not contradicted on the noise of a solver either
    assert verdict(of, evidence(value=number(1.5, 1.5, 1.5))) == "reproduced"
    assert verdict(of, evidence(value=number(1.51, 1.509, 1.511))) == "contradicted"


def test_the_rounding_of_printed_inputs_may_explain_a_printed_number():
    # 1.50 stands for 1.495 to 1.505: inputs that round as printed give 1.50 to 1.52, or 1.51 to 1.52
    digits = "printed digits: a product"
    of = claim("equal", "1.50", "parameter")
    judged = judge(Tables(), of, evidence(value=number(1.51, 1.50, 1.52, digits)), {})
    assert judged.verdict == "reproduced"
    assert "rounding of the digits" in judged.note
    assert verdict(of, evidence(value=number(1.51, 1.50, 1.52))) == "undecided"  # an error of ours explains nothing
    assert verdict(of, evidence(value=number(1.515, 1.51, 1.52, digits))) == "contradicted"
    assert verdict(claim("equal", "1.50", "ordering"), evidence(value=number(1.51, 1.50, 1.52, digits))) == "undecided"
    # an enclosure that leaves the number no digit would hold 1.50 and -0.4 alike; beside zero the tolerance counts
    assert verdict(of, evidence(value=number(1.6, 0.1, 3.1, digits))) == "reproduced"
    assert verdict(of, evidence(value=number(1.6, -0.1, 3.1, digits))) == "undecided"
    assert (
        verdict(claim("equal", "0.00", "parameter"), evidence(value=number(0.0, -4e-3, 5.5e-3, digits))) == "reproduced"
    )
    assert verdict(claim("equal", "0.00", "parameter"), evidence(value=number(0.0, -9e-3, 9e-3, digits))) == "undecided"


# --- proofs ---------------------------------------------------------------------------------------------------------


@given(
    st.sampled_from(sorted(PROVED)),
    st.sampled_from([("equal", "1"), ("at_most", "1"), ("at_least", "1"), ("inside", "0..1"), ("feasible", ""),
                     ("infeasible", ""), ("holds", ""), ("fails", ""), ("less_than", "other")]),
    st.sampled_from([0.0, 0.5, 1.0, 2.0]),
)  # fmt: skip
def test_a_kind_that_needs_proof_gets_no_verdict_from_numbers_alone(kind, compared, value):
    # Law of the design: only an accepted certificate decides.
    on = evidence(value=number(value, value, value), other=number(5.0, 5.0, 5.0))
    assert verdict(claim(*compared, kind), on) == "undecided"


@given(st.sampled_from(sorted(PROVED)), st.lists(st.sampled_from([0.5, 1.5]), min_size=1))
def test_samples_never_prove(kind, values):
    of = claim("at_most", "1", kind)
    expected = "undetermined" if len(set(values)) == 2 else "undecided"
    assert verdict(of, evidence(value=number(0.5), scans=scans(of, *values))) == expected


@pytest.mark.parametrize(
    ("comparator", "published", "said", "expected"),
    [
        ("feasible", "", "holds", "reproduced"), ("feasible", "", "fails", "contradicted"),
        ("infeasible", "", "holds", "contradicted"), ("infeasible", "", "fails", "reproduced"),
        ("holds", "", "holds", "reproduced"), ("holds", "", "fails", "contradicted"),
        ("fails", "", "holds", "contradicted"), ("fails", "", "fails", "reproduced"),
        ("equal", "1", "holds", "failed"), ("equal", "0", "fails", "failed"), ("equal", "24", "fails", "failed"),
        ("at_most", "1", "holds", "failed"), ("at_least", "1", "fails", "failed"),
        ("inside", "0..1", "holds", "failed"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["identity", "feasibility", "stability"])
def test_what_holds_or_fails(kind, comparator, published, said, expected):
    assert verdict(claim(comparator, published, kind), evidence(says(said))) == expected


def test_proved_numbers():
    of = claim("at_most", "2", "norm-bound")
    assert verdict(of, evidence(at_most(2))) == "reproduced"
    assert verdict(of, evidence(at_most("2.0001"))) == "undecided"  # proves a bound, but not this one
    assert verdict(of, evidence(at_least("2.0001"))) == "contradicted"
    assert verdict(of, evidence(at_least(2))) == "undecided"
    equal = claim("equal", "1.50", "norm-bound")
    assert verdict(equal, evidence(at_least("1.499"), at_most("1.501"))) == "reproduced"
    assert verdict(equal, evidence(at_most("1.501"))) == "undecided"
    judged = judge(Tables(), of, evidence(at_most(5, "loose"), at_most(1, "tight")), {})
    assert (judged.verdict, judged.certificate, judged.range_high) == ("reproduced", "tight", 1.0)


def test_a_proof_is_named_and_stands_for_itself():
    # what was computed besides does not narrow what is proved
    judged = judge(Tables(), claim("at_most", "2", kind="norm-bound"), evidence(at_most("1.9"), value=number(1.5)), {})
    assert (judged.verdict, judged.evidence, judged.range_high) == ("reproduced", "proved: theorem", 1.9)
    judged = judge(Tables(), claim("at_most", "2"), evidence(at_most("1.9"), value=number(1.5, 1.4, 1.6)), {})
    assert (judged.evidence, judged.range_high) == ("enclosed", 1.6)


@pytest.mark.parametrize(
    ("ends", "kind"),
    [((1.4, 1.6), "enclosed"), ((1.4, None), "computed"), ((None, 1.6), "computed"), ((None, None), "computed")],
)
def test_a_number_is_enclosed_where_it_has_both_ends(ends, kind):
    assert judge(Tables(), claim("at_most", "2"), evidence(value=number(1.5, *ends)), {}).evidence == kind


@pytest.mark.parametrize("kind", ["parameter", "gain", "trajectory"])
def test_a_printed_number_of_which_only_bounds_are_proved_has_no_verdict(kind):
    judged = judge(Tables(), claim(kind=kind), evidence(at_most("1.501"), at_least("1.499")), {})
    assert judged.verdict == "failed" and "none was computed" in judged.note


def test_stability_is_not_reached_on_the_boundary():
    # A spectral abscissa of 0 is marginal: `at most 0` proves no asymptotic stability, `less than 0` does.
    of = claim("at_most", "0", "stability")
    below = Concluded("less_than", None, Fraction(0), "cert", "theorem")
    assert verdict(of, evidence(at_most(0))) == "undecided"
    assert verdict(of, evidence(at_most(0), below)) == "reproduced"
    assert verdict(of, evidence(at_most(Fraction(-1, 10**9)))) == "reproduced"
    assert verdict(of, evidence(at_least(Fraction(1, 10**9)))) == "contradicted"
    rate = claim("at_least", "0", "stability")
    assert verdict(rate, evidence(at_least(0))) == "undecided"
    assert verdict(rate, evidence(Concluded("greater_than", Fraction(0), None, "cert", "t"))) == "reproduced"
    assert verdict(claim("at_most", "0", "norm-bound"), evidence(at_most(0))) == "reproduced"


def test_a_bound_proved_about_another_quantity_counts_for_nothing():
    assert verdict(claim("at_most", "2", "norm-bound"), evidence(at_most(1), quantity="other")) == "failed"


# --- evidence that contradicts itself -------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["norm-bound", "parameter"])
@pytest.mark.parametrize(
    ("comparator", "published"), [("at_most", "6"), ("at_least", "1"), ("inside", "0..9"), ("equal", "5")]
)
def test_proofs_that_exclude_each_other_decide_nothing(kind, comparator, published):
    assert verdict(claim(comparator, published, kind), evidence(at_least(6), at_most(4))) == "failed"
    both = evidence(says("holds", "a"), says("fails", "b"))
    assert verdict(claim("feasible", "", "feasibility"), both) == "failed"


@pytest.mark.parametrize("kind", ["norm-bound", "figure", "ordering"])
def test_a_number_outside_what_was_proved_of_it_decides_nothing(kind):
    # Proved at least 10, computed as 1: one of the two is wrong, so `at most 5` must not come out as anything.
    assert verdict(claim("at_most", "5", kind), evidence(at_least(10), value=number(1.0))) == "failed"
    assert verdict(claim("at_most", "5", kind), evidence(at_most(3), value=number(4.0))) == "failed"
    assert verdict(claim("at_most", "5", kind), evidence(at_most(3), value=number(4.0, 2.9, 4.5))) == "reproduced"
    assert verdict(claim("at_most", "5", kind), evidence(at_most(3), value=number(3.0 + 1e-12))) == "reproduced"


def test_a_computed_truth_value_that_the_certificate_denies():
    of = claim("holds", "", "identity", quantity="flag", unit="1")
    assert verdict(of, evidence(says("holds"), value=number(0.0), quantity="flag")) == "failed"
    assert verdict(of, evidence(says("holds"), value=number(1.0), quantity="flag")) == "reproduced"


# --- order, scans, joined claims, remarks ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "other", "expected"),
    [
        (number(1.0), number(2.0), "reproduced"), (number(2.0), number(2.0), "contradicted"),
        (number(3.0), number(2.0), "contradicted"), (number(1.0, 0.5, 1.5), number(1.6, 1.4, 1.8), "undecided"),
        (number(1.0), None, "failed"), (None, number(1.0), "failed"),
    ],
)  # fmt: skip
def test_less_than_is_strict_and_needs_both(value, other, expected):
    assert verdict(claim("less_than", "other", "ordering"), evidence(value=value, other=other)) == expected


def test_proved_order():
    of = claim("less_than", "other", "norm-bound")
    on = Evidence(concluded={"q": [at_most(1)], "other": [at_least(2)]}, certificates={"cert": "s"})
    assert verdict(of, on) == "reproduced"
    on.concluded["other"] = [at_least(1)]
    assert verdict(of, on) == "undecided"
    on.concluded["other"] = [at_least(2), at_most("1.5")]
    assert verdict(of, on) == "failed"


@pytest.mark.parametrize("kind", SAMPLED)
@pytest.mark.parametrize(
    ("values", "expected"),
    [((1.0, 2.0), "reproduced"), ((3.0, math.inf), "contradicted"), ((1.0, 3.0), "undetermined")],
)
def test_a_scan_decides_over_the_plausible_inputs(kind, values, expected):
    of = claim("at_most", "2", kind)
    judged = judge(Tables(), of, evidence(value=number(values[0]), scans=scans(of, *values)), {})
    assert (judged.verdict, judged.range_low) == (expected, values[0])
    assert judged.range_high == (None if values[1] == math.inf else values[1])


@pytest.mark.parametrize(
    ("comparator", "published", "values", "holding"),
    # by hand: 1.50 stands for 1.495 to 1.505
    [("at_most", "2", (1, 2, 2.1), 2), ("at_least", "2", (1, 2, 2.1), 2), ("inside", "1..2", (0.9, 1, 2, 2.1), 2),
     ("equal", "1.50", (1.494, 1.495, 1.505, 1.506), 2)],
)  # fmt: skip
def test_a_scan_counts_by_the_claims_own_rule(comparator, published, values, holding):
    of = claim(comparator, published, "ordering")
    assert scans(of, *map(float, values))["c"].holding == holding


@pytest.mark.parametrize(("value", "own"), [(1.5, 3.0), (4.0, 1.0)])
def test_a_scan_that_our_own_filling_denies_decides_nothing(value, own):
    # The value computed at the assumed inputs is one plausible value more.
    of = claim("at_most", "2", "ordering")
    assert verdict(of, evidence(value=number(own), scans=scans(of, value))) == "failed"


@given(st.lists(st.sampled_from(VERDICTS), min_size=1, max_size=6), st.randoms())
def test_joined_claims_are_as_bad_as_the_worst(verdicts, random):
    names = {f"p{i}": v for i, v in enumerate(verdicts)}
    of, case = claim("all_of", "", quantity=" ".join(names)), Tables(*(claim(id=name) for name in names))
    joined = judge(case, of, Evidence(), names).verdict
    # By definition of the order: no part is worse, and one is as bad.
    assert joined in verdicts
    assert all(SEVERITY.index(joined) <= SEVERITY.index(v) for v in verdicts)
    assert (joined == "reproduced") == (set(verdicts) == {"reproduced"})
    shuffled = list(names)
    random.shuffle(shuffled)
    assert judge(case, replace_quantity(of, shuffled), Evidence(), names).verdict == joined


def replace_quantity(of: Claim, names: list[str]) -> Claim:
    return of.model_copy(update={"quantity": " ".join(names)})


def test_a_remark_is_uncheckable_whatever_was_computed():
    assert verdict(claim("", "", "remark"), evidence(at_most(1), value=number(1.0))) == "uncheckable"


def test_what_was_not_computed_has_failed_and_says_why():
    on = Evidence(failures=[{"step": "audit", "where": "(3)", "task": "t", "message": "broke"}])
    judged = judge(Tables(), claim(), on, {})
    assert judged.verdict == "failed"
    assert "(3): broke" in judged.note
    assert judge(Tables(), claim(), Evidence(), {}).note.startswith("the step audit did not compute q")


def test_what_is_computed_and_proved_on_neither_side_is_undecided_and_says_how_far_it_got():
    of = claim("feasible", "", "feasibility")
    judged = judge(Tables(), of, Evidence(undecided={"q": "gap of 1e-3 after 100 iterations"}), {})
    assert (judged.verdict, judged.note) == ("undecided", "gap of 1e-3 after 100 iterations")
    # a proof counts even where the solver gave up
    on = evidence(says("holds"), undecided={"q": "gave up"})
    assert verdict(of, on) == "reproduced"
    # a certificate that the checker refuses is our own trouble
    lost = {"refused": {"bad": "not proved"}, "lost": {"q": ["bad"]}}
    judged = judge(Tables(), of, evidence(value=number(1.0), **lost), {})
    assert (judged.verdict, judged.certificate, judged.note) == ("failed", "bad", "refused: not proved")
    # a step that broke is no limit of the method
    broke = [{"step": "audit", "where": "(3)", "task": "t", "message": "broke"}]
    assert verdict(of, evidence(value=number(1.0), failures=broke)) == "failed"


# --- laws -----------------------------------------------------------------------------------------------------------

NUMBERS = st.floats(-100, 100).map(lambda x: round(x, 3))


@given(
    st.sampled_from(["equal", "at_most", "at_least"]), NUMBERS, NUMBERS, st.floats(0, 10), st.floats(0, 10), NUMBERS,
    st.sampled_from(SAMPLED),
)  # fmt: skip
@settings(max_examples=300)
def test_widening_the_tolerance_never_turns_reproduced_into_anything_else(
    comparator, published, value, a, b, width, kind
):
    small, large = sorted(PrintedNumber(f"{x:.6f}").value for x in (a, b))
    on = evidence(value=number(value, value - abs(width) / 100, value + abs(width) / 100))
    texts = [f"{float(x):.6f}" for x in (small, large)]
    narrow, wide = (verdict(claim(comparator, f"{published:.3f}", kind, tolerance=t), on) for t in texts)
    rank = {"contradicted": 0, "undecided": 1, "reproduced": 2}
    assert rank[wide] >= rank[narrow]


@given(NUMBERS, NUMBERS, st.floats(0, 5), st.floats(0, 5), st.sampled_from(["equal", "at_most", "at_least"]))
@settings(max_examples=300)
def test_narrowing_the_enclosure_never_reverses_a_verdict(published, value, inner, outer, comparator):
    # Law of intervals: what holds for all of a set holds for all of a part of it.
    inner, outer = sorted((inner, outer))
    of = claim(comparator, f"{published:.3f}")
    wide = verdict(of, evidence(value=number(value, value - outer, value + outer)))
    narrow = verdict(of, evidence(value=number(value, value - inner, value + inner)))
    assert wide in ("undecided", narrow)


@given(NUMBERS, NUMBERS)
def test_at_most_and_at_least_exclude_each_other_off_the_bound(published, value):
    on = evidence(value=number(value))
    both = {verdict(claim(c, f"{published:.3f}"), on) for c in ("at_most", "at_least")}
    assert both == (
        {"reproduced"} if Fraction(value) == PrintedNumber(f"{published:.3f}").value else {"reproduced", "contradicted"}
    )


# --- quantities against certificates, claimed or not ----------------------------------------------------------------


@pytest.mark.parametrize(
    ("on", "said"),
    [
        (evidence(says("fails"), value=number(1.0)), "the certificate cert says that it fails"),
        (evidence(says("holds"), value=number(0.0)), "the certificate cert says that it holds"),
        (evidence(says("holds"), value=number(0.5)), "written as 0.5"),
        (evidence(says("holds", "one"), says("fails", "two")), "one two"),
        (
            evidence(at_most("1.5", "above"), value=number(1.6)),
            "written as 1.6, outside of what certificates prove: above",
        ),
        (evidence(at_least(2, "low"), at_most("1.5", "high")), "low high"),
    ],
)
def test_a_quantity_written_by_hand_against_its_certificate_is_a_contradiction(on, said):
    [(quantity, message)] = contradictions(on)
    assert quantity == "q" and said in message


@pytest.mark.parametrize(
    "on",
    [
        evidence(says("holds"), value=number(1.0)),
        evidence(says("fails")),
        evidence(at_most("1.5"), value=number(1.5)),
        evidence(at_least("1.5"), at_most("1.5"), value=number(1.5000001)),  # rounding, as a verdict allows it
        evidence(value=number(7.0)),
        evidence(says("holds", "one"), says("fails", "two"), quantity=""),
    ],
)
def test_what_follows_from_a_certificate_is_none(on):
    assert not list(contradictions(on))
