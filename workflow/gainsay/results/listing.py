"""The list of files that a step leaves, each with its SHA-256: what is lost, emptied or altered shows."""

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from gainsay.errors import InputError
from gainsay.tables.contract import CONTRACT
from gainsay.tables.files import read_records, write_csv

LISTING_COLUMNS = ("file", "sha256", "of", "contract")
DERIVED_COLUMNS = ("file", "sha256")


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def derived_listing(path: Path, folder: Path) -> Path:
    """Return where the digests of files that are never the same twice stand: among the attempts, which are not either.

    Parameters
    ----------
    path : Path
        The list of the step's files, ``<step>.files.csv``.
    folder : Path
        What the names of the files are relative to.
    """
    return folder / "attempts" / path.name.replace(".files.", ".derived.")


def write_listing(path: Path, folder: Path, files: Mapping[str, str]) -> None:
    """Write the list of the files that a step leaves.

    Parameters
    ----------
    path : Path
        The list.
    folder : Path
        What the names of the files are relative to.
    files : mapping of str to str
        File -> the file that it is made of, for one whose bytes are never the same twice (``.rrd``): the list, which is
        the same every time, holds the digest of that one, and `derived_listing` the file's own. Else empty: the file
        stands for itself.
    """
    derived = [(file, sha256(folder / file)) for file, of in sorted(files.items()) if of]
    if derived:
        write_csv(derived_listing(path, folder), DERIVED_COLUMNS, derived)
    rows = [(file, sha256(folder / (of or file)), of, CONTRACT) for file, of in sorted(files.items())]
    write_csv(path, LISTING_COLUMNS, rows)


def damage(path: Path, folder: Path) -> Iterator[tuple[str, str]]:
    """Yield each file of a list that is not as it was left, and how: missing, empty, altered or unreadable.

    A list that is missing, malformed, without a file or written under another contract is itself what is damaged: every
    step leaves something.
    """
    name = f"{path.parent.name}/{path.name}"
    rows = _rows(path, LISTING_COLUMNS)
    if not rows:
        yield name, "altered" if path.exists() else "missing"
        return
    if any(contract != CONTRACT for *_, contract in rows):
        yield name, f"of another contract than {CONTRACT}"
        return
    derived = _rows(derived_listing(path, folder), DERIVED_COLUMNS) if any(of for _, _, of, _ in rows) else []
    own = dict(derived)
    for file, digest, of, _ in rows:
        digests = {folder / file: own.get(file, ""), folder / of: digest} if of else {folder / file: digest}
        how = _damaged(folder / file, digests)
        if how:
            yield file, how


def _rows(path: Path, columns: tuple[str, ...]) -> list[tuple[Any, ...]]:
    """Rows of a list; none where it is missing or malformed."""
    try:
        return [tuple(row[column] for column in columns) for row in read_records(path)]
    except (InputError, KeyError):
        return []


def _damaged(path: Path, digests: Mapping[Path, str]) -> str:
    """Say how a file is damaged, or nothing; `digests` are those of all that it is held against."""
    try:
        if not path.is_file():
            return "missing"
        if not path.stat().st_size:
            return "empty"
        held = all(other.is_file() and sha256(other) == digest for other, digest in digests.items())
        return "" if held else "altered"
    except OSError:  # no permission, a name that no file can have
        return "unreadable"
