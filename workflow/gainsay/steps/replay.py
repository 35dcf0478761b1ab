"""Recompute every quantity and figure of a run from its log alone, and say where they differ from those on file."""

import tempfile
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from gainsay.errors import LogError
from gainsay.logs import Log, Measured, RunSpec, read_log
from gainsay.results.listing import sha256
from gainsay.results.returned import read_returned
from gainsay.steps.modules import paper_module
from gainsay.steps.simulation import provenance
from gainsay.tables import Case, paper_names, read_case
from gainsay.tables.contract import CONTRACT
from gainsay.tables.files import cell, read_bytes


def spec_of(case: Case, log: Log, path: Path) -> RunSpec:
    """Return what the paper declares of the run that a log says it holds.

    Raises
    ------
    LogError
        If the paper declares no such run, or the log was written under another contract.
    """
    contract = log.metadata.get("contract", "")
    if contract != CONTRACT:
        raise LogError(file=str(path), field="contract", value=contract, expected=f"version {CONTRACT}")
    runs = {run.name: run for run in paper_module(case, "runs").RUNS}
    name = log.metadata.get("run", "")
    if name not in runs:
        raise LogError(file=str(path), field="run", value=name, expected=f"one of {', '.join(runs)}")
    return runs[name]


def origin_differences(case: Case, run: RunSpec, log: Log) -> Iterator[str]:
    """Hold what a log says of its origin against the paper's tables: its provenance and the table attached to it."""
    for key, expected in provenance(case, run).items():
        if log.metadata.get(key) != expected:
            yield f"{key}: {log.metadata.get(key)!r} in the log, {expected!r} expected"
    if log.attachments.get("parameters.csv") != read_bytes(case.folder / "parameters.csv", case.root):
        how = "differs from" if "parameters.csv" in log.attachments else "is not attached, unlike"
        yield f"parameters.csv: {how} papers/{case.name}/parameters.csv"


def sample_differences(case: Case, run: RunSpec, log: Log) -> Iterator[str]:
    """Hold a log against the one that the simulation left, to the bit.

    A located extreme is a number of its own: it does not follow from the samples, so that samples changed beside it
    change no quantity.
    """
    file = f"logs/{run.name}.mcap"
    listed = read_returned(case.results / "parts" / "simulation.files.csv", case.root)
    digests = [row["sha256"] for row in listed if row["file"] == file]
    if digests == [sha256(log.path)]:
        return
    if not digests or not (case.results / file).is_file() or sha256(case.results / file) not in digests:
        yield f"{file}: the log is not the one that the simulation left"
        return
    left = read_log(case.results / file)
    topics = [t for t in dict.fromkeys((*left.topics, *log.topics)) if not _same(left, log, t)]
    what = ", ".join(topics) or "neither samples nor messages but other parts"
    yield f"{file}: differs from the log that the simulation left in {what}"


def _same(one: Log, other: Log, topic: str) -> bool:
    """Say whether a topic holds the same in two logs, to the bit."""
    if topic not in one.topics or topic not in other.topics or one.count(topic) != other.count(topic):
        return False
    if topic not in one or topic not in other:
        return topic not in one and topic not in other and one.messages(topic) == other.messages(topic)
    a, b = one[topic], other[topic]
    if dict(a.units) != dict(b.units) or a.time.tobytes() != b.time.tobytes():
        return False
    return all(a.column(field).tobytes() == b.column(field).tobytes() for field in a.fields)


def measured(case: Case, run: RunSpec, log: Log) -> Mapping[str, Measured]:
    """Measure a run from its log.

    Raises
    ------
    LogError
        If the log lacks what the measures need, or holds what they cannot be taken of.
    """
    try:
        return run.measure(case, log)
    except LogError:
        raise
    except Exception as error:  # the log may come from anywhere: whatever the measures stumble over is its fault
        message = f"cannot be measured: {type(error).__name__}: {error}"
        raise LogError(message, file=log.path.name, expected=f"a log of {case.name}/{run.name}") from error


def quantity_differences(case: Case, run: RunSpec, log: Log) -> Iterator[str]:
    """Measure a run from its log and yield a line for every quantity that is not on file to the last bit."""
    on_file = {row["quantity"]: row for row in read_returned(case.results / "quantities.csv", case.root)}
    for quantity, number in measured(case, run, log).items():
        row = on_file.get(quantity)
        for column, value in (("value", number.value), ("lower", number.lower), ("upper", number.upper)):
            text = "nothing" if row is None else row[column]
            if text != cell(value):
                yield f"{quantity}: {column} {cell(value)} from the log, {text} on file"


def figure_differences(case: Case, run: RunSpec, log: Log) -> Iterator[str]:
    """Draw the figures that show a run again and yield a line for every file that differs."""
    from gainsay.figures import save  # drawing costs a second to import: not where only numbers are asked for

    read = cache(read_log)  # several figures show another run
    for figure in paper_module(case, "figures").FIGURES:
        if run.name not in figure.runs:
            continue
        others = [case.results / "logs" / f"{name}.mcap" for name in figure.runs if name != run.name]
        if not all(path.is_file() for path in others):
            yield f"{figure.name}: not drawn, the log of another run is missing"
            continue
        logs = {run.name: log, **{path.stem: read(path) for path in others}}
        with tempfile.TemporaryDirectory() as folder:
            save(figure, logs, case, Path(folder))
            for ending in ("svg", "png"):
                fresh, on_file = (
                    place / f"{figure.name}.{ending}" for place in (Path(folder), case.results / "figures")
                )
                if not on_file.is_file() or fresh.read_bytes() != on_file.read_bytes():
                    yield f"{on_file.name}: drawn from the log, it differs from the one on file"


def replay(root: Path, path: Path, *, figures: bool = True) -> tuple[str, list[str]]:
    """Replay a log.

    Parameters
    ----------
    root : Path
        Project root.
    path : Path
        A log of any of its papers.
    figures : bool
        Whether to draw the figures again too.

    Returns
    -------
    name : str
        ``paper/run``.
    differences : list of str

    Raises
    ------
    LogError
        If the log is damaged, or holds no run of a paper of this project.
    """
    log = read_log(path)
    paper = log.metadata.get("paper", "")
    if paper not in paper_names(root):
        raise LogError(file=str(path), field="paper", value=paper, expected=f"one of {', '.join(paper_names(root))}")
    case = read_case(root, paper)
    run = spec_of(case, log, path)
    faults = [
        *origin_differences(case, run, log),
        *sample_differences(case, run, log),
        *quantity_differences(case, run, log),
    ]
    if figures:
        faults += figure_differences(case, run, log)
    return f"{paper}/{run.name}", faults
