"""The pages themselves: one over all papers, and one for each paper that can be attached to it."""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
from markupsafe import Markup, escape

from gainsay import __version__
from gainsay.report.campaigns import CampaignView, campaign_views
from gainsay.report.claims import AGAINST, NONE_YET, ORDER, QuantityView, Verdicts, quantity_view, verdicts_of
from gainsay.report.designs import Comparison, DesignView, comparisons, design_views
from gainsay.report.numbers import typeset, unit
from gainsay.report.pictures import data_uri
from gainsay.report.provenance import Provenance, provenance_of, provenance_over
from gainsay.report.published import PublishedView, counts_of, published_view
from gainsay.report.reading import FigureFile, PaperResults
from gainsay.report.sentences import formula, name, plain_text, said
from gainsay.tables.files import write_atomically
from gainsay.verdicts.published import record_sentence

#: claims that the page over all papers names of each
MOST_CLAIMS = 6
#: tables that stand inside the page of a paper
TABLES_INSIDE = ("published", "verdicts", "quantities")
#: templates, style sheet and captions
FOLDER = Path(__file__).resolve().parent / "templates"
_ID = re.compile(r"[^A-Za-z0-9_.-]")
#: what an id cannot stand in, or what looks like one: words joined by dots, dashes and underscores
_MARKED_OR_ID = re.compile(r"<(math|code)>.*?</\1>|<[^>]*>|&\w+;|[A-Za-z]\w*(?:[-.]\w+|_\w+)+|[a-z]+_\w+", re.DOTALL)


def _anchor(identifier: str) -> str:
    return _ID.sub("-", identifier)


@dataclass(frozen=True)
class PaperPage:
    """A paper as the templates see it."""

    results: PaperResults
    verdicts: Verdicts
    published: PublishedView
    quantities: tuple[QuantityView, ...]
    comparisons: tuple[Comparison, ...]
    designs: tuple[DesignView, ...]

    @property
    def case(self) -> Any:
        """The paper's tables."""
        return self.results.case

    @property
    def finding(self) -> str:
        """What was found, in two sentences."""
        return " ".join(self.case.paper.finding)

    @property
    def record(self) -> str:
        """A sentence on what differs from the record."""
        sentence = record_sentence([tuple(row.values()) for row in self.results.differences]).removeprefix("record: ")
        return f"{sentence[:1].upper()}{sentence[1:]}."

    @property
    def accepted(self) -> int:
        """How many certificates the checker accepts."""
        return sum(certificate.accepted for certificate in self.results.certificates.values())

    @property
    def faith(self) -> list[str]:
        """Sentences on faith that all readable certificates share."""
        readable = [c.faith for c in self.results.certificates.values() if c.faith]
        return [sentence for sentence in (readable[0] if readable else ()) if all(sentence in c for c in readable)]

    @cached_property
    def notation(self) -> list[tuple[Markup, Markup]]:
        """Symbols of the certificates' formulas with what they stand for, each pair once."""
        pairs = dict.fromkeys(pair for c in self.results.certificates.values() for pair in c.definitions)
        return [(name(symbol), formula(text)) for symbol, text in sorted(pairs)]

    @cached_property
    def tables(self) -> dict[str, str]:
        """The tables for machines as data links, so that a page that is mailed has them too."""
        files = {f"{table}.csv": self.case.results / f"{table}.csv" for table in TABLES_INSIDE}
        return {
            file: f"data:text/csv;charset=utf-8,{quote(path.read_text(encoding='utf-8'), safe=' ,.;:/()=+-_')}"
            for file, path in files.items()
            if path.is_file()
        }

    @cached_property
    def campaigns(self) -> tuple[CampaignView, ...]:
        """The campaigns that have been computed."""
        return campaign_views(self.case, self.results.campaigns)

    @cached_property
    def _places(self) -> dict[str, str]:
        """Where on the page each claim, quantity, certificate and assumed input stands, by its id."""
        named = {
            "input": self.case.assumed,
            "quantity": self.case.quantities,
            "certificate": self.results.certificates,
            "claim": self.case.claims,
        }
        return {id: f"{self.case.name}-{sort}-{_anchor(id)}" for sort, ids in named.items() for id in ids}

    def linked(self, sentence: str) -> Markup:
        """Return a sentence with its mathematics typeset, in which each id leads to what it stands for."""

        def shown(match: re.Match[str]) -> str:
            place = self._places.get(match[0])
            if place is None:
                return match[0]
            return f'<a href="#{place}">{match[0].replace("_", " ") if match[0] in self.case.assumed else match[0]}</a>'

        return Markup(_MARKED_OR_ID.sub(shown, str(said(sentence))))

    @property
    def provenance(self) -> Provenance:
        """Digests of what went in, versions of what computed."""
        return provenance_of(self.results)

    def picture(self, figure: FigureFile) -> Markup:
        """Return a figure as a data URI for an attribute in double quotes, which it holds none of."""
        folder = self.case.results
        uri = data_uri(folder / figure.file, folder / figure.print_file if figure.print_file else None)
        return Markup(uri.replace("&", "&amp;"))  # angle brackets may stand in an attribute, and are a tenth of a page

    def decided_by(self, parameter: str) -> list[str]:
        """Claims whose scan turns at a parameter that the paper leaves out."""
        return [c for c, scan in self.results.scans.items() if scan.boundary and scan.boundary.input == parameter]

    def scanned(self, parameter: str) -> bool:
        """Whether some claim was evaluated over the plausible values of a parameter."""
        return any(parameter == entry.name for scan in self.results.scans.values() for entry in scan.inputs)

    def bears_on(self, certificate: str) -> list[str]:
        """Claims that rest on a certificate."""
        return [view.claim.id for view in self.verdicts.claims if certificate in view.row["certificate"].split()]

    def witnesses(self, text: str) -> list[tuple[str, QuantityView | None, Any]]:
        """Split the witnesses of an erratum into quantities and certificates."""
        known = {view.id: view for view in self.quantities}
        return [(name, known.get(name), self.results.certificates.get(name)) for name in text.split()]


def paper_page(results: PaperResults) -> PaperPage:
    """Work out everything that the templates show of a paper."""
    return PaperPage(
        results=results,
        verdicts=verdicts_of(results),
        published=published_view(results),
        quantities=tuple(quantity_view(results, quantity) for quantity in results.case.quantities),
        comparisons=comparisons(results),
        designs=design_views(results.case),
    )


def _decimal(text: str) -> Markup:
    """Typeset a parameter's value where it is a number, also a plausible range of numbers."""
    low, dots, high = text.partition("..")
    if dots:
        return Markup("{} to {}").format(typeset(low), typeset(high))
    return Markup(", ").join(typeset(part) for part in text.split("|"))


def _symbol(parameter: str) -> Markup:
    """Return the name of a table entry: words as words, a symbol typeset."""
    return (
        name(parameter)
        if re.fullmatch(r"[A-Za-z]{1,2}\d*(_[A-Za-z])?|[a-z]+\d+|gamma|mu", parameter)
        else escape(parameter.replace("_", " "))
    )


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
        said=said,
        formula=formula,
        plain=plain_text,
        url=quote,
        symbol=_symbol,
        anchor=_anchor,
    )
    environment.globals.update(
        ORDER=ORDER,
        NONE_YET=NONE_YET,
        AGAINST=AGAINST,
        MOST=MOST_CLAIMS,
        version=__version__,
        style=Markup((FOLDER / "style.css").read_text(encoding="utf-8")),
        words=tomllib.loads((FOLDER / "captions.toml").read_text(encoding="utf-8")),
    )
    return environment


def render_index(root: Path, papers: Sequence[PaperResults]) -> str:
    """Return the page over all papers, which stands in `results/`: what was found, a screen a paper."""
    differences = [tuple(row.values()) for results in papers for row in results.differences]
    pages = [paper_page(results) for results in papers]
    return (
        _environment()
        .get_template("index.html.j2")
        .render(
            papers=pages,
            used=[verdict for verdict in ORDER if any(page.verdicts.counts.get(verdict) is not None for page in pages)],
            outcomes=counts_of([row for results in papers for row in results.published]),
            differences=differences,
            record=record_sentence(differences),
            provenance_of_all=provenance_over(root, papers),
            gallery=(root / "results" / "gallery.html").is_file(),
        )
    )


def render_paper(results: PaperResults) -> str:
    """Return the page of one paper, which needs nothing beside itself."""
    return _environment().get_template("paper.html.j2").render(p=paper_page(results))


def write_paper(results: PaperResults) -> Path:
    """Write the page of a paper and return its path."""
    path = results.case.results / "index.html"
    write_atomically(path, render_paper(results))
    return path


def write_index(root: Path, papers: Sequence[PaperResults]) -> Path:
    """Write the page over all papers and return its path."""
    path = root / "results" / "index.html"
    write_atomically(path, render_index(root, papers))
    return path
