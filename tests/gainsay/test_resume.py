"""Going on: which steps count as not done, and who may write results."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from gainsay.errors import InputError
from gainsay.results.listing import damage, write_listing
from gainsay.results.returned import FAILURE_COLUMNS
from gainsay.steps import holding
from gainsay.steps.resume import AFTER, forget_damaged
from gainsay.tables.files import write_csv

STEPS = tuple(AFTER)


@pytest.fixture
def done(tmp_path):
    """Return a root whose results look as after a whole run of the paper `toy`."""
    results = tmp_path / "results" / "toy"
    (results / "parts").mkdir(parents=True)
    for step in STEPS:
        (results / f"{step}.txt").write_text(step)
        write_listing(results / "parts" / f"{step}.files.csv", results, {f"{step}.txt": ""})
    (tmp_path / "results" / "index.html").write_text("page")
    write_listing(tmp_path / "results" / "report.files.csv", tmp_path / "results", {"index.html": ""})
    (tmp_path / "results" / ".checked").touch()
    (results / ".checked").touch()
    return tmp_path


def standing(root: Path) -> set[str]:
    """Return the steps whose lists stand, and the marks of the checks."""
    found = {path.name.split(".")[0] for path in (root / "results" / "toy" / "parts").glob("*.files.csv")}
    marks = {"report": "report.files.csv", "all": ".checked", "toy": "toy/.checked"}
    return found | {name for name, file in marks.items() if (root / "results" / file).exists()}


WHOLE = {*STEPS, "report", "all", "toy"}


def test_a_whole_run_stands(done):
    assert forget_damaged(done, ["toy"]) == []
    assert standing(done) == WHOLE


def lose(path):
    path.unlink()


def empty(path):
    path.write_text("")


def alter(path):
    path.write_text("another")


@pytest.mark.parametrize(("harm", "how"), [(lose, "missing"), (empty, "empty"), (alter, "altered")])
@pytest.mark.parametrize(
    ("step", "kept"),
    [
        ("simulation", {"synthesis", "audit"}),
        ("audit", {"synthesis", "simulation", "views"}),
        ("verdicts", {"synthesis", "audit", "simulation", "figures", "views"}),
        ("page", {*STEPS} - {"page"}),
    ],
)
def test_a_damaged_step_and_all_that_follow_run_again(done, step, kept, harm, how):
    harm(done / "results" / "toy" / f"{step}.txt")
    assert forget_damaged(done, ["toy"]) == [f"toy: {step} runs again, {step}.txt {how}"]
    assert standing(done) == kept


def test_a_lost_list_makes_all_that_follows_run_again(done):
    lose(done / "results" / "toy" / "parts" / "views.files.csv")
    assert forget_damaged(done, ["toy"]) == []
    assert standing(done) == {"synthesis", "audit", "simulation", "figures"}


def test_a_damaged_page_over_all_papers_is_made_again(done):
    alter(done / "results" / "index.html")
    assert len(forget_damaged(done, ["toy"])) == 1
    assert standing(done) == WHOLE - {"report", "all"}


def test_a_run_of_some_papers_leaves_what_belongs_to_all(done):
    alter(done / "results" / "index.html")
    alter(done / "results" / "toy" / "page.txt")
    assert forget_damaged(done, ["toy"], whole=False) == ["toy: page runs again, page.txt altered"]
    assert standing(done) == WHOLE - {"page", "toy"}
    assert forget_damaged(done, [], whole=False) == []


def test_a_step_with_failures_is_not_done(done):
    row = ("audit", "(1)", "length", "no memory")
    write_csv(done / "results/toy/parts/audit.failures.csv", FAILURE_COLUMNS, [row])
    assert forget_damaged(done, ["toy"]) == ["toy: audit runs again, it had failures"]
    assert "audit" not in standing(done)


@pytest.mark.parametrize(
    "text", ["", "file\n", "file,sha256,of\n", "file,sha256,of\na\n", "file,sha256,of\n" + "x" * 5000 + ",0,\n"]
)
def test_a_malformed_list_is_damage_and_no_traceback(done, text):
    listing = done / "results/toy/parts/audit.files.csv"
    listing.write_text(text)
    assert list(damage(listing, done / "results/toy"))


HOLD = """
import sys, time
from pathlib import Path
from gainsay.steps.holding import {what}
{what}(Path(sys.argv[1]))
print("held", flush=True)
time.sleep(60)
"""


def holder(root: Path, what: str, **environment: str) -> subprocess.Popen:
    """Start a process that holds something and return it once it does."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD.format(what=what), str(root)], stdout=subprocess.PIPE, text=True,
        env={**os.environ, **environment},
    )  # fmt: skip
    assert process.stdout.readline() == "held\n"
    return process


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Return a root whose locks this process gives back after the test."""
    monkeypatch.setenv(holding.RUN, "")
    monkeypatch.delenv(holding.RUN)
    monkeypatch.setattr(holding, "_held", [])
    return tmp_path


def test_a_second_run_is_refused_with_the_process_and_a_killed_one_leaves_nothing_locked(here):
    first = holder(here, "hold_results")
    with pytest.raises(InputError, match=f"process {first.pid}"):
        holding.hold_results(here)
    first.kill()
    first.wait()
    holding.hold_results(here)
    assert os.environ[holding.RUN] == str(os.getpid())


def test_a_run_waits_for_a_step_of_a_killed_run(here):
    step = holder(here, "hold_as_step")
    second = subprocess.Popen(
        [sys.executable, "-c", HOLD.format(what="hold_results"), str(here)], stdout=subprocess.PIPE, text=True
    )
    assert "waiting" in second.stdout.readline()
    step.kill()
    step.wait()
    assert second.stdout.readline() == "held\n"
    second.kill()
    second.wait()


def test_a_late_step_of_a_killed_run_does_not_write_beside_the_next_run(here, monkeypatch):
    holding.hold_results(here)
    holding.hold_as_step(here)  # a step of this run
    monkeypatch.setenv(holding.RUN, "1")
    with pytest.raises(InputError, match="another is at work"):
        holding.hold_as_step(here)
