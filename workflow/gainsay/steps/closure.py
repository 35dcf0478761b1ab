"""What a step depends on, read from its imports and its tables: the workflow reruns a step when one of these changes.

Nothing is listed by hand, and nothing is imported to find out: imports are parsed, also those inside functions.
What is loaded by name is known: the modules of a paper that a step runs, and everything in `gainsay.proof`, whose kinds
of proof are found by their names.
"""

import ast
import csv
import hashlib
import io
import tomllib
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from gainsay.errors import InputError
from gainsay.tables.files import read_text, short_path

LIBRARY = Path(__file__).resolve().parents[1]
#: the modules of a paper that each step runs; a page asks whether campaigns are of the code as it stands
PAPER_MODULES = {
    "synthesis": ("synthesis",),
    "audit": ("audit",),
    "simulation": ("runs",),
    "figures": ("figures",),
    "views": ("runs",),
    "verdicts": (),
    "compare": ("statements",),
    "page": ("campaigns",),
    "report": (),
}
#: packages whose modules are loaded by name: one that is imported stands for all of them
BY_NAME = ("gainsay.proof",)
#: columns of a table that computations depend on; the others are for readers
COLUMNS = {
    "claims.csv": ("id", "comparator", "quantity", "published", "unit", "tolerance"),
    "quantities.csv": ("id", "unit", "step", "requires"),
    "parameters.csv": ("name", "type", "value", "unit", "status", "plausible"),
}
#: step -> entries of paper.toml that it hangs on, whole or, with a star, their names alone: captions are for readers
ENTRIES = {"simulation": ("title", "doi", "runs"), "figures": ("journal", "figures*")}

#: what holds statements, in statements of every kind
_BODIES = ("body", "handlers", "orelse", "finalbody", "cases")


@cache
def _file(root: Path, module: str) -> Path | None:
    """Return the file of a module of the library or of a paper, or None."""
    parts = module.split(".")
    if parts[0] == "gainsay":
        base = LIBRARY
    elif parts[0] == "papers":
        base = root / "papers"
    else:
        return None
    place = base.joinpath(*parts[1:])
    for path in (place.with_suffix(".py") if len(parts) > 1 else None, place / "__init__.py"):
        if path is not None and path.is_file():
            return path
    return None


def _imported(path: Path, module: str) -> set[str]:
    """Return every module that the file of a module may import, at its top or inside a function.

    One that cannot be parsed imports nothing: the step that runs it says what is wrong, and runs again when it changes.
    """
    try:
        tree = ast.parse(path.read_bytes())
    except (SyntaxError, ValueError):
        return set()
    names: set[str] = set()
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    for node in _statements(tree):
        if isinstance(node, ast.Import):
            names |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) + 1 - node.level] if node.level else []
            source = ".".join([*above, *filter(None, [node.module])])
            names |= {source, *(f"{source}.{name.name}" for name in node.names)}
    return names


def _statements(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the statements of a module, those inside others too: imports stand nowhere else."""
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        for part in _BODIES:
            waiting += getattr(node, part, ())


def closure(root: Path, modules: Iterable[str]) -> list[Path]:
    """Return the files of some modules and of all that they import, of the library and of the papers.

    Parameters
    ----------
    root : Path
        Project root.
    modules : iterable of str
        Names such as ``gainsay.steps.audit``.

    Returns
    -------
    list of Path
        Sorted; packages' ``__init__`` files among them.
    """
    files: set[Path] = set()
    waiting = [path for name in modules for path in _files(root, name)]
    while waiting:
        path = waiting.pop()
        if path not in files:
            files.add(path)
            waiting += _needed(root, path)
    return sorted(files)


@cache
def _files(root: Path, module: str) -> tuple[Path, ...]:
    """Return the files that importing a module runs: its own and those of the packages around it."""
    parts = module.split(".")
    files = (_file(root, ".".join(parts[:k])) for k in range(1, len(parts) + 1))
    return tuple(path for path in files if path is not None)


@cache
def _needed(root: Path, path: Path) -> frozenset[Path]:
    """Return the files of all modules that a file may import."""
    names = _imported(path, _module(root, path))
    for package in BY_NAME:
        if path == _file(root, package):
            names |= {_module(root, inside) for inside in path.parent.rglob("*.py")}
    return frozenset(file for name in names for file in _files(root, name))


def _module(root: Path, path: Path) -> str:
    above = LIBRARY.parent if path.is_relative_to(LIBRARY) else root
    parts = path.relative_to(above).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def sources(root: Path, step: str, paper: str | None = None) -> list[str]:
    """Return the source files that a step depends on, relative to the root where they lie below it."""
    modules = [f"gainsay.steps.{step}"]
    if paper is not None:
        modules += [f"papers.{paper}.{module}" for module in PAPER_MODULES[step]]
    return sorted(short_path(path, root) for path in closure(root, modules))


def table_digest(root: Path, paper: str, step: str) -> str:
    """Return a digest of what of a paper's tables a step depends on: columns of tables, entries of paper.toml.

    A word in a statement, a note or a caption changes nothing here, so that it makes no computation run again.
    """
    folder = root / "papers" / paper
    cells = [_cells(folder / table, columns) for table, columns in COLUMNS.items()]
    entries = _entries(folder / "paper.toml", ENTRIES.get(step, ()))
    return hashlib.sha256(repr((cells, entries)).encode()).hexdigest()


def _cells(path: Path, columns: Iterable[str]) -> list[list[str | None]]:
    """Cells of some columns of a table."""
    try:
        lines = csv.DictReader(io.StringIO(read_text(path), newline=""))
        return [[row.get(column) for column in columns] for row in lines]
    except (InputError, csv.Error):
        return [[str(path)]]  # whatever is wrong with it, the steps refuse it


def _entries(path: Path, entries: Iterable[str]) -> list[object]:
    """Entries of paper.toml, of those with a star their names."""
    try:
        table = tomllib.loads(read_text(path))
    except (InputError, tomllib.TOMLDecodeError):
        return [str(path)]
    return [list(table.get(name[:-1], ())) if name.endswith("*") else table.get(name) for name in entries]
