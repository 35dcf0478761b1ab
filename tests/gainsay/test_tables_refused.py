"""Bad tables one by one, each with the reason why it is refused."""

import os
import random
from pathlib import Path

import pytest

from gainsay.errors import InputError
from gainsay.tables import paper_names
from gainsay.tables.reading import read_paper_file
from tests.gainsay.table_damage import device, folder, loop, nowhere, pipe, post, second_reading

ROOT = Path(__file__).resolve().parents[2]
PAPERS = ("li2021", "pinheiro2013", "wan2014", "zhang2013")


def refused(project):
    with pytest.raises(InputError) as caught:
        project.case()
    assert len(str(caught.value)) <= 300
    assert str(caught.value).isprintable()
    return caught.value


@pytest.mark.parametrize("damage", [loop, nowhere, device, pipe, post, folder])
@pytest.mark.parametrize(
    "name", ["claims.csv", "paper.toml", "printed/K.csv", "recorded.csv", "recorded_scans.csv", "designs/repaired.json"]
)
def test_what_is_no_file_is_no_table(project, damage, name):
    """Also a table that may be missing is not missing where something else stands in its place."""
    path = project.file(name)
    path.parent.mkdir(exist_ok=True)
    path.touch()
    damage(path, random.Random(0))
    error = refused(project)
    if name == "paper.toml":
        assert "paper.toml" in str(error)  # a folder without one, or with one that cannot be read
    else:
        assert str(error.file) == f"papers/toy/{name}"


NUMBERS = ["1_5", "１５", "1٥", "²", "1e1_0", "0x1F", "nan", "1e999", "1.", ".5", "+", " 1.5", "1.5\u00a0", "9" * 5000]


@pytest.mark.parametrize("text", NUMBERS)
@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("parameters.csv", "mass,number,2.0", "mass,number,{}"),
        ("printed/K.csv", "0.1,7", "{},7"),
        ("claims.csv", "audit.length,1.50", "audit.length,{}"),
        ("claims.csv", "1.50,m,,reproduced", "1.50,m,{},reproduced"),
        ("recorded.csv", "1.5,m", "{},m"),
        ("recorded.csv", "1e-6", "{}"),
        ("parameters.csv", "assumed,0..1", "assumed,{}..1"),
        ("parameters.csv", "K.csv 2x2", "K.csv {}x2"),
        ("paper.toml", "year = 2000", 'year = "{}"'),
        ("paper.toml", "10.1000/toy", "10.{}/toy"),
    ],
)
def test_only_ascii_digits_are_numbers(project, file, old, new, text):
    project.edit(file, old, new.format(text))
    refused(project)


def test_a_number_in_quotes_is_no_year(project):
    """What a table of TOML calls text is not made a number: 2000 in other digits was one."""
    project.edit("paper.toml", "year = 2000", 'year = "2000"')
    assert refused(project).field == "year"


@pytest.mark.parametrize("character", ["\x1b", "\x9b", "\u200b", "\u202e", "\u2066", "\ufeff", "\U000e0041"])
@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("claims.csv", "it is 1.50 m", "it is {}1.50 m"),
        ("claims.csv", "nothing to compare with", "nothing to {}compare with"),
        ("quantities.csv", "another length", "another {}length"),
        ("paper.toml", '"A. Author"', '"A. {}Author"'),
        ("paper.toml", '"a run"', '"a {}run"'),
    ],
)
def test_characters_that_do_not_show_are_refused(project, file, old, new, character):
    """A terminal obeys U+009B as it does ESC [; others turn or hide what stands beside them."""
    project.edit(file, old, new.format(character))
    refused(project)


@pytest.mark.parametrize("file", ["parameters.csv", "claims.csv", "printed/K.csv", "recorded.csv"])
def test_a_table_cut_in_its_last_line_is_refused(project, file):
    """At every byte: 0.1,7 cut to 0.1 has too few cells, 0.25,17 cut to 0.25,1 is another number."""
    path = project.file(file)
    data = path.read_bytes()
    for end in range(data.rindex(b"\n", 0, -1) + 2, len(data)):
        path.write_bytes(data[:end])
        assert "final newline" in str(refused(project)) or end == 0


@pytest.mark.parametrize(
    "text", ["[" * 3000, "a = " + "[" * 3000, "year = " + "9" * 5000, "a = 1979-99-99", "a." * 3000]
)
def test_deep_and_long_toml_is_refused(project, text):
    project.file("paper.toml").write_text(text)
    assert "paper.toml" in str(refused(project))


@pytest.mark.parametrize("text", ["[" * 3000, '{"a":' * 3000, '{"seed": ' + "9" * 5000 + "}", '{"seed": 1, "seed": 1}'])
def test_deep_and_long_designs_are_refused(project, text):
    project.file("designs").mkdir()
    project.file("designs/repaired.json").write_text(text)
    assert str(refused(project).file) == "papers/toy/designs/repaired.json"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ('[printed]\nK = "mass"', "'mass'"),  # a number
        ('[measures]\n"audit.length" = "less nobody repaired=audit.other"', "'nobody'"),
        ('[measures]\n"audit.length" = "less repaired nobody=audit.other"', "'nobody'"),
        ('[measures]\n"audit.length" = "less repaired nominal=audit.nothing"', "'audit.nothing'"),
        ('[measures]\n"audit.length" = "less repaired nominal=run.peak"', "quantities of designs or runs in m"),
        ('[measures]\n"audit.length" = "less repaired"', "measures"),
    ],
)
def test_a_comparison_of_what_is_not_there_is_refused(project, text, value):
    path = project.file("paper.toml")
    path.write_text(path.read_text() + "\n" + text + "\n")
    assert value in str(refused(project))


@pytest.mark.parametrize("length", [101, 300, 100_000])
@pytest.mark.parametrize(
    ("file", "old"),
    [("claims.csv", "length,(1)"), ("quantities.csv", "audit.other"), ("parameters.csv", "mass"),
     ("parameters.csv", "printed/K.csv"), ("paper.toml", "nominal"), ("claims.csv", "1.50,m")],
)  # fmt: skip
def test_long_names_are_refused_in_a_short_line(project, file, old, length):
    project.edit(file, old, "a" * length + old)
    refused(project)


def test_folders_of_papers_that_cannot_be_read_are_not_passed_over(project):
    (project.root / "papers" / "loop").symlink_to("loop")
    with pytest.raises(InputError, match=r"papers/loop: too many levels.*a readable folder"):
        paper_names(project.root)


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read everything")
@pytest.mark.parametrize("name", ["claims.csv", "printed", "."])
def test_what_may_not_be_read_is_named(project, name):
    project.file(name).chmod(0)
    try:
        assert "permission denied" in str(refused(project))
    finally:
        project.file(name).chmod(0o700)


def test_a_message_obeys_no_terminal_and_keeps_its_ends():
    error = InputError("a\nb\x1b[2J", file="x" * 400, row=3, field="f" * 400, value="v" * 10**6, expected="e" * 400)
    assert len(str(error)) == 300
    assert str(error).isprintable()
    assert str(error).startswith("x")
    assert str(error).endswith("e")
    assert "too large" in str(InputError(value=10**5000))


def test_the_second_reader_can_disagree(project):
    """The campaign can fail: a case read from other tables is noticed."""
    case = project.case()
    second_reading(project.root / "papers" / "toy", case)
    project.edit("printed/K.csv", "0.1,7", "0.1,8")
    with pytest.raises(AssertionError):
        second_reading(project.root / "papers" / "toy", case)
    project.edit("claims.csv", "it is 1.50 m", "it is 1.60 m")
    with pytest.raises(AssertionError, match="claims"):
        second_reading(project.root / "papers" / "toy", case)


def test_a_paper_file_is_read_as_a_second_reader_finds_it():
    for paper in PAPERS:
        text = (ROOT / "papers" / paper / "paper.toml").read_text(encoding="utf-8")
        assert f'title = "{read_paper_file(ROOT / "papers" / paper / "paper.toml").title}"' in text
