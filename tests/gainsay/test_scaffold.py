import csv
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from gainsay import cli
from gainsay.errors import InputError
from gainsay.scaffold import new
from gainsay.steps.audit import audit
from gainsay.tables import read_case
from gainsay.tables.models import TABLES, columns

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def root(tmp_path):
    """A new project with the worked example."""
    assert cli.main(["new", "--project", str(tmp_path / "own"), "toy2001"]) == 0
    return tmp_path / "own"


def test_a_new_project_is_well_formed(root, capsys):
    assert cli.main(["--root", str(root), "lint"]) == 0
    case = read_case(root, "toy2001")
    assert {claim.kind for claim in case.claims.values()} >= {"parameter", "stability", "feasibility", "trajectory"}
    assert not list((root / "papers").glob(".new-*"))


def test_every_table_of_a_new_paper_has_the_columns_of_its_model(root):
    for table in ("parameters.csv", "quantities.csv", "claims.csv", "errata.csv", "not_checked.csv"):
        with (root / "papers/toy2001" / table).open(newline="") as file:
            assert tuple(next(csv.reader(file))) == columns(TABLES[table])


def test_a_second_paper_stands_beside_the_first(root):
    assert cli.main(["--root", str(root), "new", "second"]) == 0
    for module in (root / "papers/second").glob("*.py"):
        assert "example." not in module.read_text()
    assert cli.main(["--root", str(root), "lint"]) == 0


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["new", "toy2001"], "nothing of this name"),
        (["new", "Toy"], "lower-case"),
        (["new", "all"], "not a target"),
        (["new", "--project", ".", "third"], "an empty folder"),
    ],
)
def test_nothing_is_overwritten(root, arguments, reason, capsys, monkeypatch):
    monkeypatch.chdir(root)
    before = sorted(root.rglob("*"))
    assert cli.main(arguments) == 2
    assert reason in capsys.readouterr().err
    assert sorted(root.rglob("*")) == before


def test_a_new_paper_passes_the_style_of_this_project(root):
    settings = ["--config", str(ROOT / "pyproject.toml"), "--no-cache"]
    for command in (["check", *settings], ["format", "--check", *settings]):
        done = subprocess.run(
            [str(Path(sys.executable).parent / "ruff"), *command, str(root / "papers/toy2001")],
            capture_output=True, text=True, check=False, timeout=60,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout


def test_the_audit_of_the_example_finds_what_a_hand_finds(root):
    """Poles: 2 s^2 + 2 s + 0.48 = 2 (s + 0.4) (s + 0.6)."""
    audit(read_case(root, "toy2001"))
    with (root / "results/toy2001/parts/audit.quantities.csv").open(newline="") as file:
        rows = {row["quantity"]: row for row in csv.DictReader(file)}
    assert float(rows["audit.abscissa"]["lower"]) <= -0.4 <= float(rows["audit.abscissa"]["upper"])
    assert rows["audit.identity"]["value"] == "1.0"


def test_the_examples_of_the_docs_are_well_formed(root):
    shutil.copytree(ROOT / "docs/examples", root / "papers", dirs_exist_ok=True)
    assert cli.main(["--root", str(root), "lint"]) == 0
    examples = [path.name for path in (ROOT / "docs/examples").iterdir()]
    assert len(examples) == 3
    assert not [name for name in examples if read_case(root, name).paper.draft]


SEARCHES = '''"""A design by hand."""

import numpy as np

from gainsay.tables.designs import FoundDesign

SEARCHES = {
    "robust": lambda case: FoundDesign(
        asked="a gain", method="by hand", converged=True, outcome={}, matrices={"K": np.array([[0.5, 2.25]])}
    )
}
'''


def test_a_search_writes_the_design_that_a_run_reads(root, capsys):
    paper = root / "papers/toy2001"
    (paper / "paper.toml").write_text(
        (paper / "paper.toml").read_text().replace("[designs]", '[designs]\nrobust = "a gain by hand"')
    )
    (paper / "searches.py").write_text(SEARCHES)
    assert cli.main(["--root", str(root), "search", "toy2001", "robst"]) == 2
    assert "'robust'?" in capsys.readouterr().err
    assert not (paper / "designs/robust.json").exists()
    assert cli.main(["--root", str(root), "search", "toy2001", "robust"]) == 0
    assert read_case(root, "toy2001").designs["robust"]["K"].tolist() == [[0.5, 2.25]]


def test_an_unknown_command_is_answered_with_the_nearest(root, capsys):
    assert cli.main(["chek"]) == 2
    assert "bad input: unknown command 'chek': expected 'check'? It is one of lint, check," in capsys.readouterr().err


@pytest.mark.parametrize("table", ["claims", "designs"])
def test_an_unknown_row_is_named_with_what_there_is(root, table):
    rows = getattr(read_case(root, "toy2001"), table)
    with pytest.raises(
        InputError, match=f"{table.removesuffix('s')} 'torqe': expected .*{'torque' if rows else 'none'}"
    ):
        rows["torqe"]
    assert rows.get("torqe") is None


def test_a_new_project_that_fails_leaves_nothing(tmp_path, monkeypatch):
    def full(root, name):
        raise InputError("new paper", expected="room on the disk")

    monkeypatch.setattr(new, "new_paper", full)
    with pytest.raises(InputError, match="room on the disk"):
        new.new_project(tmp_path / "own", "toy2001")
    assert not list(tmp_path.iterdir())
