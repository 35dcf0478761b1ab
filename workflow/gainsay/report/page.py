"""The pages themselves: one over all papers, and one for each paper that can be attached to it."""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
from markupsafe import Markup, escape

from gainsay import __version__
from gainsay.report.claims import NONE_YET, ORDER, QuantityView, Verdicts, quantity_view, verdicts_of
from gainsay.report.designs import Comparison, GainEntry, comparisons, design_matrices, gain_entries
from gainsay.report.numbers import typeset, unit
from gainsay.report.reading import PaperResults
from gainsay.tables.files import write_atomically

#: templates, style sheet and captions
FOLDER = Path(__file__).resolve().parent / "templates"
_ID = re.compile(r"[^A-Za-z0-9_.-]")


@dataclass(frozen=True)
class PaperPage:
    """A paper as the templates see it."""

    found: PaperResults
    verdicts: Verdicts
    quantities: tuple[QuantityView, ...]
    gains: dict[str, list[GainEntry]]
    comparisons: list[Comparison]
    matrices: dict[str, list[tuple]]

    @property
    def case(self) -> Any:
        """The paper's tables."""
        return self.found.case

    def decided_by(self, parameter: str) -> list[str]:
        """Claims whose scan turns at a parameter that the paper leaves out."""
        return [c for c, scan in self.found.scans.items() if scan.boundary and scan.boundary.input == parameter]

    def scanned(self, parameter: str) -> bool:
        """Whether some claim was evaluated over the plausible values of a parameter."""
        return any(parameter == entry.name for scan in self.found.scans.values() for entry in scan.inputs)

    def bears_on(self, certificate: str) -> list[str]:
        """Claims that rest on a certificate."""
        return [view.claim.id for view in self.verdicts.claims if certificate in view.row["certificate"].split()]

    def witnesses(self, text: str) -> list[tuple[str, QuantityView | None, Any]]:
        """Split the witnesses of an erratum into quantities and certificates."""
        known = {view.id: view for view in self.quantities}
        return [(name, known.get(name), self.found.certificates.get(name)) for name in text.split()]


def paper_page(found: PaperResults) -> PaperPage:
    """Work out everything that the templates show of a paper."""
    return PaperPage(
        found=found,
        verdicts=verdicts_of(found),
        quantities=tuple(quantity_view(found, quantity) for quantity in found.case.quantities),
        gains=gain_entries(found),
        comparisons=comparisons(found),
        matrices={design.name: design_matrices(found, design) for design in found.designs},
    )


def _decimal(text: str) -> Markup:
    """Typeset a parameter's value where it is a number, also a plausible range of numbers."""
    low, dots, high = text.partition("..")
    if dots:
        return Markup("{} to {}").format(typeset(low), typeset(high))
    return Markup(", ").join(typeset(part) for part in text.split("|"))


def _breakable(identifier: str) -> Markup:
    """Allow a line to break after the dots, dashes and underscores of an identifier."""
    return Markup(re.sub(r"([._-])(?=.)", r"\1<wbr>", str(escape(identifier))))


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(FOLDER),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(
        unit=unit,
        decimal=_decimal,
        breakable=_breakable,
        url=quote,
        anchor=lambda identifier: _ID.sub("-", identifier),
    )
    environment.globals.update(
        ORDER=ORDER,
        NONE_YET=NONE_YET,
        version=__version__,
        style=Markup((FOLDER / "style.css").read_text(encoding="utf-8")),
        words=tomllib.loads((FOLDER / "captions.toml").read_text(encoding="utf-8")),
    )
    return environment


def render_index(papers: Sequence[PaperResults]) -> str:
    """Return the page over all papers, which stands in `results/`."""
    return _environment().get_template("index.html.j2").render(papers=[paper_page(found) for found in papers])


def render_paper(found: PaperResults) -> str:
    """Return the page of one paper, which stands in `results/<paper>/` and needs nothing outside that folder."""
    return _environment().get_template("paper.html.j2").render(p=paper_page(found))


def write_paper(found: PaperResults) -> Path:
    """Write the page of a paper and return its path."""
    path = found.case.results / "index.html"
    write_atomically(path, render_paper(found))
    return path


def write_index(root: Path, papers: Sequence[PaperResults]) -> Path:
    """Write the page over all papers and return its path."""
    path = root / "results" / "index.html"
    write_atomically(path, render_index(papers))
    return path
