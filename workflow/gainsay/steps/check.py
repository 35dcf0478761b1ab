"""The last word: files as they were left, certificates checked again, everything as on record. Writes nothing."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from gainsay.errors import InputError
from gainsay.results.listing import damage
from gainsay.results.returned import STEPS
from gainsay.steps.compare import compared
from gainsay.steps.verdicts import judged
from gainsay.tables import Case
from gainsay.tables.files import Table, csv_text, read_text
from gainsay.verdicts.differences import Difference
from gainsay.verdicts.joined import joined

#: steps whose files a paper's results consist of
LISTED = (*STEPS, "verdicts", "compare", "page")


def file_differences(case: Case) -> Iterator[Difference]:
    """Yield every file of a paper that is not as its step left it."""
    for step in LISTED:
        for file, how in damage(case.results / "parts" / f"{step}.files.csv", case.results):
            yield case.name, "file", file, "as the step left it", how, f"made by the step {step}"


def altered(folder: Path, tables: Mapping[str, Table]) -> Iterator[str]:
    """Yield the file of every table that does not follow from the results beside it."""
    for name, (columns, rows) in tables.items():
        if read_text(folder / f"{name}.csv") != csv_text(columns, rows):
            yield f"{name}.csv"


def _not_following(name: str, folder: Path, tables: Mapping[str, Table]) -> Iterator[Difference]:
    """A table that was altered together with the list that names it, or made by code of another day."""
    for file in altered(folder, tables):
        yield (
            name,
            "file",
            file,
            "what follows from the results",
            "does not follow",
            "altered together with its list, or made by other code",
        )


def derived_differences(case: Case, *, whole: bool) -> Iterator[Difference]:
    """Judge a paper again and yield every certificate that is refused, and every table that does not follow.

    Parameters
    ----------
    case : Case
    whole : bool
        Whether every file is as its step left it; else `file_differences` says what is not, and nothing follows.
    """
    tables, evidence = judged(case)
    for name, reason in evidence.refused.items():
        yield case.name, "certificate", name, "accepted", "refused", reason
    if whole:
        yield from _not_following(case.name, case.results, tables)


def record_differences(case: Case, *, whole: bool) -> Iterator[Difference]:
    """Yield all of a paper that is not as on record, and every table of that which does not follow."""
    tables = compared(case)
    for paper, what, item, expected, found, note in tables["differences"][1]:
        yield str(paper), str(what), str(item), str(expected), str(found), str(note)
    if whole:
        yield from _not_following(case.name, case.results, tables)


def shared_differences(cases: Sequence[Case]) -> Iterator[Difference]:
    """Yield every file over all papers that is not as the report left it, or not that of the papers."""
    root = cases[0].root
    damaged = dict(damage(root / "results" / "report.files.csv", root / "results"))
    for file, how in damaged.items():
        yield "all papers", "file", file, "as the step left it", how, "made by the step report"
    if not damaged:
        yield from _not_following("all papers", root / "results", joined(cases))


def check(cases: Sequence[Case]) -> list[Difference]:
    """Return all that keeps the results of some papers from being clean.

    Parameters
    ----------
    cases : sequence of Case

    Raises
    ------
    InputError
        If nothing of a paper was computed. A results table that is missing or malformed is a difference of its paper.
    """
    differing_rows: list[Difference] = []
    for case in cases:
        own: dict[Difference, None] = dict.fromkeys(file_differences(case))
        whole = not own
        for part in (derived_differences, record_differences):
            try:
                own |= dict.fromkeys(part(case, whole=whole))
            except InputError as error:
                if not (case.results / "parts").is_dir():
                    raise InputError(
                        "nothing computed yet", file=f"results/{case.name}", expected="a run of `snakemake --cores 2`"
                    ) from None
                file = str(error.file).removeprefix(f"results/{case.name}/")
                own[case.name, "file", file, "as the step left it", "damaged", str(error)] = None
        differing_rows += own
    return differing_rows
