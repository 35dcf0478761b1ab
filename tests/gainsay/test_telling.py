"""What is told of results without computing: explain, status, diff, JUnit XML, annotations, nearest names."""

import shutil
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from gainsay import cli
from gainsay.errors import InputError
from gainsay.steps.audit import audit
from gainsay.steps.compare import compare
from gainsay.steps.figures import figures
from gainsay.steps.simulation import simulation
from gainsay.steps.synthesis import synthesis
from gainsay.steps.verdicts import verdicts
from gainsay.tables import read_case
from gainsay.tables.files import read_records

ROOT = Path(__file__).resolve().parents[2]
#: data of the example of the LMI Control Toolbox manual, typed here a second time
A = np.array([[-1.0, -2, 1], [3, 2, 1], [1, -2, -1]])
B = np.array([[1.0], [0], [1]])
Q = np.array([[1.0, -1, 0], [-1, -3, -12], [0, -12, -36]])


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    """The worked example, computed but for its views and page."""
    root = tmp_path_factory.mktemp("project") / "own"
    assert cli.main(["new", "--project", str(root), "toy2001"]) == 0
    case = read_case(root, "toy2001")
    for step in (synthesis, audit, simulation, figures, verdicts, compare):
        step(case)
    return root


@pytest.fixture
def root(computed, tmp_path):
    """A copy that a test may change."""
    shutil.copytree(computed, tmp_path / "own")
    return tmp_path / "own"


def test_every_step_of_the_example_and_of_the_tutorial_is_whole(root):
    """What the library changes in its calls has to be changed in what `gainsay new` writes and in the docs too."""
    shutil.copytree(ROOT / "docs/examples/double_integrator", root / "papers/double_integrator")
    case = read_case(root, "double_integrator")
    for step in (synthesis, audit, simulation, figures, verdicts, compare):
        step(case)
    # The manual of the LMI Control Toolbox prints Xopt to four decimals and -18.716695, asked for to 1e-5 relative.
    shutil.copytree(ROOT / "docs/examples/riccati_lmi", root / "papers/riccati_lmi")
    case = read_case(root, "riccati_lmi")
    for step in (synthesis, audit, simulation, figures, verdicts, compare):
        step(case)
    found = read_records(root / "results/riccati_lmi/quantities.csv")
    least = next(row for row in found if row["quantity"] == "lmi.trace")
    trace = -float(np.trace(solve_continuous_are(A, B, -Q, np.eye(1))))  # by another method
    assert float(least["lower"]) <= trace <= float(least["upper"])
    assert float(least["upper"]) - float(least["lower"]) < 1e-6
    assert {row["verdict"] for row in read_records(root / "results/riccati_lmi/verdicts.csv")} == {"reproduced"}
    for paper in ("toy2001", "double_integrator", "riccati_lmi"):
        assert (root / "results" / paper / "failures.csv").read_text().count("\n") == 1, paper
        rows = (root / "results" / paper / "differences.csv").read_text().splitlines()[1:]
        assert not [row for row in rows if ",verdict," in row or ",quantity," in row or ",certificate," in row], rows


def said(root, capsys, *arguments, code=0):
    capsys.readouterr()
    assert cli.main(["--root", str(root), *arguments]) == code
    return capsys.readouterr().out


def test_a_verdict_is_explained_down_to_the_command_that_checks_it(root, capsys, monkeypatch):
    text = said(root, capsys, "explain", "toy2001", "stable")
    assert "the closed loop decays faster than exp(-0.3 t) ((2))" in text
    assert "papers/toy2001/claims.csv:3" in text
    assert "papers/toy2001/quantities.csv:3" in text
    assert "reproduced (as on record)" in text
    (command,) = (line.split(maxsplit=2)[2] for line in text.splitlines() if line.startswith("  check it"))
    monkeypatch.chdir(root)
    assert cli.main(command.split()[1:]) == 0


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["explain", "toy2001", "stabel"], "expected 'stable'? It is one of abscissa, stable"),
        (["explain", "toy201", "stable"], "expected 'toy2001'?"),
        (["lint", "toy201"], "expected 'toy2001'?"),
        (["view", "toy2001", "nominl"], "expected 'nominal'?"),
    ],
)
def test_an_unknown_name_is_answered_with_the_nearest(root, capsys, arguments, reason):
    assert cli.main(["--root", str(root), *arguments]) == 2
    error = capsys.readouterr().err
    assert reason in error
    assert error.count("\n") == 1


def test_unknown_names_in_code_and_tables_too(root):
    case = read_case(root, "toy2001")
    with pytest.raises(InputError, match="there is 'decay'"):
        case.number("deccay")
    with pytest.raises(InputError, match=r"design 'robst': expected one of none"):
        case.designs["robst"]
    path = root / "papers/toy2001/claims.csv"
    path.write_text(path.read_text().replace("audit.torque_gain", "audit.torque_gian"))
    with pytest.raises(InputError, match=r"quantities.csv, such as audit\.torque_gain"):
        read_case(root, "toy2001")


def test_status_takes_a_line_a_paper(root, capsys):
    text = said(root, capsys, "status")
    assert text.count("\n") == 1
    assert "10 claims: 7 reproduced, 1 contradicted, 1 undetermined, 1 uncheckable; views has not run" in text


@pytest.mark.parametrize("table", ["verdicts", "quantities", "certificates", "failures"])
def test_results_of_another_version_are_refused_and_other_papers_told(root, computed, capsys, table):
    """A column that an earlier version did not write was a KeyError."""
    before = said(root, capsys, "status")
    shutil.copytree(root / "papers/toy2001", root / "papers/other")
    shutil.copytree(root / "results/toy2001", root / "results/other")
    path = root / f"results/toy2001/{table}.csv"
    header, rest = path.read_text().split("\n", 1)
    first, *others = header.split(",")
    path.write_text(",".join([f"old_{first}", *others]) + "\n" + rest)
    other, toy = said(root, capsys, "status").splitlines()
    assert other.split(maxsplit=1)[1] + "\n" == before.split(maxsplit=1)[1]
    for arguments in (["explain", "toy2001", "stable"], ["diff", str(root / "results"), str(computed / "results")]):
        code = cli.main(["--root", str(root), *arguments])
        error = capsys.readouterr().err
        assert (code, error.count("\n")) in ((0, 0), (1, 0), (2, 1))
        assert len(error) < 320
        if table == "verdicts":
            assert code == 2
            assert f"{table}.csv:1" in error
            assert f"results/toy2001/{table}.csv:1" in toy


def test_diff_names_what_differs_and_by_how_much(root, computed, capsys, monkeypatch):
    assert said(root, capsys, "diff", str(root / "results"), str(computed / "results")) == ""
    path = root / "results/toy2001/quantities.csv"
    path.write_text(path.read_text().replace("1.149545416973495", "2.29909083394699"))
    text = said(root, capsys, "diff", str(root / "results"), str(computed / "results"), code=1)
    assert text == (
        "toy2001  quantities audit.torque_gain: value 2.29909083394699 | 1.149545416973495 (5.0e-01 relative)\n"
    )
    monkeypatch.chdir(root.parent)  # outside any project
    assert cli.main(["diff", str(root), str(computed / "results")]) == 2


def test_differences_for_machines_have_file_and_line(root, capsys):
    path = root / "papers/toy2001/claims.csv"
    path.write_text(path.read_text().replace("undetermined", "reproduced"))
    text = said(root, capsys, "check", "--junit", str(root / "check.xml"), "--annotations", code=1)
    line = next(line for line in text.splitlines() if "verdict torque" in line and line.startswith("::error"))
    assert line.startswith("::error file=papers/toy2001/claims.csv,line=9,title=toy2001 verdict torque::")
    suite = ElementTree.parse(root / "check.xml").getroot()[0]
    failed = {test.get("name") for test in suite if len(test)}
    assert "torque" in failed
    assert "stable" in {test.get("name") for test in suite} - failed
    assert int(suite.get("tests")) == len(suite)
    assert int(suite.get("failures")) == len(failed)


def test_a_task_that_fails_says_where_and_where_its_traceback_is(root, capsys):
    path = root / "papers/toy2001/statements.py"
    path.write_text(path.read_text().replace("X", "Z", 1) + '\nraise ValueError("broken")\n')
    synthesis(read_case(root, "toy2001"))
    out = capsys.readouterr().out
    assert "FAILED: broken, at papers/toy2001/statements.py:" in out
    assert "traceback in results/toy2001/attempts/synthesis.json" in out
