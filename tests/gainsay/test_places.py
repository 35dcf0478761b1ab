"""Places that cannot be written: a full disk, a results folder that is none, no temporary folder. One line each."""

import errno
import os
import resource
import signal
import stat
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import pytest

from gainsay.campaigns import Plan
from gainsay.campaigns.draws import counted_draws
from gainsay.campaigns.store import write_chunk
from gainsay.cli import main
from gainsay.errors import InputError
from gainsay.steps import holding
from gainsay.steps.command import step_command
from gainsay.tables.files import write_atomically
from gainsay.tables.models import Campaign

ROOT = Path(__file__).resolve().parents[2]


def step(project, work):
    return step_command(work, "", ["toy", "--root", str(project.root)])


@pytest.fixture(autouse=True)
def released():
    """Locks that steps in this process took end with the test."""
    before = list(holding._held)
    yield
    for descriptor in holding._held[len(before) :]:
        os.close(descriptor)
    holding._held[len(before) :] = []


def test_what_is_no_file_is_not_replaced(tmp_path):
    """A pipe stands for devices: `--junit /dev/null`, run by the superuser, put a file in the place of the device."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(InputError, match="not a file"):
        write_atomically(pipe, "text")
    assert pipe.is_fifo()


def test_a_link_stays_one(tmp_path):
    (tmp_path / "link").symlink_to("file")
    write_atomically(tmp_path / "link", "text")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").read_text() == "text"


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="no /dev/full here")
@pytest.mark.parametrize("command", [["lint"], ["lint", "wan2014"]])
def test_output_to_a_full_disk_is_one_line(command):
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "gainsay.cli", *command], stdout=full, stderr=subprocess.PIPE, text=True, cwd=ROOT,
            check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == "broken off: output: no space left on device\n"


def test_a_reader_that_goes_away_is_nothing_to_speak_of():
    done = subprocess.Popen(
        [sys.executable, "-m", "gainsay.cli", "lint"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
    done.stdout.close()
    assert done.stderr.read() == ""
    done.stderr.close()
    assert done.wait() == 2


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_streams_are_the_null_device_and_no_file_takes_their_number(tmp_path, closed):
    """`gainsay lint >&-` ended in a traceback; what a solver writes to number 1 would go into the next file opened."""
    code = "from gainsay.cli import main; code = main(['lint', 'wan2014']); import os; kept = open('a', 'wb')\n"
    code += "[os.write(n, b'x') for n in (1, 2)]; kept.close(); os._exit(code)"
    command = f'cd {tmp_path}; exec {sys.executable} -c "$0" {closed}'
    code = code.replace("['lint'", f"['--root', '{ROOT}', 'lint'")
    done = subprocess.run(["sh", "-c", command, code], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert done.stderr in ("", "x")
    assert (tmp_path / "a").read_bytes() == b""


def test_results_that_are_no_folder_are_one_line(project, capsys):
    (project.root / "results").write_text("")
    assert step(project, lambda case: None) == 2
    said = capsys.readouterr().err
    assert said.startswith("bad input: results/.steps: ")
    assert said.count("\n") == 1


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may write everywhere")
def test_results_that_may_not_be_written_are_one_line(project, capsys):
    (project.root / "results").mkdir(mode=0o500)
    assert step(project, lambda case: None) == 2
    assert capsys.readouterr().err == (
        "bad input: results/.steps: permission denied: expected a folder that can be written\n"
    )


def test_a_full_disk_ends_a_step_in_one_line_and_leaves_the_old_file(project, capsys, monkeypatch):
    path = project.root / "results" / "toy" / "a.csv"
    write_atomically(path, "old")

    def full(self, target):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    monkeypatch.setattr(Path, "replace", full)
    assert step(project, lambda case: write_atomically(path, "new")) == 2
    assert capsys.readouterr().err == f"broken off: {path}: no space left on device\n"
    assert path.read_text() == "old"
    assert [p.name for p in path.parent.iterdir()] == ["a.csv"]


@pytest.fixture
def short_files():
    """No file of this process grows beyond 4 kB: the disk that a test can fill."""
    before, handler = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, handler)


def draws(case):
    """A campaign whose only chunk is longer than 4 kB."""
    row = Campaign(name="luck", kind="draws", inputs="factor=0..1", resolution="100000", seed="7", block="10",
                   chunk="100000", claim="", question="q")  # fmt: skip
    counted = counted_draws(("factor",), "n", {"n": "n"}, lambda case, block: {"n": (block.first * 7919 % 10007, 0)})
    return Plan(case, row, counted, "0" * 16)


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("a.csv", lambda case: write_atomically(case.results / "a.csv", "x" * 5000)),
        ("chunk-0000000.parquet", lambda case: write_chunk(draws(case), 0)),
    ],
)
def test_what_cannot_be_written_to_its_end_is_named_and_not_left(project, capsys, short_files, name, write):
    """The system names no file in an error of writing; a chunk left its half behind."""
    assert step(project, write) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"broken off: {project.root}/results/toy/")
    assert f"{name}: " in said
    assert "file too large" in said
    assert [path.name for path in (project.root / "results/toy").rglob("*") if path.is_file()] == []


def test_no_temporary_folder_is_one_line(project, capsys, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(project.root / "nowhere"))
    assert step(project, lambda case: tempfile.TemporaryFile().close()) == 2
    said = capsys.readouterr().err
    assert said.startswith("broken off: ")
    assert said.endswith("no such file or directory\n")
    assert said.count("\n") == 1


def test_a_command_that_cannot_write_says_so_in_one_line(project, capsys, monkeypatch):
    def full(options):
        """Read nothing."""
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), "README.md")

    monkeypatch.setattr("gainsay.cli.lint", full)
    assert main(["--root", str(project.root), "lint"]) == 2
    assert capsys.readouterr().err == "broken off: README.md: read-only file system\n"


def test_temporary_names_are_unique_and_files_as_private_as_one_wants_them(tmp_path):
    """Many writers of one file at once: the file is always whole, and nothing else is left."""
    path = tmp_path / "a.csv"
    texts = [str(n) * 50_000 for n in range(8)]
    writers = [threading.Thread(target=write_atomically, args=(path, text)) for text in texts for _ in range(5)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert path.read_text() in texts
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]
    code = "from pathlib import Path; from gainsay.tables.files import write_atomically as w; w(Path('b'), 'x')"
    for mask, mode in ((0o022, 0o644), (0o077, 0o600), (0o002, 0o664)):
        subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, umask=mask)
        assert stat.S_IMODE((tmp_path / "b").stat().st_mode) == mode


ENVIRONMENT = """
import runpy, subprocess, sys
made = runpy.run_path(sys.argv[1], run_name="environment")
code = "import sys; sys.stderr.write(sys.argv[1]); sys.exit(1)"
made["run"](sys.executable, "-c", code, sys.argv[2], doing="fetching uv")
"""


@pytest.mark.parametrize(
    ("said", "line"),
    [
        ("WARNING: Retrying ... NewConnectionError('<pip...>: [Errno -3] Temporary failure in name resolution')\nERROR",
         "no package index can be reached; a network is needed this once"),
        ("error: Failed to fetch\n  Caused by: dns error\n  Caused by: failed to lookup",
         "no package index can be reached; a network is needed this once"),
        ("one\ntwo\nthree\n" + "x" * 1000, "x" * 200),
    ],
)  # fmt: skip
def test_set_up_says_in_one_line_what_it_needs(said, line):
    done = subprocess.run(
        [sys.executable, "-c", ENVIRONMENT, str(ROOT / "workflow" / "environment.py"), said],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == f"setting up .venv: fetching uv failed: {line}\n"
    assert len(done.stderr) < 300
