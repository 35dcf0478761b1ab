"""New papers and new projects: a worked example that is green at once, to be replaced piece by piece."""

import csv
import io
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from gainsay import __version__
from gainsay.errors import InputError
from gainsay.tables.files import naming
from gainsay.tables.folder import checked_name
from gainsay.tables.models import TABLES, columns

_HERE = Path(__file__).resolve().parent
#: name under which the example stands in its own modules
_EXAMPLE = "example"
#: what a folder may hold before a project is made in it
_BEFOREHAND = {".git", ".venv", "wheels"}
#: file of a project -> its template
_PROJECT = {
    "Snakefile": "Snakefile",
    "config.yaml": "config.yaml",
    "profiles/default/config.yaml": "profile.yaml",
    ".gitignore": "gitignore",
    ".github/workflows/gainsay.yml": "ci.yaml",
    "requirements.txt": "requirements.txt",
    "README.md": "README.md",
    "papers/__init__.py": "papers_init.py",
}


def _table(name: str, text: str) -> str:
    """Return a table with all columns of its model; those that the example does not fill are empty."""
    header = columns(TABLES[name])
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([row.get(column, "") for column in header] for row in csv.DictReader(io.StringIO(text)))
    return out.getvalue()


def paper_files(name: str) -> Iterator[tuple[str, str]]:
    """Yield every file of a new paper, below its folder, with its text."""
    for path in sorted((_HERE / "paper").rglob("*")):
        file = str(path.relative_to(_HERE / "paper"))
        if not path.is_file() or "__pycache__" in file:
            continue
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".py":
            text = text.replace(f"papers.{_EXAMPLE}", f"papers.{name}").replace(f'"{_EXAMPLE}"', f'"{name}"')
        yield file, _table(file, text) if file in TABLES else text
    for file in ("errata.csv", "not_checked.csv", "replies.csv"):
        if not (_HERE / "paper" / file).is_file():
            yield file, _table(file, "")


def project_files() -> Iterator[tuple[str, str]]:
    """Yield every file of a new project, below its root, with its text."""
    for file, template in _PROJECT.items():
        yield file, (_HERE / "project" / template).read_text(encoding="utf-8").replace("VERSION", __version__)


def _write(folder: Path, files: Iterator[tuple[str, str]]) -> None:
    for file, text in files:
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        with naming(path):
            path.write_text(text, encoding="utf-8")


def new_paper(root: Path, name: str) -> Path:
    """Write the worked example as a new paper of a project, whole or not at all.

    Parameters
    ----------
    root : Path
        Project root.
    name : str
        Name of the paper's folder, such as ``wan2014``.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    InputError
        If the name is none for a paper, or something of this name stands there.
    """
    folder = root / "papers" / checked_name(name)
    if folder.exists():
        raise InputError("new paper", file=f"papers/{name}", expected="nothing of this name there")
    with tempfile.TemporaryDirectory(dir=root / "papers", prefix=".new-") as place:
        made = Path(place, name)
        _write(made, paper_files(name))
        made.rename(folder)
    return folder


def new_project(root: Path, name: str) -> Path:
    """Write a project with one paper, whole or not at all, and return the paper's folder.

    Raises
    ------
    InputError
        If the folder holds more than ``.git``, ``.venv`` and ``wheels``, or the name is none for a paper.
    """
    checked_name(name)
    entries = sorted({path.name for path in root.glob("*")} - _BEFOREHAND)
    if entries:
        raise InputError("new project", file=str(root), value=entries[0], expected="an empty folder")
    root.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=root.parent, prefix=".new-") as place:
        made = Path(place, "project")
        _write(made, project_files())
        new_paper(made, name)
        root.mkdir(exist_ok=True)
        for path in made.iterdir():
            shutil.move(path, root / path.name)
    return root / "papers" / name
