"""Replaying logs that anyone may have changed: each is held against what the simulation left, in one line."""

import json
import subprocess
import sys
import textwrap
from types import SimpleNamespace

import numpy as np
import pytest

from gainsay.cli import main
from gainsay.errors import LogError
from gainsay.logs import LogWriter, Measured, RunSpec, read_log
from gainsay.results.returned import QUANTITY_COLUMNS, read_part
from gainsay.steps.replay import replay
from gainsay.steps.simulation import provenance, simulation
from gainsay.tables.files import write_csv

#: what docs/robustness.md says of the large log
TRIED = [
    {
        "what": "samples in one log",
        "how": "simulated, read and replayed in one process",
        "fast": 0, "slow": 10_000_000, "night": 10_000_000,
        "promise": "within 300 MB of memory, with every import",
    }
]  # fmt: skip
TIME = np.linspace(0.0, 5.0, 101)


def simulate(case, designs, log, force=39.0, extreme=39.0):
    log.signal("/thrust", {"x": "N"}, TIME, force * np.exp(-TIME)[:, None])
    if extreme is not None:
        log.extreme("peak", 0.0, extreme, "N")


def measure(case, log):
    peak = log.extremes["peak"].value
    return {"run.peak": Measured(peak, "closed form", peak - 1e-9, peak + 1e-9)}


RUN = RunSpec("nominal", simulate, measure)


@pytest.fixture
def flown(project, monkeypatch):
    """Return the small project with its run simulated and its quantity on file."""
    module = SimpleNamespace(RUNS=(RUN,), FIGURES=())
    for step in ("replay", "simulation"):
        monkeypatch.setattr(f"gainsay.steps.{step}.paper_module", lambda case, name: module)
    case = project.case()
    simulation(case)
    rows = [[row[column] for column in QUANTITY_COLUMNS] for row in read_part(case, "quantities")]
    write_csv(case.results / "quantities.csv", QUANTITY_COLUMNS, rows)
    return case


def forged(case, path, *, table=None, about=None, **changes):
    """Write the run again with something changed."""
    parameters = table or (case.folder / "parameters.csv").read_bytes()
    origin = provenance(case, RUN) | (about or {})
    with LogWriter(path, provenance=origin, attachments={"parameters.csv": parameters}) as log:
        simulate(case, {}, log, **changes)
    return path


def differences(case, path):
    return replay(case.root, path, figures=False)[1]


def test_the_log_on_file_and_a_copy_replay_without_a_difference(flown, tmp_path):
    log = flown.results / "logs" / "nominal.mcap"
    assert differences(flown, log) == []
    (tmp_path / "copy.mcap").write_bytes(log.read_bytes())
    assert differences(flown, tmp_path / "copy.mcap") == []
    assert differences(flown, forged(flown, tmp_path / "again.mcap")) == []  # the same calls, the same bytes


def test_samples_forged_beside_their_old_extreme_are_named(flown, tmp_path):
    """The quantity rests on the located extreme alone and is as on file; the samples are not."""
    path = forged(flown, tmp_path / "forged.mcap", force=20.0)
    (line,) = differences(flown, path)
    assert line == "logs/nominal.mcap: differs from the log that the simulation left in /thrust"
    log = flown.results / "logs" / "nominal.mcap"
    forged(flown, log, force=20.0)
    assert differences(flown, log) == ["logs/nominal.mcap: the log is not the one that the simulation left"]


def test_an_extreme_changed_is_named_with_its_quantity(flown, tmp_path):
    found = differences(flown, forged(flown, tmp_path / "forged.mcap", extreme=40.0))
    assert found[0].endswith("in /events, /extremes")
    assert found[1] == "run.peak: value 40.0 from the log, 39.0 on file"


def test_a_table_attached_to_the_log_is_held_against_the_papers(flown, tmp_path, project):
    path = forged(flown, tmp_path / "forged.mcap", table=b"name\n")
    found = differences(flown, path)
    assert "parameters.csv: differs from papers/toy/parameters.csv" in found
    project.edit("parameters.csv", "2.0,kg", "2.5,kg")
    log = flown.results / "logs" / "nominal.mcap"
    assert differences(flown, log) == ["parameters.csv: differs from papers/toy/parameters.csv"]
    with LogWriter(path, provenance=provenance(flown, RUN)) as bare:
        simulate(flown, {}, bare)
    assert "parameters.csv: is not attached, unlike papers/toy/parameters.csv" in differences(flown, path)


def test_the_origin_of_a_log_is_held_against_the_tables(flown, tmp_path):
    found = differences(flown, forged(flown, tmp_path / "forged.mcap", about={"title": "Another"}))
    assert "title: 'Another' in the log, 'A toy' expected" in found


def test_a_log_that_lacks_what_is_measured_is_refused(flown, tmp_path):
    with pytest.raises(LogError, match=r"short\.mcap: no extreme 'peak': expected a log that has one"):
        differences(flown, forged(flown, tmp_path / "short.mcap", extreme=None))


@pytest.mark.parametrize("error", [KeyError("x"), ZeroDivisionError("by zero"), IndexError("out of\nbounds")])
def test_whatever_a_measure_stumbles_over_is_one_line(flown, monkeypatch, tmp_path, error):
    def stumble(case, log):
        raise error

    module = SimpleNamespace(RUNS=(RunSpec("nominal", simulate, stumble),), FIGURES=())
    monkeypatch.setattr("gainsay.steps.replay.paper_module", lambda case, name: module)
    with pytest.raises(LogError, match=rf"cannot be measured: {type(error).__name__}") as caught:
        differences(flown, flown.results / "logs" / "nominal.mcap")
    assert str(caught.value).isprintable()


def test_one_bad_log_hides_no_other(flown, tmp_path, capsys):
    good, bad = flown.results / "logs" / "nominal.mcap", tmp_path / "bad.mcap"
    bad.write_bytes(good.read_bytes()[:-40])
    assert main(["--root", str(flown.root), "replay", "--numbers-only", str(bad), str(good)]) == 2
    said = capsys.readouterr()
    assert said.out == "toy/nominal  samples, parameters and every quantity are as on file\n"
    assert said.err.startswith("bad input: bad.mcap: broken at byte")
    (flown.results / "logs" / "a.mcap").write_bytes(bad.read_bytes())
    assert main(["--root", str(flown.root), "logs"]) == 2
    said = capsys.readouterr()
    assert "toy\tnominal\t5\t3\t" in said.out
    assert said.err.startswith("bad input: toy  a.mcap: broken at byte")


LARGE = """
import json, sys, time
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from gainsay.logs import LogWriter, Measured, RunSpec, read_log
from gainsay.steps import replay, simulation
from gainsay.tables import read_case
from gainsay.tables.files import write_csv
from gainsay.results.returned import QUANTITY_COLUMNS, read_part

root, samples = Path(sys.argv[1]), int(sys.argv[2])


def simulate(case, designs, log):
    for start in range(0, samples, 100_000):
        time = 1e-3 * np.arange(start, min(start + 100_000, samples))
        log.signal("/thrust", {"x": "N", "y": "N"}, time, np.stack([np.sin(time), np.floor(time)], axis=1))


def measure(case, log):
    peak = float(log["/thrust"].column("x").max())
    return {"run.peak": Measured(peak, "largest sample")}


module = SimpleNamespace(RUNS=(RunSpec("nominal", simulate, measure),), FIGURES=())
simulation.paper_module = replay.paper_module = lambda case, name: module
case = read_case(root, "toy")
# of this program alone: ru_maxrss would count what started it
status = lambda: Path("/proc/self/status").read_text().splitlines()
most = lambda: next(int(line.split()[1]) for line in status() if line.startswith("VmHWM:")) // 1024
start = most()
simulation.simulation(case)
rows = [[row[column] for column in QUANTITY_COLUMNS] for row in read_part(case, "quantities")]
write_csv(case.results / "quantities.csv", QUANTITY_COLUMNS, rows)
done = most()
path = case.results / "logs" / "nominal.mcap"
log = read_log(path)
ends = [log["/thrust"].time[-1], log["/thrust"].column("y")[-1], log["/thrust"].count, log.duration]
read = most()
found = replay.replay(root, path, figures=False)[1]
print(json.dumps({"MB": [start, done, read, most()], "ends": [float(x) for x in ends], "found": found,
                  "value": float(rows[0][1]), "size": path.stat().st_size, "cpu": time.process_time()}))
"""


@pytest.mark.slow
def test_ten_million_samples_are_simulated_read_and_replayed_in_300_mb(project, tmp_path):
    """Peak of the resident memory of a process, in MB, from its start with all imports to the end of the replay."""
    script = tmp_path / "large.py"
    script.write_text(textwrap.dedent(LARGE))
    done = subprocess.run(
        [sys.executable, str(script), str(project.root), str(TRIED[0]["slow"])],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    print(f"large log: {found}")
    assert found["ends"] == [9999.999, 9999.0, 10_000_000, 9999.999]
    assert found["value"] == pytest.approx(1.0, abs=1e-6)  # sin, sampled every millisecond: within 1 - cos(5e-4)
    assert found["found"] == []
    assert max(found["MB"]) < 300


def test_a_large_log_read_from_its_file_gives_the_same_bits(tmp_path, monkeypatch):
    """What is not kept in memory is read again; nothing of what a log says depends on that."""
    from tests.gainsay.demo_log import write_demo

    path = write_demo(tmp_path / "demo.mcap", samples=501)
    kept = read_log(path)
    monkeypatch.setattr("gainsay.logs.chunks.KEPT", 1000)
    again = read_log(path)
    assert list(again) == list(kept)
    for topic in kept:
        assert again[topic].time.tobytes() == kept[topic].time.tobytes()
        assert again[topic].values.tobytes() == kept[topic].values.tobytes()
        for field in kept[topic].fields:
            assert again[topic].column(field).tobytes() == kept[topic].column(field).tobytes()
    assert again.events == kept.events
    assert again.frames == kept.frames
    assert repr((again.extremes, again.summaries, again.bounds)) == repr((kept.extremes, kept.summaries, kept.bounds))


def test_a_file_changed_while_it_is_read_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("gainsay.logs.chunks.KEPT", 0)
    path = tmp_path / "a.mcap"
    noise = np.random.default_rng(1).random((20_000, 1))  # more than a buffer of the file holds
    for force in (1.0, 2.0):
        with LogWriter(tmp_path / f"{force}.mcap", provenance={}) as log:
            log.signal("/thrust", {"x": "N"}, np.arange(20_000.0), force * noise)
    path.write_bytes((tmp_path / "1.0.mcap").read_bytes())
    log = read_log(path)
    assert log["/thrust"].values.tobytes() == noise.tobytes()
    with path.open("r+b") as file:
        file.write((tmp_path / "2.0.mcap").read_bytes())
    with pytest.raises(LogError, match="broken at byte"):
        log["/thrust"].values.max()
    path.write_bytes(b"")
    with pytest.raises(LogError, match="shorter"):
        log["/thrust"].time.max()
