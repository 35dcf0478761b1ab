"""Ways to damage a table, and a second reader of tables: for the tests.

The second reader (`second_reading`) shares no code with ours: it cuts a table into cells character by character and
turns digits into numbers one by one.
"""

import json
import os
import socket
from fractions import Fraction
from pathlib import Path

from gainsay.exact.digits import PrintedNumber, double
from gainsay.tables.models import TABLES, columns

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
    return data.decode(errors="replace").encode(draw.choice(["utf-16", "utf-8-sig", "utf-32", "utf-7"]))


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


def some_json(value, draw):
    """Another value somewhere in JSON."""
    paths = list(places_in(value))
    path = draw.choice([p for p in paths if p] or paths)
    new = draw.choice([None, True, -1, 1e308, "", "x" * 400, [], {}, [[]], {"a": 1}, 10**400, "nan", [1, [2]]])
    target = value
    for key in path[:-1]:
        target = target[key]
    if draw.random() < 0.3:
        del target[path[-1]]
    else:
        target[path[-1]] = new


def places_in(value, path=()):
    yield path
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places_in(inner, (*path, key))


def in_json(path, draw):
    """Another value in a JSON file, which stays JSON."""
    content = json.loads(path.read_text())
    some_json(content, draw)
    path.write_text(json.dumps(content))


BYTES = [bytes_of(f) for f in (truncated, truncated, flipped, flipped, cut_out, zeroed, other_coding, emptied, huge)]
TEXTS = [text_of(f) for f in (digit, twin_digit, twin_digit, underscore, underscore, many_digits, words_for_numbers,
                              brackets, nested, long_name, controls, quotes, lines, words, dos, no_end)]  # fmt: skip
PLACES = [loop, nowhere, device, pipe, post, folder, private, lost]
#: the damage that must always be refused, whatever file it falls on
NEVER = {"emptied", "loop", "nowhere", "device", "pipe", "post", "folder"}
