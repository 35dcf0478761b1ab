"""CPU seconds of every task of the papers, and what of them is bare work; a process a paper, in a copy of the project.

``python -m gainsay.bench.tasks <paper> --root <copy>`` measures one paper and prints its rows as JSON.
"""

import json
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stdout
from dataclasses import asdict, dataclass
from io import StringIO
from pathlib import Path

from gainsay.bench.measure import project_copy
from gainsay.bench.meter import KINDS, Meter
from gainsay.errors import GainsayError

#: seconds below which tasks are told together
_SHORT = 0.5


@dataclass(frozen=True)
class TaskRow:
    """CPU seconds of a task, and those of its bare parts."""

    paper: str
    step: str
    task: str
    seconds: float
    parts: dict[str, float]

    def __str__(self) -> str:
        return f"{self.paper + ' ' + self.step:<24}{self.task:<40.40}{self.seconds:8.2f} s{_shares(self)}"


def _shares(row: TaskRow) -> str:
    if not row.seconds > 0:
        return ""
    shares = [f"{kind} {100 * row.parts[kind] / row.seconds:3.0f} %" for kind in KINDS]
    return "  " + "  ".join(shares)


def together(rows: Sequence[TaskRow], paper: str, step: str, task: str) -> TaskRow:
    """Sum of rows."""
    parts = {kind: sum(row.parts[kind] for row in rows) for kind in KINDS}
    return TaskRow(paper, step, task, sum(row.seconds for row in rows), parts)


def rows(root: Path, papers: Sequence[str]) -> Iterator[TaskRow | str]:
    """Measure all papers, two at a time; yield the longer tasks, a sum a paper, and the sum of all.

    A paper whose tasks did not all end well gives a line that says so instead.
    """
    with project_copy(root) as copy:
        everything: list[TaskRow] = []
        with ThreadPoolExecutor(2) as pool:
            for paper, times in zip(papers, pool.map(lambda p: _measured(copy, p), papers), strict=True):
                if isinstance(times, str):
                    yield f"not measured: {paper}: {times}"
                    continue
                everything += times
                yield from sorted((row for row in times if row.seconds >= _SHORT), key=lambda row: -row.seconds)
                short = [row for row in times if row.seconds < _SHORT]
                yield together(short, paper, "", f"{len(short)} tasks below {_SHORT} s each")
                yield together(times, paper, "", "together")
        yield together(everything, "all papers", "", "together")


def _measured(copy: Path, paper: str) -> list[TaskRow] | str:
    command = [sys.executable, "-m", "gainsay.bench.tasks", paper, "--root", str(copy)]
    done = subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False)
    if done.returncode:
        return (done.stderr.strip().splitlines() or ["no message"])[-1]
    return [TaskRow(**row) for row in json.loads(done.stdout)]


def _of_paper(root: Path, paper: str) -> list[TaskRow]:
    """Measure the tasks of a paper in this process."""
    measured: list[TaskRow] = []
    begun, meter = time.process_time(), Meter()
    with meter.imports():
        from importlib import import_module

        from gainsay.proof import check
        from gainsay.proof.build import accepted
        from gainsay.results import Results
        from gainsay.results.returned import read_part
        from gainsay.steps.simulation import simulate
        from gainsay.tables import read_case

        owners = {"synthesis": "synthesis", "audit": "audit", "simulation": "runs"}
        modules = {step: import_module(f"papers.{paper}.{owner}") for step, owner in owners.items()}
    seconds = time.process_time() - begun
    # importlib is not seen by the meter; all of it but nothing else is imports
    measured.append(
        TaskRow(paper, "start", "imports of the steps", seconds, {**dict.fromkeys(KINDS, 0.0), "imports": seconds})
    )
    case = read_case(root, paper)
    for step, module in modules.items():
        results = Results(case, step, verify=lambda certificate: accepted(certificate) or check(certificate, case))
        work = module.RUNS if step == "simulation" else module.TASKS
        for part in work:
            name = part.name if step == "simulation" else part.where
            meter, begun = Meter(), time.process_time()
            with meter.imports(), meter.calls(), results.task(name, name):
                if step == "simulation":
                    simulate(case, part, results)
                else:
                    part(case, results)
            measured.append(TaskRow(paper, step, name, time.process_time() - begun, meter.seconds))
        results.close()
    if failed := read_part(case, "failures"):
        raise RuntimeError(f"{len(failed)} tasks failed, which is not a measurement: {failed[0]['message']}")
    return measured


def main() -> int:
    """Measure one paper and print its rows."""
    paper, _, root = sys.argv[1:]
    with redirect_stdout(StringIO()):
        try:
            times = _of_paper(Path(root), paper)
        except (GainsayError, RuntimeError) as error:
            print(error, file=sys.stderr)
            return 1
    print(json.dumps([asdict(row) for row in times]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
