"""Where the numbers of a page come from: digests of what went in, versions of what computed; the same everywhere.

What is not the same everywhere (commit, date, machine) stands in ``provenance.json``, which no page quotes.
"""

import datetime
import hashlib
import json
import os
import platform
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from gainsay import __version__
from gainsay.report.reading import PaperResults
from gainsay.results.listing import sha256
from gainsay.tables.contract import CONTRACT
from gainsay.tables.files import write_atomically

__all__ = ["Provenance", "provenance_of", "provenance_over", "write_provenance"]

_LIBRARY = Path(__file__).resolve().parents[2]
#: libraries whose versions numbers depend on
LIBRARIES = ("numpy", "scipy", "cvxpy", "clarabel", "python-flint", "mcap", "matplotlib", "snakemake")


@dataclass(frozen=True)
class Provenance:
    """Digests and versions.

    Attributes
    ----------
    digests : tuple of (str, str)
        What, and its SHA-256.
    versions : tuple of (str, str)
        Library and version.
    """

    digests: tuple[tuple[str, str], ...]
    versions: tuple[tuple[str, str], ...]


def _named(path: Path, root: Path) -> str:
    """Return a name that is the same everywhere: below the project, or below where the library is installed."""
    for base in (root, _LIBRARY):
        if path.is_relative_to(base):
            return path.relative_to(base).as_posix().removeprefix("workflow/")
    return path.name


def _digest(root: Path, files: Iterable[Path]) -> str:
    """Return one SHA-256 over the names and the contents of files."""
    lines = sorted(f"{sha256(path)}  {_named(path, root)}\n" for path in files if path.is_file())
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def _tables(results: PaperResults) -> list[Path]:
    folder = results.case.folder
    return [path for kind in ("*.csv", "*.toml", "printed/*.csv", "designs/*.json") for path in folder.glob(kind)]


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return "not installed"


def _provenance(root: Path, tables: Iterable[Path], code: Iterable[str], about: str) -> Provenance:
    digests = [
        (f"tables of {about}", _digest(root, tables)),
        ("code that computed them", _digest(root, [root / file for file in code])),
        ("every library and its digest (requirements.lock)", _digest(root, [root / "requirements.lock"])),
    ]
    gainsay, *others = _versions()
    return Provenance(tuple(digests), (gainsay, ("contract of the results", CONTRACT), *others))


def _versions() -> list[tuple[str, str]]:
    return [("gainsay", __version__), *((library, _version(library)) for library in LIBRARIES)]


def provenance_of(results: PaperResults) -> Provenance:
    """Return where the numbers of a paper's page come from."""
    return _provenance(results.case.root, _tables(results), results.code, results.case.name)


def provenance_over(root: Path, papers: Iterable[PaperResults]) -> Provenance:
    """Return where the numbers of the page over all papers come from."""
    papers = list(papers)
    tables = [path for results in papers for path in _tables(results)]
    code = sorted({file for results in papers for file in results.code})
    return _provenance(root, tables, code, "all papers")


def _commit(root: Path) -> str | None:
    """Return the commit that is checked out, with a plus where files differ from it; None outside a repository."""
    try:
        text = [
            subprocess.run(["git", *command], cwd=root, capture_output=True, text=True, timeout=20, check=True).stdout
            for command in (("rev-parse", "HEAD"), ("status", "--porcelain", "--untracked-files=no"))
        ]
    except (OSError, subprocess.SubprocessError):
        return None
    return text[0].strip() + ("+" if text[1].strip() else "")


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return platform.processor() or platform.machine()
    named = [line.partition(":")[2].strip() for line in text.splitlines() if line.startswith("model name")]
    return named[0] if named else platform.machine()


def write_provenance(root: Path) -> Path:
    """Write ``results/provenance.json``: what differs from run to run and from machine to machine."""
    content = {
        "commit": _commit(root),
        "finished": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "processor": _processor(),
        "processors": os.cpu_count(),
        "versions": {"python": platform.python_version(), **dict(_versions())},
        "kernels": {
            name: os.environ.get(name)
            for name in ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES", "OMP_NUM_THREADS")
        },
    }
    path = root / "results" / "provenance.json"
    write_atomically(path, json.dumps(content, indent=2) + "\n")
    return path
