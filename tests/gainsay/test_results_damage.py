"""Results damaged between the steps: every command refuses them or says what is damaged, and other papers stand.

A small project with two papers and results of every sort; files of one are damaged, steps and commands run over both.
The seed is part of the test.
"""

import os
import random
import runpy
import shutil
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from gainsay.cli import main
from gainsay.errors import ComputationError, InputError
from gainsay.proof import build
from gainsay.report import read_results
from gainsay.report.page import render_paper
from gainsay.results import Results
from gainsay.results.listing import sha256
from gainsay.results.returned import read_returned
from gainsay.scans import Plausible, Scan
from gainsay.steps.between import between
from gainsay.steps.check import check, shared_differences
from gainsay.steps.compare import compare
from gainsay.steps.explain import explain, status
from gainsay.steps.page import page
from gainsay.steps.report import main as report
from gainsay.steps.verdicts import verdicts
from gainsay.tables import read_case
from gainsay.tables.designs import FoundDesign, write_design
from gainsay.tables.files import read_records, write_atomically
from gainsay.verdicts.record import record_paper
from tests.gainsay.table_damage import BYTES, PLACES, TEXTS, in_json

TOY = runpy.run_path(str(Path(__file__).parents[1] / "conftest.py"))["TOY"]
#: what docs/robustness.md says of this campaign
TRIED = [
    {
        "what": "results between the steps",
        "how": "as tables; and another value somewhere in a JSON file",
        "fast": 6, "slow": 100, "night": 300,
        "promise": "verdicts, compare, page, report, check, record, explain, status and diff refuse what is damaged in "
        "one line or say it; "
        "every verdict, number and difference of another paper is the same",
    }
]  # fmt: skip
COUNT = TRIED[0]["night" if os.environ.get("GAINSAY_NIGHT") else "slow"]
SEED = 20261125


def scan_of_other():
    """A scan of a quantity over two inputs, with a crossing."""
    inputs = (Plausible("guess", "1", 0.5, 1.0, logarithmic=True), Plausible("start", "1", values=("near", "far")))
    found = tuple((float(k), {"guess": 0.5 + k / 512, "start": "near" if k % 2 else "far"}) for k in range(256))
    crossing = ((1.0, {"guess": 0.5, "start": "near"}), (3.0, {"guess": 0.75, "start": "near"}))
    return Scan("audit.other", inputs, 0, found, (crossing,))


def compute(case):
    """Leave what the steps of a paper would: numbers, gains, poles, a scan, a certificate, a log, a figure."""
    results = Results(case, "audit")
    results.quantity("audit.length", 1.5, method="m", lower=1.4999, upper=1.5001)
    results.quantity("audit.other", case.number("mass") / 2, method="half")
    results.prove(build.certificate(
        "identity", id="square", tables=case, statement="A square.", unknowns={"s": {}},
        fields={"left": "(s + 1)**2", "right": "s**2 + 2*s + 1"}, quantities={"identity": "audit.holds"},
    ))  # fmt: skip
    K = case.printed("K")
    results.gains(
        "K", published=K, resynthesised=K.floats, identified=np.ones((2, 2), dtype=bool), low=K.floats, high=K.floats
    )
    results.poles("(4)", published=K, recomputed=[1.5 + 0.002j, 0.1 + 7j], radius=[0.0, 0.1])
    results.scan(scan_of_other())
    results.close()
    results = Results(case, "simulation")
    results.quantity("run.peak", 39.0, method="m")
    write_atomically(case.results / "logs" / "nominal.mcap", "log")
    results.list_file("logs/nominal.mcap")
    results.close()
    results = Results(case, "figures")
    write_atomically(case.results / "figures" / "figure_1.svg", '<svg width="10pt" height="20pt"></svg>')
    results.list_file("figures/figure_1.svg")
    results.close()
    for step in ("synthesis", "views"):
        Results(case, step).close()


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Return a project with two papers, computed, judged, on record, with pages."""
    root = tmp_path_factory.mktemp("made") / "project"
    for name, text in TOY.items():
        for paper in ("toy", "other"):
            path = root / name.replace("/toy/", f"/{paper}/")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    for paper in ("toy", "other"):
        write_design(root / "papers" / paper, "repaired", FoundDesign("one", "picked", {"K": np.eye(2)}, True, {}))
        case = read_case(root, paper)
        compute(case)
        verdicts(case)
        list(record_paper(case))
        case = read_case(root, paper)
        compare(case)
        page(case)
    assert report(["toy", "other", "--root", str(root)]) == 0
    return root


def damaged(root, draw):
    """Damage one file of the results of `toy`; returns it and what was done."""
    results = root / "results" / "toy"
    kinds = [sorted(results.glob(p)) for p in ("*.csv", "parts/*.csv", "scans/*", "certificates/*", "figures/*",
                                               "logs/*")]  # fmt: skip
    path = draw.choice(draw.choice([found for found in kinds if found]))
    structured = path.suffix == ".json" and draw.random() < 0.6
    damage = in_json if structured else draw.choice(draw.choice([BYTES, TEXTS, TEXTS, PLACES]))
    damage(path, draw)
    return f"{path.relative_to(root)} after {damage.__name__}"


def sound(root, made, what):
    """Run every step and command that reads results back; none may break, the other paper must come out the same."""
    other = read_case(root, "other")
    before = {name: read_records(other.results / f"{name}.csv") for name in ("verdicts", "published", "differences")}
    outcomes = Counter()
    case = read_case(root, "toy")
    typed = (
        lambda c: [explain(c, claim) for claim in c.claims],
        lambda c: list(between(root / "results", made / "results")),
        read_results,
        lambda c: render_paper(read_results(c)),
        verdicts,
        compare,
        page,
        lambda c: list(record_paper(c)),
    )
    for step in typed:
        try:
            step(case)
            outcomes["read"] += 1
        except InputError as error:
            outcomes["refused"] += 1
            assert len(str(error)) <= 300, what
            assert str(error).isprintable(), what
        except (ComputationError, OSError):  # a number is missing, or a folder stands where a table is to be written
            outcomes["refused"] += 1
        except Exception as error:  # whatever is no refusal is what this looks for: it fails with the damage named
            pytest.fail(f"{what}: {type(error).__name__}: {error}"[:2000])
    _, line = status(root, ["toy", "other"])
    assert line == status(root, ["other"])[0], what
    found = check([read_case(root, "toy"), other])
    assert all(len(row) == 6 and all(isinstance(cell, str) for cell in row) for row in found), what
    assert [row for row in found if row[0] == "other"] == check([other]), what
    assert report(["toy", "other", "--root", str(root)]) == 0, what
    for name, rows in before.items():
        assert read_records(other.results / f"{name}.csv") == rows, what
        joined = read_records(root / "results" / f"{name}.csv")
        assert [row for row in joined if row["paper"] == "other"] == [{"paper": "other", **row} for row in rows], what
    assert "other" in (root / "results" / "index.html").read_text(), what
    return outcomes


def campaign(made, tmp_path, count, draw):
    outcomes = Counter()
    for number in range(count):
        root = tmp_path / "project"
        shutil.rmtree(root, ignore_errors=True)
        shutil.copytree(made, root, symlinks=True)
        outcomes += sound(root, made, f"{number}: {damaged(root, draw)}")
    return outcomes


def test_some_damaged_results_break_no_command_and_no_other_paper(made, tmp_path, capsys):
    outcomes = campaign(made, tmp_path, TRIED[0]["fast"], random.Random(SEED))
    assert outcomes["read"] > 5


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(4))
def test_damaged_results_break_no_command_and_no_other_paper(made, tmp_path, batch, capsys):
    outcomes = campaign(made, tmp_path, COUNT // 4, random.Random(f"{SEED} {batch}"))
    with capsys.disabled():
        print(f"damaged results, batch {batch}: {dict(outcomes)}")
    assert outcomes["refused"] > 4
    assert outcomes["read"] > 10


@pytest.mark.parametrize("data", [b"<svg wid\xf4h='10pt'></svg>", b"\xff\xfe<\0s\0", b"\0", b""])
def test_a_damaged_picture_costs_no_page_and_is_said(made, tmp_path, data):
    root = tmp_path / "project"
    shutil.copytree(made, root, symlinks=True)
    (root / "results/toy/figures/figure_1.svg").write_bytes(data)
    case = read_case(root, "toy")
    assert "<h1" in render_paper(read_results(case))
    assert [row for row in check([case]) if "figure_1.svg" in row[2]]


def test_whole_results_are_clean(made, tmp_path):
    """The campaign begins with nothing to complain about, but for what a toy lacks: proofs and views."""
    whats = {what for _, what, *_ in check([read_case(made, "toy")])}
    assert whats <= {"file", "verdict", "certificate"}
    assert read_results(read_case(made, "toy")).missing == []


NUMBERS = ["1_5", "１５", "", "x", "1e1_0", "0x1F", " 1.5", "9" * 5000]


@pytest.mark.parametrize("text", NUMBERS)
@pytest.mark.parametrize(("table", "column"), [("quantities", "value"), ("poles", "radius"), ("gains", "published")])
def test_numbers_read_back_are_numbers_as_they_were_written(made, tmp_path, table, column, text):
    path = tmp_path / f"{table}.csv"
    rows = read_records(made / "results" / "toy" / f"{table}.csv")
    lines = [",".join(rows[0]), *(",".join(text if key == column else "1" for key in row) for row in rows[:1])]
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=rf"{table}\.csv:2: {column}"):
        read_returned(path, tmp_path)


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("toy/verdicts.csv", ",reproduced,", ",uncheckable,"),
        ("toy/published.csv", "reproduced", "contradicted"),
        ("toy/quantities.csv", "half", "third"),
        ("toy/gains.csv", "1.50", "1.51"),
        ("toy/differences.csv", "toy,", "other,"),
        ("published.csv", "reproduced", "contradicted"),
        ("verdicts.csv", ",reproduced,", ",uncheckable,"),
    ],
)
def test_a_table_altered_together_with_its_list_does_not_follow_from_the_results(made, tmp_path, file, old, new):
    root = tmp_path / "project"
    shutil.copytree(made, root)
    path = root / "results" / file
    before, text = sha256(path), path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    lists = [f"toy/parts/{step}.files.csv" for step in ("verdicts", "compare")]
    for listing in (root / "results" / name for name in [*lists, "report.files.csv"]):
        listing.write_text(listing.read_text().replace(before, sha256(path)))
    cases = [read_case(root, paper) for paper in ("toy", "other")]
    found = {(row[0], row[2]) for row in [*check(cases), *shared_differences(cases)] if row[4] == "does not follow"}
    assert ("toy" if "toy/" in file else "all papers", path.name) in found


def test_a_row_twice_is_refused(made, tmp_path):
    path = tmp_path / "quantities.csv"
    text = (made / "results" / "toy" / "quantities.csv").read_text()
    path.write_text(text + text.splitlines()[1] + "\n")
    with pytest.raises(InputError, match=r"quantities\.csv:\d+: quantity 'audit.length': expected a name"):
        read_returned(path, tmp_path)


@pytest.mark.parametrize("place", ["../../papers/toy/claims.csv", "/etc/hostname", "a/../../b", ""])
def test_a_step_removes_nothing_outside_its_results(made, tmp_path, place):
    """Its earlier list of files may say anything; what it names is removed when the step begins again."""
    root = tmp_path / "project"
    shutil.copytree(made, root)
    case = read_case(root, "toy")
    listing = case.results / "parts" / "audit.files.csv"
    lines = listing.read_text().splitlines()
    listing.write_text("\n".join([*lines, f"{place},0,,1"]) + "\n")
    Results(case, "audit")
    assert (root / "papers/toy/claims.csv").is_file()
    assert not listing.exists()


def test_one_damaged_scan_or_table_costs_itself_alone(made, tmp_path):
    root = tmp_path / "project"
    shutil.copytree(made, root)
    results = root / "results" / "toy"
    (results / "scans" / "audit.other.json").write_text("{}")
    (results / "gains.csv").write_text("gain\nK")
    found = read_results(read_case(root, "toy"))
    assert [line.partition(":")[0] for line in found.missing] == [
        "gains.csv is damaged, the gains are not compared yet", "scans/audit.other.json is damaged",
    ]  # fmt: skip
    assert len(found.verdicts) == 6
    assert "scans/audit.other.json is damaged" in render_paper(found)


def test_check_and_record_go_on_past_a_damaged_paper(made, tmp_path, capsys):
    root = tmp_path / "project"
    shutil.copytree(made, root)
    (root / "results" / "toy" / "quantities.csv").write_text("quantity,value\n")
    found = check([read_case(root, paper) for paper in ("toy", "other")])
    (row,) = [row for row in found if row[4] == "damaged"]
    assert row[:5] == ("toy", "file", "quantities.csv", "as the step left it", "damaged")
    assert row[5].startswith("results/toy/quantities.csv:1: header 'quantity,value'")
    assert [row for row in found if row[0] == "other"] == check([read_case(made, "other")])
    assert main(["--root", str(root), "check"]) == 1
    assert capsys.readouterr().err == ""
    assert main(["--root", str(root), "record"]) == 1
    said = capsys.readouterr()
    assert "toy  results/toy/quantities.csv:1: header 'quantity,value'" in said.out
    assert "other  4 quantities on record, 0 changes" in said.out
