import ast
import subprocess
import sys
import tomllib
from graphlib import CycleError, TopologicalSorter
from itertools import chain
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = ROOT / "workflow" / "gainsay"
#: from the ground up; what stands together may import each other
FLOORS = (
    ("errors",), ("exact",), ("tables",), ("results",), ("scans",), ("proof",), ("lmi",), ("statements",), ("systems",),
    ("dynamics",), ("simulation",), ("logs",), ("figures",), ("verdicts",), ("campaigns",), ("report",),
    ("steps", "cli", "bench", "rules", "scaffold", "__main__"),
)  # fmt: skip
LEVEL = {name: level for level, floor in enumerate(FLOORS) for name in floor}
EXAMPLE = LIBRARY / "scaffold" / "paper"
MODULES = sorted(path for path in LIBRARY.rglob("*.py") if not path.is_relative_to(EXAMPLE))
PAPERS = sorted([*(ROOT / "papers").rglob("*.py"), *EXAMPLE.rglob("*.py")])


def identity(path: Path) -> str:
    return str(path.relative_to(ROOT))


def imported(path: Path) -> set[str]:
    """Return every module that a file imports, at its top or inside a function; names of packages as modules too."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{identity(path)}: relative import"
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
    return found


def floor(path: Path) -> str:
    return path.relative_to(LIBRARY).parts[0].removesuffix(".py")


@pytest.mark.parametrize("path", MODULES, ids=identity)
def test_imports_go_down_the_floors_only(path):
    if path == LIBRARY / "__init__.py":
        assert not imported(path), "the package itself imports nothing"
        return
    own = LEVEL[floor(path)]
    for module in imported(path):
        parts = module.split(".")
        if parts[0] == "papers":
            pytest.fail(f"{identity(path)} imports {module}: the library knows no paper")
        if parts[0] != "gainsay" or len(parts) == 1:
            continue
        if parts[1] not in LEVEL:
            assert parts[1].startswith("__"), f"{identity(path)} imports {module}, on no floor"
            continue
        assert LEVEL[parts[1]] <= own, f"{identity(path)} imports {module} from above"


@pytest.mark.parametrize("path", [*MODULES, *PAPERS], ids=identity)
def test_cvxpy_and_solvers_stay_on_their_floor(path):
    heavy = {module.split(".")[0] for module in imported(path)} & {"cvxpy", "clarabel", "scs", "ecos", "osqp"}
    assert not heavy or floor_of(path) == "lmi", f"{identity(path)} imports {heavy}"


def test_no_module_imports_itself_by_way_of_others():
    names = {".".join(path.relative_to(LIBRARY.parent).with_suffix("").parts): path for path in MODULES}
    below = {name: sorted(imported(path) & names.keys() - {name}) for name, path in names.items()}
    try:
        TopologicalSorter(below).prepare()
    except CycleError as error:
        pytest.fail(f"a circle of imports: {' -> '.join(error.args[1])}")


#: imported name -> the package that brings it, where the two differ
PACKAGES = {"flint": "python-flint", "google": "protobuf", "PIL": "pillow", "rerun": "rerun-sdk"}


def test_every_package_that_is_imported_is_declared():
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())
    extras = declared["project"]["optional-dependencies"].values()
    product = [*declared["project"]["dependencies"], *chain.from_iterable(extras)]
    everything = [*product, *declared["dependency-groups"]["dev"]]
    own = {"gainsay", "papers", "tests"}
    for paths, packages in (([*MODULES, *PAPERS], product), (sorted((ROOT / "tests").rglob("*.py")), everything)):
        named = {package.partition("==")[0] for package in packages}
        for path in paths:
            roots = {module.split(".")[0] for module in imported(path)} - own - sys.stdlib_module_names
            missing = {PACKAGES.get(root, root.replace("_", "-")) for root in roots} - named
            assert not missing, f"{identity(path)} imports {sorted(missing)}, which pyproject.toml does not declare"


def floor_of(path: Path) -> str:
    return floor(path) if path.is_relative_to(LIBRARY) else "papers"


@pytest.mark.parametrize("path", [*MODULES, *PAPERS], ids=identity)
def test_oracles_of_tests_and_gpl_stay_out_of_the_product(path):
    roots = {module.split(".")[0] for module in imported(path)}
    assert not roots & {"control", "slycot", "cvxopt", "jitcdde", "hypothesis", "pytest"}


def test_the_checker_knows_no_solver_and_no_paper():
    for path in sorted((LIBRARY / "proof").rglob("*.py")):
        roots = {module.split(".")[0] for module in imported(path)}
        assert not roots & {"cvxpy", "clarabel", "scipy", "papers"}, identity(path)


def loaded_after(statement: str) -> set[str]:
    code = f"import sys; {statement}; print(' '.join(sorted({{name.split('.')[0] for name in sys.modules}})))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    return set(done.stdout.split())


HEAVY = {"numpy", "scipy", "cvxpy", "clarabel", "flint", "pandas", "matplotlib", "mcap", "google", "rerun", "pydantic"}


@pytest.mark.parametrize("statement", ["import gainsay", "import gainsay.proof", "import gainsay.errors"])
def test_some_imports_are_light(statement):
    assert not loaded_after(statement) & HEAVY


@pytest.mark.parametrize(
    ("module", "without"),
    [
        ("gainsay.tables", {"scipy", "cvxpy", "matplotlib", "pandas", "rerun"}),
        ("gainsay.verdicts.table", {"scipy", "cvxpy", "matplotlib", "pandas", "rerun"}),
        ("gainsay.steps.simulation", {"cvxpy", "matplotlib", "rerun"}),
        ("gainsay.steps.figures", {"cvxpy", "rerun"}),
        ("gainsay.cli", {"scipy", "cvxpy", "matplotlib", "pandas", "rerun", "mcap"}),
    ],
)
def test_a_step_loads_only_what_it_needs(module, without):
    assert not loaded_after(f"import {module}") & without


def public(body: list[ast.stmt]) -> list[ast.stmt]:
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return [node for node in body if isinstance(node, kinds) and not node.name.startswith("_")]


@pytest.mark.parametrize("path", [*MODULES, *PAPERS], ids=identity)
def test_everything_public_has_a_docstring(path):
    tree = ast.parse(path.read_text())
    assert ast.get_docstring(tree), f"{identity(path)}: the module"
    for node in public(tree.body):
        assert ast.get_docstring(node), f"{identity(path)}:{node.lineno} {node.name}"
        if isinstance(node, ast.ClassDef):
            for method in public(node.body):
                assert ast.get_docstring(method), f"{identity(path)}:{method.lineno} {node.name}.{method.name}"
