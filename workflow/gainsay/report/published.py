"""The published numbers as a page shows them: gains as the matrices they are, everything else a row each."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from gainsay.report.numbers import digits_apart, number, shorten, span, typeset, with_unit
from gainsay.report.reading import PaperResults, Row
from gainsay.tables.models import VERDICTS
from gainsay.verdicts.published import LINES

__all__ = ["EntryView", "GainView", "NumberView", "PublishedView", "counts_of", "published_view"]

_PLACE = re.compile(r"(?P<gain>.+)\((?P<row>\d+),(?P<column>\d+)\)")
_POLE = re.compile(r"(?P<set>.+) (?P<pole>\S+) (?P<part>\S+)")
#: how a difference in units of the last printed digit is written
_DIGITS_OF_DIFFERENCE = 2
#: columns that stand even where they are empty
ALWAYS = VERDICTS[:3]


@dataclass(frozen=True)
class EntryView:
    """An entry of a printed gain."""

    place: str
    published: Markup
    recomputed: Markup
    range: Markup
    difference: Markup
    identified: str
    verdict: str


@dataclass(frozen=True)
class GainView:
    """A printed gain: its entries in rows, and how many came out how."""

    name: str
    rows: tuple[tuple[EntryView, ...], ...]
    counts: Mapping[str, int]

    @property
    def entries(self) -> list[EntryView]:
        """All entries, row after row."""
        return [entry for row in self.rows for entry in row]


@dataclass(frozen=True)
class NumberView:
    """A published number that is not an entry of a gain."""

    sort: str
    claim: str
    about: str
    published: Markup
    recomputed: Markup
    difference: Markup
    verdict: str


@dataclass(frozen=True)
class PublishedView:
    """All published numbers of a paper."""

    gains: tuple[GainView, ...]
    numbers: tuple[NumberView, ...]
    counts: Mapping[str, Mapping[str, int]]

    @property
    def total(self) -> int:
        """How many numbers the paper publishes."""
        return sum(sum(counts.values()) for counts in self.counts.values())


def counts_of(rows: Sequence[Row]) -> dict[str, dict[str, int]]:
    """Count outcomes for each sort of published number, in the order of the summary that `make` prints.

    Outcomes that no number has are left out but for those that a reader looks for.
    """
    counted = {what: Counter(row["verdict"] for row in rows if row["what"] == what) for what in LINES}
    some = [o for o in VERDICTS if o in ALWAYS or any(counts[o] for counts in counted.values())]
    return {LINES[what]: {outcome: counts[outcome] for outcome in some} for what, counts in counted.items() if counts}


def _difference(text: str) -> Markup:
    """Return a difference in units of the last printed digit, with its sign."""
    if not text:
        return Markup("")
    shown = typeset(shorten(text, _DIGITS_OF_DIFFERENCE))
    sign = "+" if not text.startswith("-") and shown != "0" else ""
    return Markup('<data value="{0}" title="{0}">{1}{2}</data>').format(text, sign, shown)


def _recomputed(row: Row) -> Markup:
    if row["recomputed"]:
        _, _, power = row["published"].lower().partition("e")
        exponent = int(power) if re.fullmatch(r"[+-]?\d+", power) else None
        digits = digits_apart(row["recomputed"], [row["published"]]) if row["verdict"] != "reproduced" else 6
        return number(row["recomputed"], digits=digits, power=exponent)
    return span(row["low"], row["high"])


def _entry(place: str, row: Row) -> EntryView:
    return EntryView(
        place=place,
        published=typeset(row["published"]),
        recomputed=_recomputed(row),
        range=span(row["low"], row["high"]) if row["low"] != row["high"] else Markup(""),
        difference=_difference(row["units_of_last_digit"]),
        identified={"1": "yes", "0": "no"}.get(row["identified"], ""),
        verdict=row["verdict"],
    )


def _gains(rows: Sequence[Row]) -> tuple[GainView, ...]:
    gains: dict[str, dict[int, dict[int, EntryView]]] = {}
    for row in rows:
        place = _PLACE.fullmatch(row["entry"])
        if row["what"] == "gain" and place:
            at = f"{place['row']}, {place['column']}"
            lines = gains.setdefault(place["gain"], {})
            lines.setdefault(int(place["row"]), {})[int(place["column"])] = _entry(at, row)
    views = []
    for name, lines in gains.items():
        shown = tuple(tuple(line[column] for column in sorted(line)) for _, line in sorted(lines.items()))
        counted = Counter(entry.verdict for line in shown for entry in line)
        views.append(GainView(name, shown, {outcome: counted[outcome] for outcome in VERDICTS if counted[outcome]}))
    return tuple(views)


def _about(results: PaperResults, row: Row) -> str:
    claim = results.case.claims.get(row["claim"])
    if claim is not None:
        return claim.statement
    pole = _POLE.fullmatch(row["entry"])
    if row["what"] == "pole" and pole:
        return f"{pole['set'].replace('_', ' ')}, pole {pole['pole']}, {pole['part']} part"
    return row["entry"]


def _published(results: PaperResults, row: Row) -> Markup:
    claim = results.case.claims.get(row["claim"])
    low, dots, high = row["published"].partition("..")
    shown = Markup("{} to {}").format(typeset(low), typeset(high)) if dots else typeset(low)
    sign = {"at_most": "≤\u00a0", "at_least": "≥\u00a0"}.get(claim.comparator if claim else "", "")
    return with_unit(sign + shown, row["unit"])


def published_view(results: PaperResults) -> PublishedView:
    """Return the published numbers of a paper in the order of published.csv."""
    rows = results.published
    numbers = tuple(
        NumberView(
            sort=row["what"],
            claim=row["claim"],
            about=_about(results, row),
            published=_published(results, row),
            recomputed=with_unit(_recomputed(row), row["unit"]),
            difference=_difference(row["units_of_last_digit"]),
            verdict=row["verdict"],
        )
        for row in rows
        if not (row["what"] == "gain" and _PLACE.fullmatch(row["entry"]))
    )
    return PublishedView(_gains(rows), numbers, counts_of(rows))
