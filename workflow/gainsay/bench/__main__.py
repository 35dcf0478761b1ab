"""Measure everything and print a line each: `make bench`."""

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from gainsay import steps  # noqa: F401  # one thread per numeric library, as in the workflow
from gainsay.bench import chain, integration, logs, synthesis
from gainsay.bench.measure import Row
from gainsay.errors import GainsayError
from gainsay.tables import Case, find_root, paper_names, read_case


def rows(root: Path, case: Case) -> Iterator[Iterable[Row]]:
    """Yield the measurements of a paper, each a few rows."""
    if case.name == "wan2014":
        yield integration.rendezvous(case)
        yield synthesis.rows(case)
    yield chain.proofs(case)
    yield chain.replays(case)
    yield chain.pipeline(root, case)


def main() -> int:
    """Print every ratio with its aim; misses are reported and change no exit code."""
    root = find_root()
    missed = unmeasured = 0
    everything = [logs.rows(), *(part for paper in paper_names(root) for part in rows(root, read_case(root, paper)))]
    for part in everything:
        try:
            for row in part:
                print(row, flush=True)
                missed += row.aim is not None and row.ratio > row.aim
        except (GainsayError, RuntimeError) as error:
            print(f"not measured: {error}", flush=True)
            unmeasured += 1
    print(f"{missed} aims missed, {unmeasured} not measured")
    return 0


if __name__ == "__main__":
    sys.exit(main())
