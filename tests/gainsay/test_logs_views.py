"""The files for viewers, read back by Rerun's own command, and the commands around them."""

import json
import os
import re
import resource
import subprocess
import sys
import time
from pathlib import Path

import pytest

from gainsay.errors import InputError, LogError
from gainsay.logs import LogWriter, commands, read_log
from gainsay.logs.quiet import quiet
from gainsay.logs.topics import Topics
from gainsay.logs.views import write_views
from tests.gainsay.demo_log import LAYOUT, write_demo
from tests.gainsay.rerun_command import call


def test_usage_statistics_are_off_in_every_call():
    assert json.loads(call("analytics", "config"))["analytics_enabled"] is False


def test_the_environment_comes_back():
    before = dict(os.environ)
    with quiet():
        assert os.environ["XDG_CONFIG_HOME"] != before.get("XDG_CONFIG_HOME")
    assert dict(os.environ) == before


def test_one_file_holds_log_drawings_and_blueprint(demo_rrd):
    """Oracle: Rerun's own verifier and printer."""
    call("rrd", "verify", str(demo_rrd))
    text = call("rrd", "print", str(demo_rrd))
    for entity in (
        "/chaser/position",
        "/bounds/thrust_xy",
        "/events",
        "/tf/chaser",
        "/scene/path/line0",
        "/text/about",
    ):
        assert f" - {entity}" in text
    # The recording and the blueprint are of one application: that is what ties them together in the viewer.
    stores = [" ".join(part.split(")")[0].split()) for part in text.split("StoreId(")[1:]]
    assert set(stores) >= {'Recording, "gainsay_demo", "spiral",'}
    assert {store.split(",")[0] for store in stores} == {"Blueprint", "Recording"}
    assert all('"gainsay_demo"' in store for store in stores)
    assert "/scene/path - " not in text  # the struct is left out where its drawing is in


def test_a_layout_that_does_not_fit_writes_nothing(tmp_path):
    with LogWriter(tmp_path / "a.mcap", provenance={}) as log:
        log.signal("/a", {"x": "m"}, [0.0], [[1.0]])
    with pytest.raises(LogError, match="layout demo"):
        write_views(tmp_path / "a.mcap", LAYOUT)
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap"]


def test_a_name_that_viewers_would_lose_is_refused(tmp_path):
    write_demo(tmp_path / "run-1.mcap", samples=11)
    with pytest.raises(InputError, match="run-1"):
        write_views(tmp_path / "run-1.mcap", LAYOUT)


def test_a_full_disk_leaves_no_half_of_a_view(tmp_path):
    log = write_demo(tmp_path / "spiral.mcap", samples=101)
    sizes = {path.suffix: path.stat().st_size for path in write_views(log, LAYOUT)}
    (tmp_path / "spiral.rrd").unlink()
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (sizes[".rrd"] - 1000, before[1]))
    try:
        with pytest.raises(OSError, match="too large"):
            write_views(log, LAYOUT)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert {path.name for path in tmp_path.iterdir()} == {"spiral.mcap", "spiral.foxglove.json"}


def test_conformance_of_every_kind_of_topic(demo):
    """Oracle: Rerun's full check of an MCAP file; it names topics with problems."""
    text = call("mcap", "check", "--full", str(demo / "results/demo/logs/spiral.mcap"))
    lines = [line for line in text.splitlines() if "/" in line and "mcap" not in line]
    assert len(lines) == 17
    assert all(line.startswith("ok") and line.rstrip().endswith("—") for line in lines)


def test_list_is_plain_when_piped(demo, capsys):
    assert commands.list_logs(demo) == 0
    rows = [line.split("\t") for line in capsys.readouterr().out.splitlines()]
    assert rows[0] == ["paper", "run", "duration [s]", "topics", "messages", "size [B]", "what it is"]
    assert [row[:4] for row in rows[1:]] == [["demo", "later", "3000", "17"], ["demo", "spiral", "3000", "17"]]
    assert int(rows[1][5]) == (demo / "results/demo/logs/later.mcap").stat().st_size


@pytest.mark.parametrize(
    ("paper", "run", "words"),
    [("other", None, "no logs"), ("demo", "nominal", "one of later, spiral"), ("demo", "later", "not made yet")],
)
def test_view_refuses_what_is_not_there(demo, paper, run, words):
    with pytest.raises(InputError, match=words):
        commands.view(demo, paper, run)


def test_view_without_a_run_opens_the_nominal_one(demo, monkeypatch, capsys):
    asked = []
    monkeypatch.setattr(commands, "_open", lambda _, rrd, ports: asked.append((rrd.stem, ports)) or 0)
    monkeypatch.setenv("DISPLAY", ":0")
    toml = demo / "papers/demo/paper.toml"
    toml.parent.mkdir(parents=True)
    toml.write_text('[runs]\nspiral = "the first that is declared"\nlater = "another"\n')
    assert commands.view(demo, "demo") == 0
    assert asked == [("spiral", ())]
    assert "opening spiral; also there: later" in capsys.readouterr().err
    toml.unlink()


def test_without_the_viewer_a_line_names_the_extra_that_brings_it(demo, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(sys, "path", [])
    monkeypatch.setenv("PATH", str(tmp_path))
    for work in (lambda: commands.view(demo, "demo", "spiral"), lambda: commands.gallery(demo)):
        assert work() == 3
        (line,) = capsys.readouterr().err.splitlines()
        assert "the Rerun viewer is not installed" in line
        assert "pip install 'gainsay[view]'" in line


def test_without_a_screen_a_line_says_how_to_look(demo, monkeypatch, capsys):
    monkeypatch.setattr(commands, "_open", lambda _, rrd, ports: pytest.fail("nothing is opened"))
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert commands.view(demo, "demo", "spiral") == 3
    (line,) = capsys.readouterr().err.splitlines()
    assert "gainsay view demo spiral --web" in line
    assert line.count(":localhost:") == 2  # the page and the data
    assert "ssh -N -L" in line


def test_the_topics_of_a_paper_are_listed_with_units_and_runs(demo, tmp_path):
    topics = Topics()
    topics.add("spiral", read_log(demo / "results/demo/logs/spiral.mcap"))
    with LogWriter(tmp_path / "other.mcap", provenance={"about": "a | bar"}) as log:
        log.signal("/chaser/position", {"x": "m", "y": "m", "z": "m"}, [0.0], [[1.0, 2.0, 3.0]])
    topics.add("other", read_log(tmp_path / "other.mcap"))
    page = topics.page("demo").splitlines()
    assert "| `/chaser/position` | samples | `x` [m], `y` [m], `z` [m] | all |" in page
    assert "| `/bounds/thrust_z` | bound | `lower` [N], `upper` [N] | `spiral` |" in page
    assert "| `other` | a \\| bar |" in page


def test_what_the_documentation_says_of_reading_back_works(demo, monkeypatch):
    """Each block of docs/logs.md, run on the demonstration log, gives the samples of the log."""
    text = (Path(__file__).resolve().parents[2] / "docs" / "logs.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) == 3
    monkeypatch.chdir(demo)
    expected = read_log(demo / "results/demo/logs/spiral.mcap")["/chaser/thrust"]
    for block in blocks:
        found = {}
        exec(block.replace("wan2014/logs/nominal", "demo/logs/spiral"), found)  # a page of ours
        if "thrust" in found:
            assert found["thrust"]["y"].tolist() == expected.column("y").tolist()
            assert found["thrust"].attrs["units"]["y"] == "N"
        else:
            assert [row["y"] for row in found["rows"]] == expected.column("y").tolist()
            assert [row["time"] for row in found["rows"]] == expected.time.tolist()


def test_the_gallery_shows_every_run(demo, monkeypatch, capsys):
    from gainsay.logs.render import Rendering

    def drawn(rrd, png):
        png.write_bytes(b"picture")
        return Rendering(rrd.stem, pictures=[png], views=["a"])

    monkeypatch.setattr("gainsay.logs.render.render", drawn)
    assert commands.gallery(demo) == 0
    page = (demo / "results/gallery.html").read_text()
    for run in ("later", "spiral"):
        assert f'src="demo/gallery/{run}.png"' in page and f'id="demo-{run}"' in page
    assert "2 runs, see results/gallery.html" in capsys.readouterr().out


def test_view_opens_the_run_and_ends_its_own_child(demo, monkeypatch, capsys):
    """A stand-in for the viewer that tells its arguments and the switch it finds."""
    script = demo / "viewer"
    script.write_text(f'#!/bin/sh\necho "$@" > {demo}/seen\ncat $XDG_CONFIG_HOME/rerun/analytics.json >> {demo}/seen\n')
    script.chmod(0o755)
    monkeypatch.setattr(commands, "rerun_binary", lambda: str(script))
    monkeypatch.setenv("DISPLAY", ":0")
    assert commands.view(demo, "demo", "spiral") == 0
    seen = (demo / "seen").read_text()
    assert "--bind 127.0.0.1" in seen
    assert seen.startswith(str(demo / "results/demo/logs/spiral.rrd"))
    assert '"analytics_enabled": false' in seen
    script.write_text("#!/bin/sh\nexit 7\n")
    assert commands.view(demo, "demo", "spiral", web=True) == 3
    assert "ended with code 7" in capsys.readouterr().err


def test_a_terminated_view_takes_its_viewer_along(demo):
    script = demo / "waiting"
    script.write_text(f"#!/bin/sh\necho $$ > {demo}/pid\nexec sleep 60\n")
    script.chmod(0o755)
    code = (
        "import sys; from pathlib import Path; from gainsay.logs import commands;"
        "commands.rerun_binary = lambda: sys.argv[2]; commands.view(Path(sys.argv[1]), 'demo', 'spiral')"
    )
    environment = os.environ | {"DISPLAY": ":0"}
    command = subprocess.Popen([sys.executable, "-c", code, str(demo), str(script)], env=environment)
    pid = demo / "pid"
    limit = time.monotonic() + 20.0
    while not (pid.exists() and pid.read_text().strip()) and time.monotonic() < limit:
        time.sleep(0.02)
    command.terminate()
    assert command.wait(timeout=10.0) == 143
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.read_text()), 0)
