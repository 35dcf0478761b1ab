"""All that one verdict rests on, and where results stand: read from files, nothing is computed."""

from collections.abc import Iterator
from pathlib import Path

from gainsay.errors import InputError, one_of
from gainsay.results.listing import damage
from gainsay.results.returned import STEPS, read_returned
from gainsay.tables import Case, read_case
from gainsay.tables.files import read_csv
from gainsay.tables.models import Claim
from gainsay.tables.units import with_unit
from gainsay.verdicts.differences import DIFFERENCE_COLUMNS
from gainsay.verdicts.errata import with_results
from gainsay.verdicts.table import outcomes

_WIDTH = 16


def _row_of(case: Case, table: str, name: str) -> str:
    """Return the place of a row that is named by its first column, for an editor to open."""
    path = case.folder / table
    rows = read_csv(path, case.root)[1] if path.is_file() else []
    for number, cells in rows:
        if cells[0] == name:
            return f"papers/{case.name}/{table}:{number}"
    return ""


def _record(case: Case, table: str, column: str, name: str) -> dict[str, str]:
    path = case.results / f"{table}.csv"
    rows = read_returned(path, case.root) if path.is_file() else []
    return next((row for row in rows if row[column] == name), {})


def _number(row: dict[str, str]) -> str:
    ends = f", enclosed by {row['lower']} .. {row['upper']}" if row["lower"] and row["upper"] else ""
    return f"{with_unit(row['value'], row['unit'])}{ends}; {row['method']}"


def _parts(case: Case, claim: Claim) -> Iterator[tuple[str, str]]:
    """Yield what is said of a claim: name and text, in the order of reading."""
    held = " ".join(part for part in (claim.comparator, claim.published) if part)
    yield "the paper says", f"{claim.statement} ({claim.where})"
    yield "read as", claim.as_read
    yield "given", claim.given
    yield "holds for", claim.holds_for
    yield "kind", claim.kind
    yield "held against", f"{claim.quantity} {with_unit(held, claim.unit)}" if claim.quantity else "nothing"
    yield (
        "tables",
        ", ".join(
            place
            for place in (
                _row_of(case, "claims.csv", claim.id),
                *(_row_of(case, "quantities.csv", name) for name in claim.quantity.split()),
            )
            if place
        ),
    )
    judgement = _record(case, "verdicts", "claim", claim.id)
    if not judgement:
        yield "verdict", "none yet: run `snakemake --cores 2`"
        return
    as_expected = "as on record" if judgement["verdict"] == claim.expected else f"on record: {claim.expected}"
    yield "verdict", f"{judgement['verdict']} ({as_expected})"
    others = judgement["of_sentence"] != judgement["verdict"]
    yield "its sentence", f"{judgement['of_sentence']}, with its other claims" if others else ""
    yield "weight", claim.weight
    yield "the scan", f"to blame: {claim.ocr}" if claim.ocr else ""
    yield "digits", f"read from the scan alone: {judgement['digits']}" if judgement.get("digits") else ""
    yield "evidence", judgement["evidence"]
    for quantity in claim.quantity.split():
        row = _record(case, "quantities", "quantity", quantity)
        if row:
            yield "computed", f"{quantity} = {_number(row)}"
    yield "witness", judgement["witness"]
    yield "note", judgement["note"]
    yield "basis", claim.basis
    for name in judgement["certificate"].split():
        row = _record(case, "certificates", "certificate", name)
        yield "certificate", f"{name}: {row.get('says', 'missing')}"
        yield "check it", f"gainsay prove results/{case.name}/certificates/{name}.json"
    for reply in case.replies_to(claim.id):
        who = f", says {reply.who}" if reply.who else ""
        yield "reply", f"disputed{who}: {reply.disputed}; on the ground: {reply.ground}; done: {reply.done}"
    for erratum in with_results(case).errata.values():
        if set(erratum.witness.split()) & {*claim.quantity.split(), *judgement["certificate"].split()}:
            yield "erratum", f"{erratum.id}: {erratum.printed} -> {erratum.corrected}"


def explain(case: Case, claim: str) -> list[str]:
    """Return the lines on one claim: sentence, condition, table rows, number, evidence, how to check it.

    Raises
    ------
    InputError
        If the paper has no such claim; names the nearest.
    """
    if claim not in case.claims:
        raise InputError(f"no claim of {case.name}", value=claim, expected=one_of(claim, case.claims))
    parts = [(name, text) for name, text in _parts(case, case.claims[claim]) if text]
    return [f"{case.name} {claim}", *(f"  {name:<{_WIDTH}}{text}" for name, text in parts)]


def _state(case: Case) -> str:
    """Say how far the results of a paper have come."""
    missing = [
        step
        for step in (*STEPS, "verdicts", "compare", "page")
        if not (case.results / "parts" / f"{step}.files.csv").is_file()
    ]
    if missing:
        return f"{missing[0]} has not run"
    lost = sum(
        1
        for step in (*STEPS, "verdicts", "compare", "page")
        for _ in damage(case.results / "parts" / f"{step}.files.csv", case.results)
    )
    failures = len(read_returned(case.results / "failures.csv", case.root))
    differing = len(read_returned(case.results / "differences.csv", case.root, DIFFERENCE_COLUMNS))
    remarks = [
        f"{count} {what}"
        for count, what in ((failures, "failures"), (differing, "differences"), (lost, "damaged files"))
        if count
    ]
    return ", ".join(remarks) or ("draft, nothing else to say" if case.paper.draft else "as on record")


def _stand(case: Case) -> str:
    path = case.results / "verdicts.csv"
    counts = outcomes(row["verdict"] for row in read_returned(path, case.root)) if path.is_file() else ""
    return f"{counts or 'no verdicts yet'}; {_state(case)}"


def status(root: Path, papers: list[str]) -> list[str]:
    """Return one screen on where the results stand: a line a paper with its verdicts and what differs.

    Results that cannot be read back are said in the line of their paper.
    """
    lines = []
    for paper in papers:
        case = read_case(root, paper)
        try:
            stand = _stand(case)
        except InputError as error:
            stand = str(error)
        lines.append(f"{paper:<16}{len(case.claims):>4} claims: {stand}")
    return lines
