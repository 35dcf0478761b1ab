"""published.csv: a row for every number that a paper publishes, judged entry by entry."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gainsay.exact.digits import PrintedNumber
from gainsay.results import Results
from gainsay.steps.verdicts import verdicts
from gainsay.tables.reading import PrintedMatrix
from gainsay.verdicts.published import (
    PUBLISHED_COLUMNS,
    _is_published,
    pole_verdict,
    published_rows,
    record_line,
    record_sentence,
    summary,
    units_of_last_digit,
)


def printed(*rows):
    return PrintedMatrix(tuple(tuple(PrintedNumber(x) for x in row) for row in rows))


@pytest.fixture
def rows(project):
    """Return the rows of the toy paper: a gain of four entries, a pole pair, and its claims."""
    project.edit("claims.csv", "(1),ordering", "(1),parameter")
    case = project.case()
    results = Results(case, "audit")
    results.quantity("audit.length", 1.52, method="m", lower=1.52, upper=1.52)
    results.quantity("audit.other", 1.0, method="m")
    results.quantity("audit.holds", 1.0, method="m")
    value = np.array([[1.501, -2.0e-3], [0.5, 7.0]])
    results.gains("K", published=case.printed("K"), resynthesised=value,
                  identified=np.array([[True, True], [True, False]]), low=value - 1e-4, high=value + 1e-4)  # fmt: skip
    results.gains("lost", published=printed(["3.0"]))
    results.poles("(4)", published=printed(["-0.50", "0.12"]), recomputed=[-0.47 + 0.1201j], radius=[1e-3])
    results.poles("(5)", published=printed(["-0.50", "0.12"]), recomputed=[-0.4945 + 0.1255j], radius=[1e-3])
    results.gains("alone", published=printed(["3.0"]), resynthesised=np.array([[3.04]]), identified=np.array([[True]]))
    results.close()
    results = Results(case, "simulation")
    results.quantity("run.peak", 39.5, method="m", lower=39.4, upper=39.6)
    results.close()
    verdicts(case)
    return {(row["what"], row["entry"]): row for row in published_rows(case)}


def test_entries_of_a_gain_are_judged_one_by_one(rows):
    assert rows["gain", "K(1,1)"]["verdict"] == "reproduced"  # 1.501 rounds to 1.50
    assert rows["gain", "K(1,1)"]["units_of_last_digit"] == "0.1"
    assert rows["gain", "K(2,1)"]["verdict"] == "undetermined"  # determined by our program, printed otherwise
    assert rows["gain", "K(2,2)"]["verdict"] == "undetermined"  # not determined, though it agrees
    assert rows["gain", "alone(1,1)"]["verdict"] == "reproduced"  # no range was computed beside it
    assert (rows["gain", "lost(1,1)"]["verdict"], rows["gain", "lost(1,1)"]["recomputed"]) == ("uncheckable", "")


def test_a_printed_gain_that_no_program_gives_again_is_uncheckable(project):
    case = project.case()
    Results(case, "audit").close()
    verdicts(case)
    ours = SimpleNamespace(matrices={"A": None, "weight": None})  # the second stands for no printed matrix
    case = replace(case, designs={"ours": ours}, paper=case.paper.model_copy(update={"printed": {"A": "K"}}))
    gains = [row for row in published_rows(case) if row["what"] == "gain"]
    assert [row["entry"] for row in gains] == ["K(1,1)", "K(1,2)", "K(2,1)", "K(2,2)"]
    assert [row["published"] for row in gains] == [e.text for row in case.printed("K").rows for e in row]
    assert {(row["verdict"], row["recomputed"], row["identified"]) for row in gains} == {("uncheckable", "", "")}


@pytest.mark.parametrize(
    ("value", "radius", "expected"),
    [
        (-0.47, 1e-3, "contradicted"),
        (-0.49, 6e-3, "reproduced"),
        (-0.47, 0.6, "undecided"),  # -0.5 is within reach, and so is 0.1
        (-0.47, 4e16, "undecided"),  # the radius of a triple pole, by eigenvectors that are one
        (0.0, 1e-12, "contradicted"),
    ],
)
def test_a_pole_known_to_no_digit_is_not_reproduced(value, radius, expected):
    assert pole_verdict(value, radius, (-0.505, -0.495)) == expected


def test_poles_are_judged_with_the_rounding_of_the_gains(rows):
    real, imaginary = rows["pole", "(4) 1 real"], rows["pole", "(4) 1 imaginary"]
    assert (real["verdict"], imaginary["verdict"]) == ("contradicted", "reproduced")
    assert real["units_of_last_digit"] == "3.0"
    # half a thousandth beyond what rounds to the printed digits, on either side, and a pole known to a thousandth
    assert {rows["pole", f"(5) 1 {part}"]["verdict"] for part in ("real", "imaginary")} == {"reproduced"}


def test_claims_with_a_number_stand_and_those_without_do_not(rows):
    claims = {row["claim"]: row for row in rows.values() if row["claim"]}
    assert set(claims) == {"length", "bound", "peak"}  # feasibility, joined claims and remarks publish no number
    assert claims["length"]["verdict"] == "contradicted" and claims["length"]["units_of_last_digit"] == "2.0"
    assert (claims["peak"]["what"], claims["peak"]["low"], claims["peak"]["high"]) == ("response", "39.4", "39.6")
    assert all(tuple(row) == PUBLISHED_COLUMNS for row in rows.values())


@pytest.mark.parametrize(
    ("comparator", "published", "reading", "stands"),
    [("at_most", "2", "", True), ("at_most", "2", "bands in use", False), ("at_most", "0.0", "", False),
     ("equal", "0", "", True), ("inside", "1..2", "", True), ("inside", "1..2", "bands in use", False)],
)  # fmt: skip
def test_a_number_that_the_paper_does_not_print_is_not_published(project, comparator, published, reading, stands):
    claim = project.case().claims["bound"]
    changed = claim.model_copy(update={"comparator": comparator, "published": published, "reading": reading})
    assert _is_published(project.case(), changed) == stands


def test_the_summary_counts_every_row_once(rows):
    lines = summary(rows.values())
    assert lines[0] == "gains: 6 published, 3 reproduced, 2 undetermined, 1 uncheckable"
    assert lines[1] == "poles: 4 published, 3 reproduced, 1 contradicted"
    assert sum(int(line.split()[1]) for line in lines) == len(rows)


def test_the_line_on_the_record_says_whether_a_verdict_differs():
    assert record_sentence([]).endswith("is as on record")
    assert record_line([]) == record_sentence([]) + "; page: results/index.html"
    numbers = [("toy", "quantity", "a", "1", "2", ""), ("toy", "quantity", "b", "1", "2", "")]
    assert record_sentence(numbers) == "2 numbers of toy differ from the record, no verdict does"
    line = record_sentence([*numbers, ("other", "verdict", "c", "reproduced", "contradicted", "")])
    assert line == "2 numbers of toy and 1 verdict of other differ from the record"
    assert record_sentence([("toy", "verdict", "c", "", "", "")] * 2) == "2 verdicts of toy differ from the record"
    assert record_line(numbers).endswith("details: results/differences.csv; `gainsay record` accepts")


@pytest.mark.parametrize(
    ("row", "end"),
    [
        (("toy", "file", "a.csv", "", "altered", ""), "index.html; `make` makes again what is lost, altered or broken"),
        (
            ("toy", "failure", "audit (1)", "", "no", ""),
            "differences.csv; `make` makes again what is lost, altered or broken",
        ),
        (("toy", "verdict", "c", "reproduced", "contradicted", ""), "details: results/toy/differences.csv"),
        (("toy", "certificate", "c", "accepted", "refused", ""), "details: results/toy/differences.csv"),
        (("toy", "certificate", "c", "sha256:1", "sha256:2", ""), "differences.csv; `gainsay record` accepts"),
    ],
)
def test_the_line_on_the_record_offers_what_helps(row, end):
    line = record_line([row], ["results/toy"])
    assert "; page: results/toy/index.html" in line
    assert line.endswith(end)


@pytest.mark.parametrize(
    ("text", "value", "units"), [("1.50", 1.53, 3), ("-8.8129e-4", -8.8130e-4, -1), ("40", 38.0, -2)]
)
def test_units_of_the_last_digit(text, value, units):
    assert units_of_last_digit(text, value) == pytest.approx(units, abs=1e-6)  # by hand
