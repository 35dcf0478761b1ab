"""Where the CPU seconds of one chunk of a campaign go, at its size by default, the start of its process included.

``python -m gainsay.bench.campaigns [paper campaign]`` prints a line for each campaign, or for the one named; in
minutes, each in a process and a copy of the project of its own. What is told apart, each without the ones before it:

- the solver: Clarabel, LAPACK's eigenvalues, an integrator with its right-hand side;
- solving: scaling a program, evaluating every block at the points that came back, multipliers that may refute; reading
  states, peaks and crossings off the polynomials of an integration;
- proving: certificates made and accepted, eigenvalues enclosed, boxes tested, which the campaign is asked for;
- starting: the interpreter, imports, tables, digest of the code;
- the rest: programs stated from their text, random numbers, rows and files.
"""

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gainsay import steps  # noqa: F401  # one thread per numeric library, as in the workflow
from gainsay.bench.measure import project_copy
from gainsay.bench.meter import Meter, replaced
from gainsay.errors import GainsayError
from gainsay.tables import find_root, paper_names, read_case

#: part of the seconds of a chunk that solving, integrating and proving should take
AIM = 0.9
_KINDS = ("solves", "integrations", "imports", "solving", "proving")
#: how the kinds are told
_COLUMNS = {"solver": ("solves", "integrations"), "solving": ("solving",), "proving": ("proving",)}


@contextmanager
def _counted(meter: Meter) -> Iterator[None]:
    """Count solving and proving inside the block, in modules of papers that are imported inside it too."""
    import numpy as np

    from gainsay.campaigns import box, feasibility
    from gainsay.proof import build
    from gainsay.simulation import batch
    from gainsay.systems import enclosed_spectra

    def candidates(program: Any) -> Iterator[Any]:
        following = meter.around("solving", iter(plain(program)).__next__)
        while True:
            try:
                yield following()
            except StopIteration:
                return

    plain = feasibility.candidates
    of_segments = ((batch.Segment, name) for name in ("__call__", "of", "outputs", "bounds"))
    reading = (*of_segments, (batch, "polished_peak"), (batch, "polished_crossing"))
    proving = (
        *((build, "feasible_point"), (build, "farkas")),
        *((box, "branch"), (box, "_proofs"), (enclosed_spectra, "resolved")),
    )
    places: list[tuple[Any, str, Any]] = [
        (owner, name, meter.around(kind, getattr(owner, name)))
        for kind, counted in (("solving", reading), ("proving", proving))
        for owner, name in counted
    ]
    places.append((np.linalg, "eig", meter.around("solves", np.linalg.eig)))
    with meter.calls(), replaced([*places, (feasibility, "candidates", candidates)]):
        yield


def _of_chunk(root: Path, paper: str, campaign: str) -> dict[str, float]:
    """Evaluate the first chunk of a campaign in this process; return its seconds by column, and those of all."""
    from gainsay.campaigns.store import write_chunk
    from gainsay.steps.campaign import collect_seldom, plan_of

    collect_seldom()
    meter = Meter(_KINDS)
    with meter.imports(), _counted(meter):
        plan = plan_of(read_case(root, paper), campaign)
        start = time.process_time() - sum(meter.seconds.values())
        write_chunk(plan, 0)
    everything = time.process_time()
    seconds_of = {name: sum(meter.seconds[kind] for kind in kinds) for name, kinds in _COLUMNS.items()}
    seconds_of["starting"] = start + meter.seconds["imports"]
    return {**seconds_of, "rest": everything - sum(seconds_of.values()), "seconds": everything}


def told(paper: str, campaign: str, seconds_of: dict[str, float]) -> str:
    """One line of the table."""
    whole = seconds_of["seconds"]
    parts = "".join(f"{100 * seconds_of[name] / whole:9.1f} %" for name in (*_COLUMNS, "starting", "rest"))
    share = sum(seconds_of[name] for name in _COLUMNS) / whole
    verdict = "met" if share >= AIM else "MISSED"
    return f"{paper + ' ' + campaign:<32}{whole:7.1f} s{parts}{100 * share:9.1f} %  {verdict}"


def measured(root: Path, paper: str, campaign: str) -> dict[str, float]:
    """Measure one chunk in a process of its own.

    Raises
    ------
    RuntimeError
        If it does not end well.
    """
    with project_copy(root) as copy:
        command = [sys.executable, "-m", "gainsay.bench.campaigns", paper, campaign, "--copy", str(copy)]
        done = subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or ["no message"])[-1])
    return json.loads(done.stdout)


def main() -> int:
    """Print the table, or as JSON the seconds of one chunk where its copy of the project is given."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("campaign", nargs="*", help="paper and name of one campaign; default: all of all papers")
    parser.add_argument("--copy", type=Path, help=argparse.SUPPRESS)  # of the project, made by the process that asks
    options = parser.parse_args()
    if len(options.campaign) not in (0, 2):
        parser.error("expected a paper and the name of one of its campaigns, or nothing")
    if options.copy:
        try:
            print(json.dumps(_of_chunk(options.copy, *options.campaign)))
        except GainsayError as error:
            print(error, file=sys.stderr)
            return 1
        return 0
    root = find_root()
    names = [(paper, name) for paper in paper_names(root) for name in read_case(root, paper).campaigns]
    print(
        f"{'one chunk of':<32}{'CPU':>9}"
        + "".join(f"{name:>11}" for name in (*_COLUMNS, "starting", "rest"))
        + f"{'the first three, aim 90 %':>27}"
    )
    for paper, campaign in [tuple(options.campaign)] if options.campaign else names:
        try:
            print(told(paper, campaign, measured(root, paper, campaign)), flush=True)
        except RuntimeError as error:
            print(f"{paper} {campaign}: not measured: {error}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
