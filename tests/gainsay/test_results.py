import json
import math
import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from gainsay.errors import CertificateError, ComputationError, InputError, LogError
from gainsay.proof.build import certificate
from gainsay.results import Results, run_tasks, task
from gainsay.results.listing import damage
from gainsay.results.returned import read_part
from gainsay.tables.contract import CONTRACT


class Paper:
    """Stands for a certificate: has an id and a text."""

    def __init__(self, name: str) -> None:
        self.id = name

    def to_json(self) -> str:
        return json.dumps({"id": self.id})


def files(case) -> set[str]:
    if not case.results.is_dir():
        return set()
    return {str(path.relative_to(case.results)) for path in case.results.rglob("*") if path.is_file()}


def rows(case, part) -> list[dict]:
    return read_part(case, part)


def test_a_quantity_keeps_every_bit_of_its_value_and_enclosure(project):
    case = project.case()
    results = Results(case, "audit")
    value = 0.1 + 0.2
    results.quantity("audit.length", value, method="sum", source="(1)", lower=math.nextafter(value, 0), upper=value)
    results.close()
    (row,) = rows(case, "quantities")
    assert float(row["value"]) == value
    assert float(row["lower"]) == math.nextafter(value, 0)
    assert (row["unit"], row["method"], row["source"]) == ("m", "sum", "(1)")


@pytest.mark.parametrize(
    ("quantity", "value", "bounds", "reason"),
    [
        ("audit.width", 1.0, {}, "not declared for the step audit"),
        ("run.peak", 1.0, {}, "not declared for the step audit"),
        ("audit.length", math.nan, {}, "not finite"),
        ("audit.length", math.inf, {}, "not finite"),
        ("audit.length", 1.0, {"upper": math.inf}, "not finite"),
        ("audit.length", 1.0, {"lower": 1.1}, "outside its own enclosure"),
        ("audit.length", 1.0, {"upper": 0.9}, "outside its own enclosure"),
    ],
)
def test_a_number_that_means_nothing_is_no_quantity(project, quantity, value, bounds, reason):
    results = Results(project.case(), "audit")
    with pytest.raises(ComputationError, match=reason):
        results.quantity(quantity, value, method="m", **bounds)
    results.close()
    assert rows(project.case(), "quantities") == []


def test_a_quantity_computed_twice_is_refused_and_the_first_stays(project):
    results = Results(project.case(), "audit")
    results.quantity("audit.length", 1.0, method="m")
    with pytest.raises(ComputationError, match="computed twice"):
        results.quantity("audit.length", 2.0, method="m")
    results.close()
    assert [row["value"] for row in rows(project.case(), "quantities")] == ["1.0"]


def test_a_task_that_breaks_leaves_a_record_and_the_others_run(project, capsys):
    @task("(1)")
    def first(case, results):
        results.quantity("audit.length", 1.0, method="m")

    @task("(2)")
    def broken(case, results):
        raise ComputationError("(2)", "no solver\ragreed\non it", attempts=[{"solver": "a", "gap": np.float64(0.1)}])

    @task("(3)")
    def last(case, results):
        results.quantity("audit.other", 2.0, method="m")

    case = project.case()
    run_tasks(Results(case, "audit"), (first, broken, last))
    assert {row["quantity"] for row in rows(case, "quantities")} == {"audit.length", "audit.other"}
    (failure,) = rows(case, "failures")
    assert failure == {"step": "audit", "where": "(2)", "task": "broken", "message": "(2): no solver agreed on it"}
    said = capsys.readouterr().out
    assert "toy  audit       (2)  FAILED, 1 attempts: (2): no solver agreed on it" in said
    (attempt,) = json.loads((case.results / "attempts" / "audit.json").read_text())
    assert attempt["attempts"] == [{"solver": "a", "gap": 0.1}]
    assert "broken" in attempt["traceback"]


@pytest.mark.parametrize(
    "error",
    [ValueError("x"), KeyError("x"), ZeroDivisionError(), MemoryError(), AssertionError("a,b\r\n\x00'\""),
     InputError("matrix shape", value=(2, 3), expected="(3, 2)"), LogError("broken", file="logs/nominal.mcap"),
     InputError("file not found", file="results/toy/designs/repaired.json")],
)  # fmt: skip
def test_whatever_breaks_inside_a_task_is_a_failure(project, error):
    results = Results(project.case(), "audit")
    with results.task("(1)", "name"):
        raise error
    results.close()
    (failure,) = rows(project.case(), "failures")
    assert failure["message"]
    assert "\n" not in failure["message"]


def test_messages_hold_no_absolute_path(project):
    case = project.case()
    results = Results(case, "audit")
    with results.task("(1)", "name"):
        raise LogError("missing", file=str(case.results / "logs" / "nominal.mcap"))
    results.close()
    assert rows(case, "failures")[0]["message"] == "results/toy/logs/nominal.mcap: missing"


def test_bad_input_inside_a_task_ends_the_step_and_nothing_is_written(project):
    @task("(1)")
    def first(case, results):
        results.certificate(Paper("first"))
        results.quantity("audit.length", 1.0, method="m")

    @task("(2)")
    def second(case, results):
        case.number("weight")

    case = project.case()
    with pytest.raises(InputError, match=r"parameters.csv.*weight"):
        run_tasks(Results(case, "audit"), (first, second))
    assert files(case) == set()


def test_an_interrupted_step_leaves_nothing_that_counts(project):
    case = project.case()
    results = Results(case, "audit")
    results.quantity("audit.length", 1.0, method="m")
    results.certificate(Paper("old"))
    results.close()
    results = Results(case, "audit")
    results.certificate(Paper("new"))
    with pytest.raises(KeyboardInterrupt), results.task("(1)", "name"):
        raise KeyboardInterrupt
    assert rows(case, "quantities") == []
    assert read_part(case, "files") == []


@pytest.mark.parametrize("listed", [True, False])
def test_files_of_an_earlier_run_go_before_the_next(project, listed):
    """Also where the list is gone: Snakemake deletes the outputs of a job before it begins."""
    case = project.case()
    results = Results(case, "audit")
    results.certificate(Paper("gone-tomorrow"))
    results.close()
    assert "certificates/gone-tomorrow.json" in files(case)
    if not listed:
        (case.results / "parts/audit.files.csv").unlink()
    results = Results(case, "audit")
    results.certificate(Paper("stays"))
    results.close()
    listed = [row["file"] for row in read_part(case, "files") if not row["file"].startswith("parts/")]
    assert listed == ["certificates/stays.json"]
    assert "certificates/gone-tomorrow.json" not in files(case)


def test_a_step_leaves_files_of_other_steps_alone(project):
    case = project.case()
    results = Results(case, "synthesis")
    results.certificate(Paper("kept"))
    results.close()
    Results(case, "audit").close()
    assert "certificates/kept.json" in files(case)


def test_a_refused_certificate_is_a_failure_and_is_not_written(project):
    def refuse(certificate):
        raise CertificateError("not positive definite")

    case = project.case()
    results = Results(case, "audit", verify=refuse)
    with results.task("(3)", "proof"):
        results.certificate(Paper("wrong"))
    results.close()
    assert "certificate refused: not positive definite" in rows(case, "failures")[0]["message"]
    assert not any(file.startswith("certificates") for file in files(case))


def test_the_same_file_twice_is_refused(project):
    results = Results(project.case(), "audit")
    results.certificate(Paper("same"))
    with pytest.raises(ComputationError, match="written twice"):
        results.certificate(Paper("same"))


def listed_damage(case, step="audit"):
    return list(damage(case.results / "parts" / f"{step}.files.csv", case.results))


def test_what_is_lost_emptied_or_altered_shows(project):
    case = project.case()
    results = Results(case, "audit")
    results.certificate(Paper("one"))
    for name in ("log.mcap", "log.rrd"):
        (case.results / name).write_text(name)
    results.list_file("log.mcap")
    results.list_file("log.rrd", of="log.mcap")
    results.quantity("audit.length", 1.0, method="m")
    results.close()
    assert listed_damage(case) == []
    (case.results / "log.rrd").write_text("altered, and not empty")
    assert listed_damage(case) == [("log.rrd", "altered")]
    (case.results / "log.rrd").write_text("")
    assert listed_damage(case) == [("log.rrd", "empty")]
    (case.results / "log.mcap").write_text("another run")  # what is made of it is then of another run too
    assert listed_damage(case) == [("log.mcap", "altered"), ("log.rrd", "empty")]
    (case.results / "log.rrd").write_text("x")
    assert listed_damage(case) == [("log.mcap", "altered"), ("log.rrd", "altered")]
    (case.results / "certificates" / "one.json").unlink()
    assert ("certificates/one.json", "missing") in listed_damage(case)
    quantities = case.results / "parts" / "audit.quantities.csv"
    quantities.write_text(quantities.read_text().replace("1.0", "2.0"))
    assert ("parts/audit.quantities.csv", "altered") in listed_damage(case)
    (case.results / "parts" / "audit.files.csv").write_text("file\nlog.mcap\n")
    assert listed_damage(case) == [("parts/audit.files.csv", "altered")]


def test_what_is_never_the_same_twice_leaves_the_list_the_same(project):
    """The list takes the digest of what a file is made of; the file's own stands among the attempts."""
    case, lists = project.case(), []
    case.results.mkdir(parents=True)
    for text in ("one", "other"):
        results = Results(case, "views")
        for name in ("log.mcap", "log.rrd"):
            (case.results / name).write_text("log" if name == "log.mcap" else text)
        results.list_file("log.rrd", of="log.mcap")
        results.close()
        assert listed_damage(case, "views") == []
        lists.append((case.results / "parts" / "views.files.csv").read_bytes())
    assert lists[0] == lists[1]
    (case.results / "attempts" / "views.derived.csv").unlink()
    assert listed_damage(case, "views") == [("log.rrd", "altered")]


def test_results_of_another_contract_are_damage(project):
    case = project.case()
    Results(case, "audit").close()
    listing = case.results / "parts" / "audit.files.csv"
    rows = listing.read_text().splitlines()
    assert {row.split(",")[3] for row in rows[1:]} == {CONTRACT}
    listing.write_text("\n".join(row.removesuffix(CONTRACT) + "0" if i else row for i, row in enumerate(rows)) + "\n")
    assert listed_damage(case) == [("parts/audit.files.csv", f"of another contract than {CONTRACT}")]


def test_temporary_files_of_a_killed_process_are_removed_and_those_of_living_ones_are_not(project):
    case = project.case()
    Results(case, "audit").close()
    dead = subprocess.Popen([sys.executable, "-c", "pass"])
    dead.wait()
    abandoned, living = (case.results / f".{pid}.abc.part" for pid in (dead.pid, os.getpid()))
    abandoned.write_text("half")
    living.write_text("half")
    Results(case, "synthesis")
    assert (abandoned.exists(), living.exists()) == (False, True)


def test_gains_stand_entry_by_entry_with_the_interval_of_their_digits(project):
    case = project.case()
    results = Results(case, "audit")
    results.gains("K", published=case.printed("K"), resynthesised=np.full((2, 2), 2.0),
                  identified=np.array([[True, False], [False, True]]))  # fmt: skip
    results.close()
    first = rows(case, "gains")[0]
    # 1.50 stands for 1.495 .. 1.505
    assert (first["published"], first["rounding_low"], first["rounding_high"]) == ("1.50", "1.495", "1.505")
    assert [row["identified"] for row in rows(case, "gains")] == ["1", "0", "0", "1"]
    assert [(row["row"], row["column"]) for row in rows(case, "gains")] == [
        ("1", "1"),
        ("1", "2"),
        ("2", "1"),
        ("2", "2"),
    ]


def test_a_note_that_json_does_not_know_does_not_stop_the_step(project):
    case = project.case()
    results = Results(case, "audit")
    content = {"matrix": np.eye(2), "flag": np.bool_(True), "count": np.int64(3), "thing": object}
    results.attempted("(1)", SimpleNamespace(attempts=(content,)))
    results.close()
    (kept,) = json.loads((case.results / "attempts" / "audit.json").read_text())
    assert kept["content"][0]["matrix"] == [[1, 0], [0, 1]]
    assert kept["content"][0]["flag"] is True


@pytest.mark.parametrize(
    ("fields", "value", "ends"),
    [
        ({"formula": "3/5 * 5"}, 3.0, (3.0, 3.0)),
        ({"formula": "3/5 * 5", "low": "2", "high": "4"}, 3.0, (3.0, 3.0)),
        ({"formula": "interval(1, 2)", "high": "4"}, 1.5, (1.0, 2.0)),
    ],
)
def test_a_number_proved_to_the_point_keeps_its_ends(project, fields, value, ends):
    """Values by hand: 3/5 of 5 is 3, and what lies between 1 and 2 is given as 1.5, whatever the level it is below."""
    case = project.case()
    results = Results(case, "audit")
    parts = {"id": "length", "statement": "s", "tables": case, "quantities": {"value": "audit.length"}}
    results.prove(certificate("enclosed", fields=fields, **parts))
    results.close()
    (row,) = rows(case, "quantities")
    found = [float(row[column]) for column in ("value", "lower", "upper")]
    assert found == pytest.approx([value, *ends], rel=1e-8)  # a ball of an interval is a little wider


def test_what_holds_has_no_ends(project):
    case = project.case()
    results = Results(case, "audit")
    parts = {"id": "holds", "statement": "s", "tables": case}
    results.prove(
        certificate("definite", fields={"constraint": "2 > 1"}, quantities={"definite": "audit.holds"}, **parts)
    )
    results.close()
    (row,) = rows(case, "quantities")
    assert (row["value"], row["lower"], row["upper"]) == ("1.0", "", "")
