import pytest

from gainsay.errors import InputError
from gainsay.steps.check import write_differences
from gainsay.steps.verdicts import verdicts
from gainsay.tables.files import write_atomically, write_csv
from gainsay.tables.results import Results
from gainsay.verdicts.differences import differences, rows_of
from gainsay.verdicts.evidence import read_evidence
from gainsay.verdicts.record import record_paper

COMPUTED = {"audit.length": 1.5, "audit.other": 1.0, "audit.holds": 1.0}


def run(project, *, length=1.5, peak=39.0):
    """Do what the steps would: quantities of two steps, then verdicts; the claims that need proofs fail."""
    case = project.case()
    results = Results(case, "audit")
    for quantity, value in {**COMPUTED, "audit.length": length}.items():
        results.quantity(quantity, value, method="m")
    results.close()
    results = Results(case, "simulation")
    results.quantity("run.peak", peak, method="m", lower=peak - 1e-6, upper=peak + 1e-6)
    results.close()
    verdicts(case)
    for file in ("logs/nominal.mcap", "logs/nominal.rrd", "figures/figure_1.svg", "figures/figure_1.png",
                 "designs/repaired.json"):  # fmt: skip
        write_atomically(case.results / file, "x")
    return case


def drop_claims(project, *names):
    lines = project.file("claims.csv").read_text().splitlines(keepends=True)
    project.file("claims.csv").write_text("".join(x for x in lines if x.split(",")[0] not in names))


@pytest.fixture
def clean(project):
    """Return a project whose results are as on record: claims without proofs, all quantities recorded."""
    drop_claims(project, "bound", "lmi", "both")
    list(record_paper(run(project)))
    return project


def items(project):
    return {(what, item) for _, what, item, *_ in differences(project.case())}


def test_a_clean_run_has_no_difference_and_the_table_only_its_header(clean):
    run(clean)
    assert write_differences(clean.root, ["toy"]) == []
    assert (clean.root / "results" / "differences.csv").read_text() == "paper,what,item,expected,found,note\n"


def test_a_claim_that_needs_a_proof_and_has_none_is_a_difference(project):
    run(project)
    found = items(project)
    assert {("verdict", "bound"), ("verdict", "lmi"), ("verdict", "both")} <= found
    assert ("verdict", "length") not in found


def test_another_verdict_and_another_value_are_differences(clean):
    run(clean, length=1.6)
    assert items(clean) == {("verdict", "length"), ("quantity", "audit.length")}
    run(clean, length=1.5 * (1 + 1e-7))
    assert items(clean) == set()
    run(clean, length=1.5 * (1 + 3e-6))
    assert items(clean) == {("quantity", "audit.length")}


def test_a_contradiction_on_record_is_no_difference_and_its_end_is_one(clean):
    clean.edit("claims.csv", "1.50,m,,reproduced", "1.4,m,,contradicted")
    run(clean)
    assert items(clean) == set()
    clean.edit("claims.csv", "1.4,m,,contradicted", "1.5,m,,contradicted")
    run(clean)
    assert items(clean) == {("verdict", "length")}


def test_a_claim_added_after_the_verdicts_is_a_difference(clean):
    run(clean)
    row = "late,(9),parameter,it is 1.50 m,equal,audit.length,1.50,m,,reproduced,by hand,\n"
    clean.file("claims.csv").write_text(clean.file("claims.csv").read_text() + row)
    assert items(clean) == {("verdict", "late")}
    clean.edit("claims.csv", "1.50,m,,reproduced,by hand,\npeak", "1.50,m,,contradicted,by hand,\npeak")
    assert ("verdict", "length") in items(clean)


def test_a_failed_verdict_is_a_difference_whatever_is_expected(clean):
    case = clean.case()
    run(clean)
    Results(case, "simulation").close()
    verdicts(case)
    assert items(clean) == {("verdict", "peak"), ("quantity", "run.peak")}


def test_a_broken_task_is_a_difference_even_where_all_verdicts_stand(clean):
    case = run(clean)
    results = Results(case, "figures")
    with results.task("figure_1", "draw"):
        raise ValueError("no picture")
    results.close()
    verdicts(case)
    assert items(clean) == {("failure", "figures figure_1")}


@pytest.mark.parametrize(
    "file", ["logs/nominal.mcap", "logs/nominal.rrd", "figures/figure_1.svg", "designs/repaired.json"]
)
def test_a_missing_file_is_a_difference(clean, file):
    (run(clean).results / file).unlink()
    assert items(clean) == {("file", file)}


def test_an_erratum_without_its_witness_is_a_difference(clean):
    clean.edit("errata.csv", "audit.length", "audit.length gone")
    run(clean)
    assert items(clean) == {("erratum", "sign")}


def test_what_is_not_a_certificate_is_refused_and_is_a_difference(clean):
    case = run(clean)
    write_atomically(case.results / "certificates" / "bad.json", '{"format": "gainsay certificate"}')
    write_csv(case.results / "parts" / "synthesis.files.csv", ("file",), [("certificates/bad.json",)])
    verdicts(case)
    assert items(clean) == {("certificate", "bad")}


def test_files_that_no_step_lists_are_no_evidence(clean):
    case = run(clean)
    write_atomically(case.results / "certificates" / "orphan.json", "{}")
    write_atomically(case.results / "scans" / "length.json", '{"claim": "length", "outcome": "holds"}')
    found = read_evidence(case)
    assert (found.certificates, found.refused, found.scans) == ({}, {}, {})


def test_results_that_are_not_there_are_bad_input(project):
    with pytest.raises(InputError, match=r"results/toy/failures.csv: file not found"):
        write_differences(project.root, ["toy"])


def test_recording_keeps_tolerances_shows_changes_and_is_stable(project):
    case = run(project)
    lines = list(record_paper(case))
    assert "audit.other: new, 1.0 m" in lines
    assert lines[-1] == "4 quantities on record, 3 changed"
    recorded = {row["quantity"]: row for row in rows_of(case.folder / "recorded.csv", case.root)}
    assert recorded["audit.length"]["reason"] == "rounding"
    project.edit("recorded.csv", "audit.length,1.5,m,1e-6", "audit.length,1.25,m,1e-3")
    lines = list(record_paper(project.case()))
    assert lines[0] == "audit.length: 1.25 -> 1.5 m"
    recorded = {row["quantity"]: row for row in rows_of(case.folder / "recorded.csv", case.root)}
    assert (recorded["audit.length"]["relative"], recorded["audit.length"]["value"]) == ("1e-3", "1.5")
    before = project.file("recorded.csv").read_bytes()
    assert list(record_paper(project.case())) == ["4 quantities on record, 0 changed"]
    assert project.file("recorded.csv").read_bytes() == before


def test_a_quantity_that_is_no_longer_computed_leaves_the_record_with_a_line(clean):
    case = clean.case()
    Results(case, "simulation").close()
    verdicts(case)
    assert "run.peak: 39.0 -> not computed, taken off the record" in list(record_paper(case))
