"""The modules of a paper, always those of the project whose tables are read."""

import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

from gainsay.tables import Case


def use_project(root: Path) -> None:
    """Let `papers` mean the folder of a project, whatever it meant before in this process."""
    root = root.resolve()
    loaded = sys.modules.get("papers")
    if loaded is not None and str(root / "papers") not in list(loaded.__path__):
        for name in [name for name in sys.modules if name.partition(".")[0] == "papers"]:
            del sys.modules[name]
    if sys.path[:1] != [str(root)]:
        sys.path.insert(0, str(root))


def paper_module(case: Case, name: str) -> ModuleType:
    """Import a module of a paper, such as its ``audit``, from the project of its tables.

    Raises
    ------
    ImportError
        If the paper has no such module, or the module does not import; whatever else it raises passes through.
    """
    use_project(case.root)
    return import_module(f"papers.{case.name}.{name}")


def is_declared(case: Case, name: str, declared: object) -> bool:
    """Say whether a module of a paper has work to do: what it makes is declared in paper.toml, or it is there."""
    return bool(declared) or (case.folder / f"{name}.py").is_file()
