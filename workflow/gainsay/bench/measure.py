"""Paired measurements: candidate and baseline in turn, so that a machine's drift hits both."""

import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any


@dataclass(frozen=True)
class Row:
    """A ratio with its aim.

    Attributes
    ----------
    what, against : str
        What was measured, and the baseline.
    seconds, baseline : float
        Medians, CPU seconds.
    aim : float or None
        The ratio seconds / baseline should be at most this; None where no aim was set.
    """

    what: str
    against: str
    seconds: float
    baseline: float
    aim: float | None

    @property
    def ratio(self) -> float:
        """Candidate over baseline."""
        return self.seconds / self.baseline

    def __str__(self) -> str:
        aim = "" if self.aim is None else f"  aim {self.aim:.2f}  {'met' if self.ratio <= self.aim else 'MISSED'}"
        return f"{self.what:<42} {self.seconds:8.3f} s  {self.ratio:7.2f} x {self.against:<44}{aim}"


@contextmanager
def project_copy(root: Path) -> Iterator[Path]:
    """Yield a folder with the tables and modules of a project and no results, which is gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="gainsay-") as place:
        copy = Path(place)
        shutil.copy(root / "Snakefile", copy)
        shutil.copytree(root / "papers", copy / "papers", ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("workflow", "profiles"):
            (copy / name).symlink_to(root / name)
        yield copy


def cpu_of(work: Callable[[], object]) -> float:
    """Return the CPU seconds that a call takes in this process."""
    start = time.process_time()
    work()
    return time.process_time() - start


def cpu_of_command(arguments: Sequence[str], folder: Path) -> float:
    """Return the CPU seconds of a command and all that it starts.

    Raises
    ------
    RuntimeError
        If the command fails: a broken run is not a measurement.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(arguments, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(arguments)} ended with {done.returncode}: {done.stderr[-2000:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def paired(
    what: str,
    candidate: Callable[[], Any],
    against: str,
    baseline: Callable[[], Any],
    *,
    aim: float | None = None,
    runs: int = 5,
    timer: Callable[[Callable[[], Any]], float] = cpu_of,
) -> Row:
    """Measure two calls in turn and return the medians; several runs have one more before them, to warm up."""
    if runs > 1:
        timer(candidate), timer(baseline)
    times = [(timer(candidate), timer(baseline)) for _ in range(runs)]
    return Row(what, against, median(t for t, _ in times), median(t for _, t in times), aim)
