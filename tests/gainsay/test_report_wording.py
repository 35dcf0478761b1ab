"""How the page says conditions and what an undetermined verdict hangs on."""

import re
from html import unescape
from types import SimpleNamespace

import pytest

from gainsay.report.certificates import _concluded, _label
from gainsay.report.wording import condition, reason


def test_conditions_read_as_words():
    units = {"gravity": ("m^3/s^2", "assumed"), "observer_start": ("1", "assumed"), "level": ("1", "printed")}
    parameters = {name: SimpleNamespace(unit=unit, status=status) for name, (unit, status) in units.items()}
    found = SimpleNamespace(case=SimpleNamespace(name="toy", parameters=parameters, assumed={"gravity": 0}))
    shown = condition(found, "observer_start=exact; gravity=3.9e14; level=0.2")
    said = bare(shown)
    assert '<a href="#toy-input-gravity">gravity</a>' in shown and "input-level" not in shown
    assert said == "observer start = exact, gravity = 3.9 × 1014 m3/s2, level = 0.2 as printed"


def bare(shown):
    """Text of a piece of a page."""
    return unescape(re.sub("<[^>]*>", "", str(shown))).replace("\u00a0", " ")


def hung(comparator, values, published, boundary=None, others=0):
    """Return the sentence on a claim that hangs on what the paper leaves out, with `values` found."""
    inputs = tuple(SimpleNamespace(name=name, unit="kg m^2") for name in ("inertia_x", "b", "c")[: 1 + others])
    scan = SimpleNamespace(boundary=boundary, inputs=inputs, samples=9, holding=4, at_best=4 if boundary else 9,
                           least=(min(values), {}), greatest=(max(values), {}), finite=False)  # fmt: skip
    claim = SimpleNamespace(id="x", comparator=comparator, unit="deg", published=published)
    row = {"verdict": "undetermined", "evidence": "sampled 9 (distinct 9)"}
    return bare(reason(SimpleNamespace(scans={"x": scan}), claim, row))


@pytest.mark.parametrize(("holds", "fails", "side", "other"), [(8.94, 8.95, "below", "above"),
                                                               (8.95, 8.94, "above", "below")])  # fmt: skip
def test_an_undetermined_verdict_is_one_sentence_with_the_turning_point(holds, fails, side, other):
    boundary = SimpleNamespace(input="inertia_x", holds=holds, fails=fails)
    assert hung("at_most", [1.0], "3", boundary) == (
        f"Holds when inertia x is {side} {holds} kg m2, fails when it is {other}; "
        "it holds at 4 of 9 plausible values of what the paper leaves out."
    )
    assert ", the other 2 inputs kept; it holds" in hung("at_most", [1.0], "3", boundary, others=2)


def test_a_word_without_a_number_hangs_on_its_reading():
    # 0.1 rad is 5.7295779 deg, 0.2 rad 11.459155 deg; ends are rounded away from each other.
    where = "9 plausible values of what the paper leaves out"
    assert hung("at_most", [0.1, 0.2], "1..9") == (
        f"Holds at all {where} where the sentence allows 11.46 deg or more, "
        "fails at all where it allows less than 5.729 deg; it prints no number."
    )
    assert hung("at_least", [0.1, 0.2], "1..9") == (
        f"Holds at all {where} where the sentence asks for 5.729 deg or less, "
        "fails at all where it asks for more than 11.46 deg; it prints no number."
    )


@pytest.mark.parametrize(
    ("relation", "value", "said"),
    [
        ("fails", None, "the bandwidth: fails"),
        ("at_most", "29.01455", "the bandwidth: at most 29.0146 1/s"),  # rounded away from the number
        ("greater_than", "0", "the bandwidth: above 0 1/s"),
        # neither a fraction nor a row of digits: a third lies between 0.3333333333333333 and 0.33333333333333337
        ("inside", "1/3..1/3", "the bandwidth: 0.333333 1/s (± 3.5 × 10−17 1/s)"),
    ],
)
def test_what_a_certificate_concludes_is_a_word_or_a_short_number(relation, value, said):
    declared = SimpleNamespace(id="audit.bandwidth", meaning="the bandwidth", unit="1/s")
    case = SimpleNamespace(quantities={"audit.bandwidth": declared})
    found = _concluded(case, {"of": "x", "quantity": "audit.bandwidth", "relation": relation, "value": value})
    assert f"{bare(found.about)}: {found.truth or bare(found.bound)}" == said
    assert bare(_concluded(case, {"of": "x_y", "quantity": "", "relation": "holds", "value": None}).about) == "the x y"


def test_a_part_of_a_statement_is_named_in_words_or_as_a_symbol():
    shown = [bare(_label(label, {"eps": {}})) for label in ("(14)", "rho > 0", "eps", "left", "Cz", "row 4")]
    assert shown == ["(14)", "condition", "ε", "one side", "Cz", "row 4"]
