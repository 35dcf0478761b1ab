"""Seconds of wall of a campaign on one core and on two, as the workflow runs it, and that the results are the same.

``python -m gainsay.bench.scaling [paper campaign]`` on a machine that does nothing else; in minutes, in copies of the
project.
"""

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

from gainsay.bench.measure import project_copy
from gainsay.tables import find_root

#: chunks of equal work, enough of it that starting Snakemake weighs little
PAPER, CAMPAIGN = "li2021", "random-gains"
AIM = 1.8


def measured(root: Path, paper: str, campaign: str, cores: int) -> tuple[float, bytes]:
    """Run a campaign in a copy of the project; return seconds of wall and its gathered table.

    Raises
    ------
    RuntimeError
        If the campaign does not end well.
    """
    with project_copy(root) as copy:
        command = [sys.executable, "-m", "snakemake", "campaigns", "--cores", str(cores)]
        chosen = ["--config", f"papers={paper}", f"campaigns={campaign}"]
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
        begun = time.perf_counter()
        done = subprocess.run(
            [*command, *chosen], cwd=copy, env={**os.environ, "PATH": path}, capture_output=True, text=True, check=False
        )
        seconds = time.perf_counter() - begun
        if done.returncode:
            raise RuntimeError((done.stderr.strip().splitlines() or ["no message"])[-1])
        return seconds, (copy / "results" / paper / "campaigns" / f"{campaign}.parquet").read_bytes()


def main() -> int:
    """Print seconds on one core and on two, and their ratio."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("paper", nargs="?", default=PAPER)
    parser.add_argument("campaign", nargs="?", default=CAMPAIGN)
    options = parser.parse_args()
    root, paper, campaign = find_root(), options.paper, options.campaign
    (one, table), (two, same) = (measured(root, paper, campaign, cores) for cores in (1, 2))
    told = "the same table" if same == table else "ANOTHER TABLE"
    print(
        f"{paper} {campaign}: {one:.1f} s on one core, {two:.1f} s on two, {told}: "
        f"{one / two:.2f} times as fast, aim {AIM}"
    )
    return int(same != table)


if __name__ == "__main__":
    sys.exit(main())
