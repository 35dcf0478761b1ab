"""Measure everything and print a line each: `make bench`."""

import sys

from gainsay import steps  # noqa: F401  # one thread per numeric library, as in the workflow
from gainsay.bench import chain, integration, logs, synthesis
from gainsay.tables import find_root, paper_names, read_case


def main() -> int:
    """Print every ratio with its aim; misses are reported and change no exit code."""
    root = find_root()
    missed = 0

    def show(row: object) -> None:
        nonlocal missed
        if row is not None:
            print(row, flush=True)
            missed += row.aim is not None and row.ratio > row.aim

    for row in logs.rows():
        show(row)
    for paper in paper_names(root):
        case = read_case(root, paper)
        if paper == "wan2014":
            for row in integration.rendezvous(case):
                show(row)
            for row in synthesis.rows(case):
                show(row)
        show(chain.proofs(case))
        for row in chain.replays(case):
            show(row)
        show(chain.pipeline(root, case))
    print(f"{missed} aims missed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
