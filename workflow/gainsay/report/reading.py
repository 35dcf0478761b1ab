"""What the steps left of a paper, read for the page: what is missing is said, never an error."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from gainsay.errors import InputError
from gainsay.report.certificates import CertificateFile, read_certificate
from gainsay.tables import Case
from gainsay.tables.files import read_csv, read_text, shown
from gainsay.tables.results import FAILURE_COLUMNS, GAIN_COLUMNS, QUANTITY_COLUMNS
from gainsay.verdicts.differences import DIFFERENCE_COLUMNS
from gainsay.verdicts.outcome import Outcome, outcomes, read_scans
from gainsay.verdicts.published import PUBLISHED_COLUMNS
from gainsay.verdicts.table import VERDICT_COLUMNS

CERTIFICATE_COLUMNS = ("certificate", "accepted", "says")
_SIZE = re.compile(r'<svg\b[^>]*?\bwidth="([\d.]+)[a-z]*"[^>]*?\bheight="([\d.]+)[a-z]*"', re.DOTALL)
_SIZE_REVERSED = re.compile(r'<svg\b[^>]*?\bheight="([\d.]+)[a-z]*"[^>]*?\bwidth="([\d.]+)[a-z]*"', re.DOTALL)

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
    """A figure, the runs it is drawn from (None where not known) and its size in CSS pixels."""

    name: str
    caption: str
    runs: tuple[str, ...] | None
    file: str
    print_file: str
    width: int = 0
    height: int = 0


@dataclass(frozen=True)
class DesignFile:
    """A design that the synthesis made; matrices None where it did not."""

    name: str
    about: str
    note: str = ""
    matrices: Mapping[str, Sequence[Sequence[float]]] | None = None


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
    figures, runs, designs : list
    missing : list of str
        A sentence for each result file that is not there.
    code : tuple of str
        Source files behind the results, below the project root.
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
    designs: list[DesignFile] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    code: tuple[str, ...] = ()

    def existing(self, file: str) -> str:
        """Return a path below the paper's results where such a file exists, else nothing."""
        inside = bool(file) and ".." not in Path(file).parts and not Path(file).is_absolute()
        return file if inside and (self.case.results / file).is_file() else ""


def _table(found: PaperResults, name: str, columns: Sequence[str], lost: str) -> list[Row]:
    path = found.case.results / f"{name}.csv"
    if not path.is_file():
        found.missing.append(f"{name}.csv is missing: {lost}")
        return []
    header, rows = read_csv(path, found.case.root)
    if tuple(header) != tuple(columns):
        raise InputError(
            "header", file=shown(path, found.case.root), row=1, value=",".join(header), expected=",".join(columns)
        )
    return [dict(zip(columns, cells, strict=True)) for _, cells in rows]


def _size(path: Path) -> tuple[int, int]:
    """Width and height of an SVG in CSS pixels (its lengths are points), so that a page does not jump as it loads."""
    with path.open(encoding="utf-8", errors="replace") as file:
        head = file.read(4000)
    match, reverse = _SIZE.search(head), _SIZE_REVERSED.search(head)
    if match is None and reverse is None:
        return 0, 0
    width, height = match.groups() if match else reverse.groups()[::-1]
    return round(float(width) * 4 / 3), round(float(height) * 4 / 3)


def _pictures(found: PaperResults, figure_runs: Mapping[str, Sequence[str]] | None) -> None:
    paper = found.case.paper
    for name, caption in paper.figures.items():
        file = found.existing(f"figures/{name}.svg")
        width, height = _size(found.case.results / file) if file else (0, 0)
        drawn_from = None if figure_runs is None or name not in figure_runs else tuple(figure_runs[name])
        found.figures.append(
            FigureFile(name, caption, drawn_from, file, found.existing(f"figures/{name}.png"), width, height)
        )
    for name, about in paper.runs.items():
        files = [found.existing(f"logs/{name}.{ending}") for ending in ("mcap", "rrd", "foxglove.json")]
        shown_in = tuple(figure.name for figure in found.figures if name in (figure.runs or ()))
        found.runs.append(RunFiles(name, about, *files, shown_in))


def _designs(found: PaperResults) -> None:
    for name, about in found.case.paper.designs.items():
        file = found.existing(f"designs/{name}.json")
        if not file:
            found.designs.append(DesignFile(name, about))
            continue
        content = json.loads(read_text(found.case.results / file, found.case.root))
        found.designs.append(DesignFile(name, about, content["note"], content["matrices"]))


def read_results(
    case: Case, figure_runs: Mapping[str, Sequence[str]] | None = None, code: Sequence[str] = ()
) -> PaperResults:
    """Read everything that the page says of a paper.

    Parameters
    ----------
    case : Case
    figure_runs : mapping of figure to runs, optional
        The runs that each figure is drawn from; None where not known.
    code : sequence of str, optional
        Source files behind the results.

    Raises
    ------
    InputError
        If a results table is malformed.
    """
    found = PaperResults(case, code=tuple(code))
    found.verdicts = {row["claim"]: row for row in _table(found, "verdicts", VERDICT_COLUMNS, "no claim is judged yet")}
    rows = _table(found, "quantities", QUANTITY_COLUMNS, "no number is computed yet")
    found.quantities = {row["quantity"]: row for row in rows}
    found.gains = _table(found, "gains", GAIN_COLUMNS, "the gains are not compared yet")
    found.failures = _table(found, "failures", FAILURE_COLUMNS, "whether a computation broke is not known")
    rows = _table(found, "certificates", CERTIFICATE_COLUMNS, "no certificate is checked yet")
    found.certificates = {row["certificate"]: read_certificate(case, row) for row in rows}
    found.published = _table(found, "published", PUBLISHED_COLUMNS, "published numbers are not compared yet")
    found.differences = _table(found, "differences", DIFFERENCE_COLUMNS, "nothing is held against the record yet")
    found.scans = outcomes(case, read_scans((case.results / "scans").glob("*.json"), case.root))
    _pictures(found, figure_runs)
    _designs(found)
    return found
