"""The steps by hand on copies: a small paper quickly, wan2014 in the slow tests."""

import csv
import hashlib
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from gainsay.tables.designs import FoundDesign, write_design

ROOT = Path(__file__).resolve().parents[2]
STEPS = ("synthesis", "audit", "simulation", "figures", "views", "verdicts", "compare", "page", "report")

TOY_CODE = {
    "__init__.py": "",
    "synthesis.py": "TASKS = ()\n",
    "searches.py": """
import numpy as np

from gainsay.tables.designs import FoundDesign

SEARCHES = {"repaired": lambda case: FoundDesign(
    asked="one", method="picked", matrices={"K": np.eye(2)}, converged=True, outcome={}
)}
""",
    "audit.py": """
from gainsay.proof import build
from gainsay.results import task


@task("(1)")
def length(case, results):
    results.quantity("audit.length", 1.5, method="by hand")


@task("(2)")
def bound(case, results):
    results.certificate(build.certificate(
        "enclosed", id="half-mass", tables=case, statement="Half the mass.",
        fields={"formula": "number('mass') / 2", "high": "2"}, quantities={"value": "audit.other"},
    ))
    results.quantity("audit.other", case.number("mass") / 2, method="half")


@task("(3)")
def holds(case, results):
    results.certificate(build.certificate(
        "identity", id="square", tables=case, statement="A square.",
        unknowns={"s": {}}, fields={"left": "(s + 1)**2", "right": "s**2 + 2*s + 1"},
        quantities={"identity": "audit.holds"},
    ))
    results.quantity("audit.holds", 1, method="proof")


TASKS = (length, bound, holds)
""",
    "runs.py": """
import numpy as np

from gainsay.logs import Layout, Line, Measured, Plot, RunSpec, Tab


def simulate(case, designs, log):
    time = np.linspace(0.0, 5.0, 101)
    force = 39.0 * np.exp(-time) * designs["repaired"]["K"][0, 0]
    log.signal("/thrust", {"x": "N"}, time, force[:, None])
    log.extreme("peak", 0.0, float(force[0]), "N")


def measure(case, log):
    peak = log.extremes["peak"].value
    return {"run.peak": Measured(peak, "closed form", peak - 1e-9, peak + 1e-9)}


RUNS = (RunSpec("nominal", simulate, measure),)
LAYOUT = Layout("toy", (Tab("Thrust", Plot("Thrust [N]", (Line("/thrust", "x", "x", "axis_1"),))),))
""",
    "figures.py": """
from gainsay.figures import FigureSpec, curves, finish, panels


def draw(figure, logs, case):
    (panel,) = panels(figure, ["Thrust [N]"])
    curves(panel, logs["nominal"], "/thrust", ("x",), until=5.0)
    finish(figure, [panel])


FIGURES = (FigureSpec("figure_1", ("nominal",), draw),)
""",
}


def python(*arguments: str, cwd: Path) -> subprocess.CompletedProcess:
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.run(
        [sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=cwd, env=environment, timeout=300,
        check=False,
    )  # fmt: skip


def step(root: Path, name: str, paper: str = "toy") -> subprocess.CompletedProcess:
    return python(f"gainsay.steps.{name}", paper, "--root", str(root), cwd=root.parent)


def check(root: Path, paper: str = "toy") -> subprocess.CompletedProcess:
    return python("gainsay.cli", "--root", str(root), "check", paper, cwd=root.parent)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def digests(root: Path) -> dict[str, str]:
    """Return what must be identical from run to run: all but attempts/, provenance.json and the derived .rrd."""
    results = root / "results"
    return {
        str(path.relative_to(results)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(results.rglob("*"))
        if path.is_file()
        and path.suffix != ".rrd"
        and path.parent.name != "attempts"
        and path.name != "provenance.json"
    }


def add_code(project) -> None:
    (project.root / "papers" / "__init__.py").write_text("")
    for name, text in TOY_CODE.items():
        project.file(name).write_text(text)
    write_design(project.file(""), "repaired", FoundDesign("one", "picked", {"K": np.eye(2)}, True, {}))


def run_all(root: Path, steps=STEPS, paper: str = "toy") -> None:
    for name in steps:
        done = step(root, name, paper)
        assert (done.returncode, done.stderr) == (0, ""), f"{name}: {done.stderr}{done.stdout}"


@pytest.fixture
def toy(project):
    """Return the small project with modules of its own, nothing computed."""
    add_code(project)
    return project


# --- a whole chain --------------------------------------------------------------------------------------------------


def test_steps_one_after_another_give_verdicts_a_page_and_a_clean_check(toy):
    run_all(toy.root)
    verdicts = {row["claim"]: row["verdict"] for row in table(toy.root / "results/toy/verdicts.csv")}
    assert verdicts == {"length": "reproduced", "bound": "reproduced", "lmi": "reproduced", "peak": "reproduced",
                        "both": "reproduced", "talk": "uncheckable"}  # fmt: skip
    done = check(toy.root)
    assert done.returncode == 1  # quantities that nobody recorded yet
    assert {(row["what"], row["note"]) for row in table(toy.root / "results/differences.csv")} == {
        ("quantity", "not on record"), ("certificate", "not on record")
    }  # fmt: skip
    assert python("gainsay.cli", "--root", str(toy.root), "record", cwd=toy.root).returncode == 0
    run_all(toy.root, ("compare", "page", "report"))
    done = check(toy.root)
    assert (done.returncode, done.stderr) == (0, "")
    page = (toy.root / "results/index.html").read_text()
    assert "A toy" in page
    for path in (toy.root / "results").rglob("*"):
        if path.suffix in (".csv", ".html", ".svg", ".json") and path.parent.name != "attempts":
            assert str(toy.root) not in path.read_text(), f"{path.name} holds an absolute path"
    # again in the same place: the same bytes
    before = digests(toy.root)
    run_all(toy.root, tuple(name for name in STEPS if name != "views"))
    assert digests(toy.root) == before


def test_a_task_that_raises_costs_its_own_verdicts_only(toy):
    toy.edit("audit.py", 'results.quantity("audit.length", 1.5, method="by hand")', 'raise ValueError("broken")')
    toy.edit("runs.py", "time = np.linspace", "raise MemoryError('too big')\n    time = np.linspace")
    for name in STEPS:
        done = step(toy.root, name)
        assert (done.returncode, done.stderr) == (0, ""), name
        if name == "audit":
            assert "toy  audit       (1)  FAILED: broken" in done.stdout
    verdicts = {row["claim"]: row for row in table(toy.root / "results/toy/verdicts.csv")}
    assert {name: row["verdict"] for name, row in verdicts.items()} == {
        "length": "failed", "bound": "reproduced", "lmi": "reproduced", "peak": "failed", "both": "reproduced",
        "talk": "uncheckable",
    }  # fmt: skip
    assert "(1): broken" in verdicts["length"]["note"]
    assert (toy.root / "results/index.html").is_file()
    done = check(toy.root)
    assert done.returncode == 1
    found = {(row["what"], row["item"]) for row in table(toy.root / "results/differences.csv")}
    assert {("failure", "audit (1)"), ("failure", "simulation nominal"), ("failure", "figures figure_1"),
            ("failure", "views nominal"), ("verdict", "length"), ("verdict", "peak"),
            ("file", "logs/nominal.mcap"), ("file", "figures/figure_1.svg")} <= found  # fmt: skip


@pytest.mark.parametrize("module", ["synthesis", "audit", "runs", "figures"])
def test_a_module_that_does_not_import_is_a_failure_not_a_crash(toy, module):
    toy.file(f"{module}.py").write_text("import nothing_of_that_name\n")
    name = {"runs": "simulation"}.get(module, module)
    done = step(toy.root, name)
    assert (done.returncode, done.stderr) == (0, "")
    (failure,) = table(toy.root / f"results/toy/parts/{name}.failures.csv")
    assert "nothing_of_that_name" in failure["message"]


def test_a_log_cut_short_fails_the_figure_and_names_the_byte(toy):
    run_all(toy.root, ("synthesis", "simulation"))
    log = toy.root / "results/toy/logs/nominal.mcap"
    log.write_bytes(log.read_bytes()[:-100])
    done = step(toy.root, "figures")
    assert (done.returncode, done.stderr) == (0, "")
    (failure,) = table(toy.root / "results/toy/parts/figures.failures.csv")
    assert "byte" in failure["message"]
    assert not (toy.root / "results/toy/figures/figure_1.svg").exists()


def test_changed_data_after_the_proofs_are_caught_by_the_next_verdicts(toy):
    # An accepted certificate quotes the tables; with other tables it must not count any more.
    run_all(toy.root, ("synthesis", "audit", "simulation", "verdicts"))
    toy.edit("parameters.csv", "2.0,kg", "6.0,kg")
    assert step(toy.root, "verdicts").returncode == 0
    verdicts = {row["claim"]: row["verdict"] for row in table(toy.root / "results/toy/verdicts.csv")}
    assert (verdicts["bound"], verdicts["both"], verdicts["lmi"]) == ("failed", "failed", "reproduced")


def test_a_forged_certificate_is_no_evidence(toy):
    run_all(toy.root, ("audit",))
    path = toy.root / "results/toy/certificates/half-mass.json"
    path.write_text(path.read_text().replace('"2"', '"0.5"'))
    (toy.root / "results/toy/certificates/extra.json").write_text(path.read_text())
    assert step(toy.root, "verdicts").returncode == 0
    verdicts = {row["claim"]: row["verdict"] for row in table(toy.root / "results/toy/verdicts.csv")}
    assert verdicts["bound"] == "failed"
    rows = {row["certificate"]: row["accepted"] for row in table(toy.root / "results/toy/certificates.csv")}
    assert rows == {"half-mass": "0", "square": "1"}


# --- bad input ------------------------------------------------------------------------------------------------------

BAD_INPUT = [
    ("claims.csv", None, None, "papers/toy/claims.csv: file not found: expected a readable file"),
    ("parameters.csv", "mass,number", '"mass,number', "papers/toy/parameters.csv:"),
    ("parameters.csv", "2.0,kg", "2.0,stone", "papers/toy/parameters.csv:2: unit 'stone': expected a known unit"),
    ("parameters.csv", "2.0,kg", "2.0e,kg", "papers/toy/parameters.csv:2: value '2.0e': expected a decimal number"),
    ("printed/K.csv", "0.1,7", "0.1;7", "papers/toy/printed/K.csv:2: 1 cells: expected 2 cells"),
    ("printed/K.csv", "0.1,7", "0.1,7 ", "papers/toy/printed/K.csv:2: column 2 '7 ': expected a decimal number"),
    ("printed/K.csv", "0.1,7\n", "", "papers/toy/printed/K.csv: shape '1x2': expected 2x2"),
    ("claims.csv", "equal,audit.length", "equal,audit.width",
     "papers/toy/claims.csv:2: claim length: quantity 'audit.width': expected a quantity declared in quantities.csv"),
]  # fmt: skip


@pytest.mark.parametrize(("file", "old", "new", "message"), BAD_INPUT)
def test_bad_input_is_one_line_and_nothing_is_written(toy, file, old, new, message):
    if old is None:
        toy.file(file).unlink()
    else:
        toy.edit(file, old, new)
    done = step(toy.root, "audit")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith(f"bad input: {message}")
    assert not (toy.root / "results").exists()


def test_an_unknown_paper_is_bad_input_for_every_step(toy):
    for name in STEPS:
        done = step(toy.root, name, "none")
        assert (done.returncode, done.stdout) == (2, ""), name
        assert done.stderr == "bad input: unknown paper 'none': expected one of toy\n"
    assert not (toy.root / "results").exists()


def test_bad_input_found_inside_a_step_writes_nothing_either(toy):
    toy.edit("audit.py", 'results.quantity("audit.holds", 1, method="proof")', 'case.number("weight")')
    done = step(toy.root, "audit")
    assert done.returncode == 2
    assert done.stderr.startswith("bad input: papers/toy/parameters.csv: name 'weight': expected a number of this name")
    assert [path.name for path in (toy.root / "results").rglob("*") if path.is_file()] == [".steps"]  # a lock


def test_an_interrupted_step_leaves_no_half_file_and_nothing_that_counts(toy):
    run_all(toy.root, ("synthesis", "audit", "simulation"))
    toy.edit("runs.py", "time = np.linspace", "import time as clock\n    log.event(0.0, 'a', 'b')\n"
             "    print('ready', flush=True)\n    clock.sleep(60)\n    time = np.linspace")  # fmt: skip
    running = subprocess.Popen(
        [sys.executable, "-m", "gainsay.steps.simulation", "toy", "--root", str(toy.root)],
        stdout=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a shell's background jobs ignore it
    )
    assert running.stdout.readline() == b"ready\n"
    running.send_signal(signal.SIGINT)
    running.communicate(timeout=30)
    assert running.returncode != 0
    assert [path.name for path in (toy.root / "results/toy/logs").iterdir()] == []
    assert not (toy.root / "results/toy/parts/simulation.quantities.csv").exists()
    assert step(toy.root, "verdicts").returncode == 0
    verdicts = {row["claim"]: row["verdict"] for row in table(toy.root / "results/toy/verdicts.csv")}
    assert (verdicts["peak"], verdicts["length"]) == ("failed", "reproduced")


# --- Snakemake and wan2014 ------------------------------------------------------------------------------------------


def copied(folder: Path) -> Path:
    """Copy what a run of the whole workflow reads."""
    root = folder / "copy"
    ignore = shutil.ignore_patterns("__pycache__")
    for name in ("papers", "workflow"):
        shutil.copytree(ROOT / name, root / name, ignore=ignore)
    for name in ("Snakefile", "README.md"):
        shutil.copy(ROOT / name, root / name)
    return root


def snakemake(root: Path, *arguments: str) -> subprocess.CompletedProcess:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", "1", *arguments], capture_output=True, text=True, cwd=root,
        env={**os.environ, "PATH": path}, timeout=900, check=False,
    )  # fmt: skip


@pytest.mark.slow
def test_snakemake_runs_the_small_paper_and_then_has_nothing_to_do(toy):
    for name in ("workflow", "profiles", "Snakefile"):
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, toy.root / name)
    first = snakemake(toy.root)
    assert first.returncode != 0  # nothing is on record yet: the check says so, and all else is there
    assert (toy.root / "results/index.html").is_file()
    assert table(toy.root / "results/differences.csv")
    assert python("gainsay.cli", "record", cwd=toy.root).returncode == 0
    assert snakemake(toy.root).returncode == 0
    again = snakemake(toy.root)
    assert again.returncode == 0
    assert again.stdout == ""
    (toy.root / "results/toy/logs/nominal.mcap").write_bytes(b"")
    mended = snakemake(toy.root)
    assert mended.returncode == 0
    assert mended.stdout.startswith("toy: simulation runs again, logs/nominal.mcap empty\n")
    assert (toy.root / "results/toy/logs/nominal.mcap").stat().st_size
    assert "synthesis" not in mended.stdout
    toy.edit("audit.py", 'results.quantity("audit.length", 1.5, method="by hand")', 'raise ValueError("broken")')
    broken = snakemake(toy.root)
    assert broken.returncode == 1
    verdicts = {row["claim"]: row["verdict"] for row in table(toy.root / "results/toy/verdicts.csv")}
    assert (verdicts["length"], verdicts["lmi"]) == ("failed", "reproduced")
    assert (toy.root / "results/index.html").is_file()


@pytest.mark.slow
def test_a_run_killed_behind_the_verdicts_leaves_no_page_with_an_older_figure(toy):
    """The verdicts come out as before, so that nothing newer is seen by who goes by their list alone."""
    for name in ("workflow", "profiles", "Snakefile"):
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, toy.root / name)
    snakemake(toy.root)
    page = toy.root / "results/toy/index.html"
    before, verdicts = page.read_bytes(), (toy.root / "results/toy/parts/verdicts.files.csv").read_bytes()
    toy.edit("figures.py", "Thrust [N]", "Force [N]")
    snakemake(toy.root, "results/toy/parts/verdicts.files.csv")  # as far as a killed run would come
    assert (toy.root / "results/toy/parts/verdicts.files.csv").read_bytes() == verdicts
    assert page.read_bytes() == before
    snakemake(toy.root)
    assert page.read_bytes() != before


@pytest.mark.slow
def test_wan2014_twice_gives_the_same_bytes_and_a_verdict_on_every_claim(tmp_path):
    found = []
    for name in ("one", "two"):
        root = copied(tmp_path / name)
        run_all(root, tuple(s for s in STEPS if s != "views"), "wan2014")
        found.append(digests(root))
        rows = table(root / "results/wan2014/verdicts.csv")
        assert {row["claim"] for row in rows} == {row["claim"] for row in rows if row["verdict"]}
        assert {row["claim"] for row in rows} == {row["id"] for row in table(root / "papers/wan2014/claims.csv")}
    assert found[0] == found[1]
    assert {Path(name).suffix for name in found[0]} >= {".csv", ".mcap", ".svg", ".png", ".html"}
