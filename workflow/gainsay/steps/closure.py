"""What a step depends on, read from its imports and its tables: the workflow reruns a step when one of these changes.

Nothing is listed by hand, and nothing is imported to find out: imports are read as text, also those inside functions.
What is loaded by name is known: the modules of a paper that a step runs, and everything in `gainsay.proof`, whose kinds
of proof are found by their names.
"""

import ast
import csv
import hashlib
import io
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
    "quantities.csv": ("id", "unit", "step"),
}

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


@cache
def _imported(path: Path) -> frozenset[str]:
    """Return every module that a file may import, at its top or inside a function."""
    names: set[str] = set()
    for node in _statements(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
    return frozenset(names)


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

    Raises
    ------
    SyntaxError
        If a file cannot be parsed; the step itself then says so, hence callers may pass over it.
    """
    files: dict[Path, None] = {}
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        parts = name.split(".")
        for package in (".".join(parts[:k]) for k in range(1, len(parts) + 1)):
            path = _file(root, package)
            if path is None or path in files:
                continue
            files[path] = None
            waiting += _imported(path)
            if package in BY_NAME:
                inside = (p for p in path.parent.rglob("*.py"))
                waiting += [_module(p) for p in inside]
    return sorted(files)


def _module(path: Path) -> str:
    parts = path.relative_to(LIBRARY.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def sources(root: Path, step: str, paper: str | None = None) -> list[str]:
    """Return the source files that a step depends on, relative to the root where they lie below it.

    A module of the paper that cannot be parsed stands for itself: the step that runs it says what is wrong.
    """
    files: set[Path] = set(closure(root, [f"gainsay.steps.{step}"]))
    if paper is None:
        return sorted(short_path(path, root) for path in files)
    for module in PAPER_MODULES[step]:
        name = f"papers.{paper}.{module}"
        try:
            files |= set(closure(root, [name]))
        except SyntaxError:
            files |= set((root / "papers" / paper).glob("*.py"))
    return sorted(short_path(path, root) for path in files)


def table_digest(root: Path, paper: str) -> str:
    """Return a digest of the columns of claims and quantities that computations depend on.

    A word in a statement or a note changes nothing here, so that it makes no computation run again.
    """
    digest = hashlib.sha256()
    for table, columns in COLUMNS.items():
        path = root / "papers" / paper / table
        try:
            lines = csv.DictReader(io.StringIO(read_text(path), newline=""))
            rows = [[row.get(column) for column in columns] for row in lines]
        except (InputError, csv.Error):
            rows = [[str(path)]]  # whatever is wrong with it, the steps refuse it
        digest.update(repr(rows).encode())
    return digest.hexdigest()
