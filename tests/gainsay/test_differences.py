import csv
import hashlib

import numpy as np
import pytest

from gainsay.errors import ComputationError, InputError
from gainsay.proof import build
from gainsay.results import Results
from gainsay.results.listing import LISTING_COLUMNS, sha256, write_listing
from gainsay.steps.compare import compare
from gainsay.steps.verdicts import verdicts
from gainsay.tables.designs import FoundDesign, write_design
from gainsay.tables.files import read_records, write_atomically, write_csv, write_json
from gainsay.tables.models import Recorded
from gainsay.verdicts.differences import differences, scan_differences
from gainsay.verdicts.errata import with_results
from gainsay.verdicts.evidence import read_evidence
from gainsay.verdicts.record import record_paper
from gainsay.verdicts.tolerance import decimal_above, share

COMPUTED = {"audit.length": 1.5, "audit.other": 1.0, "audit.holds": 1.0}


def design_of(project):
    write_design(project.file(""), "repaired", FoundDesign("one", "picked", {"K": np.eye(2)}, True, {}))


def run(project, *, length=1.5, peak=39.0):
    """Do what the steps would: quantities of two steps, then verdicts; the claims that need proofs fail."""
    design_of(project)
    case = project.case()
    results = Results(case, "audit")
    for quantity, value in {**COMPUTED, "audit.length": length}.items():
        results.quantity(quantity, value, method="m")
    results.close()
    results = Results(case, "simulation")
    results.quantity("run.peak", peak, method="m", lower=peak - 1e-6, upper=peak + 1e-6)
    results.close()
    for step in ("synthesis", "figures", "views"):
        Results(case, step).close()
    verdicts(case)
    for file in ("logs/nominal.mcap", "logs/nominal.rrd", "figures/figure_1.svg", "figures/figure_1.png"):
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
    compare(clean.case())
    assert (clean.root / "results/toy/differences.csv").read_text() == "paper,what,item,expected,found,note\n"


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
    clean.edit("claims.csv", "1.50,m,,reproduced,by hand,,,", "1.4,m,,contradicted,by hand,,result,excluded")
    run(clean)
    assert items(clean) == set()
    clean.edit("claims.csv", "1.4,m,,contradicted", "1.5,m,,contradicted")
    run(clean)
    assert items(clean) == {("verdict", "length")}


def test_a_claim_added_after_the_verdicts_is_a_difference(clean):
    run(clean)
    row = "late,(9),ordering,it is 1.50 m,equal,audit.length,1.50,m,,reproduced,by hand,,,\n"
    clean.file("claims.csv").write_text(clean.file("claims.csv").read_text() + row)
    assert items(clean) == {("verdict", "late")}
    clean.edit("claims.csv", "1.50,m,,reproduced,by hand,,,\npeak", "1.50,m,,contradicted,by hand,,gap,open\npeak")
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


@pytest.mark.parametrize("file", ["logs/nominal.mcap", "logs/nominal.rrd", "figures/figure_1.svg"])
def test_a_missing_file_is_a_difference(clean, file):
    (run(clean).results / file).unlink()
    assert items(clean) == {("file", file)}


def test_an_erratum_without_its_witness_is_a_difference(clean):
    clean.edit("errata.csv", "audit.length", "audit.length gone")
    run(clean)
    assert items(clean) == {("erratum", "sign")}


def test_the_texts_of_an_erratum_are_typeset_from_its_edition(clean):
    clean.follow_edition("(21) corrected: (2,2)")
    case = run(clean)
    assert items(clean) == {("erratum", "sign")}  # nothing says it yet
    compare(case)
    assert items(clean) == set()
    (row,) = csv.DictReader((case.results / "errata.csv").read_text().splitlines())
    assert (row["id"], row["printed"], row["corrected"]) == ("sign", "$g I$ in block (2,2)", "$-g I$ in block (2,2)")
    assert with_results(case).errata["sign"].corrected == "$-g I$ in block (2,2)"


@pytest.mark.parametrize(
    ("edition", "module", "said"),
    [
        ("(21) corrected: (1,2)", None, "one of (2,2)"),
        ("(12) corrected", None, "(21) corrected"),
        ("(21) corrected: (2,2)", "import no_such_module", "no_such_module"),
    ],
)
def test_an_erratum_that_no_edition_bears_out_is_a_difference(clean, capsys, edition, module, said):
    clean.follow_edition(edition)
    if module:
        write_atomically(clean.file("statements.py"), module)
    compare(run(clean))
    assert items(clean) == {("erratum", "sign")}
    assert said in capsys.readouterr().out
    assert with_results(clean.case()).errata["sign"].printed == edition  # the page says which edition was meant


@pytest.mark.parametrize(
    ("printed", "edition", "field"),
    [("$A$", "(21) corrected", "printed"), ("", "", "printed"), ("", "(21): 2,2", "edition"), ("", "(21)$", "edition")],
)
def test_an_erratum_says_its_texts_once(clean, printed, edition, field):
    clean.follow_edition(edition)
    rows = list(csv.reader(clean.file("errata.csv").read_text().splitlines()))
    rows[1][rows[0].index("printed")] = printed
    write_csv(clean.file("errata.csv"), rows[0], rows[1:])
    with pytest.raises(InputError) as refused:
        clean.case()
    assert refused.value.field == field


def test_what_is_not_a_certificate_is_refused_and_is_a_difference(clean):
    case = run(clean)
    write_atomically(case.results / "certificates" / "bad.json", '{"format": "gainsay certificate"}')
    write_csv(case.results / "parts" / "synthesis.files.csv", LISTING_COLUMNS, [("certificates/bad.json", "", "", "")])
    verdicts(case)
    assert items(clean) == {("certificate", "bad")}


def test_files_that_no_step_lists_are_no_evidence(clean):
    case = run(clean)
    write_atomically(case.results / "certificates" / "orphan.json", "{}")
    write_atomically(case.results / "scans" / "audit.length.json", '{"quantity": "audit.length"}')
    found = read_evidence(case)
    assert (found.certificates, found.refused, found.scans) == ({}, {}, {})


def test_results_that_are_not_there_are_bad_input(project):
    with pytest.raises(InputError, match=r"results/toy/[a-z]+.csv: file not found"):
        compare(project.case())


def test_recording_keeps_tolerances_shows_changes_and_is_stable(project):
    case = run(project)
    lines = list(record_paper(case))
    assert "audit.other: new, 1.0 m, rounding" in lines
    assert lines[-1] == "4 quantities on record, 3 changes"
    recorded = {row["quantity"]: row for row in read_records(case.folder / "recorded.csv", case.root)}
    assert recorded["audit.length"]["reason"] == "condition of a million"
    assert recorded["run.peak"]["class"] == "enclosed"  # it stands with an enclosure of width 2e-6
    assert float(recorded["run.peak"]["absolute"]) == pytest.approx(2e-6, rel=0.1)
    project.edit("recorded.csv", "audit.length,1.5,m,rounding,1e-6", "audit.length,1.25,m,rounding,1e-3")
    lines = list(record_paper(project.case()))
    assert lines[0] == "audit.length: 1.25 -> 1.5 m"
    recorded = {row["quantity"]: row for row in read_records(case.folder / "recorded.csv", case.root)}
    assert (recorded["audit.length"]["relative"], recorded["audit.length"]["value"]) == ("1e-3", "1.5")
    before = project.file("recorded.csv").read_bytes()
    assert list(record_paper(project.case())) == ["4 quantities on record, 0 changes"]
    assert project.file("recorded.csv").read_bytes() == before


def test_nothing_leaves_the_record_while_something_was_not_computed(clean):
    case = clean.case()
    before = clean.file("recorded.csv").read_bytes()
    Results(case, "simulation").close()
    verdicts(case)
    with pytest.raises(ComputationError, match=r"run\.peak was not computed: nothing was put on record"):
        list(record_paper(case))
    run(clean)
    results = Results(case, "figures")
    with results.task("figure_1", "draw"):
        raise ValueError("no picture")
    results.close()
    verdicts(case)
    with pytest.raises(ComputationError, match="1 computations failed"):
        list(record_paper(case))
    assert clean.file("recorded.csv").read_bytes() == before


def gained(project, value, identified=True):
    """Run with a printed gain that the audit gives again."""
    case = run(project)
    results = Results(case, "audit")
    for quantity, computed in COMPUTED.items():
        results.quantity(quantity, computed, method="m")
    K = case.printed("K")
    results.gains("K", published=K, resynthesised=np.full((2, 2), value), identified=np.full((2, 2), identified))
    results.close()
    verdicts(case)
    return case


def test_how_a_printed_entry_came_out_is_on_record(clean):
    lines = list(record_paper(gained(clean, 7.0)))
    assert "gain K(2,2): 7 reproduced" in lines  # K prints 7 there, and other numbers elsewhere
    assert "gain K(1,1): 1.50 undetermined" in lines
    assert items(clean) == set()
    gained(clean, 7.6)
    assert items(clean) == {("published", "gain K(2,2)")}
    gained(clean, 7.1)  # it rounds to 7
    assert items(clean) == set()
    gained(clean, 7.0, identified=False)
    assert items(clean) == {("published", "gain K(2,2)")}
    run(clean)  # nothing is held against it any more
    assert ("published", "gain K(2,2)") in items(clean)
    assert "gain K(2,2): off the record" in list(record_paper(clean.case()))


def test_nothing_goes_on_record_while_a_file_is_not_as_its_step_left_it(clean):
    case = clean.case()
    before = clean.file("recorded.csv").read_bytes()
    path = case.results / "quantities.csv"
    path.write_text(path.read_text().replace("audit.length,1.5,", "audit.length,1.6,"))
    with pytest.raises(ComputationError, match=r"quantities\.csv of the step verdicts is altered: nothing was put on"):
        list(record_paper(case))
    run(clean)
    (case.results / "parts" / "synthesis.files.csv").unlink()  # as in a step that was killed
    with pytest.raises(ComputationError, match=r"synthesis\.files\.csv of the step synthesis is missing"):
        list(record_paper(case))
    assert clean.file("recorded.csv").read_bytes() == before


def test_nothing_goes_on_record_beside_a_refused_certificate(clean):
    case = certified(clean, "1 > 0")
    list(record_paper(case))
    path = case.results / "certificates" / "one.json"
    before = clean.file("recorded_certificates.csv").read_bytes()
    text = path.read_text()
    forged = text.replace("1 > 0", "0 > 1")
    assert forged != text
    path.write_text(forged)
    listing = case.results / "parts" / "audit.files.csv"
    listing.write_text(listing.read_text().replace(hashlib.sha256(text.encode()).hexdigest(), sha256(path)))
    verdicts(case)
    with pytest.raises(ComputationError, match="certificate one refused: nothing was put on record"):
        list(record_paper(case))
    assert clean.file("recorded_certificates.csv").read_bytes() == before


def test_a_paper_without_a_record_has_everything_not_on_record(clean):
    run(clean)
    clean.file("recorded.csv").unlink()
    assert items(clean) == {("quantity", name) for name in clean.case().quantities}
    clean.edit("paper.toml", "year = 2000", "year = 2000\ndraft = true")
    assert not items(clean)


def test_an_enclosure_on_record_that_is_not_there_any_more_is_a_difference(clean):
    clean.edit("recorded.csv", "audit.length,1.5,m,rounding,1e-6,1e-12", "audit.length,1.5,m,enclosed,1e-6,1e-12")
    run(clean)
    assert items(clean) == {("quantity", "audit.length")}


def test_rounding_noise_is_on_record_as_below_a_floor(clean):
    clean.edit("recorded.csv", "audit.length,1.5,m,rounding,1e-6,1e-12", "audit.length,0,m,floor,0,2")
    run(clean)
    assert items(clean) == set()
    list(record_paper(clean.case()))
    assert "audit.length,0,m,floor,0,2" in clean.file("recorded.csv").read_text()


INPUT = {"name": "guess", "unit": "1", "low": 0.0, "high": 1.0, "logarithmic": False}


def put_scan(case, *values, crossing=()):
    """A scan of the length, which the paper prints as 1.50 m, over a guess from 0 to 1."""
    points = [[i / len(values)] for i in range(len(values))]
    crossings = [{"values": [1.5, 1.6], "points": [[x] for x in crossing]}] if crossing else []
    content = {
        "quantity": "audit.length",
        "seed": 0,
        "sequence": "by hand",
        "inputs": [INPUT],
        "values": values,
        "points": points,
    }
    write_json(case.results / "scans" / "audit.length.json", {**content, "points": points, "crossings": crossings})
    write_listing(case.results / "parts" / "audit.files.csv", case.results, {"scans/audit.length.json": ""})


@pytest.mark.parametrize("change", [
    {"values": (1.5, 1.75, 1.75)},
    {"values": (1.5, 1.75 * (1 + 1e-8))},
    {"values": (1.5, 1.505)},
    {"values": (1.5, 1.75), "crossing": (0.25, 0.6)},
])  # fmt: skip
def test_what_a_scan_found_is_on_record(clean, change):
    case = run(clean)
    put_scan(case, 1.5, 1.75, crossing=(0.25, 0.5))
    list(record_paper(case))
    assert scan_differences(clean.case()) == []
    put_scan(case, 1.5, 1.75 * (1 + 1e-12), crossing=(0.25, 0.5))
    assert scan_differences(clean.case()) == []  # rounding
    put_scan(case, *change["values"], crossing=change.get("crossing", (0.25, 0.5)))
    assert len(scan_differences(clean.case())) >= 1


def test_another_published_value_changes_what_a_scan_says_not_the_scan(clean):
    case = run(clean)
    put_scan(case, 1.5, 1.75)
    list(record_paper(case))
    clean.edit("claims.csv", "equal,audit.length,1.50", "equal,audit.length,1.75")
    assert [row[2] for row in scan_differences(clean.case())] == []  # one of two holds either way
    clean.edit("claims.csv", "equal,audit.length,1.75", "equal,audit.length,1.9")
    assert [row[2] for row in scan_differences(clean.case())] == ["length outcome", "length holding"]


def test_a_scan_keeps_its_floor_on_record(clean):
    case = run(clean)
    put_scan(case, 3e-15, 1.5)
    list(record_paper(case))
    clean.edit("recorded_scans.csv", "length,smallest,3e-15,m,rounding,1e-9,0", "length,smallest,0,m,floor,0,1e-12")
    put_scan(case, -7e-14, 1.5)
    list(record_paper(clean.case()))
    assert "length,smallest,0,m,floor,0,1e-12" in clean.file("recorded_scans.csv").read_text()
    assert scan_differences(clean.case()) == []
    put_scan(case, 2e-12, 1.5)
    assert [row[2] for row in scan_differences(clean.case())] == ["length smallest"]


@pytest.mark.parametrize(("value", "above"), [(0.00123, "0.0013"), (2e-6, "0.000002"), (123456.0, "1.3e5")])
def test_a_width_is_rounded_up_so_that_it_covers_the_enclosure(value, above):
    assert decimal_above(value) == above  # by hand
    assert float(decimal_above(value)) >= value


def test_the_share_of_a_tolerance():
    row = Recorded(
        quantity="a", value="2.0", unit="1", relative="1e-3", absolute="1e-3", reason="r", **{"class": "rounding"}
    )
    assert share(row, 2.0 + 1.5e-3) == pytest.approx(0.5)  # 1e-3 + 2 * 1e-3 is allowed
    assert share(row, float("nan")) == float("inf")
    exact = row.model_copy(update={"class_": "exact", "relative": "0", "absolute": "0"})
    assert (share(exact, 2.0), share(exact, 2.0 + 1e-15)) == (0.0, float("inf"))


def certified(project, constraint, name="one"):
    """Run with one certificate of the audit beside the quantities."""
    case = run(project)
    results = Results(case, "audit")
    for quantity, value in COMPUTED.items():
        results.quantity(quantity, value, method="m")
    parts = {"statement": "A number is positive.", "tables": case}
    results.certificate(build.certificate("definite", id=name, fields={"constraint": constraint}, **parts))
    results.close()
    verdicts(case)
    return case


def test_a_certificate_that_states_something_else_is_a_difference(clean):
    list(record_paper(certified(clean, "1 > 0")))
    certified(clean, "1 > 0")
    assert not items(clean)
    certified(clean, "2 > 0")
    assert items(clean) == {("certificate", "one")}
    certified(clean, "1 > 0", name="two")
    assert items(clean) == {("certificate", "one"), ("certificate", "two")}


def test_a_quantity_without_a_claim_cannot_be_written_against_its_certificate(clean):
    case = run(clean)
    results = Results(case, "audit")
    for quantity, value in COMPUTED.items():
        results.quantity(quantity, value, method="typed by hand")
    fields = {"formula": "3/2", "high": "2"}
    made = build.certificate("enclosed", id="one", statement="S.", tables=case, fields=fields,
                             quantities={"value": "audit.other"})  # fmt: skip
    results.certificate(made)
    results.close()
    verdicts(case)
    assert ("failure", "audit audit.other") in items(clean)  # 1.0, where the certificate encloses 3/2
    typed = case.results / "parts" / "audit.quantities.csv"
    write_atomically(typed, typed.read_text().replace("audit.other,1.0", "audit.other,1.5"))
    verdicts(case)
    assert ("failure", "audit audit.other") not in items(clean)
