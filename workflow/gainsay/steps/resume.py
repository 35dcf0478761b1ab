"""Going on: steps whose files are lost, altered or unfinished count as not done.

Used by the Snakefile before it plans anything, so that a run that was killed, or whose results were touched, goes on at
the next `snakemake --cores 2` by itself.
"""

from collections.abc import Iterable
from pathlib import Path

from gainsay.errors import InputError
from gainsay.tables.files import read_csv
from gainsay.tables.listing import damage
from gainsay.tables.results import STEPS

def _unfinished(results: Path, step: str) -> bool:
    """Whether a step left failures: what broke may not break again (memory, a full disk)."""
    path = results / "parts" / f"{step}.failures.csv"
    try:
        return path.is_file() and bool(read_csv(path)[1])
    except InputError:
        return True


def forget_damaged(root: Path, papers: Iterable[str]) -> list[str]:
    """Take the lists of files away from steps that are not done whole, so that they are run again.

    Returns
    -------
    list of str
        A line for each such step: what is damaged.
    """
    said = []
    for paper in papers:
        results = root / "results" / paper
        for step in (*STEPS, "verdicts", "compare", "page"):
            listing = results / "parts" / f"{step}.files.csv"
            if not listing.exists():
                continue
            damaged = [f"{file} {how}" for file, how in damage(listing, results)]
            if damaged or _unfinished(results, step):
                listing.unlink()
                more = f" and {len(damaged) - 1} more" if len(damaged) > 1 else ""
                said.append(f"{paper}: {step} runs again, {damaged[0] + more if damaged else 'it had failures'}")
    listing = root / "results" / "report.files.csv"
    if listing.exists() and list(damage(listing, root / "results")):
        listing.unlink()
        said.append("report runs again, its files are not as it left them")
    return said
