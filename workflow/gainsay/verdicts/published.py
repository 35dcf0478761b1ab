"""Every number that a paper publishes, beside the one recomputed: the first table that a reader looks for."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction

from gainsay.errors import InputError
from gainsay.exact.digits import PrintedNumber
from gainsay.results.returned import read_returned
from gainsay.tables import Case
from gainsay.tables.files import cell
from gainsay.tables.models import Claim
from gainsay.verdicts.table import outcomes

PUBLISHED_COLUMNS = (
    "paper",
    "claim",
    "what",
    "entry",
    "published",
    "recomputed",
    "unit",
    "low",
    "high",
    "units_of_last_digit",
    "identified",
    "verdict",
)
#: kind of claim -> what its published number is; other kinds say something without a number of their own
WHAT = {
    "parameter": "parameter",
    "gain": "gain",
    "pole-region": "pole",
    "norm-bound": "norm",
    "cost-bound": "bound",
    "input-bound": "bound",
    "delay-margin": "bound",
    "trajectory": "response",
}
#: what -> the word of its line in the summary, in the order of the lines
LINES = {
    "gain": "gains",
    "pole": "poles",
    "norm": "norms",
    "bound": "bounds",
    "response": "responses",
    "parameter": "parameters",
}
_NOUNS = {
    "quantity": "number",
    "failure": "failed computation",
    "erratum": "erratum's witness",
    "published": "published number",
}

#: what `gainsay record` puts on record
_RECORDED = ("quantity", "scan", "input", "certificate", "published")

Row = Mapping[str, str]


def units_of_last_digit(published: str, recomputed: float) -> float:
    """Return how far a number lies from the printed one, in units of its last printed digit.

    Examples
    --------
    >>> units_of_last_digit("1.50", 1.53)
    3.0
    """
    printed = PrintedNumber(published)
    return round(float((Fraction(recomputed) - printed.value) / (2 * printed.half_unit)), 9)


def _row(case: Case, **cells: object) -> dict[str, str]:
    filled: dict[str, object] = {"paper": case.name, **cells}
    published, recomputed = str(cells["published"]), cells.get("recomputed")
    if isinstance(recomputed, float):
        with suppress(InputError):  # a range has no last digit of its own
            filled["units_of_last_digit"] = units_of_last_digit(published, recomputed)
    return {column: cell(filled.get(column)) for column in PUBLISHED_COLUMNS}


def _number(text: str) -> float | None:
    return float(text) if text else None


def _entry_verdict(low: float, high: float, rounding: tuple[float, float], identified: bool) -> str:
    """Judge an entry of a gain that is synthesised again.

    Where the program determines the entry and near-optimal solutions round to it, it is reproduced. Else the printed
    digits are one of many solutions, or belong to another program than the one we could read out of the paper: the
    text does not decide, and neither do we.
    """
    meets = low <= rounding[1] and rounding[0] <= high
    return "reproduced" if identified and meets else "undetermined"


def _gain_rows(case: Case) -> Iterator[dict[str, str]]:
    for row in read_returned(case.results / "gains.csv", case.root):
        value = _number(row["resynthesised"])
        low = _number(row["range_low"]) if row["range_low"] else value
        high = _number(row["range_high"]) if row["range_high"] else value
        verdict = "uncheckable"
        if value is not None and low is not None and high is not None:
            rounding = float(row["rounding_low"]), float(row["rounding_high"])
            verdict = _entry_verdict(low, high, rounding, row["identified"] == "1")
        yield _row(
            case,
            what="gain",
            entry=f"{row['gain']}({row['row']},{row['column']})",
            published=row["published"],
            recomputed=value,
            low=low,
            high=high,
            identified=row["identified"],
            verdict=verdict,
        )


def _unidentified_rows(case: Case) -> Iterator[dict[str, str]]:
    """Entries of printed gains that no program of the paper gives again: there is nothing to hold them against."""
    resynthesised = {row["gain"] for row in read_returned(case.results / "gains.csv", case.root)}
    matrices = [matrix for design in case.designs.values() for matrix in design.matrices]
    for name in dict.fromkeys(case.paper.printed.get(matrix, matrix) for matrix in matrices):
        parameter = case.parameters.get(name)
        if name in resynthesised or parameter is None or (parameter.type, parameter.status) != ("matrix", "printed"):
            continue
        for i, row in enumerate(case.printed(name).rows, 1):
            for j, entry in enumerate(row, 1):
                yield _row(case, what="gain", entry=f"{name}({i},{j})", published=entry.text, verdict="uncheckable")


def pole_verdict(value: float, radius: float, rounding: tuple[float, float]) -> str:
    """Judge a part of a pole that lies somewhere within a radius of its value.

    Of a pole that is known to no digit, as that of a nearly defective matrix, every print would be within reach.
    """
    if radius >= max(abs(value), rounding[1] - rounding[0]):
        return "undecided"
    return "reproduced" if value - radius <= rounding[1] and rounding[0] <= value + radius else "contradicted"


def _pole_rows(case: Case) -> Iterator[dict[str, str]]:
    for row in read_returned(case.results / "poles.csv", case.root):
        value, radius = float(row["recomputed"]), float(row["radius"])
        rounding = float(row["rounding_low"]), float(row["rounding_high"])
        yield _row(
            case,
            what="pole",
            entry=f"{row['set']} {row['pole']} {row['part']}",
            published=row["published"],
            recomputed=value,
            unit="1/s",
            low=value - radius,
            high=value + radius,
            verdict=pole_verdict(value, radius, rounding),
        )


def _is_published(case: Case, claim: Claim) -> bool:
    """Say whether a claim publishes a number: no yes or no, and none that only compares two of ours.

    A threshold that is our reading of a word is printed nowhere, nor is a bound of zero, which says that something
    vanishes.
    """
    if claim.kind not in WHAT or claim.comparator not in ("equal", "at_most", "at_least", "inside"):
        return False
    if claim.reading or (claim.comparator in ("at_most", "at_least") and PrintedNumber(claim.published).value == 0):
        return False
    return not case.quantities[claim.quantity].meaning.startswith("whether")


def _claim_rows(case: Case) -> Iterator[dict[str, str]]:
    verdicts = {row["claim"]: row for row in read_returned(case.results / "verdicts.csv", case.root)}
    for claim in case.claims.values():
        if not _is_published(case, claim):
            continue
        row = verdicts.get(claim.id)
        about = {
            "claim": claim.id,
            "what": WHAT[claim.kind],
            "entry": claim.quantity,
            "published": claim.published,
            "unit": claim.unit,
        }
        if row is None:
            yield _row(case, **about, verdict="failed")
            continue
        yield _row(
            case,
            **about,
            recomputed=_number(row["recomputed"]),
            low=_number(row["range_low"]),
            high=_number(row["range_high"]),
            verdict=row["verdict"],
        )


def entry_rows(case: Case) -> list[dict[str, str]]:
    """Return a row for every entry of a gain and every pole that a paper prints; keys as in `PUBLISHED_COLUMNS`."""
    return [*_gain_rows(case), *_unidentified_rows(case), *_pole_rows(case)]


def published_rows(case: Case) -> list[dict[str, str]]:
    """Return a row for every number that a paper publishes, held against one of ours where there is one.

    Returns
    -------
    list of dict
        Keys as in `PUBLISHED_COLUMNS`: entries of gains, locations of poles, then the numbers of claims.

    Raises
    ------
    InputError
        If a results table is missing or malformed.
    """
    return [*entry_rows(case), *_claim_rows(case)]


def summary(rows: Iterable[Row]) -> list[str]:
    """Return a line for each sort of published number: how many, and how they came out.

    Examples
    --------
    >>> summary([{"what": "norm", "verdict": "reproduced"}])
    ['norms: 1 published, 1 reproduced']
    """
    sorts: dict[str, list[str]] = {what: [] for what in LINES}
    for row in rows:
        sorts[row["what"]].append(row["verdict"])
    return [
        f"{LINES[what]}: {len(verdicts)} published, {outcomes(verdicts)}"
        for what, verdicts in sorts.items()
        if verdicts
    ]


def _several(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def record_sentence(differences: Sequence[Sequence[str]]) -> str:
    """Return one sentence on the record: what differs in which papers, and whether a verdict does.

    Parameters
    ----------
    differences : sequence of rows
        As `gainsay.verdicts.differences.differences` gives them.

    Examples
    --------
    >>> record_sentence([("li2021", "quantity", "audit.gain", "1.0", "2.0", "")])
    '1 number of li2021 differs from the record, no verdict does'
    """
    if not differences:
        return "record: every verdict, number, scan, certificate and file is as on record"
    papers: dict[str, Counter[str]] = {}
    for paper, what, *_ in differences:
        papers.setdefault(paper, Counter())[what] += 1
    parts = [
        ", ".join(_several(count, _NOUNS.get(what, what)) for what, count in counts.items()) + f" of {paper}"
        for paper, counts in papers.items()
    ]
    verb = "differs" if len(differences) == 1 else "differ"
    sentence = f"{' and '.join(parts)} {verb} from the record"
    return (
        sentence
        if any(counts["verdict"] + counts["published"] for counts in papers.values())
        else f"{sentence}, no verdict does"
    )


def record_line(differences: Sequence[Sequence[str]], folders: Sequence[str] = ("results",)) -> str:
    """Return the last line of `make`: the sentence on the record, where to look, and what to do.

    Parameters
    ----------
    differences : sequence of rows
    folders : sequence of str, optional
        Where the pages and tables of what was checked stand.
    """

    def each(file: str) -> str:
        return ", ".join(f"{folder}/{file}" for folder in folders)

    parts = [record_sentence(differences), f"page: {each('index.html')}"]
    whats = {row[1] for row in differences}
    if whats - {"file"}:
        parts.append(f"details: {each('differences.csv')}")
    if whats & {"file", "failure"}:
        parts.append("`make` makes again what is lost, altered or broken")
    elif differences and all(row[1] in _RECORDED and row[4] not in ("missing", "refused") for row in differences):
        parts.append("`gainsay record` accepts")
    return "; ".join(parts)
