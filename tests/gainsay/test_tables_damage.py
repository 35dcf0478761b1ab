"""Damaged tables: each copy is refused in one short line, or read as what a second reader finds in it.

The second reader (`second_reading`) shares no code with ours: it cuts a table into cells character by character and
turns digits into numbers one by one. The seed is part of the test.
"""

import json
import os
import random
import shutil
import socket
from collections import Counter
from fractions import Fraction
from pathlib import Path

import pytest

from gainsay.errors import InputError
from gainsay.exact.digits import PrintedNumber, double
from gainsay.tables import paper_names, read_case
from gainsay.tables.models import TABLES, columns
from gainsay.tables.reading import read_paper_file

ROOT = Path(__file__).resolve().parents[2]
#: what docs/robustness.md says of this campaign
TRIED = [
    {
        "what": "tables of the papers",
        "how": "bytes, digits, names, quotes, lines and codings changed; a link, a pipe, a device, a folder or nothing "
        "in place of the file",
        "fast": 40, "slow": 300, "night": 3000,
        "promise": "refused in one line of at most 300 characters, or read as a second reader reads the same bytes, "
        "cell by cell and digit by digit",
    }
]  # fmt: skip
COUNT = TRIED[0]["night" if os.environ.get("GAINSAY_NIGHT") else "slow"]
SEED, BATCHES = 20261125, 10
PAPERS = ("li2021", "pinheiro2013", "wan2014", "zhang2013")

# ---------------------------------------------------------------------------------------------------- the second reader


class Malformed(Exception):
    """The second reader does not understand the file either."""


def cells_of(path):
    """Rows of cells of a CSV file, one character at a time: quotes, commas and ends of lines mean something."""
    text = path.read_bytes().decode()
    rows, row, cell, quoted, at = [], [], "", False, 0
    while at < len(text):
        c, after = text[at], text[at + 1 : at + 2]
        if quoted and c == '"' and after == '"':
            cell, at = cell + '"', at + 1
        elif quoted and c == '"':
            if after not in (",", "\r", "\n"):
                raise Malformed("text after a quote")
            quoted = False
        elif quoted:
            cell += c
        elif c == '"' and (at == 0 or text[at - 1] in ",\r\n"):
            quoted = True
        elif c in "\r\n":
            at += c == "\r" and after == "\n"
            rows, row, cell = [*rows, [*row, cell]], [], ""
        elif c == ",":
            row, cell = [*row, cell], ""
        else:
            cell += c
        at += 1
    if row or cell or quoted:
        raise Malformed("no end of the last line")
    return rows


def number_of(text):
    """The number that decimal digits stand for, one digit at a time."""
    mantissa, mark, power = text.replace("E", "e").partition("e")
    sign = -1 if mantissa.startswith("-") else 1
    whole, dot, decimals = mantissa.lstrip("+-").partition(".")
    if any(c not in "0123456789" for c in whole + decimals) or not whole or bool(dot) != bool(decimals):
        raise Malformed(text)
    found = 0
    for c in whole + decimals:
        found = 10 * found + "0123456789".index(c)
    exponent = 0
    if mark:
        if not power.lstrip("+-") or any(c not in "0123456789" for c in power.lstrip("+-")):
            raise Malformed(text)
        for c in power.lstrip("+-"):
            exponent = 10 * exponent + "0123456789".index(c)
        exponent *= -1 if power.startswith("-") else 1
    return sign * Fraction(found) * Fraction(10) ** (exponent - len(decimals))


def second_reading(folder, case):
    """Hold every cell, number and matrix of a case against the files; raises AssertionError where one differs."""
    for file, model in TABLES.items():
        path = folder / file
        if not os.path.lexists(path):
            continue
        header, *rows = cells_of(path)
        assert header == [column for column in columns(model) if column in header], file
        rows_of = getattr(case, file.removesuffix(".csv"))
        read = list(rows_of.values()) if hasattr(rows_of, "values") else list(rows_of)
        assert rows == [[getattr(row, "class_" if c == "class" else c) for c in header] for row in read], file
        assert not [row for row in read for c in columns(model) if c not in header and getattr(row, c)], file
    for name, row in case.parameters.items():
        if row.type == "number":
            assert PrintedNumber(row.value).value == number_of(row.value), name
        if row.type == "matrix":
            rows = cells_of(folder / row.value.split()[0])
            assert [[entry.text for entry in r] for r in case.printed(name).rows] == rows, name
            assert [list(r) for r in case.printed(name).exact] == [[number_of(x) for x in r] for r in rows], name
    for row in case.recorded.values():
        assert double(row.value) == float(number_of(row.value)), row.quantity
    for name, design in case.designs.items():
        content = json.loads((folder / "designs" / f"{name}.json").read_bytes())
        for entry, rows in content["matrices"].items():
            assert [list(r) for r in design.exact(entry)] == [[number_of(x) for x in r] for r in rows], name


# ----------------------------------------------------------------------------------------------------------- the damage

TWIN = "1٣３〇²½"  # digits of other scripts, a superscript, a fraction


def bytes_of(change):
    """A change of the bytes of a file."""

    def damage(path, draw):
        path.write_bytes(change(path.read_bytes(), draw))

    damage.__name__ = change.__name__
    return damage


def text_of(change):
    """A change of the text of a file, which stays UTF-8."""

    def damage(path, draw):
        path.write_bytes(change(path.read_bytes().decode(), draw).encode())

    damage.__name__ = change.__name__
    return damage


def some_digit(text, draw):
    """Place of a digit, or of any character where there is none."""
    places = [at for at, c in enumerate(text) if c in "0123456789"] or list(range(len(text)))
    return draw.choice(places) if places else 0


def put(text, at, new, length=1):
    return text[:at] + new + text[at + length :]


def truncated(data, draw):
    return data[: draw.randrange(len(data))] if data else data


def flipped(data, draw):
    copy = bytearray(data)
    for _ in range(draw.choice([1, 1, 3])):
        copy[draw.randrange(len(copy))] ^= 1 << draw.randrange(8)
    return bytes(copy)


def cut_out(data, draw):
    at = draw.randrange(len(data))
    return data[:at] + data[at + draw.choice([1, 2, 10, 200]) :]


def zeroed(data, draw):
    at = draw.randrange(len(data))
    return data[:at] + bytes(5) + data[at + 5 :]


def other_coding(data, draw):
    return data.decode().encode(draw.choice(["utf-16", "utf-8-sig", "utf-32", "utf-7"]))


def emptied(data, draw):
    return b""


def huge(data, draw):
    return data + b"x" * draw.choice([200_000, 1_000_000])


def digit(text, draw):
    return put(text, some_digit(text, draw), draw.choice("0123456789"))


def twin_digit(text, draw):
    return put(text, some_digit(text, draw), draw.choice(TWIN[1:]))


def underscore(text, draw):
    return put(text, some_digit(text, draw) + 1, "_", 0)


def many_digits(text, draw):
    return put(text, some_digit(text, draw), draw.choice("19") * 5000)


def words_for_numbers(text, draw):
    words = ["nan", "inf", "-inf", "0x10", "1e999999999", "1e-99999", "1,5", "1 000", "--1", "1.", ".5", "1e", "True"]
    return put(text, some_digit(text, draw), draw.choice(words))


def brackets(text, draw):
    return put(text, some_digit(text, draw), draw.choice("[{(") * 3000)


def nested(text, draw):
    at = text.find("= ")
    return put(
        text, at + 2 if at >= 0 else 0, draw.choice(["[" * 3000 + "]" * 3000, "{a=" * 3000 + "1" + "}" * 3000]), 0
    )


def long_name(text, draw):
    words = [at for at, c in enumerate(text) if c in ',/\n"' and text[at + 1 : at + 2].isalpha()]
    return put(text, draw.choice(words) + 1 if words else 0, "a" * 300, 0)


def controls(text, draw):
    return put(text, draw.randrange(len(text) + 1), draw.choice("\0\x07\x1b\r\x85\u2028\u202e\ufeff\ufffd\x7f\t"), 0)


def quotes(text, draw):
    return put(text, draw.randrange(len(text) + 1), draw.choice(['"', '""', ',"', '",', ",", "\n", "\r\n", ";"]), 0)


def lines(text, draw):
    rows = text.splitlines(keepends=True)
    i, j = draw.randrange(len(rows)), draw.randrange(len(rows))
    match draw.randrange(3):
        case 0:
            del rows[i]
        case 1:
            rows.insert(j, rows[i])
        case 2:
            rows[i], rows[j] = rows[j], rows[i]
    return "".join(rows)


def words(text, draw):
    """A word from elsewhere in the file in place of another."""
    cells = text.split(",")
    cells[draw.randrange(len(cells))] = draw.choice(cells)
    return ",".join(cells)


def dos(text, draw):
    return text.replace("\n", draw.choice(["\r\n", "\r"]))


def no_end(text, draw):
    return text.rstrip("\n")


def loop(path, draw):
    path.unlink()
    path.symlink_to(path.name)


def nowhere(path, draw):
    path.unlink()
    path.symlink_to("nothing")


def device(path, draw):
    path.unlink()
    path.symlink_to(draw.choice(["/dev/zero", "/dev/null", "/dev/random", "/"]))


def pipe(path, draw):
    path.unlink()
    os.mkfifo(path)


def post(path, draw):
    """A socket stands there."""
    path.unlink()
    before = Path.cwd()
    os.chdir(path.parent)  # the name of a socket is at most some 100 characters long
    try:
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(path.name)
    finally:
        os.chdir(before)


def folder(path, draw):
    path.unlink()
    path.mkdir()


def private(path, draw):
    """Unreadable, but for the superuser."""
    path.chmod(0)


def lost(path, draw):
    path.unlink()


BYTES = [bytes_of(f) for f in (truncated, truncated, flipped, flipped, cut_out, zeroed, other_coding, emptied, huge)]
TEXTS = [text_of(f) for f in (digit, twin_digit, twin_digit, underscore, underscore, many_digits, words_for_numbers,
                              brackets, nested, long_name, controls, quotes, lines, words, dos, no_end)]  # fmt: skip
PLACES = [loop, nowhere, device, pipe, post, folder, private, lost]
#: the damage that must always be refused, whatever file it falls on
NEVER = {"emptied", "loop", "nowhere", "device", "pipe", "post", "folder"}


def copied(to, paper):
    """A project with a copy of the tables of one paper."""
    shutil.copytree(
        ROOT / "papers" / paper, to / "papers" / paper, ignore=shutil.ignore_patterns("*.py", "__pycache__")
    )
    (to / "Snakefile").touch()
    return to


def tried(root, paper, draw):
    """Damage one file of a copy and read it; returns the damage and what became of it."""
    folder_ = root / "papers" / paper
    kinds = [sorted(folder_.glob(p)) for p in ("*.csv", "*.toml", "printed/*.csv", "designs/*.json")]
    path = draw.choice(draw.choice([found for found in kinds if found]))
    before = path.read_bytes()
    damages = draw.choice([BYTES, TEXTS, TEXTS, PLACES])
    done = []
    for _ in range(1 if damages is PLACES else draw.choice([1, 1, 2])):
        damage = draw.choice(damages)
        try:
            damage(path, draw)
        except (ValueError, IndexError):
            continue  # the second damage finds nothing left to damage
        done.append(damage.__name__)
    what = f"{path.relative_to(root)} after {done}"
    try:
        case = read_case(root, paper)
    except InputError as error:
        found = "refused"
        assert len(str(error)) <= 300, what
        assert str(error).isprintable(), what
    except Exception as error:  # whatever is no refusal is what this looks for: it fails with the damage named
        pytest.fail(f"{what}: {type(error).__name__}: {error}"[:2000])
    else:
        found = "read"
        assert not NEVER & set(done), what
        try:
            second_reading(folder_, case)
        except (Malformed, AssertionError, UnicodeDecodeError) as error:
            pytest.fail(f"{what}: read as something else: {error!r}"[:2000])
    finally:
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        else:
            path.unlink(missing_ok=True)
        path.write_bytes(before)
    return done, found


def campaign(tmp_path, papers, count, draw):
    """Damage copies one after the other; returns how many were refused and read, and how many of each damage."""
    roots = {paper: copied(tmp_path / paper, paper) for paper in papers}
    outcomes, damages = Counter(), Counter()
    for _ in range(count):
        paper = draw.choice(papers)
        done, found = tried(roots[paper], paper, draw)
        outcomes[found] += 1
        damages.update(done)
    for paper, root in roots.items():  # put back as it was, it is read
        second_reading(root / "papers" / paper, read_case(root, paper))
    return outcomes, damages


def test_some_damaged_copies_are_refused_or_read_as_they_stand(tmp_path):
    outcomes, _ = campaign(tmp_path, ("wan2014",), TRIED[0]["fast"], random.Random(SEED))
    assert outcomes["refused"] > 20
    assert outcomes["read"] > 0


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(BATCHES))
def test_damaged_copies_are_refused_or_read_as_they_stand(tmp_path, batch):
    outcomes, damages = campaign(tmp_path, PAPERS, COUNT // BATCHES, random.Random(f"{SEED} {batch}"))
    print(f"damaged tables, batch {batch}: {dict(outcomes)}; {dict(damages)}")
    assert outcomes["refused"] > outcomes.total() // 3
    assert outcomes["read"] > 0


# --------------------------------------------------------------------------------------------- one by one, with reasons


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
