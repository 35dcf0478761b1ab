"""The list of files that a step leaves, each with its SHA-256: what is lost, emptied or altered shows."""

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path

from gainsay.errors import InputError
from gainsay.tables.files import read_records, write_csv

LISTING_COLUMNS = ("file", "sha256", "of")


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_listing(path: Path, folder: Path, files: Mapping[str, str]) -> None:
    """Write the list of the files that a step leaves.

    Parameters
    ----------
    path : Path
        The list.
    folder : Path
        What the names of the files are relative to.
    files : mapping of str to str
        File -> the file that it is made of and held against, for one whose bytes are never the same twice (``.rrd``);
        else empty: the file stands for itself.
    """
    rows = [(file, sha256(folder / (of or file)), of) for file, of in sorted(files.items())]
    write_csv(path, LISTING_COLUMNS, rows)


def damage(path: Path, folder: Path) -> Iterator[tuple[str, str]]:
    """Yield each file of a list that is not as it was left, and how: missing, empty, altered or unreadable.

    A list that is missing, malformed or without a file is itself what is damaged: every step leaves something.
    """
    name = f"{path.parent.name}/{path.name}"
    try:
        rows = [(row["file"], row["sha256"], row["of"]) for row in read_records(path)]
    except (InputError, KeyError):
        rows = []
    if not rows:
        yield name, "altered" if path.exists() else "missing"
        return
    for file, digest, of in rows:
        how = _damaged(folder / file, folder / (of or file), digest)
        if how:
            yield file, how


def _damaged(path: Path, held: Path, digest: str) -> str:
    """Say how a file is damaged, or nothing; `held` is what its digest was taken of."""
    try:
        if not path.is_file():
            return "missing"
        if not path.stat().st_size:
            return "empty"
        return "" if held.is_file() and sha256(held) == digest else "altered"
    except OSError:  # no permission, a name that no file can have
        return "unreadable"
