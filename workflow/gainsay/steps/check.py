"""The last word: files as they were left, certificates checked again, everything as on record. Writes nothing."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from gainsay.errors import InputError
from gainsay.results.listing import damage
from gainsay.results.returned import STEPS
from gainsay.tables import Case
from gainsay.verdicts.differences import Difference, differences
from gainsay.verdicts.evidence import read_evidence

#: steps whose files a paper's results consist of
LISTED = (*STEPS, "verdicts", "compare", "page")


def file_differences(case: Case) -> Iterator[Difference]:
    """Yield every file of a paper that is not as its step left it."""
    for step in LISTED:
        for file, how in damage(case.results / "parts" / f"{step}.files.csv", case.results):
            yield case.name, "file", file, "as the step left it", how, f"made by the step {step}"


def certificate_differences(case: Case) -> Iterator[Difference]:
    """Check every certificate of a paper again and yield those that are refused."""
    for name, reason in read_evidence(case).refused.items():
        yield case.name, "certificate", name, "accepted", "refused", reason


def shared_differences(root: Path) -> Iterator[Difference]:
    """Yield every file over all papers that is not as the report left it."""
    for file, how in damage(root / "results" / "report.files.csv", root / "results"):
        yield "all papers", "file", file, "as the step left it", how, "made by the step report"


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
        own: dict[Difference, None] = {}
        for part in (file_differences, certificate_differences, differences):
            try:
                own |= dict.fromkeys(part(case))
            except InputError as error:
                if not (case.results / "parts").is_dir():
                    raise InputError(
                        "nothing computed yet", file=f"results/{case.name}", expected="a run of `snakemake --cores 2`"
                    ) from None
                file = str(error.file).removeprefix(f"results/{case.name}/")
                own[case.name, "file", file, "as the step left it", "damaged", str(error)] = None
        differing_rows += own
    return differing_rows
