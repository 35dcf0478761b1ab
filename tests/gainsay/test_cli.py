import re
import shutil
import subprocess
import sys

import pytest

from gainsay import cli
from gainsay.cli import LONGEST, MOST_LINES
from gainsay.results import Results
from gainsay.steps.command import step_command
from gainsay.steps.modules import paper_module
from gainsay.tables import read_case

COMMANDS = [
    "new",
    "explain",
    "status",
    "diff",
    "lint",
    "check",
    "record",
    "campaigns",
    "docs",
    "prove",
    "logs",
    "view",
    "gallery",
    "replay",
]


def command(project, *arguments):
    return cli.main(["--root", str(project.root), *arguments])


def test_lint_says_what_it_read(project, capsys):
    assert command(project, "lint") == 0
    assert capsys.readouterr().out.startswith("toy  tables     6 parameters, 6 claims, 1 errata, 1 not checked")


def test_bad_input_is_one_line_on_standard_error_and_exit_code_2(project, capsys):
    project.edit("parameters.csv", "2.0,kg", "2.0,lb")
    assert command(project, "lint") == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert said.err.startswith("bad input: papers/toy/parameters.csv:2: unit 'lb': expected a known unit")


def test_unknown_papers_and_a_missing_project(project, tmp_path, capsys):
    assert command(project, "lint", "none") == 2
    assert capsys.readouterr().err == "bad input: unknown paper 'none': expected one of toy\n"
    assert cli.main(["--root", str(tmp_path), "lint"]) == 2
    assert "not inside a project" in capsys.readouterr().err


def test_check_before_any_results_is_bad_input(project, capsys):
    assert command(project, "check") == 2
    assert "results/toy: nothing computed yet: expected a run of `snakemake" in capsys.readouterr().err


def test_check_names_every_difference_and_exits_with_1(project, capsys):
    from gainsay.steps.verdicts import verdicts

    case = project.case()
    for step in ("synthesis", "audit", "simulation"):
        Results(case, step).close()
    verdicts(case)
    capsys.readouterr()
    assert command(project, "check") == 1
    said = capsys.readouterr().out
    assert "toy  verdict length: expected reproduced, found failed" in said
    assert "toy  file logs/nominal.mcap: expected present, found missing" in said
    assert "report.files.csv" in said  # what all papers share is asked for
    assert not (project.root / "results" / "differences.csv").exists()  # the last word writes nothing
    assert command(project, "check", "toy") == 1
    assert "report.files.csv" not in capsys.readouterr().out  # of a paper by its name, it is not


def test_check_in_brief_names_a_few_and_counts_the_rest(project, capsys):
    case = project.case()
    from gainsay.steps.verdicts import verdicts

    for step in ("synthesis", "audit", "simulation"):
        Results(case, step).close()
    verdicts(case)
    capsys.readouterr()
    assert command(project, "check") == command(project, "check", "--brief") == 1
    lines = capsys.readouterr().out.splitlines()
    whole = next(i for i, line in enumerate(lines) if "differ from the record" in line) + 1
    brief = lines[whole:]
    named = [line for line in brief if ": expected " in line]
    assert len(named) == MOST_LINES < whole
    assert re.fullmatch(r"and \d+ more, which `gainsay check` names", brief[brief.index(named[-1]) + 1])
    assert all(len(line) <= LONGEST for line in named)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_explains_itself_and_its_exit_codes(name, capsys):
    with pytest.raises(SystemExit) as caught:
        cli.main([name, "--help"])
    assert caught.value.code == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "exit codes: 0 clean, 1 differences, 2 bad input" in said


def test_help_lists_every_command(capsys):
    with pytest.raises(SystemExit):
        cli.main(["--help"])
    said = capsys.readouterr().out
    assert all(f"    {name} " in said for name in COMMANDS)


@pytest.mark.parametrize("arguments", [[], ["--solve"], ["lint", "--fast"], ["prove"]])
def test_wrong_usage_has_the_exit_code_of_bad_input(arguments, capsys):
    with pytest.raises(SystemExit) as caught:
        cli.main(arguments)
    assert caught.value.code == 2


def test_a_certificate_that_proves_nothing_is_refused_with_1(project, tmp_path, capsys):
    path = tmp_path / "none.json"
    path.write_text("{}")
    assert command(project, "prove", str(path)) == 1
    assert "REFUSED" in capsys.readouterr().out


def test_a_step_reads_the_tables_before_it_works(project, capsys):
    worked = []
    root = ["--root", str(project.root)]
    assert step_command(worked.append, "about", ["toy", *root]) == 0
    assert worked[0].name == "toy"
    project.edit("claims.csv", "equal,audit.length", "equal,audit.width")
    assert step_command(worked.append, "about", ["toy", *root]) == 2
    assert step_command(worked.append, "about", ["none", *root]) == 2
    assert len(worked) == 1
    assert capsys.readouterr().err.count("\n") == 2


def test_modules_of_a_paper_come_from_the_project_of_its_tables(project):
    (project.root / "papers" / "__init__.py").write_text("")
    project.file("__init__.py").write_text("")
    project.file("audit.py").write_text(
        "from gainsay.results import task\n\n"
        "@task('(1)')\ndef one(case, results):\n    results.quantity('audit.length', 1.5, method='m')\n\n"
        "TASKS = (one,)\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "gainsay.steps.audit", "toy", "--root", str(project.root)],
        capture_output=True, text=True, cwd=project.root.parent, timeout=60, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert "audit.length,1.5,m" in (project.root / "results/toy/parts/audit.quantities.csv").read_text()


def test_two_projects_in_one_process_keep_their_own_papers(project, tmp_path):
    cases = []
    for name in ("one", "two"):
        root = tmp_path / name
        shutil.copytree(project.root, root)
        (root / "papers" / "__init__.py").write_text("")
        (root / "papers/toy/__init__.py").write_text("")
        (root / "papers/toy/audit.py").write_text(f"TASKS = ('{name}',)\n")
        cases.append(read_case(root, "toy"))
    assert [paper_module(case, "audit").TASKS for case in (*cases, cases[0])] == [("one",), ("two",), ("one",)]


@pytest.mark.parametrize("command", ["lint", "check", "record", "status", "export"])
@pytest.mark.parametrize("name", ["\x1b[31mred", "a\nb", "\ud800", "\u202e", "x" * 5000])
def test_no_command_says_a_name_as_a_terminal_would_obey_it(project, capsys, command, name):
    more = ["new", name, "--responsible", "A", "--license", "MIT"] if command == "export" else [name]
    assert cli.main(["--root", str(project.root), command, *more]) in (1, 2)
    said = capsys.readouterr()
    lines = (said.out + said.err).splitlines()
    assert all(line.isprintable() and len(line) <= 320 for line in lines)
    assert len(lines) == 1
