import csv
import html
import io
import re
import tempfile
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.tables import find_root, paper_names, read_case
from gainsay.tables.docs import documents, escaped
from gainsay.tables.files import cell, read_csv, write_atomically, write_csv, write_json
from gainsay.tables.lint import _claim_faults, given_of
from gainsay.tables.sentences import of_sentence, sentences, worst
from gainsay.tables.thresholds import reading_faults

ROOT = Path(__file__).resolve().parents[2]


def refused(project) -> InputError:
    with pytest.raises(InputError) as caught:
        project.case()
    assert "\n" not in str(caught.value)
    return caught.value


def test_a_well_formed_paper_is_read(project):
    case = project.case()
    assert case.number("height") == 400e3  # 1 km = 1000 m
    assert case.exact("height") == 400_000
    assert case.exact("mass") == 2
    assert case.choice("start") == "near"
    assert case.printed("K").shape == (2, 2)
    assert case.printed("K").exact == ((Fraction(3, 2), Fraction(-2, 1000)), (Fraction(1, 10), Fraction(7)))
    assert case.printed("K").half_units[0] == (Fraction(1, 200), Fraction(1, 2000))  # by hand, last places
    assert case.printed("K").low[0][0] == Fraction(1495, 1000)
    np.testing.assert_array_equal(case.matrix("K"), [[1.5, -2e-3], [0.1, 7.0]])
    assert set(case.assumed) == {"guess", "count", "start"}
    with pytest.raises(ValueError, match="read-only"):
        case.matrix("K")[0, 0] = 1


@pytest.mark.parametrize(
    ("name", "kind"), [("weight", "number"), ("K", "number"), ("mass", "matrix"), ("mass", "choice")]
)
def test_a_parameter_that_is_not_there_or_of_another_type(project, name, kind):
    case = project.case()
    with pytest.raises(InputError, match=rf"papers/toy/parameters.csv.*'{name}'.*a {kind} of this name"):
        {"number": case.number, "matrix": case.matrix, "choice": case.choice}[kind](name)


#: file, text, its replacement, row, field, a part of the message
BAD = [
    ("parameters.csv", "2.0,kg", "2.0 ,kg", 2, "value", "text on one line"),
    ("parameters.csv", "2.0,kg", "2.O,kg", 2, "value", "a decimal number"),
    ("parameters.csv", "2.0,kg", '"2,0",kg', 2, "value", "a decimal number"),
    ("parameters.csv", "2.0,kg", "2.0,lb", 2, "unit", "a known unit"),
    ("parameters.csv", "2.0,kg", ",kg", 2, "value", "at least 1 character"),
    ("parameters.csv", "mass,number", "mass,numbers", 2, "type", "'number'"),
    ("parameters.csv", "mass,number", "height,number", 3, "name", "a name not used above"),
    ("parameters.csv", "(1),printed,,\nheight", "(1),printed,1..3,\nheight", 2, "plausible", "nothing"),
    ("parameters.csv", "assumed,0..1", "assumed,", 4, "plausible", "plausible values"),
    ("parameters.csv", "assumed,0..1", "assumed,1..2", 4, "plausible", "contains the value 0.5"),
    ("parameters.csv", "assumed,0..1", "assumed,1..0", 4, "plausible", "contains the value 0.5"),
    ("parameters.csv", "assumed,0..1", "assumed,0-1", 4, "plausible", "decimal numbers"),
    ("parameters.csv", "assumed,2|3", "assumed,2|4", 5, "plausible", "contains the value 3"),
    ("parameters.csv", "near|far", "close|far", 6, "value", "one of close|far"),
    ("parameters.csv", "start,choice,near,1", "start,choice,near,m", 6, "unit", "only numbers and matrices"),
    ("parameters.csv", "K.csv 2x2", "K.csv", 7, "value", "file and shape"),
    ("parameters.csv", "printed/K.csv 2x2", "../K.csv 2x2", 7, "value", "file and shape"),
    ("parameters.csv", "mass,number,2.0,kg,(1)", "mass,number,2.0,kg", 2, None, "8 cells"),
    ("parameters.csv", "name,type", "type,name", 1, None, "name,type"),
    ("parameters.csv", '(2),assumed,2|3,left out', '(2),assumed,2|3,"left out', None, None, "well-formed CSV"),
    ("printed/K.csv", "0.1", "0.1x", 2, "column 1", "a decimal number"),
    ("printed/K.csv", "0.1", " 0.1", 2, "column 1", "a decimal number"),
    ("printed/K.csv", "0.1", "−0.1", 2, "column 1", "a decimal number"),
    ("printed/K.csv", "0.1,7", "0.1", 2, None, "2 cells"),
    ("printed/K.csv", "0.1,7\n", "", None, "shape", "2x2"),
    ("quantities.csv", "audit.other,m", "audit.other,parsec", 3, "unit", "a known unit"),
    ("quantities.csv", "audit.other,m", "audit.other,km", 3, "unit", "m, since what is computed is in SI"),
    ("quantities.csv", "audit.other,m", "Audit.Other,m", 3, "id", "match"),
    ("quantities.csv", "audit.other,m", "audit.length,m", 3, "id", "a name not used above"),
    ("quantities.csv", "audit.other,m,audit", "audit.other,m,report", 3, "step", "'audit'"),
    ("claims.csv", "equal,audit.length", "equal,audit.width", 2, "quantity", "declared in quantities.csv"),
    ("claims.csv", "equal,audit.length", "equal,", 2, "quantity", "declared in quantities.csv"),
    ("claims.csv", "equal,audit.length,1.50,m", "equal,audit.length,1.50,s", 2, "unit", "the unit of audit.length"),
    ("claims.csv", "equal,audit.length,1.50", "equal,audit.length,about 1.5", 2, "published", "a decimal number"),
    ("claims.csv", "equal,audit.length,1.50", "inside,audit.length,1.50", 2, "published", "low..high"),
    ("claims.csv", "equal,audit.length,1.50", "inside,audit.length,2..1", 2, "published", "smaller end first"),
    ("claims.csv", "equal,audit.length,1.50", "less_than,audit.length,run.peak", 2, "published", "a quantity in m"),
    ("claims.csv", "equal,audit.length,1.50", "like,audit.length,1.50", 2, "comparator", "'equal'"),
    ("claims.csv", "equal,audit.length,1.50", ",audit.length,1.50", 2, "comparator", "a comparator"),
    ("claims.csv", "1.50,m,,reproduced", "1.50,m,-1,reproduced", 2, "tolerance", "at least 0"),
    ("claims.csv", "1.50,m,,reproduced", "1.50,m,0.1,reproduced", 2, "note", "the reason of the stated tolerance"),
    ("claims.csv", "feasible,audit.holds,,1,,", "feasible,audit.holds,,1,0.1,", 4, "tolerance", "no tolerance"),
    ("claims.csv", "feasible,audit.holds,,", "feasible,audit.holds,1,", 4, "published", "is feasible has no value"),
    ("claims.csv", "feasible,audit.holds,,1", "equal,audit.holds,1,1", 4, "comparator", "holds, without a published"),
    ("claims.csv", "feasible,audit.holds,,1", "equal,audit.holds,0,1", 4, "comparator", "fails, without a published"),
    ("claims.csv", "feasible,audit.holds,,1", "holds,audit.holds,1,1", 4, "published", "holds has no value"),
    ("claims.csv", "(1),ordering,it is 1.50 m,equal,audit.length,1.50", "(1),ordering,it is,holds,audit.length,", 2,
     "kind", "a kind that needs a proof"),
    ("claims.csv", "at_most,audit.other,2,m", "at_most,audit.other,2..3,m", 3, "reading", "ends of the thresholds"),
    ("claims.csv", "2,m,,reproduced", "2,m,,contradicted", 3, "weight", "misprint, gap or result"),
    ("claims.csv", "2,m,,reproduced,by hand,,,", "2,m,,contradicted,by hand,,gap,", 3, "ocr", "possible, excluded"),
    ("claims.csv", "2,m,,reproduced,by hand,,,", "2,m,,reproduced,by hand,,gap,", 3, "weight", "nothing, since"),
    ("claims.csv", "2,m,,reproduced,by hand,,,", "2,m,,contradicted,by hand,,slip,open", 3, "weight", "'misprint'"),
    ("claims.csv", "1.50,m,,reproduced", "1.50,m,,confirmed", 2, "expected", "'reproduced'"),
    ("claims.csv", "1.50,m,,reproduced", "1.50,m,,failed", 2, "expected", "never on record"),
    ("claims.csv", "1.50,m,,reproduced,by hand", "1.50,m,,reproduced,", 2, "basis", "at least 1 character"),
    ("claims.csv", "it is 1.50 m", '"it is\n1.50 m"', 2, "statement", "on one line"),
    ("claims.csv", "(1),ordering", "(1),guess", 2, "kind", "'parameter'"),
    ("claims.csv", "all_of,bound lmi", "all_of,bound none", 6, "quantity", "another claim"),
    ("claims.csv", "all_of,bound lmi", "all_of,bound both", 6, "quantity", "another claim"),
    ("claims.csv", "all_of,bound lmi", "all_of,", 6, "quantity", "the claims that it joins"),
    ("claims.csv", "all_of,bound lmi", "all_of,bound peak", 6, "quantity", "needs a proof"),
    ("claims.csv", "1,,uncheckable", "1,,reproduced", 7, "expected", "uncheckable"),
    ("claims.csv", "the best,,,", "the best,equal,audit.length,", 7, "comparator", "nothing"),
    ("errata.csv", "audit.length", "", 2, "witness", "at least 1 character"),
    ("recorded.csv", "audit.length", "audit.width", 2, "quantity", "one of quantities.csv"),
    ("recorded.csv", "1.5,m", "1.5,s", 2, "unit", "m"),
    ("recorded.csv", "1.5,m", "inf,m", 2, "value", "a finite number"),
    ("recorded.csv", "1e-6", "one", 2, "relative", "a decimal number"),
    ("recorded.csv", "1e-6", "-1e-6", 2, "relative", "at least 0"),
    ("recorded.csv", "rounding", "exact", 2, "class", "both tolerances 0"),
    ("recorded.csv", "rounding,1e-6,1e-12", "enclosed,1e-6,0", 2, "absolute", "the class is enclosed"),
    ("recorded.csv", "rounding,1e-6,1e-12", "rounding,0,0", 2, "relative", "the class exact"),
    ("recorded.csv", "rounding,1e-6,1e-12", "floor,0,1e-12", 2, "value", "the class is floor"),
    ("recorded.csv", "rounding", "guessed", 2, "class", "'exact', 'rounding'"),
    ("paper.toml", "year = 2000", "year = 200", None, "year", "1900"),
    ("paper.toml", 'doi = "10.1000/toy"', 'doi = "toy"', None, "doi", "match"),
    ("paper.toml", 'title = "A toy"', 'name = "A toy"', None, "title", "missing"),
    ("paper.toml", "[runs]", "[runs", None, None, "well-formed TOML"),
]  # fmt: skip


@pytest.mark.parametrize(("file", "old", "new", "row", "field", "expected"), BAD)
def test_every_fault_is_named(project, file, old, new, row, field, expected):
    project.edit(file, old, new)
    error = refused(project)
    assert str(error.file) == f"papers/toy/{file}"
    if row is not None:
        assert error.row == row
        assert f"{file}:{row}:" in str(error)
    if field is not None:
        assert error.field == field
    assert expected in str(error)


@pytest.mark.parametrize("entry", ["mass", "bound=maas", "bound=mass; gamma="])
def test_what_a_quantity_requires_is_a_parameter(project, entry):
    table = project.file("quantities.csv")
    header, first, *rest = table.read_text().splitlines()
    rows = [f"{header},requires", f"{first},{{}}", *(f"{row}," for row in rest)]
    table.write_text("\n".join(rows).format("bound=mass") + "\n")
    assert project.case().quantities
    table.write_text("\n".join(rows).format(entry) + "\n")
    error = refused(project)
    assert (error.row, error.field) == (2, "requires")
    assert "what=parameter, " in str(error)


@pytest.mark.parametrize(
    "name", ["parameters.csv", "quantities.csv", "claims.csv", "errata.csv", "not_checked.csv",
             "paper.toml", "printed/K.csv"]
)  # fmt: skip
def test_a_missing_empty_or_undecodable_table_is_named(project, name):
    project.file(name).write_bytes(b"\xff\xfe")
    assert "UTF-8" in str(refused(project))
    project.file(name).write_text("")
    assert str(refused(project)).startswith(f"papers/toy/{name}:")
    project.file(name).unlink()
    if name == "errata.csv":  # a paper without errata needs no file
        assert not project.case().errata
        return
    error = refused(project)
    assert str(error) == f"papers/toy/{name}: file not found: expected a readable file"


def test_an_unknown_paper_and_a_folder_outside_any_project(project, tmp_path):
    assert paper_names(project.root) == ["toy"]
    with pytest.raises(InputError, match=r"unknown paper.*toy"):
        read_case(project.root, "none")
    for name in ("../papers/toy", "", "a;touch x;b", "$(id)", "two words", "-h", "q'uote", "Toy", "t" * 61, "ünï"):
        with pytest.raises(InputError, match=r"name of a paper.*lower-case letters"):
            read_case(project.root, name)
    for name, why in (("class", "keyword of Python"), ("import", "keyword of Python"), ("report", "target of the")):
        with pytest.raises(InputError, match=why):
            read_case(project.root, name)
    assert find_root(project.root / "papers" / "toy") == project.root
    with pytest.raises(InputError, match="not inside a project"):
        find_root(tmp_path)


def test_generated_documents_are_not_stale():
    for file, text in documents(ROOT).items():
        assert (ROOT / file).read_text() == text, f"{file} is stale: make docs"


def cells(line):
    """Cells of a row of a Markdown table, split where GitHub splits it: at every bar without a backslash before it."""
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def test_what_a_paper_says_stays_in_its_cell(project):
    """Bars, HTML and emphasis of a statement are text: the verdict stays in its column, and nothing is markup."""
    said, tex = "||w|| <= 2 & <script>alert(1)</script> | a \\ b*c*d `e` [f](g) ![h](i); ", "$|w| \\le 1$"
    project.edit("paper.toml", '"A toy"', "'<b>A</b> | [toy](x)'")
    project.edit("claims.csv", "it is at most 2 m", said + tex)
    project.edit("claims.csv", "2,m,,reproduced,by hand,,,", "2,m,,contradicted,by hand,,result,excluded")
    around = "a\n<!-- verdicts: generated by `make docs` -->\n<!-- end of verdicts -->\nb"
    (project.root / "README.md").write_text(around)
    written = documents(project.root)["docs/verdicts.md"]
    assert "\nA. Author. &lt;b>A&lt;/b> \\| [toy]\\(x). Journal of Toys, 2000.\n" in written
    line = next(x for x in written.splitlines() if "||" in x.replace("\\", ""))
    verdict, where, statement, *rest = cells(line)
    assert (where, verdict, *rest) == ("(2)", "contradicted", "result", "not to blame")
    text, mathematics = statement[:-15], statement[-15:]
    assert mathematics == r"$`\|w\| \le 1`$"
    assert "<" not in text
    # By hand: undoing the escapes of Markdown, then those of HTML, gives the sentence again.
    assert html.unescape(re.sub(r"\\([\\|`*$(])", r"\1", text)) == said
    assert "](" not in text


def test_every_row_of_the_documents_has_as_many_cells_as_its_header():
    for file, text in documents(ROOT).items():
        width = 0
        for line in text.splitlines() if file.endswith(".md") else ():
            width = (width or len(cells(line))) if line.startswith("|") else 0
            assert len(cells(line) if width else ()) == width, f"{file}: {line}"


def test_each_sentence_has_one_row_with_every_claim_of_it():
    text = documents(ROOT)["docs/verdicts.md"]
    for paper in paper_names(ROOT):
        case = read_case(ROOT, paper)
        rows = [line for line in text.split(f"## {paper}\n")[1].split("\n## ")[0].splitlines() if line.startswith("| ")]
        spoken = sentences(case.claims.values())
        assert len(rows) == len(spoken) + 2
        for together in spoken:
            holding = [row for row in rows if all(escaped(claim.statement) in row for claim in together)]
            expected = of_sentence((c, c.expected) for c in together)
            assert any(row.startswith(f"| {expected} |") for row in holding), together[0].id


TEXT = st.text(st.characters(codec="utf-8", exclude_characters="\r"), max_size=20)


@given(st.lists(st.lists(TEXT, min_size=2, max_size=2), max_size=5))
@settings(max_examples=50, deadline=None)
def test_a_written_table_reads_back_as_it_was(rows):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "table.csv"
        write_csv(path, ("a", "b"), rows)
        header, found = read_csv(path)
    assert header == ["a", "b"]
    assert [cells for _, cells in found] == rows


@given(st.floats(allow_nan=False))
def test_doubles_keep_all_their_bits(value):
    assert float(cell(value)) == value
    assert cell(np.float64(value)) == cell(value)


@given(st.text(max_size=20))
def test_no_text_breaks_a_row_apart(text):
    buffer = io.StringIO()
    try:
        text.encode()
    except UnicodeEncodeError:
        return
    csv.writer(buffer, lineterminator="\n").writerow([cell(text), "end"])
    assert len(list(csv.reader(io.StringIO(buffer.getvalue(), newline=""), strict=True))) == 1


def test_a_write_that_breaks_leaves_the_old_file_and_no_other(tmp_path):
    path = tmp_path / "a.json"
    write_atomically(path, "old")

    with pytest.raises(TypeError):
        write_json(path, {"value": object()})
    with pytest.raises(UnicodeEncodeError):
        write_atomically(path, "\udc80")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]


@pytest.mark.parametrize(
    ("given", "expected"),
    [("guess", "name=value"), ("guess=", "name=value"), ("gues=1", "in parameters.csv"), ("guess=2", "0..1"),
     ("count=4", "2|3"), ("start=there", "near|far"), ("mass=2.5", "2.0, which the paper prints"),
     ("guess=0.1; guess=0.2", "each name once"), ("guess=half", "a number among")],
)  # fmt: skip
def test_a_condition_names_what_the_paper_leaves_out_and_a_plausible_value(project, given, expected):
    project.edit("claims.csv", "note,weight,ocr", "note,given,weight,ocr")
    text = project.file("claims.csv").read_text().replace(",,,\n", ",,,,\n")
    project.file("claims.csv").write_text(
        text.replace("2,m,,reproduced,by hand,,,,", f"2,m,,reproduced,by hand,,{given},,")
    )
    with pytest.raises(InputError) as refused:
        project.case()
    assert (refused.value.row, refused.value.field) == (3, "given")
    assert expected in refused.value.expected


def test_a_condition_that_is_well_formed_is_read(project):
    project.edit("claims.csv", "note,weight,ocr", "note,given,weight,ocr")
    text = project.file("claims.csv").read_text().replace(",,,\n", ",,,,\n")
    given = "guess=0.25; start=far"
    project.file("claims.csv").write_text(
        text.replace("2,m,,reproduced,by hand,,,,", f"2,m,,reproduced,by hand,,{given},,")
    )
    case = project.case()
    assert given_of(case, case.claims["bound"]) == {"guess": "0.25", "start": "far"}


def test_claims_of_one_sentence_stand_in_one_place(project):
    project.edit("claims.csv", "note,weight,ocr", "note,sentence,weight,ocr")
    text = project.file("claims.csv").read_text().replace("by hand,,,\n", "by hand,,said,,\n")
    project.file("claims.csv").write_text(text.replace("compare with,,,", "compare with,,,,"))
    with pytest.raises(InputError, match=r"claims\.csv:3: claim bound: where .*the place of length, \(1\)"):
        project.case()


@pytest.mark.parametrize(
    ("column", "value", "statement", "expected"),
    [("holds_for", "", "the length can be bounded", "some or every, since the sentence says 'can'"),
     ("holds_for", "", "the loop is able to stop", "says 'able to'"),
     ("holds_for", "every", "the length can be bounded", None), ("holds_for", "some", "it might be short", None),
     ("holds_for", "", "the $can$ canal", None),
     ("as_read", "one way", "the length", "a claim that reads it otherwise")],
)  # fmt: skip
def test_what_a_sentence_is_held_to_is_said(project, column, value, statement, expected):
    project.edit("claims.csv", "note,weight,ocr", f"note,{column},weight,ocr")
    lines = project.file("claims.csv").read_text().replace(",,,\n", ",,,,\n").splitlines()
    cells = next(csv.reader([lines[2]]))
    cells[3], cells[-3] = f"{statement} by 2 m", value
    lines[2] = ",".join(cells)
    project.file("claims.csv").write_text("\n".join(lines) + "\n")
    if expected is None:
        assert getattr(project.case().claims["bound"], column) == value
        return
    with pytest.raises(InputError) as refused:
        project.case()
    assert (refused.value.row, refused.value.field) == (3, column)
    assert expected in refused.value.expected


@pytest.mark.parametrize(
    ("comparator", "published", "unit", "statement", "reading", "expected"),
    [
        ("at_most", "3", "m", "it is short", "", ("published", "a range `low..high` with its `reading`")),
        ("at_most", "3", "m", "it is 3 m or less", "ours", ("reading", "nothing, or a range")),
        ("at_most", "3", "m", "it is below 3.0 m", "", None),
        ("at_least", "-3", "m", "it is above -3 m", "", None),
        ("at_most", "0.03", "1", "it is within 3 % of it", "", None),
        ("at_most", "0.03", "m", "it is within $3\\times 10^{-2}$ m", "", None),
        ("at_most", "2.0", "kg", "it is light", "", None),  # the mass that the paper prints
        ("at_most", "2000", "g", "it is light", "", None),  # the same in another unit
        ("at_most", "0.5", "1", "it is short", "", ("published", "`statement` or a parameter prints")),  # one we assume
        ("at_most", "0", "m", "it is negative", "", None),  # a sign
        ("at_most", "1", "1", "it is less than the other", "", None),  # a ratio
        ("at_most", "1", "m", "it is less than the other", "", ("published", "a range `low..high`")),
        ("at_most", "2..3", "m", "it is short", "", ("reading", "where the ends of the thresholds 2..3 come from")),
        ("at_most", "2..3", "m", "it is short", "two bands in use", None),
        ("inside", "-3..3", "m", "it is near zero", "", ("reading", "where the ends of the thresholds -3..3")),
        ("inside", "-3..3", "m", "it is near zero", "a band in use", None),
        ("inside", "-3..3", "m", "it is within 3 m of zero", "", None),
        ("inside", "-3..3", "m", "it is within 3 m of zero", "a band in use", ("reading", "nothing, or a range")),
        ("equal", "3", "m", "it is as long", "ours", ("reading", "nothing, since equal has no threshold")),
    ],
)
def test_a_threshold_is_printed_or_a_range_with_a_source(
    project, comparator, published, unit, statement, reading, expected
):
    changes = {
        "comparator": comparator,
        "published": published,
        "unit": unit,
        "statement": statement,
        "reading": reading,
    }
    claim = project.case().claims["bound"].model_copy(update=changes)
    faults = [(field, wanted) for field, _, wanted in reading_faults(project.case(), claim)]
    assert [field for field, _ in faults] == ([] if expected is None else [expected[0]])
    assert expected is None or expected[1] in faults[0][1]


def test_the_same_said_twice_of_one_place_is_one_sentence(project):
    text = project.file("claims.csv").read_text()
    line = next(line for line in text.splitlines() if line.startswith("bound,"))
    project.file("claims.csv").write_text(text + line.replace("bound,", "again,", 1) + "\n")
    with pytest.raises(InputError, match=r"claim again: sentence .*a name shared with bound, which says the same"):
        project.case()


def test_only_a_number_bears_out_what_can_be(project):
    claims = project.case().claims
    lmi = claims["lmi"].model_copy(update={"holds_for": "some"})
    assert [fault[:2] for fault in _claim_faults(project.case(), lmi)] == [("holds_for", "some")]


def test_the_verdict_of_a_sentence_is_the_worst_of_its_claims(project):
    claims = project.case().claims
    of_one = [claim.model_copy(update={"sentence": "said"}) for claim in (claims["bound"], claims["both"])]
    together = sentences([of_one[0], claims["length"], of_one[1]])
    assert [[claim.id for claim in one] for one in together] == [["bound", "both"], ["length"]]
    assert worst(["reproduced", "uncheckable", "undecided", "undetermined"]) == "undecided"
