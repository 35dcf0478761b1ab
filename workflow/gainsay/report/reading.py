"""What the steps left of a paper, read for the page: what is missing is said, never an error."""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gainsay.errors import InputError
from gainsay.report.certificates import CertificateFile, read_certificate
from gainsay.results.returned import read_returned
from gainsay.scans.outcome import Outcome, outcomes, read_scans
from gainsay.tables import Case
from gainsay.verdicts.differences import DIFFERENCE_COLUMNS
from gainsay.verdicts.published import PUBLISHED_COLUMNS

_LENGTH = r'="(\d+(?:\.\d+)?)[a-z]*"'
_SIZE = re.compile(rf"<svg\b[^>]*?\bwidth{_LENGTH}[^>]*?\bheight{_LENGTH}", re.DOTALL)
_SOURCE = re.compile(r"<dc:source>([^<]*)</dc:source>")
_SIZE_REVERSED = re.compile(rf"<svg\b[^>]*?\bheight{_LENGTH}[^>]*?\bwidth{_LENGTH}", re.DOTALL)

Row = Mapping[str, str]


@dataclass(frozen=True)
class RunFiles:
    """A simulated run: its log and views, below the paper's results; empty where missing."""

    name: str
    about: str
    log: str
    recording: str
    foxglove: str
    figures: tuple[str, ...] = ()


@dataclass(frozen=True)
class FigureFile:
    """A figure, the runs it is drawn from (None where it does not say) and its size in CSS pixels."""

    name: str
    caption: str
    runs: tuple[str, ...] | None
    file: str
    print_file: str
    width: int = 0
    height: int = 0


@dataclass
class PaperResults:
    """Tables and result files of a paper, as far as they exist.

    Attributes
    ----------
    case : Case
    verdicts : dict of claim to row
    quantities : dict of quantity to row
    gains, failures, published : list of row
    differences : list of row
        What differs from the record.
    certificates : dict of id to CertificateFile
    scans : dict of claim to Outcome
    figures, runs : list
    missing : list of str
        A sentence for each result file that is not there.
    code : tuple of str
        Source files behind the results, below the project root.
    campaigns : dict of name to text
        Today's digest of all that the results of each gathered campaign depend on.
    """

    case: Case
    verdicts: dict[str, Row] = field(default_factory=dict)
    quantities: dict[str, Row] = field(default_factory=dict)
    gains: list[Row] = field(default_factory=list)
    failures: list[Row] = field(default_factory=list)
    published: list[Row] = field(default_factory=list)
    differences: list[Row] = field(default_factory=list)
    certificates: dict[str, CertificateFile] = field(default_factory=dict)
    scans: dict[str, Outcome] = field(default_factory=dict)
    figures: list[FigureFile] = field(default_factory=list)
    runs: list[RunFiles] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    code: tuple[str, ...] = ()
    campaigns: Mapping[str, str] = field(default_factory=dict)

    def existing(self, file: str) -> str:
        """Return a path below the paper's results where such a file exists, else nothing."""
        inside = bool(file) and ".." not in Path(file).parts and not Path(file).is_absolute()
        return file if inside and os.path.isfile(self.case.results / file) else ""  # noqa: PTH113  # has an answer for every name


def _table(results: PaperResults, name: str, lost: str, columns: Sequence[str] = ()) -> list[Row]:
    path = results.case.results / f"{name}.csv"
    if not os.path.lexists(path):
        results.missing.append(f"{name}.csv is missing: {lost}")
        return []
    try:
        return [*read_returned(path, results.case.root, columns)]
    except InputError as error:
        results.missing.append(f"{name}.csv is damaged, {lost}: {error}")
        return []


def _size(head: str) -> tuple[int, int]:
    """Width and height of an SVG in CSS pixels (its lengths are points), so that a page does not jump as it loads."""
    match, reverse = _SIZE.search(head), _SIZE_REVERSED.search(head)
    width, height = match.groups() if match else reverse.groups()[::-1] if reverse else ("0", "0")
    return round(float(width) * 4 / 3), round(float(height) * 4 / 3)


def _drawn_from(head: str) -> tuple[str, ...] | None:
    """Runs whose logs an SVG names as its source, or None where it names none."""
    match = _SOURCE.search(head)
    return (
        None if match is None else tuple(Path(file).stem for file in match[1].split(", ") if file.startswith("logs/"))
    )


def _pictures(results: PaperResults) -> None:
    paper = results.case.paper
    for name, caption in paper.figures.items():
        file, head = results.existing(f"figures/{name}.svg"), ""
        if file:
            with (results.case.results / file).open(encoding="utf-8", errors="replace") as svg:
                head = svg.read(4000)
        results.figures.append(
            FigureFile(name, caption, _drawn_from(head), file, results.existing(f"figures/{name}.png"), *_size(head))
        )
    for name, about in paper.runs.items():
        log, view, layout = (results.existing(f"logs/{name}.{ending}") for ending in ("mcap", "rrd", "foxglove.json"))
        shown_in = tuple(figure.name for figure in results.figures if name in (figure.runs or ()))
        results.runs.append(RunFiles(name, about, log, view, layout, shown_in))


def _scans(results: PaperResults) -> None:
    scans: dict[str, dict[str, Any]] = {}
    for path in sorted((results.case.results / "scans").glob("*.json")):
        try:
            scans |= read_scans([path], results.case.root)
        except InputError as error:
            results.missing.append(f"scans/{path.name} is damaged: {error}")
    results.scans = outcomes(results.case, scans)


def read_results(
    case: Case,
    code: Sequence[str] = (),
    campaigns: Mapping[str, str] | None = None,
) -> PaperResults:
    """Read everything that the page says of a paper.

    Parameters
    ----------
    case : Case
    code : sequence of str, optional
        Source files behind the results.
    campaigns : mapping of name to text, optional
        Today's digest of each gathered campaign; without it none is shown.

    Returns
    -------
    PaperResults
        Whatever can be read; a file that is damaged costs what it held and nothing else.
    """
    results = PaperResults(case, code=tuple(code), campaigns=campaigns or {})
    results.verdicts = {row["claim"]: row for row in _table(results, "verdicts", "no claim is judged yet")}
    rows = _table(results, "quantities", "no number is computed yet")
    results.quantities = {row["quantity"]: row for row in rows}
    results.gains = _table(results, "gains", "the gains are not compared yet")
    results.failures = _table(results, "failures", "whether a computation broke is not known")
    rows = _table(results, "certificates", "no certificate is checked yet")
    results.certificates = {row["certificate"]: read_certificate(case, row) for row in rows}
    results.published = _table(results, "published", "published numbers are not compared yet", PUBLISHED_COLUMNS)
    results.differences = _table(results, "differences", "nothing is held against the record yet", DIFFERENCE_COLUMNS)
    _scans(results)
    _pictures(results)
    return results
