"""What a step depends on: the closure of its imports against what a run really imported and opened."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from gainsay.steps.closure import COLUMNS, closure, sources, table_digest

ROOT = Path(__file__).resolve().parents[2]

WATCH = """
import json, runpy, sys
opened = []
sys.addaudithook(lambda event, given: opened.append(str(given[0])) if event == "open" else None)
step, paper, root = sys.argv[1:]
sys.argv = [step, paper, "--root", root]
try:
    runpy.run_module(f"gainsay.steps.{step}", run_name="__main__")
except SystemExit as ended:
    code = ended.code
files = [getattr(module, "__file__", None) for module in list(sys.modules.values())]
print("\\n" + json.dumps([code, [file for file in files if file], opened]))
"""


def watched(root: Path, step: str, paper: str) -> tuple[set[str], set[str]]:
    """Run a step and return the modules of the project that it imported, and the tables of the paper that it opened."""
    done = subprocess.run(
        [sys.executable, "-c", WATCH, step, paper, str(root)], capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}, cwd=root,
    )  # fmt: skip
    code, files, opened = json.loads(done.stdout.splitlines()[-1])
    assert code == 0, done.stderr
    modules = set()
    for file in files:
        if Path(file).is_relative_to(ROOT / "workflow" / "gainsay"):
            modules.add(file)  # the library stands outside the project
        if Path(file).is_relative_to(root / "papers"):
            modules.add(str(Path(file).relative_to(root)))
    folder = root / "papers" / paper
    tables = {str(Path(file).relative_to(folder)) for file in opened if Path(file).is_relative_to(folder)}
    return modules, {file for file in tables if not file.endswith((".py", ".pyc"))}


@pytest.fixture
def toy(project):
    (project.root / "papers" / "__init__.py").write_text("")
    project.file("__init__.py").write_text("")
    project.file("helper.py").write_text("LENGTH = 1.5\n")
    project.file("audit.py").write_text(
        "from gainsay.results import task\n\n\n"
        '@task("(1)")\ndef length(case, results):\n    from papers.toy.helper import LENGTH\n\n'
        '    results.quantity("audit.length", LENGTH, method="by hand")\n\n\nTASKS = (length,)\n'
    )
    project.file("other.py").write_text("import nothing\n")
    return project


def test_a_run_imports_nothing_that_its_closure_does_not_hold(toy):
    modules, _ = watched(toy.root, "audit", "toy")
    listed = set(sources(toy.root, "audit", "toy"))
    assert "papers/toy/helper.py" in modules  # imported inside a function
    assert str(ROOT / "workflow/gainsay/proof/checker.py") in modules
    assert modules <= listed
    assert "papers/toy/other.py" not in listed
    assert not {file for file in listed if "/gainsay/report/" in file or "/gainsay/figures/" in file}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("step", "paper"),
    [("synthesis", "wan2014"), ("audit", "zhang2013"), ("simulation", "pinheiro2013"), ("verdicts", "wan2014")],
)
def test_real_steps_import_nothing_that_their_closure_does_not_hold(tmp_path, step, paper):
    shutil.copytree(ROOT / "papers", tmp_path / "papers", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "Snakefile", tmp_path / "Snakefile")
    modules, _ = watched(tmp_path, step, paper)
    assert modules
    assert modules <= set(sources(tmp_path, step, paper))


def test_the_kinds_of_proof_are_in_the_closure_of_whoever_checks():
    kinds = {path.name for path in (ROOT / "workflow/gainsay/proof/kinds").glob("*.py")}
    found = {path.name for path in closure(ROOT, ["gainsay.steps.audit"]) if path.parent.name == "kinds"}
    assert found == kinds


def test_judging_is_no_part_of_computing():
    for paper in ("wan2014", "li2021", "zhang2013", "pinheiro2013"):
        for step in ("synthesis", "audit", "simulation", "figures", "views"):
            listed = sources(ROOT, step, paper)
            assert "workflow/gainsay/verdicts/judge.py" not in listed, (step, paper)
            assert "workflow/gainsay/steps/report.py" not in listed, (step, paper)
        assert f"papers/{paper}/audit.py" not in sources(ROOT, "synthesis", paper)
        assert f"papers/{paper}/figures.py" not in sources(ROOT, "audit", paper)
        assert "workflow/gainsay/verdicts/judge.py" in sources(ROOT, "verdicts", paper)


def test_a_module_that_cannot_be_parsed_is_an_input_by_itself(toy):
    toy.file("audit.py").write_text("from papers.toy.helper import LENGTH\n\ndef (:\n")
    listed = sources(toy.root, "audit", "toy")
    assert "papers/toy/audit.py" in listed and "papers/toy/helper.py" not in listed


def test_every_table_that_a_step_opens_is_an_input_or_changes_nothing(toy):
    # Reading validates all tables, so all are opened; what counts is what the results hang on.
    _, opened = watched(toy.root, "audit", "toy")
    hangs_on = {"printed/K.csv", *COLUMNS}
    for_readers = {"paper.toml", "errata.csv", "not_checked.csv", "recorded.csv"}
    assert opened <= hangs_on | for_readers | {"designs", "designs/repaired.json"}

    def left() -> dict[str, bytes]:
        folder = toy.root / "results" / "toy"
        files = (*folder.glob("parts/audit.*"), *folder.glob("certificates/*"))
        return {path.name: path.read_bytes() for path in files}

    before, digest = left(), table_digest(toy.root, "toy", "audit")
    assert before
    toy.edit("paper.toml", "a picture", "a plot")
    toy.edit("paper.toml", "a run", "a flight")
    toy.edit("paper.toml", '"Journal of Toys"', '"Toys"')
    toy.edit("parameters.csv", "mass,number,2.0,kg,(1)", "mass,number,2.0,kg,Table 1")
    toy.edit("parameters.csv", "near|far,left out", "near|far,not given")
    toy.edit("claims.csv", "it is at most 2 m", "it stays below 2 m")
    toy.edit("claims.csv", "it is 1.50 m,equal", "the length is 1.50 m,equal")
    toy.edit("quantities.csv", "another length", "a width")
    toy.edit("errata.csv", "none", "small")
    toy.edit("not_checked.csv", "a definition", "a name")
    toy.edit("recorded.csv", "1.5,m", "9.5,m")
    assert table_digest(toy.root, "toy", "audit") == digest
    watched(toy.root, "audit", "toy")
    assert left() == before


@pytest.mark.parametrize(
    ("step", "file", "old", "new"),
    [
        ("audit", "claims.csv", "audit.other,2,m", "audit.other,3,m"),
        ("audit", "claims.csv", "at_most,audit.other", "at_least,audit.other"),
        ("audit", "quantities.csv", "audit.other,m", "audit.other,km"),
        ("audit", "quantities.csv", "audit.holds,1,audit", "audit.holds,1,synthesis"),
        ("audit", "parameters.csv", "mass,number,2.0", "mass,number,2.1"),
        ("audit", "parameters.csv", "assumed,0..1", "assumed,0..2"),
        ("audit", "parameters.csv", "height,number,400,km", "height,number,400,m"),
        ("simulation", "paper.toml", "a run", "a flight"),
        ("simulation", "paper.toml", "nominal =", "blind ="),
        ("simulation", "paper.toml", "A toy", "A play"),
        ("figures", "paper.toml", "figure_1 =", "figure_2 ="),
        ("figures", "paper.toml", "Journal of Toys", "Toys"),
    ],
)
def test_what_computations_read_of_a_table_changes_its_digest(project, step, file, old, new):
    before = table_digest(project.root, "toy", step)
    project.edit(file, old, new)
    assert table_digest(project.root, "toy", step) != before


def test_what_a_level_requires_changes_the_digest_of_its_table(project):
    text = project.file("quantities.csv").read_text().splitlines()
    lines = [f"{line}," for line in text[1:]]
    project.file("quantities.csv").write_text("\n".join([f"{text[0]},requires", *lines]) + "\n")
    before = table_digest(project.root, "toy", "audit")
    project.file("quantities.csv").write_text("\n".join([f"{text[0]},requires", f"{lines[0]}radius=mass", *lines[1:]]))
    assert table_digest(project.root, "toy", "audit") != before


@pytest.mark.parametrize(
    "line",
    [
        "from .helper import LENGTH",
        "from . import helper",
        "from ..toy import helper",
        "from ..toy.helper import LENGTH",
    ],
)
def test_an_import_relative_to_its_package_is_one(toy, line):
    toy.file("audit.py").write_text(f"{line}\n")
    assert "papers/toy/helper.py" in sources(toy.root, "audit", "toy")
