"""What a run is told: settings that there are none of are refused, as are papers."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from gainsay.cli import main

SNAKEMAKE = str(Path(sys.executable).parent / "snakemake")


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("project") / "own"
    assert main(["new", "--project", str(root), "toy2001"]) == 0
    return root


def planned(root, *arguments):
    """Plan a run and return its exit code and all that it said."""
    done = subprocess.run(
        [SNAKEMAKE, "--cores", "1", "--dry-run", *arguments], cwd=root, capture_output=True, text=True, check=False,
        timeout=120,
    )  # fmt: skip
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("paper=toy2001", "bad input: configuration 'paper': expected 'papers'? It is one of papers, numeric_threads"),
        ("papers=toy2002", "bad input: unknown paper 'toy2002': expected 'toy2001'?"),
        ("papers=../toy2001", "bad input: name of a paper '../toy2001'"),
        ("numeric_threads=many", "bad input: configuration numeric_threads 'many': expected 1 or more"),
    ],
)
def test_a_setting_that_is_none_is_refused_in_one_line(root, setting, said):
    code, text = planned(root, "--config", setting)
    assert code == 2
    assert said in text
    assert "Traceback" not in text


@pytest.mark.slow
def test_a_target_that_is_none_is_refused_in_one_line(root):
    (root / "Snakefile").write_text(
        (root / "Snakefile").read_text() + "\n\nrule own:\n    output:\n        touch('mine'),\n"
    )
    for target in ("toy2001", "toy2001_audit", "own", "mine", "campaigns", "results/index.html"):
        code, text = planned(root, target)
        assert code == 0, text
    code, text = planned(root, "toy201")
    assert code == 2
    assert "bad input: unknown target 'toy201': expected 'toy2001'? It is one of toy2001, campaigns" in text


@pytest.mark.slow
def test_bad_tables_of_a_paper_that_is_worked_on_are_refused_once(root):
    assert main(["--root", str(root), "new", "second"]) == 0
    table = root / "papers/second/parameters.csv"
    table.write_text(table.read_text().replace("2.00", "2..00"))
    for target in ((), ("second",), ("second_audit",)):
        code, text = planned(root, *target)
        said = [line for line in text.splitlines() if "bad input" in line]
        assert said == ["bad input: papers/second/parameters.csv:2: value '2..00': expected a decimal number such as "
                        "-8.8129e-4"]  # fmt: skip
        assert code == 2
    assert planned(root, "toy2001")[0] == 0  # what is not worked on is not looked at
    shutil.rmtree(root / "papers/second")


@pytest.mark.slow
@pytest.mark.parametrize(
    "papers", ["papers:\n", "papers: [toy2001]\n", "papers: toy2001, toy2001\n", "numeric_threads: 2\n"]
)
def test_papers_are_a_list_or_separated_by_commas_or_all(root, papers):
    (root / "config.yaml").write_text(papers)
    code, text = planned(root, "--workflow-profile", "none")
    assert code == 0, text
    assert "toy2001_audit" in text
