"""What is behind `gainsay logs`, `gainsay view` and `make gallery`: plain functions that print and return exit codes.

Exit codes: 0 done, 1 a picture shows a broken or empty view, 2 a log cannot be read, 3 the viewer cannot run here
(nothing was checked). Other bad input raises InputError, which the command line turns into 2.
"""

import os
import signal
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from gainsay.errors import InputError, LogError, one_of
from gainsay.logs.quiet import quiet, rerun_binary
from gainsay.logs.reader import read_log


def log_files(root: Path, paper: str | None = None) -> list[Path]:
    """List the logs under ``results/``, of one paper or of all, in order of paper and run.

    Raises
    ------
    InputError
        There is none.
    """
    found = sorted(Path(root).glob(f"results/{paper or '*'}/logs/*.mcap"))
    if not found:
        raise InputError("no logs", file=f"results/{paper or '*'}/logs", expected="runs written by the simulation step")
    return found


def _paper(mcap: Path) -> str:
    return mcap.parent.parent.name


def list_logs(root: Path, paper: str | None = None) -> int:
    """Print every run with its duration, topics and size: aligned on a terminal, tab-separated elsewhere.

    A log that cannot be read is named on stderr and hides no other; the exit code is then 2.
    """
    rows = [("paper", "run", "duration [s]", "topics", "messages", "size [B]")]
    code = 0
    for mcap in log_files(root, paper):
        try:
            log = read_log(mcap)
        except LogError as error:
            print(f"bad input: {_paper(mcap)}  {error}", file=sys.stderr)
            code = 2
            continue
        messages = sum(log.count(topic) for topic in log.topics)
        row = (_paper(mcap), mcap.stem, f"{log.duration:g}", len(log.topics), messages, log.size)
        rows.append(tuple(str(cell) for cell in row))
    if sys.stdout.isatty():
        widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
        for row in rows:
            names = [cell.ljust(width) for cell, width in zip(row[:2], widths[:2], strict=True)]
            numbers = [cell.rjust(width) for cell, width in zip(row[2:], widths[2:], strict=True)]
            print("  ".join(names + numbers))
    else:
        for row in rows:
            print("\t".join(row))
    return code


def view(root: Path, paper: str, run: str | None = None, *, web: bool = False) -> int:
    """Open a run in the Rerun viewer and wait until it is closed.

    Parameters
    ----------
    root : Path
        Project root.
    paper : str
    run : str, optional
        By default the first in the order of names; the others are named on stderr.
    web : bool
        Open it in the web browser instead.

    Raises
    ------
    InputError
        There is no such run, or its ``.rrd`` has not been made.
    """
    runs = {mcap.stem: mcap for mcap in log_files(root, paper)}
    if run is None:
        run, *others = runs
        if others:
            print(f"opening {run}; also there: {', '.join(others)}", file=sys.stderr)
    if run not in runs:
        raise InputError(f"no run of {paper}", value=run, expected=one_of(run, runs))
    rrd = runs[run].with_suffix(".rrd")
    if not rrd.is_file():
        raise InputError("not made yet", file=f"results/{paper}/logs/{rrd.name}", expected="the views step to have run")
    return _open(rrd, web)


def _open(rrd: Path, web: bool) -> int:
    try:
        binary = rerun_binary()
    except LogError as error:
        print(f"not shown: {error}", file=sys.stderr)
        return 3
    arguments = [binary, str(rrd), "--port", "auto"]
    if web:
        arguments += ["--web-viewer", "--bind", "127.0.0.1"]
    with quiet() as environment:
        environment.pop("RUST_LOG", None)  # the address of the web viewer is told as information
        viewer = subprocess.Popen(arguments, env=environment)
        # A terminated command must not leave its viewer behind: end it by its own process id.
        before = signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
        try:
            code = viewer.wait()
        except KeyboardInterrupt:
            code = 0
        finally:
            if viewer.poll() is None:
                viewer.terminate()
                viewer.wait()
            signal.signal(signal.SIGTERM, before)
    if code != 0:
        hint = "" if web or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") else "; no screen: try --web"
        print(f"not shown: the viewer ended with code {code}{hint}", file=sys.stderr)
        return 3
    return 0


def gallery(root: Path, papers: Iterable[str] = (), *, out: str = "gallery") -> int:
    """Render every run in the real viewer and check that no view is broken or empty.

    Pictures go to ``results/<paper>/<out>/<run>.png``, further tabs to ``<run>_2.png`` and so on.
    """
    from gainsay.logs.render import NotCheckedError, render

    code = 0
    for paper in tuple(papers) or (None,):
        for mcap in log_files(root, paper):
            folder = mcap.parent.parent / out
            folder.mkdir(exist_ok=True)
            try:
                found = render(mcap.with_suffix(".rrd"), folder / f"{mcap.stem}.png")
            except NotCheckedError as error:
                print(f"{_paper(mcap)}  {error}")
                code = 3
                continue
            for problem in found.problems:
                print(f"{_paper(mcap)}  {problem}")
            if found.problems:
                code = code or 1
            else:
                print(f"{_paper(mcap)}  {found.run}: {len(found.views)} views, {len(found.pictures)} pictures")
    return code
