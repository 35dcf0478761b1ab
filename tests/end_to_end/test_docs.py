"""What the documentation tells a reader to type works, and its tables leave nothing out."""

import argparse
import csv
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest

from gainsay.cli import _parser, main
from gainsay.steps.reference import COMPARATORS, KINDS
from gainsay.tables.models import Comparator, Kind

ROOT = Path(__file__).resolve().parents[2]
GUIDE = ROOT / "docs" / "adding-a-paper.md"
CAPTIONS = ROOT / "workflow/gainsay/rules/captions"
SCAFFOLD = ROOT / "workflow/gainsay/scaffold/project"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("docs/*.md")), SCAFFOLD / "README.md"]
#: what names a command and is none: a placeholder of a page, or the program in general
ANY = re.compile(r"STEP|\.\.\.")


def typed(page: Path) -> list[str]:
    """Lines of blocks of code that begin with a command, without the description after two blanks; commands in text."""
    text = page.read_text()
    lines = [line.strip().removeprefix("- run: ").removeprefix("run: ") for line in text.splitlines()]
    found = [re.split(r"\s{2,}|\s#", line)[0] for line in lines if line.startswith(("gainsay ", "make "))]
    return found + [inline for inline in re.findall(r"`(gainsay \w[^`]* [^`]+)`", text) if not ANY.search(inline)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_command_of_a_page_is_one(page):
    targets = re.search(r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)[1].split()
    for line in typed(page):
        name, *arguments = shlex.split(line.replace("[", "").replace("]", ""))
        if name == "make":
            assert set(arguments) <= set(targets), line
        else:
            _parser().parse_args(arguments)  # ends with an error where it is none


def test_the_job_that_a_project_copies_runs_commands():
    assert len(typed(SCAFFOLD / "ci.yaml")) == 2
    for line in typed(SCAFFOLD / "ci.yaml"):
        _parser().parse_args(shlex.split(line)[1:])


def test_every_command_is_run_by_a_test():
    (commands,) = (a for a in _parser()._actions if isinstance(a, argparse._SubParsersAction))
    tests = "".join(path.read_text() for path in (ROOT / "tests").rglob("test_*.py") if path != Path(__file__))
    assert [name for name in commands.choices if f'"{name}"' not in tests] == []


def test_every_link_leads_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


EXCERPT = re.compile(r"<!-- excerpt of (\S+) -->\n```\w+\n(.*?)```", re.DOTALL)
EXCERPTS = [found.groups() for page in PAGES[:4] for found in EXCERPT.finditer(page.read_text())]


@pytest.mark.parametrize(("file", "lines"), EXCERPTS, ids=[file for file, _ in EXCERPTS])
def test_an_excerpt_is_what_the_file_says(file, lines):
    text = (ROOT / file).read_text()
    # a row of a table may be cut at its end
    assert (lines.rstrip("\n") if file.endswith(".csv") else lines) in text


def test_there_are_excerpts_of_a_theorem_a_paper_and_a_run():
    assert {Path(file).name for file, _ in EXCERPTS} >= {"statements.py", "claims.csv", "runs.py"}


def test_every_kind_and_comparator_is_explained():
    assert set(KINDS) == set(get_args(Kind))
    assert set(COMPARATORS) == set(get_args(Comparator))


def test_the_package_is_installed_by_its_file_for_another_has_its_name():
    """`--find-links` alone takes whatever the index holds under this name with a higher version."""
    (line,) = [line for line in GUIDE.read_text().splitlines() if "pip install" in line]
    assert '`pip install "$(ls wheels/gainsay-*.whl)[workflow,view]"`' in line
    (wanted,) = [line for line in (SCAFFOLD / "requirements.txt").read_text().splitlines() if not line.startswith("#")]
    assert wanted == "./wheels/gainsay-VERSION-py3-none-any.whl[workflow,view]"


@pytest.mark.slow
def test_the_guide_from_an_empty_folder(tmp_path):
    """Every block of the guide that a reader types, in order, ends without an error."""
    blocks = re.findall(r"```sh\n(.*?)```", GUIDE.read_text(), re.DOTALL)
    assert len(blocks) == 3
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    for block in blocks:
        done = subprocess.run(
            ["bash", "-e", "-c", block], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
            timeout=600,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        if "snakemake --cores 2\n" in block:  # says at once what it begins, and stays on a screen
            assert re.search(r"^\d+ steps to run;", done.stdout, re.MULTILINE)
            assert len((done.stdout + done.stderr).splitlines()) <= 60
    assert (tmp_path / "papers/smith1999/recorded.csv").is_file()


@pytest.mark.slow
def test_the_examples_are_clean_in_a_project_of_their_own(tmp_path):
    root = tmp_path / "own"
    assert main(["new", "--project", str(root), "toy2001"]) == 0
    shutil.rmtree(root / "papers/toy2001")
    shutil.copytree(ROOT / "docs/examples", root / "papers", dirs_exist_ok=True)
    done = subprocess.run(
        [str(Path(sys.executable).parent / "snakemake"), "--cores", "2"], cwd=root, capture_output=True, text=True,
        check=False, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    shown = subprocess.run(
        [str(Path(sys.executable).parent / "snakemake"), "--report", "report.html"], cwd=root, capture_output=True,
        text=True, check=False, timeout=120,
    )  # fmt: skip
    assert shown.returncode == 0, shown.stdout + shown.stderr
    page = (root / "report.html").read_text()
    captions = [path.read_text().split()[:4] for path in CAPTIONS.glob("*.rst")]
    assert len(captions) == 4
    for caption in captions:
        assert " ".join(caption) in page
    # the search finds the design on file again, but for the path of the solver
    before = json.loads((root / "papers/scherer1997/designs/mixed.json").read_text())["outcome"]["h2"]
    searched = subprocess.run(
        [sys.executable, "-m", "gainsay.cli", "search", "scherer1997"], cwd=root, capture_output=True, text=True,
        check=False, timeout=120,
    )  # fmt: skip
    assert searched.returncode == 0, searched.stdout + searched.stderr
    after = json.loads((root / "papers/scherer1997/designs/mixed.json").read_text())["outcome"]["h2"]
    assert float(after) == pytest.approx(float(before), rel=1e-3)
    found = {}
    for name in ("double_integrator", "scherer1997"):
        with (root / "results" / name / "quantities.csv").open(newline="") as file:
            found |= {row["quantity"]: float(row["value"]) for row in csv.DictReader(file)}
    # as python-control documents it; and as H2 norms and H-infinity norms, which the inequalities bound from above
    assert found["h2.least"] == pytest.approx(7.748350599360575, rel=1e-13)
    assert found["h2.least"] < found["audit.h2"] < 9 and found["hinf.least"] < found["audit.hinf"] < 23.6
    # closed forms, but for the digits of the printed gain: sqrt(2), root of the golden ratio, exp(-pi)
    assert found["riccati.p11"] == pytest.approx(math.sqrt(2), rel=1e-12)
    assert found["audit.peak"] == pytest.approx(math.sqrt((1 + math.sqrt(5)) / 2), abs=2e-4)
    assert found["run.undershoot"] == pytest.approx(math.exp(-math.pi), abs=1e-4)


@pytest.mark.slow
def test_the_rules_pass_snakemakes_lint_but_for_containers(tmp_path):
    root = tmp_path / "own"
    assert main(["new", "--project", str(root), "toy2001"]) == 0
    done = subprocess.run(
        [str(Path(sys.executable).parent / "snakemake"), "--workflow-profile", "none", "--lint"], cwd=root,
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    found = {line.strip() for line in (done.stdout + done.stderr).splitlines() if line.startswith("    * ")}
    assert found == {"* Specify a conda environment or container for each rule.:"}
