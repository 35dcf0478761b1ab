"""Recompute every quantity and figure of a run from its log alone, and say where they differ from those on file."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

from gainsay.errors import LogError
from gainsay.logs import Log, RunSpec, read_log
from gainsay.steps.modules import paper_module
from gainsay.tables import Case, paper_names, read_case
from gainsay.tables.contract import CONTRACT
from gainsay.tables.files import cell, read_records


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


def quantity_differences(case: Case, run: RunSpec, log: Log) -> Iterator[str]:
    """Measure a run from its log and yield a line for every quantity that is not on file to the last bit."""
    on_file = {row["quantity"]: row for row in read_records(case.results / "quantities.csv", case.root)}
    for quantity, found in run.measure(case, log).items():
        row = on_file.get(quantity)
        for column, value in (("value", found.value), ("lower", found.lower), ("upper", found.upper)):
            text = "nothing" if row is None else row[column]
            if text != cell(value):
                yield f"{quantity}: {column} {cell(value)} from the log, {text} on file"


def figure_differences(case: Case, run: RunSpec, log: Log) -> Iterator[str]:
    """Draw the figures that show a run again and yield a line for every file that differs."""
    from gainsay.figures import save  # drawing costs a second to import: not where only numbers are asked for

    for figure in paper_module(case, "figures").FIGURES:
        if run.name not in figure.runs:
            continue
        others = [case.results / "logs" / f"{name}.mcap" for name in figure.runs if name != run.name]
        if not all(path.is_file() for path in others):
            yield f"{figure.name}: not drawn, the log of another run is missing"
            continue
        logs = {run.name: log, **{path.stem: read_log(path) for path in others}}
        with tempfile.TemporaryDirectory() as folder:
            save(figure, logs, case, Path(folder))
            for ending in ("svg", "png"):
                drawn, on_file = (
                    place / f"{figure.name}.{ending}" for place in (Path(folder), case.results / "figures")
                )
                if not on_file.is_file() or drawn.read_bytes() != on_file.read_bytes():
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
    found = list(quantity_differences(case, run, log))
    if figures:
        found += figure_differences(case, run, log)
    return f"{paper}/{run.name}", found
