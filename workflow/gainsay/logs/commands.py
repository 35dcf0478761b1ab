"""What is behind `gainsay logs`, `gainsay view` and `make gallery`: plain functions that print and return exit codes.

Exit codes: 0 done, 1 a picture shows a broken or empty view, 2 a log cannot be read, 3 the viewer cannot run here
(nothing was checked). Other bad input raises InputError, which the command line turns into 2.
"""

import os
import signal
import socket
import subprocess
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path

from gainsay.errors import InputError, LogError, one_of
from gainsay.logs.foreign import describe
from gainsay.logs.gallery import gallery_page
from gainsay.logs.quiet import quiet, rerun_binary
from gainsay.logs.reader import read_log
from gainsay.tables.files import write_atomically


def log_files(root: Path, paper: str | None = None) -> list[Path]:
    """List the logs under ``results/``, of one paper or of all, in order of paper and run.

    Raises
    ------
    InputError
        There is none.
    """
    every = sorted(Path(root).glob("results/*/logs/*.mcap"))
    files = [mcap for mcap in every if paper in (None, _paper(mcap))]
    if not files:
        papers = dict.fromkeys(map(_paper, every))
        expected = one_of(paper, papers) if paper and papers else "runs written by the simulation step"
        raise InputError("no logs", file=f"results/{paper or '*'}/logs", expected=expected)
    return files


def _paper(mcap: Path) -> str:
    return mcap.parent.parent.name


def list_logs(root: Path, paper: str | None = None) -> int:
    """Print every run with its size and what it is: aligned on a terminal, tab-separated elsewhere.

    A log that cannot be read is named on stderr and hides no other; the exit code is then 2.

    Parameters
    ----------
    root : Path
        Project root.
    paper : str, optional
        A paper, or a single ``.mcap`` file, which may be of somebody else.
    """
    if paper is not None and paper.endswith(".mcap"):
        for line in describe(Path(paper)):
            print(line)
        return 0
    rows: list[tuple[str, ...]] = [("paper", "run", "duration [s]", "topics", "messages", "size [B]", "what it is")]
    code = 0
    for mcap in log_files(root, paper):
        try:
            log = read_log(mcap)
        except LogError as error:
            print(f"bad input: {_paper(mcap)}  {error}", file=sys.stderr)
            code = 2
            continue
        messages = sum(log.count(topic) for topic in log.topics)
        cells = (_paper(mcap), mcap.stem, f"{log.duration:g}", len(log.topics), messages, log.size)
        rows.append(tuple(str(cell) for cell in (*cells, log.metadata.get("about", ""))))
    if sys.stdout.isatty():
        widths = [max(len(row[column]) for row in rows) for column in range(6)]
        for row in rows:
            names = [cell.ljust(width) for cell, width in zip(row[:2], widths[:2], strict=True)]
            numbers = [cell.rjust(width) for cell, width in zip(row[2:6], widths[2:], strict=True)]
            print("  ".join([*names, *numbers, row[6]]))
    else:
        for row in rows:
            print("\t".join(row))
    return code


def _first_run(root: Path, paper: str, runs: Iterable[str]) -> str:
    """The nominal run, or the first that the paper declares, or the first there is."""
    there = list(runs)
    toml = Path(root, "papers", paper, "paper.toml")
    declared = tomllib.loads(toml.read_text(encoding="utf-8")).get("runs", {}) if toml.is_file() else {}
    return next((run for run in ("nominal", *declared) if run in there), there[0])


def view(root: Path, paper: str, run: str | None = None, *, web: bool = False) -> int:
    """Open a run in the Rerun viewer, which listens on this machine alone, and wait until it is closed.

    Without a screen nothing is opened: a line says how to look from another machine.

    Parameters
    ----------
    root : Path
        Project root.
    paper : str
    run : str, optional
        By default the nominal run, or the first that the paper declares; the others are named on stderr.
    web : bool
        Open it in the web browser instead.

    Raises
    ------
    InputError
        There is no such run, or its ``.rrd`` has not been made.
    """
    runs = {mcap.stem: mcap for mcap in log_files(root, paper)}
    if run is None:
        run = _first_run(root, paper, runs)
        if len(runs) > 1:
            print(f"opening {run}; also there: {', '.join(name for name in runs if name != run)}", file=sys.stderr)
    if run not in runs:
        raise InputError(f"no run of {paper}", value=run, expected=one_of(run, runs))
    rrd = runs[run].with_suffix(".rrd")
    if not rrd.is_file():
        raise InputError("not made yet", file=f"results/{paper}/logs/{rrd.name}", expected="the views step to have run")
    try:
        binary = rerun_binary()
    except LogError as error:
        print(f"not shown: {error}", file=sys.stderr)
        return 3
    screen = sys.platform != "linux" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ports = (_free_port(9090), _free_port(9876)) if web or not screen else ()
    if ports and not screen:
        page = f"http://localhost:{ports[0]}/?url=rerun%2Bhttp%3A%2F%2Flocalhost%3A{ports[1]}%2Fproxy"
        first = "" if web else f"run `gainsay view {paper} {run} --web` here, "
        print(
            f"no screen here: {first}on your own machine `ssh -N -L {ports[0]}:localhost:{ports[0]} "
            f"-L {ports[1]}:localhost:{ports[1]} THIS_MACHINE`, and open {page}",
            file=sys.stderr,
        )
        if not web:
            return 3
    return _open(binary, rrd, ports)


def _free_port(first: int) -> int:
    """The first port from `first` on that nothing listens on."""
    for port in range(first, first + 100):
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) != 0:
                return port
    return first


def _open(binary: str, rrd: Path, ports: tuple[int, ...]) -> int:
    """Run the viewer to its end; with ports, those of the page and of the data, in the web browser."""
    arguments = [binary, str(rrd), "--bind", "127.0.0.1", "--port", str(ports[1]) if ports else "auto"]
    if ports:
        arguments += ["--web-viewer", "--web-viewer-port", str(ports[0])]
    with quiet() as environment:
        environment.pop("RUST_LOG", None)  # the address of the web viewer is told as information
        viewer = None
        asked = []

        def end(*_: object) -> None:
            asked.append(True)
            if viewer is not None:
                sys.exit(143)

        # A terminated command must not leave its viewer behind: end it by its own process id, which is not known yet
        # while it starts.
        before = signal.signal(signal.SIGTERM, end)
        try:
            viewer = subprocess.Popen(arguments, env=environment)
            if asked:
                sys.exit(143)
            code = viewer.wait()
        except KeyboardInterrupt:
            code = 0
        finally:
            if viewer is not None and viewer.poll() is None:
                viewer.terminate()
                viewer.wait()
            signal.signal(signal.SIGTERM, before)
    if code != 0:
        print(f"not shown: the viewer ended with code {code}{'' if ports else '; try --web'}", file=sys.stderr)
        return 3
    return 0


def gallery(root: Path, papers: Iterable[str] = (), *, out: str = "gallery") -> int:
    """Render every run in the real viewer, check that no view is broken or empty, and write ``results/gallery.html``.

    Pictures go to ``results/<paper>/<out>/<run>.png``, further tabs to ``<run>_2.png`` and so on. The page shows every
    run of the papers, those without a picture by name.
    """
    from gainsay.logs.render import NotCheckedError, render

    try:
        rerun_binary()
    except LogError as error:
        print(f"not checked: {error}", file=sys.stderr)
        return 3
    code = 0
    shown: list[tuple[Path, list[Path]]] = []
    for paper in tuple(papers) or (None,):
        for mcap in log_files(root, paper):
            folder = mcap.parent.parent / out
            folder.mkdir(exist_ok=True)
            shown.append((mcap, []))
            try:
                rendering = render(mcap.with_suffix(".rrd"), folder / f"{mcap.stem}.png")
            except NotCheckedError as error:
                print(f"{_paper(mcap)}  {error}", flush=True)
                code = 3
                continue
            shown[-1][1].extend(rendering.pictures)
            for problem in rendering.problems:
                print(f"{_paper(mcap)}  {problem}", flush=True)
            if rendering.problems:
                code = code or 1
            else:
                views, pictures = len(rendering.views), len(rendering.pictures)
                print(f"{_paper(mcap)}  {rendering.run}: {views} views, {pictures} pictures", flush=True)
    page = Path(root, "results", "gallery.html")
    write_atomically(page, gallery_page(page.parent, shown))
    print(f"gallery     {len(shown)} runs, see results/gallery.html")
    return code
