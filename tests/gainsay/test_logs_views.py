"""The files for viewers, made by the real Rerun command, and the commands around them."""

import io
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from gainsay.errors import InputError, LogError
from gainsay.logs import Bound, Layout, Line, LogWriter, Plot, Tab, commands, read_log
from gainsay.logs.palette import rgb
from gainsay.logs.quiet import call, quiet, rerun_binary
from gainsay.logs.render import NotCheckedError, empty, render
from gainsay.logs.topics import Topics
from gainsay.logs.views import write_views
from tests.gainsay.demo_log import LAYOUT, write_demo


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A project root with two runs of a paper called demo; one has its views."""
    root = tmp_path_factory.mktemp("root")
    for run in ("spiral", "later"):
        write_demo(root / f"results/demo/logs/{run}.mcap", samples=301)
    write_views(root / "results/demo/logs/spiral.mcap", LAYOUT)
    return root


@pytest.fixture
def rrd(root):
    return root / "results/demo/logs/spiral.rrd"


def test_usage_statistics_are_off_in_every_call():
    assert json.loads(call("analytics", "config"))["analytics_enabled"] is False


def test_the_environment_comes_back():
    before = dict(os.environ)
    with quiet():
        assert os.environ["XDG_CONFIG_HOME"] != before.get("XDG_CONFIG_HOME")
    assert dict(os.environ) == before


def test_one_file_holds_log_drawings_and_blueprint(rrd):
    """Oracle: Rerun's own verifier and printer."""
    call("rrd", "verify", str(rrd))
    text = call("rrd", "print", str(rrd))
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


def test_a_failing_call_says_so_in_one_line():
    with pytest.raises(LogError, match="rerun rrd verify failed") as caught:
        call("rrd", "verify", "nothing.rrd")
    assert "\n" not in str(caught.value)


def test_conformance_of_every_kind_of_topic(root):
    """Oracle: Rerun's full check of an MCAP file; it names topics with problems."""
    text = call("mcap", "check", "--full", str(root / "results/demo/logs/spiral.mcap"))
    lines = [line for line in text.splitlines() if "/" in line and "mcap" not in line]
    assert len(lines) == 17
    assert all(line.startswith("ok") and line.rstrip().endswith("—") for line in lines)


def test_list_is_plain_when_piped(root, capsys):
    assert commands.list_logs(root) == 0
    rows = [line.split("\t") for line in capsys.readouterr().out.splitlines()]
    assert rows[0] == ["paper", "run", "duration [s]", "topics", "messages", "size [B]", "what it is"]
    assert [row[:4] for row in rows[1:]] == [["demo", "later", "3000", "17"], ["demo", "spiral", "3000", "17"]]
    assert int(rows[1][5]) == (root / "results/demo/logs/later.mcap").stat().st_size


@pytest.mark.parametrize(
    ("paper", "run", "words"),
    [("other", None, "no logs"), ("demo", "nominal", "one of later, spiral"), ("demo", "later", "not made yet")],
)
def test_view_refuses_what_is_not_there(root, paper, run, words):
    with pytest.raises(InputError, match=words):
        commands.view(root, paper, run)


def test_view_without_a_run_opens_the_nominal_one(root, monkeypatch, capsys):
    asked = []
    monkeypatch.setattr(commands, "_open", lambda _, rrd, ports: asked.append((rrd.stem, ports)) or 0)
    monkeypatch.setenv("DISPLAY", ":0")
    toml = root / "papers/demo/paper.toml"
    toml.parent.mkdir(parents=True)
    toml.write_text('[runs]\nspiral = "the first that is declared"\nlater = "another"\n')
    assert commands.view(root, "demo") == 0
    assert asked == [("spiral", ())]
    assert "opening spiral; also there: later" in capsys.readouterr().err
    toml.unlink()


def test_without_the_viewer_a_line_names_the_extra_that_brings_it(root, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(sys, "path", [])
    monkeypatch.setenv("PATH", str(tmp_path))
    for work in (lambda: commands.view(root, "demo", "spiral"), lambda: commands.gallery(root)):
        assert work() == 3
        (line,) = capsys.readouterr().err.splitlines()
        assert "the Rerun viewer is not installed" in line
        assert "pip install 'gainsay[view]'" in line


def test_without_a_screen_a_line_says_how_to_look(root, monkeypatch, capsys):
    monkeypatch.setattr(commands, "_open", lambda _, rrd, ports: pytest.fail("nothing is opened"))
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert commands.view(root, "demo", "spiral") == 3
    (line,) = capsys.readouterr().err.splitlines()
    assert "gainsay view demo spiral --web" in line
    assert line.count(":localhost:") == 2  # the page and the data
    assert "ssh -N -L" in line


def test_a_log_of_somebody_else_is_told_as_far_as_it_goes(tmp_path, capsys):
    """Written by the mcap package; cut short, what was read before stays told."""
    from mcap.writer import CompressionType, Writer

    path = tmp_path / "other.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.NONE, use_chunking=False)
        writer.start(profile="ros2", library="other")
        schema = writer.register_schema("a", "jsonschema", b"{}")
        channel = writer.register_channel("/a.b", "json", schema)
        for second in range(5):
            writer.add_message(channel, second * 10**9, b"{}", second * 10**9)
        writer.finish()
    assert commands.list_logs(tmp_path, str(path)) == 0
    first, topic = capsys.readouterr().out.splitlines()
    assert "not one of ours (profile 'ros2'" in first and "5 messages in 4 s" in first
    assert topic.split() == ["/a.b", "json", "5", "messages"]
    path.write_bytes(path.read_bytes()[:-400])
    assert commands.list_logs(tmp_path, str(path)) == 0
    assert "it breaks off" in capsys.readouterr().out
    path.write_bytes(b"no log at all")
    with pytest.raises(LogError, match="no MCAP file"):
        commands.list_logs(tmp_path, str(path))
    mine = write_demo(tmp_path / "mine.mcap", samples=11)
    assert commands.list_logs(tmp_path, str(mine)) == 0
    assert "mine.mcap: demo mine, 3000 s" in capsys.readouterr().out


def test_the_topics_of_a_paper_are_listed_with_units_and_runs(root, tmp_path):
    topics = Topics()
    topics.add("spiral", read_log(root / "results/demo/logs/spiral.mcap"))
    with LogWriter(tmp_path / "other.mcap", provenance={"about": "a | bar"}) as log:
        log.signal("/chaser/position", {"x": "m", "y": "m", "z": "m"}, [0.0], [[1.0, 2.0, 3.0]])
    topics.add("other", read_log(tmp_path / "other.mcap"))
    page = topics.page("demo").splitlines()
    assert "| `/chaser/position` | samples | `x` [m], `y` [m], `z` [m] | all |" in page
    assert "| `/bounds/thrust_z` | bound | `lower` [N], `upper` [N] | `spiral` |" in page
    assert "| `other` | a \\| bar |" in page


def test_what_the_documentation_says_of_reading_back_works(root, monkeypatch):
    """Each block of docs/logs.md, run on the demonstration log, gives the samples of the log."""
    text = (Path(__file__).resolve().parents[2] / "docs" / "logs.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) == 3
    monkeypatch.chdir(root)
    expected = read_log(root / "results/demo/logs/spiral.mcap")["/chaser/thrust"]
    for block in blocks:
        found = {}
        exec(block.replace("wan2014/logs/nominal", "demo/logs/spiral"), found)  # a page of ours
        if "thrust" in found:
            assert found["thrust"]["y"].tolist() == expected.column("y").tolist()
            assert found["thrust"].attrs["units"]["y"] == "N"
        else:
            assert [row["y"] for row in found["rows"]] == expected.column("y").tolist()
            assert [row["time"] for row in found["rows"]] == expected.time.tolist()


def test_the_gallery_shows_every_run(root, monkeypatch, capsys):
    from gainsay.logs.render import Rendering

    def drawn(rrd, png):
        png.write_bytes(b"picture")
        return Rendering(rrd.stem, pictures=[png], views=["a"])

    monkeypatch.setattr("gainsay.logs.render.render", drawn)
    assert commands.gallery(root) == 0
    page = (root / "results/gallery.html").read_text()
    for run in ("later", "spiral"):
        assert f'src="demo/gallery/{run}.png"' in page and f'id="demo-{run}"' in page
    assert "2 runs, see results/gallery.html" in capsys.readouterr().out


def test_view_opens_the_run_and_ends_its_own_child(root, monkeypatch, capsys):
    """A stand-in for the viewer that tells its arguments and the switch it finds."""
    script = root / "viewer"
    script.write_text(f'#!/bin/sh\necho "$@" > {root}/seen\ncat $XDG_CONFIG_HOME/rerun/analytics.json >> {root}/seen\n')
    script.chmod(0o755)
    monkeypatch.setattr(commands, "rerun_binary", lambda: str(script))
    monkeypatch.setenv("DISPLAY", ":0")
    assert commands.view(root, "demo", "spiral") == 0
    seen = (root / "seen").read_text()
    assert "--bind 127.0.0.1" in seen
    assert seen.startswith(str(root / "results/demo/logs/spiral.rrd"))
    assert '"analytics_enabled": false' in seen
    script.write_text("#!/bin/sh\nexit 7\n")
    assert commands.view(root, "demo", "spiral", web=True) == 3
    assert "ended with code 7" in capsys.readouterr().err


def test_a_terminated_view_takes_its_viewer_along(root):
    script = root / "waiting"
    script.write_text(f"#!/bin/sh\necho $$ > {root}/pid\nexec sleep 60\n")
    script.chmod(0o755)
    code = (
        "import sys; from pathlib import Path; from gainsay.logs import commands;"
        "commands.rerun_binary = lambda: sys.argv[2]; commands.view(Path(sys.argv[1]), 'demo', 'spiral')"
    )
    environment = os.environ | {"DISPLAY": ":0"}
    command = subprocess.Popen([sys.executable, "-c", code, str(root), str(script)], env=environment)
    pid = root / "pid"
    limit = time.monotonic() + 20.0
    while not (pid.exists() and pid.read_text().strip()) and time.monotonic() < limit:
        time.sleep(0.02)
    command.terminate()
    assert command.wait(timeout=10.0) == 143
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.read_text()), 0)


def test_pictures_of_what_cannot_be_opened_are_not_checked(root, tmp_path, monkeypatch, capsys):
    with pytest.raises(NotCheckedError, match="not checked: no file"):
        render(tmp_path / "a.rrd", tmp_path / "a.png")

    def broken():
        raise LogError("the Rerun viewer is not installed")

    monkeypatch.setattr("gainsay.logs.headless.rerun_binary", broken)
    assert commands.gallery(root, ["demo"]) == 3
    assert capsys.readouterr().out.count("not checked: ") == 2


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("time.sleep(60)", "it did not start within 0.5 s"),
        ("print('no driver', file=sys.stderr); sys.exit(1)", "no driver"),
        # it listens, and never answers: a frozen viewer
        ("s = socket.create_server(('127.0.0.1', int(sys.argv[-1]))); time.sleep(60)", "no answer to open within 1 s"),
    ],
)
def test_a_viewer_that_does_not_answer_is_ended(root, tmp_path, monkeypatch, capsys, body, said):
    script = tmp_path / "viewer"
    script.write_text(
        f"#!{sys.executable}\nimport os, pathlib, socket, sys, time\n"
        f"pathlib.Path({str(tmp_path / 'pid')!r}).write_text(str(os.getpid()))\n{body}\n"
    )
    script.chmod(0o755)
    monkeypatch.setattr("gainsay.logs.headless.rerun_binary", lambda: str(script))
    monkeypatch.setattr("gainsay.logs.headless.STARTS", 0.5 if "start" in said else 20.0)
    monkeypatch.setattr("gainsay.logs.headless.ANSWERS", 1.0)
    (tmp_path / "stub.rrd").write_bytes(b"stub")
    with pytest.raises(NotCheckedError, match=f"^not checked: stub.rrd: the viewer failed: {said}$"):
        render(tmp_path / "stub.rrd", tmp_path / "stub.png")
    if (pid := tmp_path / "pid").exists():
        with pytest.raises(ProcessLookupError):
            os.kill(int(pid.read_text()), 0)


def picture(paint):
    from PIL import Image

    image = np.full((300, 900, 3), (20, 22, 26), dtype=np.uint8)
    paint(image)
    stream = io.BytesIO()
    Image.fromarray(image).save(stream, "PNG")
    return stream.getvalue()


def test_what_counts_as_empty():
    def cursor(image):
        image[:, 300:302] = 255  # time cursor
        image[10:90, 760:880] = 200  # legend
        image[-12:, ::3] = 200  # axis labels

    def curve(image):
        cursor(image)
        image[150, 40:] = (61, 159, 224)

    assert empty(picture(lambda image: None), "TimeSeries")
    assert empty(picture(cursor), "TimeSeries")
    assert not empty(picture(curve), "TimeSeries")

    def head(image):
        image[15:32, 10:230] = 255  # head of a text log

    def row(image):
        head(image)
        image[50:60, 20:40] = 200

    def word(image):
        image[12:24, 10:56] = 110  # (empty)

    def corner(image):
        image[100:120, 100:120] = 255

    assert empty(picture(lambda image: None), "3D")
    assert not empty(picture(corner), "3D")
    assert empty(picture(head), "TextLog")
    assert not empty(picture(row), "TextLog")
    assert empty(picture(word), "TextDocument")
    assert not empty(picture(head), "TextDocument")


@pytest.mark.slow
def test_the_viewer_shows_every_view_of_the_demo(rrd, tmp_path):
    found = viewer(rrd, tmp_path / "demo.png")
    assert found.problems == []
    assert sorted(found.views) == sorted(panel.title for panel in LAYOUT.panels())
    assert [path.name for path in found.pictures] == ["demo.png", "demo_2.png"]


@pytest.mark.slow
@pytest.mark.parametrize("content", [b"stub", b"", bytes(200_000)])
def test_what_is_no_recording_is_said_in_the_words_of_the_viewer(rrd, tmp_path, content):
    viewer(rrd, tmp_path / "looked.png")  # where there is no driver this says so
    (tmp_path / "stub.rrd").write_bytes(content)
    # the viewer's own words, not those of a wait that ran out
    with pytest.raises(NotCheckedError, match="the viewer failed: Failed to load file"):
        render(tmp_path / "stub.rrd", tmp_path / "stub.png")


@pytest.mark.slow
def test_the_gallery_is_drawn_by_the_viewer_itself(rrd, tmp_path, capsys):
    from PIL import Image

    viewer(rrd, tmp_path / "looked.png")  # where there is no driver this says so
    logs = tmp_path / "results/demo/logs"
    logs.mkdir(parents=True)
    for suffix in (".mcap", ".rrd"):
        shutil.copy(rrd.with_suffix(suffix), logs)
    assert commands.gallery(tmp_path) == 0
    views = len(list(LAYOUT.panels()))
    assert f"demo  spiral: {views} views, {len(LAYOUT.tabs)} pictures" in capsys.readouterr().out
    named = re.findall('src="([^"]+)"', (tmp_path / "results/gallery.html").read_text())
    assert len(named) == len(LAYOUT.tabs)
    for name in named:
        assert min(Image.open(tmp_path / "results" / name).size) > 500


def rows_of(png, name):
    """Rows of a picture in which the colour of a role, or one near it, is seen; the head with the legend left out."""
    from PIL import Image

    image = np.asarray(Image.open(png).convert("RGB"), dtype=int)[:, :1500]
    return np.flatnonzero((np.abs(image - rgb(name)).max(axis=2) < 40).any(axis=1))


@pytest.mark.slow
def test_a_peak_of_one_sample_is_drawn_at_its_height(tmp_path):
    """20000 samples on some 1500 columns: the located extreme is drawn where a line at its value is, to a line's width.

    With means of the samples under a pixel, as the viewer draws by itself, it stands at a tenth of the height.
    """
    time = np.arange(20001) * 0.01
    value = np.sin(time)
    value[9876] = 40.0
    mcap = tmp_path / "peak.mcap"
    with LogWriter(mcap, provenance={}) as log:
        log.signal("/thrust", {"x": "N"}, time, value[:, None])
        log.extreme("peak", time[9876], 40.0, "N")
        log.bound("peak", "N", upper=40.0)
    layout = Layout(
        "demo", (Tab("Thrust", Plot("Thrust [N]", (Line("/thrust", "x", "x", "axis_1"),), (Bound("peak"),))),)
    )
    write_views(mcap, layout)
    assert viewer(mcap.with_suffix(".rrd"), tmp_path / "peak.png").problems == []
    drawn, line = rows_of(tmp_path / "peak.png", "axis_1"), rows_of(tmp_path / "peak.png", "bound")
    assert abs(int(drawn.min()) - int(line.min())) <= 4


@pytest.mark.slow
def test_the_viewer_finds_empty_and_broken_views(root, tmp_path):
    """The same run with a blueprint whose queries find nothing: every view must be called empty."""
    code = """
import sys
from pathlib import Path
import gainsay.logs.views as views, gainsay.logs.blueprint as made
from tests.gainsay.demo_log import LAYOUT
for name in ("TimeSeriesView", "Spatial3DView", "TextLogView", "TextDocumentView"):
    kind = getattr(made.rrb, name)
    def nothing(kind=kind, **keywords):
        keywords.pop("overrides", None)
        keywords.pop("contents", None)
        return kind(**(keywords | {"origin": "/nothing"}))
    setattr(made.rrb, name, nothing)
views.write_views(Path(sys.argv[1]), LAYOUT)
"""
    mcap = write_demo(tmp_path / "nothing.mcap", samples=101)
    subprocess.run([sys.executable, "-c", code, str(mcap)], check=True, cwd=Path(__file__).resolve().parents[2])
    found = viewer(tmp_path / "nothing.rrd", tmp_path / "nothing.png")
    assert {problem for problem in found.problems if problem.endswith(": empty")} == {
        f"nothing: {panel.title}: empty" for panel in LAYOUT.panels()
    }


def viewer(rrd, png):
    try:
        return render(rrd, png)
    except NotCheckedError as error:
        if os.environ.get("CI"):
            raise  # where the driver is to be installed, not to look is no pass
        pytest.skip(str(error))  # at a desk without a graphics driver the other tests still count


@pytest.mark.slow
def test_without_a_graphics_driver_it_says_not_checked(rrd, tmp_path, monkeypatch):
    for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):
        monkeypatch.setenv(name, "/nowhere.json")
    monkeypatch.setenv("WGPU_BACKEND", "vulkan")
    with pytest.raises(NotCheckedError, match=r"not checked: spiral\.rrd: "):
        render(rrd, tmp_path / "a.png")


@pytest.mark.slow
def test_no_viewer_is_left_running(rrd, tmp_path):
    import psutil

    viewer(rrd, tmp_path / "a.png")
    binary = rerun_binary()
    mine = [child for child in psutil.Process().children(recursive=True) if binary in " ".join(child.cmdline())]
    assert mine == []


@pytest.mark.slow
def test_ten_million_doubles_in_bounded_memory(tmp_path):
    """The whole process stays under 300 MB, interpreter included, while 80 MB of doubles stream through it."""
    code = """
import re, sys
from pathlib import Path
import numpy as np
from gainsay.logs import LogWriter
random = np.random.default_rng(0)
fields = {f"c{number}": "1" for number in range(10)}
with LogWriter(sys.argv[1], provenance={}) as log:
    for block in range(100):
        log.signal("/a", fields, 100.0 * block + 0.01 * np.arange(10000), random.normal(size=(10000, 10)))
print(re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])
"""
    path = str(tmp_path / "big.mcap")
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 300 * 1024
    call("mcap", "check", "--full", path)
