"""Draw the figures of a paper from its logs alone; one that sets designs beside each other, from the quantities."""

import sys
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from gainsay.errors import ComputationError
from gainsay.figures import FigureSpec, save
from gainsay.logs import Log, read_log
from gainsay.results import Results
from gainsay.steps.command import step_command
from gainsay.steps.modules import is_declared, paper_module
from gainsay.tables import Case


def draw(case: Case, figure: FigureSpec, read: Callable[[Path], Log]) -> None:
    """Draw one figure from the logs of its runs, as SVG and PNG."""
    paths = {run: case.results / "logs" / f"{run}.mcap" for run in figure.runs}
    for run, path in paths.items():
        if not path.is_file():
            raise ComputationError(figure.name, f"the run {run} left no log")
    logs = {run: read(path) for run, path in paths.items()}
    save(figure, logs, case, case.results / "figures")


def figures(case: Case) -> None:
    """Draw every figure; one that breaks leaves a failed record and the others are drawn."""
    results, read = Results(case, "figures"), cache(read_log)  # several figures are drawn from one log
    specs: Sequence[FigureSpec] = ()
    with results.task("figures", "import", quiet=True):
        if is_declared(case, "figures", case.paper.figures):
            specs = paper_module(case, "figures").FIGURES
    for figure in specs:
        with results.task(figure.name, "draw"):
            for ending in ("svg", "png"):
                (case.results / "figures" / f"{figure.name}.{ending}").unlink(missing_ok=True)
            draw(case, figure, read)
            for ending in ("svg", "png"):
                results.list_file(f"figures/{figure.name}.{ending}")
            results.say(figure.name, f"from {', '.join(figure.runs) or 'the quantities'}")
    results.close()


if __name__ == "__main__":
    sys.exit(step_command(figures, __doc__))
