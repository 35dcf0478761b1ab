"""Make every log of a paper open well: an .rrd and a Foxglove layout beside each .mcap, and a list of all topics."""

import sys
from typing import Any

from gainsay.errors import ComputationError
from gainsay.logs import read_log
from gainsay.logs.topics import Topics
from gainsay.logs.views import write_views
from gainsay.results import Results
from gainsay.steps.command import step_command
from gainsay.steps.modules import is_declared, paper_module
from gainsay.tables import Case
from gainsay.tables.files import write_atomically


def views(case: Case) -> None:
    """Write the views of every run that left a log; one that breaks leaves a failed record."""
    results = Results(case, "views")
    layout: Any = None  # a Layout, where the paper has runs
    with results.task("views", "import", quiet=True):
        if is_declared(case, "runs", case.paper.runs):
            layout = paper_module(case, "runs").LAYOUT
    topics = Topics()
    for run in case.paper.runs if layout is not None else ():
        path = case.results / "logs" / f"{run}.mcap"
        with results.task(run, "views"):
            path.with_suffix(".rrd").unlink(missing_ok=True)  # an old view must not stand for a log that fails now
            if not path.is_file():
                raise ComputationError(run, "the run left no log")
            log = read_log(path)
            topics.add(run, log)
            for made in write_views(path, layout, log):
                derived = made.suffix == ".rrd"  # its bytes are never the same twice
                results.list_file(f"logs/{made.name}", of=f"logs/{path.name}" if derived else "")
            results.say(run, f"{path.with_suffix('.rrd').name} opens with its layout")
    write_atomically(case.results / "logs" / "README.md", topics.page(case.name))
    results.list_file("logs/README.md")
    results.close()


if __name__ == "__main__":
    sys.exit(step_command(views, __doc__))
