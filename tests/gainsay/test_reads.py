"""What a computation reads of what the paper leaves out is recorded with what it computes, and claims must say it."""

from dataclasses import replace

import pytest

from gainsay.errors import InputError
from gainsay.results import Results, run_tasks, task
from gainsay.scans import plausible, scan
from gainsay.tables.files import read_records
from gainsay.tables.lint import _claim_faults
from gainsay.tables.models import RecordedRead
from gainsay.tables.reads import recording
from gainsay.verdicts.record import reads_of
from tests.gainsay.judge_example import claim as example

CLAIM = example("at_most", "2", quantity="audit.length", statement="at most 2 m")
HEADER = "quantity,parameter,how\n"


def reads(case, *tasks):
    run_tasks(Results(case, "audit"), tasks)
    rows = read_records(case.results / "parts" / "audit.reads.csv", case.root)
    return {(row["quantity"], row["parameter"], row["how"]) for row in rows}


def test_only_what_the_paper_leaves_out_is_recorded(project):
    case = project.case()
    with recording() as names:
        case.number("mass"), case.matrix("K"), case.number("guess"), case.choice("start")
    assert names == {"guess", "start"}


def test_a_quantity_carries_what_was_read_before_it_in_its_task(project):
    @task("(1)")
    def first(case, results):
        value = case.number("guess")
        results.quantity("audit.length", value, method="m")
        results.quantity("audit.other", value + case.number("count"), method="m")

    @task("(2)")
    def second(case, results):
        results.quantity("audit.holds", case.number("mass"), method="m")

    assert reads(project.case(), first, second) == {
        ("audit.length", "guess", "read"),
        ("audit.other", "guess", "read"),
        ("audit.other", "count", "read"),
    }


def test_what_is_read_apart_is_not_held_against_what_follows(project):
    @task("(1)")
    def both(case, results):
        case.number("guess")
        with results.apart():
            results.quantity("audit.length", case.number("count"), method="m")
        results.quantity("audit.other", 1.0, method="m")

    assert reads(project.case(), both) == {
        ("audit.length", "guess", "read"),
        ("audit.length", "count", "read"),
        ("audit.other", "guess", "read"),
    }


def test_what_is_scanned_over_is_no_condition(project):
    @task("(1)")
    def over(case, results):
        inputs = [plausible(case, "guess")]
        found = scan(case, "audit.length", inputs, lambda p: p["guess"] + float(case.choice("start") == "far"))
        results.scan(found)
        results.quantity("audit.length", case.number("guess"), method="m")

    case = project.case()
    reads(case, over)
    assert reads_of(case) == {("audit.length", "guess"): "scanned", ("audit.length", "start"): "read"}


@pytest.mark.parametrize(
    ("rows", "given", "refused"),
    [
        ("audit.other,guess,read\n", "", "guess=0.5 too, since audit.other rests on it"),
        ("audit.other,guess,read\naudit.other,start,read\n", "guess=0.5", "start=near too"),
        ("audit.other,guess,read\n", "guess=0.25", "0.5, at which audit.other is computed"),
        ("audit.other,guess,read\n", "guess=0.50", None),
        ("audit.other,guess,scanned\n", "", None),
        ("audit.other,mass,borne_out\n", "", "mass=2.0 too, since audit.other rests on it"),
        ("audit.other,mass,borne_out\n", "mass=2.00", None),
        ("audit.holds,guess,read\n", "guess=0.5", "guess=0.5 too, since audit.holds"),  # the claim `lmi` has none
    ],
)
def test_a_claim_on_what_read_an_assumed_input_says_so_or_is_refused(project, rows, given, refused):
    project.file("recorded_reads.csv").write_text(HEADER + rows)
    project.edit("claims.csv", "note,weight,ocr", "note,given,weight,ocr")
    text = project.file("claims.csv").read_text().replace(",,,\n", ",,,,\n")
    project.file("claims.csv").write_text(
        text.replace("2,m,,reproduced,by hand,,,,", f"2,m,,reproduced,by hand,,{given},,")
    )
    if refused is None:
        assert project.case().claims["bound"].given == given
        return
    with pytest.raises(InputError) as found:
        project.case()
    assert refused in found.value.expected


@pytest.mark.parametrize(
    ("plausible_values", "kind", "note", "accepted"),
    [
        ("0..1", "ordering", "a note", False),
        ("0..1", "ordering", "sampled: no closed form", True),
        ("0.25|0.5", "ordering", "a note", True),  # a list has nothing between its values
        ("0..1", "input-bound", "a note", True),  # which a certificate has to decide
    ],
)
def test_a_claim_that_holds_at_samples_says_why_it_is_not_proved(project, plausible_values, kind, note, accepted):
    claim = CLAIM.model_copy(update={"kind": kind, "note": note})
    case = project.case()
    guess = case.parameters["guess"].model_copy(update={"plausible": plausible_values})
    of = replace(
        case,
        parameters={**case.parameters, "guess": guess},
        recorded_scans={("c", "samples"): None},
        recorded_reads={
            ("audit.length", "guess"): RecordedRead(quantity="audit.length", parameter="guess", how="scanned")
        },
    )
    faults = [field for field, _, _ in _claim_faults(of, claim)]
    assert faults == ([] if accepted else ["note"])
