"""Pictures of runs, drawn by the real viewer, and what counts as an empty or broken view."""

import io
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from gainsay.errors import LogError
from gainsay.logs import Bound, Layout, Line, LogWriter, Plot, Tab, commands
from gainsay.logs.palette import rgb
from gainsay.logs.quiet import rerun_binary
from gainsay.logs.render import NotCheckedError, empty, render
from gainsay.logs.views import write_views
from tests.gainsay.demo_log import LAYOUT, write_demo
from tests.gainsay.rerun_command import call


def test_pictures_of_what_cannot_be_opened_are_not_checked(demo, tmp_path, monkeypatch, capsys):
    with pytest.raises(NotCheckedError, match="not checked: no file"):
        render(tmp_path / "a.rrd", tmp_path / "a.png")

    def broken():
        raise LogError("the Rerun viewer is not installed")

    monkeypatch.setattr("gainsay.logs.headless.rerun_binary", broken)
    assert commands.gallery(demo, ["demo"]) == 3
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
def test_a_viewer_that_does_not_answer_is_ended(demo, tmp_path, monkeypatch, capsys, body, said):
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
def test_the_viewer_shows_every_view_of_the_demo(demo_rrd, tmp_path):
    found = viewer(demo_rrd, tmp_path / "demo.png")
    assert found.problems == []
    assert sorted(found.views) == sorted(panel.title for panel in LAYOUT.panels())
    assert [path.name for path in found.pictures] == ["demo.png", "demo_2.png"]


@pytest.mark.slow
@pytest.mark.parametrize("content", [b"stub", b"", bytes(200_000)])
def test_what_is_no_recording_is_said_in_the_words_of_the_viewer(demo_rrd, tmp_path, content):
    viewer(demo_rrd, tmp_path / "looked.png")  # where there is no driver this says so
    (tmp_path / "stub.rrd").write_bytes(content)
    # the viewer's own words, not those of a wait that ran out
    with pytest.raises(NotCheckedError, match="the viewer failed: Failed to load file"):
        render(tmp_path / "stub.rrd", tmp_path / "stub.png")


@pytest.mark.slow
def test_the_gallery_is_drawn_by_the_viewer_itself(demo_rrd, tmp_path, capsys):
    from PIL import Image

    viewer(demo_rrd, tmp_path / "looked.png")  # where there is no driver this says so
    logs = tmp_path / "results/demo/logs"
    logs.mkdir(parents=True)
    for suffix in (".mcap", ".rrd"):
        shutil.copy(demo_rrd.with_suffix(suffix), logs)
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
def test_the_viewer_finds_empty_and_broken_views(demo, tmp_path):
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
def test_without_a_graphics_driver_it_says_not_checked(demo_rrd, tmp_path, monkeypatch):
    for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):
        monkeypatch.setenv(name, "/nowhere.json")
    monkeypatch.setenv("WGPU_BACKEND", "vulkan")
    with pytest.raises(NotCheckedError, match=r"not checked: spiral\.rrd: "):
        render(demo_rrd, tmp_path / "a.png")


@pytest.mark.slow
def test_no_viewer_is_left_running(demo_rrd, tmp_path):
    import psutil

    viewer(demo_rrd, tmp_path / "a.png")
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
