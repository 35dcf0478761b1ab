"""Another machine is noticed: a number that moves with the environment is a difference, one that does not is none."""

import subprocess
import sys

import pytest

from gainsay.results import Results
from gainsay.steps.kernels import MACHINES, Machine, run_machine, shares
from gainsay.verdicts.record import record_paper

AUDIT = """
import os

from gainsay.results import task


@task("(1)")
def length(case, results):
    results.quantity("audit.length", 1.5 + float(os.environ.get("TOY_SHIFT", "0")), method="by hand")


TASKS = (length,)
"""


@pytest.fixture
def toy(project):
    """Return the toy paper with one quantity, which an environment variable moves."""
    folder = project.file("")
    claims = project.file("claims.csv").read_text().splitlines(keepends=True)
    project.file("claims.csv").write_text("".join(claims[:2]))
    project.file("quantities.csv").write_text("id,unit,step,meaning\naudit.length,m,audit,a length\n")
    project.edit("paper.toml", '[runs]\nnominal = "a run"\n', "[runs]\n")
    project.edit("paper.toml", '[designs]\nrepaired = "a design"\n', "")
    for name, text in {"__init__": "", "audit": AUDIT, "synthesis": "TASKS = ()\n", "runs": "RUNS = ()\n"}.items():
        (folder / f"{name}.py").write_text(text)
    (project.root / "papers" / "__init__.py").write_text("")
    return project


def run(toy, **variables):
    return run_machine(toy.root, Machine("test", variables), ["toy"])


def test_a_number_that_moves_with_the_machine_is_found(toy):
    broken, found, used = run(toy)
    assert (broken, found) == ([], [])
    assert used == [("toy", "audit.length", "rounding", 0.0, "test")]
    _, found, used = run(toy, TOY_SHIFT="1e-3")
    assert [row[2] for row in found] == ["audit.length"]
    # 1e-6 relative of 1.5 and 1e-12 are allowed
    _, found, used = run(toy, TOY_SHIFT="6e-7")
    assert found == [] and used[0][3] == pytest.approx(0.4, rel=1e-4)


def test_an_erratum_that_follows_from_an_edition_is_no_difference(toy):
    toy.follow_edition("(21) corrected: (2,2)")
    assert run(toy)[:2] == ([], [])


def test_a_step_that_breaks_is_said(toy):
    toy.edit("audit.py", "TASKS = (length,)", "TASKS = (length,)\nraise SystemExit(7)")
    broken, _, used = run(toy)
    assert broken == ["toy audit ended with 7: no message"] and used == []


def test_shares_need_a_record(toy):
    for step in ("synthesis", "audit", "simulation", "verdicts"):
        subprocess.run(
            [sys.executable, "-m", f"gainsay.steps.{step}", "toy", "--root", str(toy.root)], check=True, cwd=toy.root
        )
    toy.file("recorded.csv").unlink()
    assert list(shares(toy.case())) == []
    for step in ("figures", "views"):  # of which this toy has none
        Results(toy.case(), step).close()
    list(record_paper(toy.case()))
    assert list(shares(toy.case())) == [("audit.length", "rounding", 0.0)]


def test_every_kind_of_other_machine_is_tried_in_the_short_selection_too():
    for machines in (MACHINES, [machine for machine in MACHINES if machine.quick]):
        names = {name for machine in machines for name in machine.variables}
        assert {"OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES", "PYTHONHASHSEED"} <= names
        assert {machine.variables["OMP_NUM_THREADS"] for machine in machines} == {"1", "2"}
    assert {machine.variables["OPENBLAS_CORETYPE"] for machine in MACHINES} == {
        "Prescott",
        "Haswell",
        "Zen",
        "SkylakeX",
    }
