"""A command against its unavoidable parts."""

import sys
from collections.abc import Iterator
from functools import partial

from gainsay.bench.measure import Row, cpu_of_command, paired
from gainsay.tables import Case


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
        yield paired(
            f"{case.name}: replay, {what}",
            partial(cpu_of_command, again, case.root),
            "reading it + imports",
            partial(cpu_of_command, alone, case.root),
            aim=2.0,
            runs=1,
            timer=lambda measured: measured(),
        )
