"""Measure everything and print a line each: `make bench`."""

import argparse
import resource
import sys
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from gainsay import steps  # noqa: F401  # one thread per numeric library, as in the workflow
from gainsay.bench import chain, integration, logs, outcomes, programs, synthesis, tasks
from gainsay.bench.measure import Row
from gainsay.errors import GainsayError
from gainsay.tables import Case, find_root, paper_names, read_case


def ratios(case: Case) -> Iterator[Iterable[Row]]:
    """Yield the measurements of a paper against baselines, each a few rows."""
    if case.name == "wan2014":
        yield integration.rendezvous(case)
        yield synthesis.rows(case)
        yield chain.replays(case)


def _ratios(root: Path, papers: list[str]) -> tuple[int, int]:
    missed = unmeasured = 0
    parts = [programs.rows(), logs.rows(), *(part for paper in papers for part in ratios(read_case(root, paper)))]
    for part in parts:
        try:
            for row in part:
                print(row, flush=True)
                missed += row.aim is not None and row.ratio > row.aim
        except (GainsayError, RuntimeError) as error:
            print(f"not measured: {error}", flush=True)
            unmeasured += 1
    return missed, unmeasured


def main() -> int:
    """Print the seconds of every task and their bare parts, then every ratio; misses change no exit code."""
    argparse.ArgumentParser(prog="gainsay.bench", description=(__doc__ or "").splitlines()[0]).parse_args()
    begun, root = time.perf_counter(), find_root()
    papers = paper_names(root)
    with ThreadPoolExecutor(1) as pool:  # the tasks, in processes of their own, fill what one process leaves idle
        rows = pool.submit(lambda: list(tasks.rows(root, papers)))
        print("CPU seconds against baselines measured in turn", flush=True)
        missed, unmeasured = _ratios(root, papers)
        print("Programs of known outcome: right, undecided and wrong answers", flush=True)
        for line in outcomes.rows():
            print(line, flush=True)
        print("CPU seconds of the tasks, and the share of bare solves, bare integrations and imports in them")
        for row in rows.result():
            print(row, flush=True)
            unmeasured += isinstance(row, str)
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    seconds = sum(u.ru_utime + u.ru_stime for u in used)
    print(
        f"{missed} aims missed, {unmeasured} not measured, "
        f"in {time.perf_counter() - begun:.0f} s and {seconds:.0f} CPU seconds"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
