"""Simulate the runs of a paper, log each in full, and measure its quantities from its log."""

import sys

from gainsay.errors import InputError
from gainsay.logs import LogWriter, RunSpec, read_log
from gainsay.results import Results
from gainsay.steps.command import step_command
from gainsay.steps.modules import is_declared, paper_module
from gainsay.tables import Case
from gainsay.tables.contract import CONTRACT
from gainsay.tables.files import read_text


def provenance(case: Case, run: RunSpec) -> dict[str, str]:
    """Return what a log says of its own origin; the same on every machine."""
    from gainsay import __version__

    return {
        "paper": case.name,
        "run": run.name,
        "about": case.paper.runs[run.name],
        "title": case.paper.title,
        "doi": case.paper.doi,
        "gainsay": __version__,
        "contract": CONTRACT,
    }


def measure(case: Case, run: RunSpec, results: Results) -> None:
    """Compute a run's quantities from its log alone."""
    file = f"logs/{run.name}.mcap"
    results.measured(run.measure(case, read_log(case.results / file)), source=file)


def simulate(case: Case, run: RunSpec, results: Results) -> None:
    """Simulate a run into its log, then measure it."""
    path = case.results / "logs" / f"{run.name}.mcap"
    path.unlink(missing_ok=True)  # an old log must not stand for a run that fails now
    path.parent.mkdir(parents=True, exist_ok=True)
    parameters = read_text(case.folder / "parameters.csv", case.root).encode()
    with LogWriter(path, provenance=provenance(case, run), attachments={"parameters.csv": parameters}) as log:
        run.simulate(case, case.designs, log)
    results.list_file(f"logs/{run.name}.mcap")
    measure(case, run, results)
    size = path.stat().st_size / 1e6
    results.say(run.name, f"{case.paper.runs[run.name]}, {size:.1f} MB")


def simulation(case: Case) -> None:
    """Run every declared run of a paper; one that breaks leaves a failed record and the others run."""
    results = Results(case, "simulation")
    runs: dict[str, RunSpec] = {}
    with results.task("runs", "import", quiet=True):
        if is_declared(case, "runs", case.paper.runs):
            runs = {run.name: run for run in paper_module(case, "runs").RUNS}
    if runs and set(runs) != set(case.paper.runs):
        raise InputError(
            "runs", file=f"papers/{case.name}/paper.toml", value=sorted(case.paper.runs), expected=f"{sorted(runs)}"
        )
    for run in runs.values():
        with results.task(run.name, "simulate"):
            simulate(case, run, results)
    results.close()


if __name__ == "__main__":
    sys.exit(step_command(simulation, __doc__))
