"""What a wrong verdict or a lost difference could hide behind: changes of the code that no other test noticed."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import pytest

from gainsay.errors import InputError
from gainsay.proof import build, check
from gainsay.results import Results
from gainsay.results.listing import LISTING_COLUMNS
from gainsay.scans import Plausible, corners, plausible, scan
from gainsay.scans.outcome import outcome, read_scans
from gainsay.scans.ranges import readings
from gainsay.steps.verdicts import verdicts
from gainsay.tables.files import write_csv, write_json
from gainsay.verdicts.differences import differences, scan_differences
from gainsay.verdicts.evidence import read_evidence
from tests.gainsay.judge_example import Tables, at_most, claim, evidence, judge, number, verdict

X, WORD = Plausible("x", "m", 0.0, 1.0), Plausible("word", values=("small", "large"))


def test_a_refused_certificate_that_names_no_quantity_may_be_any_ones():
    of = claim("at_most", "2", "norm-bound")
    lost = replace(evidence(value=number(1.0)), lost={"": ["broken"]}, refused={"broken": "not readable"})
    judged = judge(Tables(), of, lost, {})
    assert judged.verdict == "failed" and judged.note == "refused: not readable"
    elsewhere = replace(lost, lost={"another": ["broken"]})
    assert judge(Tables(), of, elsewhere, {}).verdict == "undecided"


def test_an_order_of_which_one_side_is_computed_and_not_proved_is_undecided():
    of = claim("less_than", "other", "norm-bound")
    assert verdict(of, evidence(at_most(1), value=number(1.0), other=number(2.0))) == "undecided"
    assert verdict(of, evidence(at_most(1), value=number(1.0))) == "failed"  # the other was not computed


def test_a_scan_says_how_its_points_were_drawn():
    def drawn(*inputs):
        return scan(SimpleNamespace(claims={}), "value", inputs, lambda p: 1.0, samples=200).to_json()["sequence"]

    assert drawn(X).startswith("Halton") and drawn(X, WORD).startswith("Halton")
    assert drawn(WORD) == "every reading"


def test_plausible_values_of_what_is_no_parameter_are_refused():
    row = SimpleNamespace(plausible="", unit="m", type="number")
    case = SimpleNamespace(name="toy", parameters={"known": row})
    for name in ("unknown", "known"):
        with pytest.raises(InputError, match="plausible"):
            plausible(case, name)
    row.plausible = "0..1"
    assert plausible(case, "known").ends == (0.0, 1.0)


def content(**changes):
    entry = {"name": "x", "unit": "m", "low": 0.0, "high": 1.0, "logarithmic": False}
    plain = {"quantity": "audit.length", "seed": 0, "sequence": "by hand", "inputs": [entry]}
    return {**plain, "values": [1.5, 1.6], "points": [[0.0], [1.0]], "crossings": [], **changes}


@pytest.mark.parametrize(
    "changes", [{"values": [1.5]}, {"points": [[0.0]]}, {"points": [[0.0], [1.0, 0.5]]}, {"values": []}]
)
def test_a_scan_of_more_values_than_points_is_refused(changes, tmp_path):
    write_json(tmp_path / "good.json", content())
    assert list(read_scans([tmp_path / "good.json"], tmp_path)) == ["audit.length"]
    write_json(tmp_path / "bad.json", content(**changes))
    with pytest.raises(InputError):
        read_scans([tmp_path / "bad.json"], tmp_path)
    if len(changes.get("values", "ab")) != len(changes.get("points", "ab")):
        with pytest.raises(ValueError, match=r"shorter|longer"):
            outcome(claim("at_most", "2"), content(**changes))


@pytest.mark.parametrize("at", [-0.01, 1.01, 1e300])
def test_a_scan_at_a_point_outside_its_range_is_refused(at, tmp_path):
    write_json(tmp_path / "one.json", content(points=[[0.0], [at]]))
    with pytest.raises(InputError, match=r"one\.json.*outside its range"):
        read_scans([tmp_path / "one.json"], tmp_path)


def test_a_scan_that_is_new_or_gone_is_a_difference(project):
    case = project.case()
    (case.results / "scans").mkdir(parents=True)
    write_json(case.results / "scans" / "audit.length.json", content())
    write_csv(case.results / "parts" / "audit.files.csv", LISTING_COLUMNS, [("scans/audit.length.json", "", "", "")])
    new = scan_differences(project.case())
    assert new and all(row[3] == "" and row[4] for row in new)
    lines = ["claim,item,value,unit,class,relative,absolute,reason", "length,smallest,1.5,m,rounding,1e-9,0,r"]
    project.file("recorded_scans.csv").write_text("\n".join(lines) + "\n")
    write_csv(case.results / "parts" / "audit.files.csv", LISTING_COLUMNS, [])
    assert [row[2:] for row in scan_differences(project.case())] == [("length smallest", "1.5", "", "not found")]


def test_words_on_record_agree_to_the_letter(project):
    case = project.case()
    (case.results / "scans").mkdir(parents=True)
    write_json(case.results / "scans" / "audit.length.json", content())
    write_csv(case.results / "parts" / "audit.files.csv", LISTING_COLUMNS, [("scans/audit.length.json", "", "", "")])
    header = "claim,item,value,unit,class,relative,absolute,reason"
    project.file("recorded_scans.csv").write_text(f"{header}\nlength,outcome,1.5,1,rounding,1e-9,0,r\n")
    found = {row[2]: row[3:5] for row in scan_differences(project.case())}
    assert found["length outcome"][0] == "1.5" and not found["length outcome"][1].isdigit()


def test_readings_and_corners_are_admissible_and_few():
    for points in (readings, corners):
        assert points([WORD]) == [{"word": "small"}, {"word": "large"}]
        assert points([WORD], lambda point: point["word"] == "large") == [{"word": "large"}]
    with pytest.raises(InputError, match="at most 10"):
        corners([replace(WORD, name=f"w{k}") for k in range(11)])
    assert len(corners([replace(WORD, name=f"w{k}") for k in range(10)])) == 2**10


@pytest.mark.parametrize(
    ("fields", "relation"),
    [
        ({"high": "2"}, "less_than"),
        ({"high": "3/2"}, "at_most"),
        ({"low": "1"}, "greater_than"),
        ({"low": "3/2"}, "at_least"),
    ],
)
def test_each_relation_of_a_conclusion_bounds_its_own_side(fields, relation, project):
    case = project.case()
    results = Results(case, "audit")
    made = build.certificate("enclosed", id="one", statement="S.", tables=case, fields={"formula": "3/2", **fields},
                             quantities={"value": "audit.length"})  # fmt: skip
    results.certificate(made)
    results.close()
    [(low, high)] = [(c.low, c.high) for c in read_evidence(case).concluded["audit.length"] if c.relation == relation]
    assert (low, high) == tuple(Fraction(fields[name]) if name in fields else None for name in ("low", "high"))


@pytest.mark.parametrize(
    ("formula", "covered"),
    [("3 + 0*plausible('guess')", True), ("3 + ends('guess')[0, 0]", False),
     ("3 + plausible('guess') - ends('guess')[0, 1]", False)],
)  # fmt: skip
def test_an_end_of_a_plausible_range_does_not_pass_for_all_of_it(formula, covered, project):
    """What one end shows says nothing of the values between: it is put on faith, and refutes no sentence with `can`."""
    case = project.case()
    results = Results(case, "audit")
    made = build.certificate("enclosed", id="one", statement="S.", tables=case, fields={"formula": formula},
                             quantities={"value": "audit.length"})  # fmt: skip
    results.certificate(made)
    results.close()
    (concluded,) = read_evidence(case).concluded["audit.length"]
    assert concluded.over == ({"guess"} if covered else set())
    assert any("every plausible value of 'guess'" in text for text in check(made, case).faith) is not covered


def test_what_a_computation_read_of_what_is_left_out_is_on_record(project):
    header = "quantity,parameter,how\n"
    project.file("recorded_reads.csv").write_text(header + "audit.length,guess,scanned\n")
    results = Results(project.case(), "audit")
    results.quantity("audit.length", 1.5, method="m")
    results.close()
    verdicts(project.case())
    rows = [row for row in differences(project.case()) if row[1] == "input"]
    assert [row[2:5] for row in rows] == [("audit.length guess", "scanned", "")]
