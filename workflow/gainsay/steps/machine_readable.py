"""What differs from the record, for machines: JUnit XML, and annotations with file and line."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree

from gainsay.errors import InputError
from gainsay.tables import Case
from gainsay.tables.files import read_csv, write_atomically
from gainsay.verdicts.differences import Difference

#: what differs -> the table that it is declared in
_TABLES = {
    "verdict": "claims.csv",
    "scan": "claims.csv",
    "quantity": "quantities.csv",
    "erratum": "errata.csv",
    "certificate": "recorded_certificates.csv",
    "published": "recorded_published.csv",
}


def _place(case: Case, what: str, item: str) -> tuple[str, int]:
    """Return file and line of the row that a difference is about; the head of paper.toml where it is about none."""
    table = _TABLES.get(what, "")
    path = case.folder / table
    try:
        rows = read_csv(path, case.root)[1] if table and path.is_file() else []
    except InputError:
        rows = []
    for number, cells in rows:
        if cells[0] == item.partition(" ")[0]:
            return f"papers/{case.name}/{table}", number
    return f"papers/{case.name}/paper.toml", 1


def _line(difference: Difference) -> str:
    _, what, item, expected, value, note = difference
    return f"{what} {item}: expected {expected or 'nothing'}, found {value or 'nothing'}" + (
        f"; {note}" if note else ""
    )


def _escaped(text: str, extra: str = "") -> str:
    pairs = {"%": "%25", "\r": "%0D", "\n": "%0A", **{mark: f"%{ord(mark):02X}" for mark in extra}}
    return "".join(pairs.get(c, c) for c in text)


def annotations(cases: Sequence[Case], rows: Iterable[Difference]) -> Iterator[str]:
    """Yield a workflow command of GitHub Actions for each difference, with file and line."""
    known = {case.name: case for case in cases}
    for difference in rows:
        case = known.get(difference[0])
        file, line = _place(case, difference[1], difference[2]) if case else ("Snakefile", 1)
        title = _escaped(f"{difference[0]} {difference[1]} {difference[2]}", ",:")
        yield f"::error file={_escaped(file, ',:')},line={line},title={title}::{_escaped(_line(difference))}"


def _clean(text: str) -> str:
    """Text without the characters that XML cannot hold."""
    return "".join(
        c if c in "\t\n\r" or (" " <= c and not 0xD800 <= ord(c) <= 0xDFFF and c not in "\ufffe\uffff") else "?"
        for c in text
    )


def write_junit(path: Path, cases: Sequence[Case], rows: Iterable[Difference]) -> None:
    """Write JUnit XML: a suite a paper, a test a claim; what differs otherwise is a test of its own that failed."""
    differing = list(rows)
    top = ElementTree.Element("testsuites", name="gainsay")
    names = list(dict.fromkeys([*(case.name for case in cases), *(row[0] for row in differing)]))
    claims = {case.name: list(case.claims) for case in cases}
    for name in names:
        own = [row for row in differing if row[0] == name]
        of_claims = {row[2]: row for row in own if row[1] == "verdict"}
        others = [row for row in own if row[1] != "verdict"]
        tests = len(claims.get(name, ())) + len(others)
        suite = ElementTree.SubElement(
            top, "testsuite", name=name, tests=str(tests), failures=str(len(of_claims) + len(others)), errors="0"
        )
        for claim in claims.get(name, ()):
            _test(suite, name, claim, of_claims.get(claim))
        for row in others:
            _test(suite, name, f"{row[1]} {row[2]}", row)
    text = ElementTree.tostring(top, encoding="unicode", xml_declaration=False)
    write_atomically(path, f"<?xml version='1.0' encoding='UTF-8'?>\n{text}\n")


def _test(suite: ElementTree.Element, paper: str, name: str, difference: Difference | None) -> None:
    test = ElementTree.SubElement(suite, "testcase", classname=_clean(paper), name=_clean(name))
    if difference is not None:
        ElementTree.SubElement(test, "failure", message=_clean(_line(difference)))
