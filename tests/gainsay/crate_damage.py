"""Ways to damage or forge a crate, and what must come of it: for the tests."""

import hashlib
import json
import shutil
import warnings
import zipfile
from collections import Counter

import pytest

from gainsay import cli
from gainsay.steps.archive import METADATA
from gainsay.steps.verify import verify
from tests.gainsay.table_damage import BYTES, PLACES, TEXTS, in_json

NAMES = ["../out", "/etc/passwd", "", ".", "a\0b", "x" * 5000, "\ud800", "papers", "results/../papers", "\x1b[31m",
         "papers/toy2001/claims.csv/", "//", "~", "-h", 5, None, ["a"], {"a": 1}, 1e308, True]  # fmt: skip
#: what a zip file calls its entries, as text
PATHS = [name for name in NAMES if isinstance(name, str) and name.isprintable() and name]
#: a file, a link, a folder, a pipe
SORTS = [0o100644 << 16, 0o120777 << 16, 0o040755 << 16, 0o010644 << 16]


def described(crate, file):
    """Put the digest of a changed file into every description of it, as a forger would."""
    path = crate / file
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    metadata = json.loads((crate / METADATA).read_text())
    (entity,) = (entity for entity in metadata["@graph"] if entity["@id"] == file)
    entity["sha256"] = digest
    (crate / METADATA).write_text(json.dumps(metadata))
    for listing in [*crate.glob("results/*/parts/*.files.csv"), *crate.glob("results/report.files.csv")]:
        folder = crate / "results" if listing.name == "report.files.csv" else listing.parents[1]
        lines = listing.read_bytes().decode(errors="surrogateescape").split("\n")
        for number, line in enumerate(lines):
            if folder / line.split(",")[0] == path and listing != path:
                lines[number] = ",".join([line.split(",")[0], digest, *line.split(",")[2:]])
                listing.write_bytes("\n".join(lines).encode(errors="surrogateescape"))
                return described(crate, str(listing.relative_to(crate)))
    return None


def in_file(crate, draw):
    """One file is damaged; sometimes all that says its digest is forged to match."""
    path = draw.choice(sorted(path for path in crate.rglob("*") if path.is_file() and path.name != METADATA))
    structured = path.suffix == ".json" and draw.random() < 0.6
    damage = in_json if structured else draw.choice([*BYTES, *TEXTS, *PLACES])
    try:
        damage(path, draw)
    except (ValueError, IndexError):  # a picture holds no text
        path.write_bytes(path.read_bytes()[:-1])
    if path.is_file() and not path.is_symlink() and draw.random() < 0.7:
        described(crate, str(path.relative_to(crate)))
    return f"{path.relative_to(crate)} after {damage.__name__}"


def in_metadata(crate, draw):
    """Another value somewhere in the metadata, or other bytes."""
    damage = in_json if draw.random() < 0.5 else draw.choice([*BYTES, *TEXTS])
    damage(crate / METADATA, draw)
    return f"metadata after {damage.__name__}"


def names(crate, draw):
    """A file is described under another name, or as something else."""
    content = json.loads((crate / METADATA).read_text())
    entity = draw.choice(content["@graph"])
    entity["@id"] = draw.choice(NAMES)
    if draw.random() < 0.5:
        entity["@type"] = draw.choice(["File", ["File", 3], {"File": 1}, None, "Dataset"])
    (crate / METADATA).write_text(json.dumps(content))
    return f"an entity named {entity['@id']!r}"[:80]


def added(crate, draw):
    """A file that nobody described, or that a forger did; none of them is to be run."""
    folder = draw.choice(sorted(path for path in crate.rglob("*") if path.is_dir()))
    path = folder / draw.choice(
        ["sitecustomize.py", "conftest.py", "a\nb", "\x1b[31m", "paper.csv", "$(id)", "x" * 200]
    )
    path.write_text("raise SystemExit('run')\n")
    if draw.random() < 0.5:
        content = json.loads((crate / METADATA).read_text())
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        content["@graph"].append({"@id": path.relative_to(crate).as_posix(), "@type": "File", "sha256": digest})
        (crate / METADATA).write_text(json.dumps(content))
    return f"a new file {path.relative_to(crate)!s}"


def nothing(path, draw):
    """The zip file is whole; what is odd stands in its list of entries."""


def zipped(crate, draw):
    """A zip file in place of the folder, damaged, or with an entry that is doubled, renamed, or no file."""
    made = crate.with_suffix(".made")
    files = sorted(path for path in crate.rglob("*") if path.is_file())
    odd = draw.choice(files)
    with zipfile.ZipFile(made, "w", draw.choice([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED])) as archive:
        for path in files:
            entry = zipfile.ZipInfo(path.relative_to(crate).as_posix())
            if path == odd and draw.random() < 0.6:
                entry.filename, entry.external_attr = draw.choice(PATHS), draw.choice(SORTS)
            archive.writestr(entry, path.read_bytes())
            if path == odd and draw.random() < 0.2:
                with warnings.catch_warnings(action="ignore", category=UserWarning):  # a name twice is the point
                    archive.writestr(entry, b"another")
    shutil.rmtree(crate)
    made.rename(crate)
    damage = draw.choice([nothing, nothing, *BYTES])
    damage(crate, draw)
    return f"a zip file after {damage.__name__}"


WAYS = [in_file, in_file, in_file, in_metadata, names, added, zipped]


def campaign(written, place, count, draw, capsys):
    """Damage copies of a crate and check each; returns how many were refused, found to differ and found clean."""
    outcomes = Counter()
    _, clean = verify(written)
    for number in range(count):
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(written, place / "crate")
        what = f"{number}: {draw.choice(WAYS)(place / 'crate', draw)}"
        capsys.readouterr()
        try:
            code = cli.main(["verify", str(place / "crate")])
        except Exception as error:  # whatever is no refusal is what this looks for: it fails with the damage named
            pytest.fail(f"{what}: {type(error).__name__}: {error}"[:2000])
        said = capsys.readouterr()
        outcomes[code] += 1
        assert all(line.isprintable() for line in (said.out + said.err).splitlines()), what
        assert code != 2 or (said.err.count("\n") == 1 and not said.out), what
        assert code != 0 or said.out.splitlines()[1:-1] == clean[1:], what
        assert [path.name for path in place.iterdir()] == ["crate"], what
    return outcomes
