"""The whole pipeline and single commands against their unavoidable parts."""

import shutil
import sys
import tempfile
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from statistics import median

from gainsay.bench.measure import Row, cpu_of, cpu_of_command, paired
from gainsay.proof import check_file
from gainsay.tables import Case

_STEPS = ("synthesis", "audit", "simulation", "figures", "views", "verdicts", "report", "check")


def _copy(root: Path, folder: Path) -> Path:
    """Copy the project without results: a cold pipeline."""
    for name in ("papers", "workflow", "Snakefile", "README.md", "pyproject.toml"):
        source = root / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
        else:
            shutil.copy(source, folder / name)
    return folder


def _imports(root: Path, paper: str) -> float:
    """Return the CPU seconds of importing what each step imports, one process a step."""
    total = 0.0
    for step in _STEPS:
        modules = [f"gainsay.steps.{step}"]
        own = {"simulation": "runs", "views": "runs"}.get(step, step)
        if (root / "papers" / paper / f"{own}.py").is_file():
            modules.append(f"papers.{paper}.{own}")
        if step == "views":
            modules.append("rerun")
        total += cpu_of_command([sys.executable, "-c", f"import {', '.join(modules)}"], root)
    return total


def pipeline(root: Path, case: Case) -> Iterator[Row]:
    """Measure the cold pipeline of a paper against an empty DAG, bare imports and the bare work of its tasks."""
    with tempfile.TemporaryDirectory() as place:
        folder = _copy(root, Path(place))
        empty = Path(place, "empty")
        empty.mkdir()
        (empty / "Snakefile").write_text("rule all:\n")
        command = ["snakemake", "--cores", "2", "--config", f"papers={case.name}", "--until", "differences"]
        cold = cpu_of_command(command, folder)
        dag = median(cpu_of_command(["snakemake", "--cores", "2"], empty) for _ in range(3))
        work = 0.0
        for step in ("synthesis", "audit"):
            tasks = import_module(f"papers.{case.name}.{step}").TASKS
            work += sum(cpu_of(lambda t=task: t(case, _Discard(case))) for task in tasks)
        work += sum(cpu_of(lambda r=run: _integrate(case, r)) for run in import_module(f"papers.{case.name}.runs").RUNS)
        yield Row(f"{case.name}: cold pipeline", "empty DAG + imports + bare work", cold,
                   dag + _imports(folder, case.name) + work, 1.5)  # fmt: skip


class _Discard:
    """Stands for `Results` where only the work of a task counts."""

    def __init__(self, case: Case) -> None:
        self.case = case

    def __getattr__(self, name: str) -> object:
        return lambda *arguments, **named: None


def _integrate(case: Case, run: object) -> None:
    run.simulate(case, case.designs, _Discard(case))


def proofs(case: Case) -> Iterator[Row]:
    """Measure checking all certificates of a paper against reading them."""
    files = sorted((case.results / "certificates").glob("*.json"))
    if not files:
        return
    yield paired(f"{case.name}: check {len(files)} certificates", lambda: [check_file(f, case.root) for f in files],
                  "reading the files", lambda: [f.read_bytes() for f in files], runs=3)  # fmt: skip


def replays(case: Case) -> Iterator[Row]:
    """Measure `gainsay replay`, with and without its figures, against bare reading plus the same imports."""
    log = case.results / "logs" / f"{next(iter(case.paper.runs))}.mcap"
    if not log.is_file():
        return
    read = f"from pathlib import Path; from gainsay.logs import read_log; read_log(Path({str(log)!r}))"
    for what, extra, flags in (
        ("numbers", "", ["--numbers-only"]),
        ("and figures", f", papers.{case.name}.figures", []),
    ):
        bare = f"import gainsay.cli, gainsay.steps.replay, papers.{case.name}.runs{extra}; {read}"
        again = [sys.executable, "-m", "gainsay.cli", "replay", *flags, str(log)]
        alone = [sys.executable, "-c", bare]
        yield paired(f"{case.name}: replay, {what}", lambda again=again: again, "reading it + imports",
                     lambda alone=alone: alone, aim=2.0, runs=3,
                     timer=lambda make: cpu_of_command(make(), case.root))  # fmt: skip
