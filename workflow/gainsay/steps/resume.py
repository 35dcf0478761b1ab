"""Going on: steps whose files are lost, altered or unfinished count as not done.

Used by the Snakefile before it plans anything, so that a run that was killed, or whose results were touched, goes on at
the next `snakemake --cores 2` by itself.
"""

from collections.abc import Iterable
from pathlib import Path

from gainsay.errors import InputError
from gainsay.results.listing import damage
from gainsay.tables.files import read_csv

#: step -> the steps that read what it leaves, in the order of the workflow
AFTER = {
    "synthesis": ("figures", "verdicts"),
    "audit": ("figures", "verdicts"),
    "simulation": ("figures", "views", "verdicts"),
    "figures": ("verdicts",),
    "views": ("verdicts",),
    "verdicts": ("compare", "page"),
    "compare": ("page",),
    "page": (),
}


def _unfinished(results: Path, step: str) -> bool:
    """Whether a step left failures: what broke may not break again (memory, a full disk)."""
    path = results / "parts" / f"{step}.failures.csv"
    try:
        return path.is_file() and bool(read_csv(path)[1])
    except InputError:
        return True


def _undone(results: Path, step: str) -> str:
    """Say why a step does not count as done, or nothing."""
    listing = results / "parts" / f"{step}.files.csv"
    damaged = [f"{file} {how}" for file, how in damage(listing, results)]
    if not damaged:
        return "it had failures" if _unfinished(results, step) else ""
    return damaged[0] + (f" and {len(damaged) - 1} more" if len(damaged) > 1 else "")


def forget_damaged(root: Path, papers: Iterable[str], *, whole: bool = True) -> list[str]:
    """Take the lists of files away from steps that are not done whole and from all that follow, so that they run again.

    Snakemake makes a missing file only where something that is missing too, or older, needs it.

    Parameters
    ----------
    root : Path
        Project root.
    papers : iterable of str
        Those that the run works on.
    whole : bool
        Whether these are all; else what belongs to all papers is left as it is.

    Returns
    -------
    list of str
        A line for each step that had been done: what is damaged.
    """
    notices: list[str] = []
    shared = root / "results" / "report.files.csv"
    undone = [paper for paper in papers if _forget(root / "results" / paper, notices)]
    if not whole:
        return notices
    if shared.exists() and list(damage(shared, root / "results")):
        notices.append("report runs again, its files are not as it left them")
        undone.append("report")
    if undone or not shared.exists():
        shared.unlink(missing_ok=True)
        (root / "results" / ".checked").unlink(missing_ok=True)
    return notices


def _forget(results: Path, notices: list[str]) -> bool:
    """Forget what of one paper is not done whole; say whether anything is not."""
    again: set[str] = set()
    for step, after in AFTER.items():
        listing = results / "parts" / f"{step}.files.csv"
        why = _undone(results, step)
        if why and listing.exists():
            notices.append(f"{results.name}: {step} runs again, {why}")
        if why or step in again:
            again |= {step, *after}
    for step in again:
        (results / "parts" / f"{step}.files.csv").unlink(missing_ok=True)
    if again:
        (results / ".checked").unlink(missing_ok=True)
    return bool(again)
