"""Reading and writing of CSV and JSON files: strict on the way in, atomic and byte-stable on the way out."""

import csv
import io
import json
import math
import os
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from gainsay.errors import InputError, one_line

#: bytes of a table at most: what is larger is not one
LARGEST = 1 << 26
_PART = ".part"
#: columns and rows
Table = tuple[Sequence[str], Sequence[Sequence[object]]]
_UMASK = os.umask(0o022)  # it can only be read by setting it
os.umask(_UMASK)


def remove_abandoned(folder: Path) -> None:
    """Remove temporary files below a folder whose process was killed before it could rename or remove them."""
    for path in folder.rglob(f".*{_PART}"):
        owner = path.name.split(".")[1]
        if owner.isdigit() and not _lives(int(owner)):
            path.unlink(missing_ok=True)


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def real_path(path: Path) -> Path:
    """Return where a path leads; a link that leads to itself stays, for whoever opens it to refuse."""
    return Path(os.path.realpath(path))


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Name the file in an error of the system: one that comes of writing to an open file names none."""
    try:
        yield
    except OSError as error:
        error.filename = error.filename or str(path)
        raise


def write_atomically(path: Path, data: bytes | str) -> None:
    """Write a file under a temporary name, then rename it: readers never see half a file.

    Raises
    ------
    InputError
        If something else than a file is there, such as a device: renaming would put the file in its place.
    """
    path = real_path(path)  # a link stays one
    if path.exists() and not path.is_file():
        raise InputError("not a file", file=str(path), expected="a file, or a name that is free")
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{os.getpid()}.", suffix=_PART)
    try:
        with naming(path), os.fdopen(handle, "wb") as file:
            file.write(data.encode() if isinstance(data, str) else data)
        Path(temporary).chmod(0o666 & ~_UMASK)  # mkstemp makes files private; results are as private as one wants them
        Path(temporary).replace(path)
    except BaseException:
        with suppress(FileNotFoundError):
            Path(temporary).unlink()
        raise


def cell(value: object) -> str:
    """Return a value as CSV text: doubles by repr (all their bits), booleans as 1/0, None as nothing."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "1" if value else "0"
    if isinstance(value, float):
        return repr(float(value)) if math.isfinite(value) else str(value)
    return str(value).replace("\r\n", "\n").replace("\r", "\n")  # csv would leave a bare carriage return unquoted


def csv_text(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table with a header as the text of its file."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([cell(value) for value in row] for row in rows)
    return text.getvalue()


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a table with a header, atomically."""
    write_atomically(path, csv_text(header, rows))


def write_json(path: Path, content: object, default: Callable[[object], object] | None = None) -> None:
    """Write JSON with sorted keys, atomically; `default` turns what JSON does not know into what it does."""
    text = json.dumps(content, indent=1, sort_keys=True, ensure_ascii=False, default=default)
    write_atomically(path, text + "\n")


def short_path(path: Path, root: Path | None) -> str:
    """Return a path relative to the project root where it lies inside it."""
    return str(path.relative_to(root)) if root is not None and path.is_relative_to(root) else str(path)


def is_there(path: Path, root: Path | None = None) -> bool:
    """Say whether there is anything of this name, be it a link that leads nowhere.

    Raises
    ------
    InputError
        If that cannot be told: a folder that may not be entered, a name that no file can have.
    """
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    except (OSError, ValueError) as error:
        raise InputError(_reason(error), file=short_path(path, root), expected="a readable file") from None
    return True


def listed(folder: Path, root: Path | None = None) -> list[Path]:
    """Return what stands in a folder, in the order of names; nothing where there is no such folder.

    Raises
    ------
    InputError
        If the folder may not be read: passing over it would hide what it holds.
    """
    try:
        return sorted(folder.iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        raise InputError(_reason(error), file=short_path(folder, root), expected="a readable folder") from None


def _reason(error: OSError | ValueError) -> str:
    """Say why a file cannot be read, in the system's own words."""
    return (getattr(error, "strerror", None) or "no name of a file").lower()


def open_regular(path: Path, root: Path | None = None) -> BinaryIO:
    """Open a regular file for reading bytes.

    Raises
    ------
    InputError
        If it is missing, unreadable, or no regular file: a pipe would never end.
    """
    file = short_path(path, root)
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)  # a pipe must not make it wait
    except (FileNotFoundError, NotADirectoryError):
        raise InputError("file not found", file=file, expected="a readable file") from None
    except (OSError, ValueError) as error:
        raise InputError(_reason(error), file=file, expected="a readable file") from None
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise InputError("not a file", file=file, expected="a regular file")
    return os.fdopen(handle, "rb")


def read_bytes(path: Path, root: Path | None = None, *, most: int = LARGEST) -> bytes:
    """Read a regular file.

    Raises
    ------
    InputError
        As `open_regular`, or if it is larger than `most` bytes or cannot be read to its end.
    """
    file = short_path(path, root)
    with open_regular(path, root) as stream:
        try:
            data = stream.read(most + 1)
        except OSError as error:
            raise InputError(_reason(error), file=file, expected="a readable file") from None
    if len(data) > most:
        raise InputError("too large", file=file, expected=f"a file of at most {most} bytes")
    return data


def read_text(path: Path, root: Path | None = None) -> str:
    """Read a regular UTF-8 file.

    Raises
    ------
    InputError
        As `read_bytes`, or if it is not UTF-8.
    """
    try:
        return read_bytes(path, root).decode()
    except UnicodeDecodeError as error:
        raise InputError(f"byte {error.start}", file=short_path(path, root), expected="UTF-8 text") from None


def _single(pairs: list[tuple[str, object]]) -> dict[str, object]:
    content: dict[str, object] = {}
    for key, value in pairs:
        if key in content:
            raise ValueError(f"the key {one_line(key, 60)!r} twice")
        content[key] = value
    return content


def read_json(path: Path, root: Path | None = None) -> object:
    """Read a JSON file.

    Raises
    ------
    InputError
        As `read_text`, or if it is no JSON, names a key twice, or is nested without end.
    """
    text = read_text(path, root)
    try:
        return json.loads(text, object_pairs_hook=_single)
    except (ValueError, RecursionError) as error:
        raise InputError(str(error), file=short_path(path, root), expected="well-formed JSON") from None


def read_csv(path: Path, root: Path | None = None) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Read a CSV file strictly.

    Returns
    -------
    header : list of str
    rows : list of (line number, cells)
        As many cells as the header in every row.

    Raises
    ------
    InputError
        If the file is missing, empty, ragged, malformed or cut within its last row; names file and row.
    """
    file = short_path(path, root)
    text = read_text(path, root)
    if text and not text.endswith("\n"):
        raise InputError("no end of the last line", file=file, row=text.count("\n") + 1, expected="a final newline")
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    lines: list[tuple[int, list[str]]] = []
    start = 1
    try:
        for cells in reader:
            lines.append((start, cells))
            start = reader.line_num + 1
    except csv.Error as error:
        raise InputError(str(error), file=file, row=reader.line_num, expected="well-formed CSV") from None
    if not lines:
        raise InputError("empty file", file=file, expected="a header line")
    (_, header), rows = lines[0], lines[1:]
    for number, cells in rows:
        if len(cells) != len(header):
            what = f"{len(cells)} cells" if cells else "an empty row"
            more = "; one that holds a comma stands in quotes" if len(cells) > len(header) else ""
            raise InputError(what, file=file, row=number, expected=f"{len(header)} cells{more}")
    return header, rows


def read_records(path: Path, root: Path | None = None) -> list[dict[str, str]]:
    """Read a CSV file as dictionaries: column -> cell.

    Raises
    ------
    InputError
        As `read_csv`.
    """
    header, rows = read_csv(path, root)
    return [dict(zip(header, cells, strict=True)) for _, cells in rows]
