"""Right of reply, and digits that nobody held against the published page: read, refused, told beside the verdict."""

import runpy
from pathlib import Path

import pytest

from gainsay import cli
from gainsay.errors import InputError
from gainsay.report.reading import read_results
from gainsay.results.returned import VERDICT_COLUMNS
from gainsay.steps.explain import explain
from gainsay.tables import paper_names, read_case
from gainsay.verdicts.evidence import ComputedQuantity, Concluded, Evidence
from gainsay.verdicts.judge import judge
from gainsay.verdicts.table import _row

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = runpy.run_path(str(Path(__file__).with_name("report_example.py")))
HEADER = "claim,disputed,ground,done,who\n"


def test_a_reply_is_read_and_may_be_nobodys(project):
    assert project.case().replies == ()
    project.file("replies.csv").write_text(HEADER + "peak,it is 39 N,a figure,nothing,\npeak,no,none,none,an author\n")
    first, second = project.case().replies_to("peak")
    assert (first.disputed, first.who, second.who) == ("it is 39 N", "", "an author")
    assert project.case().replies_to("lmi") == ()
    project.file("replies.csv").write_text("claim,disputed,ground,done\npeak,it is 39 N,a figure,nothing\n")
    assert project.case().replies[0].who == ""


@pytest.mark.parametrize(
    ("row", "field", "expected"),
    [
        ("peek,no,none,none,", "claim", "expected 'peak'?"),
        ("peak,,none,none,", "disputed", "at least 1 character"),
        ("peak,no,,none,", "ground", "at least 1 character"),
        ("peak,no,none,,", "done", "at least 1 character"),
    ],
)
def test_a_reply_that_says_nothing_is_refused(project, row, field, expected):
    project.file("replies.csv").write_text(HEADER + row + "\n")
    with pytest.raises(InputError) as caught:
        project.case()
    assert (caught.value.file, caught.value.row, caught.value.field) == ("papers/toy/replies.csv", 2, field)
    assert expected in str(caught.value)


def parameters(project, *digits):
    """Give the rows of the toy's parameters their column of digits."""
    text = project.file("parameters.csv").read_text().splitlines()
    column = ["digits", *digits]
    lines = [f"{line},{column[i] if i < len(column) else ''}" for i, line in enumerate(text)]
    project.file("parameters.csv").write_text("\n".join(lines) + "\n")


def test_digits_are_those_of_what_is_printed(project):
    parameters(project, "confirmed", "scan")
    rows = project.case().parameters
    assert [name for name, row in rows.items() if row.unconfirmed] == ["height", "K"]  # K's cell is empty


@pytest.mark.parametrize(
    ("digits", "expected"), [(("", "", "scan"), "the digits are ours"), (("seen",), "'confirmed'")]
)
def test_digits_of_what_is_ours_are_refused(project, digits, expected):
    parameters(project, *digits)
    with pytest.raises(InputError, match=expected) as caught:
        project.case()
    assert caught.value.field == "digits"


def judged(case, claim, evidence):
    found = judge(case, case.claims[claim], evidence, {})
    return _row(case, claim, found, evidence, found.verdict)


def test_a_contradiction_names_what_its_proof_reads_from_the_scan(project):
    parameters(project, "confirmed", "scan")
    case = project.case()
    said = {word: Concluded(word, None, None, "c", "t") for word in ("holds", "fails")}
    read = {"c": {"mass", "height", "guess"}}
    for word, named in (("fails", "height"), ("holds", "")):  # confirmed and assumed ones are not named
        evidence = Evidence(concluded={"audit.holds": [said[word]]}, certificates={"c": "s"}, read=read)
        assert judged(case, "lmi", evidence)["digits"] == named
    # without a certificate it may be anything that the paper prints
    high = Evidence(numbers={"run.peak": ComputedQuantity(50.0, 50.0, 50.0, "m", "s")})
    assert judged(case, "peak", high)["digits"] == "height K"


def test_explain_and_the_page_show_replies_and_digits(tmp_path):
    root = EXAMPLE["build"](tmp_path / "project")
    hostile = EXAMPLE["HOSTILE"].replace('"', "")
    (root / "papers/toy2001/replies.csv").write_text(HEADER + f"poles,{hostile},a figure,nothing,an author\n")
    table = root / "results/toy2001/verdicts.csv"
    lines = table.read_text().splitlines()
    after = len(VERDICT_COLUMNS) - VERDICT_COLUMNS.index("digits") - 1
    rows = [f"{x[: len(x) - after]}L{',' * after}" if x.startswith("poles,") else x for x in lines]
    table.write_text("\n".join(rows) + "\n")
    case = read_case(root, "toy2001")
    text = "\n".join(explain(case, "poles"))
    assert f"disputed, says an author: {hostile}; on the ground: a figure; done: nothing" in text
    assert "read from the scan alone: L" in text
    assert "reply" not in "\n".join(explain(case, "cost"))
    page = next(p for p in EXAMPLE["write_pages"](root, [read_results(case)]) if p.parent.name == "toy2001").read_text()
    assert "Disputed: see the reply." in page and "Disputed, says an author:" in page
    assert "<script>alert(1)" not in page and "&lt;script&gt;alert(1)" in page
    assert "not held against the published page: <math><mi>L</mi></math>." in page
    assert page.count("<dt>Reply</dt>") == page.count("<dt>Digits</dt>") == 1


def test_every_printed_parameter_of_the_papers_says_where_its_digits_come_from():
    for paper in paper_names(ROOT):
        for name, row in read_case(ROOT, paper).parameters.items():
            assert bool(row.digits) == (row.status == "printed"), (paper, name)


def test_a_new_paper_has_its_table_of_replies(tmp_path):
    assert cli.main(["new", "--project", str(tmp_path / "own"), "smith1999"]) == 0
    assert (tmp_path / "own/papers/smith1999/replies.csv").read_text() == HEADER
