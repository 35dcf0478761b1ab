"""Run the steps of every paper as another machine would and hold each run against the record.

Another machine computes with other kernels of the linear algebra (OPENBLAS_CORETYPE), other vector instructions of
NumPy (NPY_DISABLE_CPU_FEATURES: exp, log, power) and of the C library (GLIBC_TUNABLES: sin, cos, exp), other numbers of
threads and another order of hashed sets. Each of these is tried at least once, not their whole product.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from gainsay.errors import InputError
from gainsay.results.returned import read_returned
from gainsay.steps.command import CLEAN, DIFFERENCES, refuse
from gainsay.tables import Case, find_root, paper_names, read_case
from gainsay.tables.files import write_csv
from gainsay.verdicts.differences import Difference, differences
from gainsay.verdicts.record import scan_items, scans_of
from gainsay.verdicts.tolerance import share

#: part of its tolerance that a quantity may use on another machine; above it, its bound is not a bound
LARGEST_SHARE = 0.3
STEPS = ("synthesis", "audit", "simulation", "verdicts", "compare")
COLUMNS = ("paper", "quantity", "class", "share", "machine")


@dataclass(frozen=True)
class Machine:
    """What one run pretends.

    Attributes
    ----------
    name : str
    variables : mapping of str to str
        Environment variables of the steps.
    needs : tuple of str
        Flags that the processor must have.
    quick : bool
        Whether it belongs to the short selection.
    """

    name: str
    variables: Mapping[str, str]
    needs: tuple[str, ...] = ()
    quick: bool = False


def _threads(number: int) -> dict[str, str]:
    return {f"{library}_NUM_THREADS": str(number) for library in ("OMP", "OPENBLAS", "MKL", "RAYON")}


MACHINES = (
    Machine(
        "Prescott, two threads",
        {"OPENBLAS_CORETYPE": "Prescott", **_threads(2), "PYTHONHASHSEED": "1"},
        quick=True,
    ),
    Machine(
        "Haswell, NumPy without AVX-512",
        {
            "OPENBLAS_CORETYPE": "Haswell",
            "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL",
            **_threads(1),
            "PYTHONHASHSEED": "2",
        },
        ("avx2", "avx512f"),
    ),
    Machine(
        "Zen, NumPy without AVX2, C library without FMA",
        {
            "OPENBLAS_CORETYPE": "Zen",
            "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL",
            "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4",
            **_threads(1),
            "PYTHONHASHSEED": "1",
        },
        ("avx2",),
        quick=True,
    ),
    Machine(
        "SkylakeX, two threads",
        {"OPENBLAS_CORETYPE": "SkylakeX", **_threads(2), "PYTHONHASHSEED": "2"},
        ("avx512f", "avx512dq"),
    ),
)


def processor_flags() -> frozenset[str]:
    """Return the flags of this processor; none where the system does not say."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return frozenset()
    line = next((line for line in text.splitlines() if line.startswith("flags")), "")
    return frozenset(line.partition(":")[2].split())


def _environment(machine: Machine, flags: frozenset[str]) -> dict[str, str]:
    """Return the environment of the steps, without features that this NumPy or processor does not know."""
    from numpy._core._multiarray_umath import (  # type: ignore[import-not-found]  # its only list of names
        __cpu_dispatch__,
        __cpu_features__,
    )

    kept = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    wanted = dict(machine.variables)
    if "NPY_DISABLE_CPU_FEATURES" in wanted:
        known = [
            name
            for name in wanted["NPY_DISABLE_CPU_FEATURES"].split()
            if name in __cpu_dispatch__ and __cpu_features__.get(name)
        ]
        wanted["NPY_DISABLE_CPU_FEATURES"] = " ".join(known)
    return {**kept, **wanted}


def _copy(root: Path, place: Path) -> None:
    """Copy what a run needs: the tables and modules of the papers, and the mark of a project's root."""
    shutil.copy(root / "Snakefile", place / "Snakefile")
    shutil.copytree(root / "papers", place / "papers", ignore=shutil.ignore_patterns("__pycache__"))


def _run_paper(place: Path, paper: str, environment: Mapping[str, str]) -> list[str]:
    """Run the steps of a paper and return a line for each that ended badly."""
    broken = []
    for step in STEPS:
        command = [sys.executable, "-m", f"gainsay.steps.{step}", paper, "--root", str(place)]
        done = subprocess.run(command, env=dict(environment), cwd=place, capture_output=True, text=True, check=False)
        if done.returncode != CLEAN:
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            broken.append(f"{paper} {step} ended with {done.returncode}: {last}")
    return broken


def shares(case: Case) -> Iterator[tuple[str, str, float]]:
    """Yield the name, class and share of its tolerance of every number on record that was computed."""
    for row in read_returned(case.results / "quantities.csv", case.root):
        recorded = case.recorded.get(row["quantity"])
        if recorded is not None:
            yield row["quantity"], recorded.class_, share(recorded, float(row["value"]))
    for claim, scan in scans_of(case).items():
        for item, (text, number) in scan_items(scan).items():
            on_record = case.recorded_scans.get((claim, item))
            if number and on_record is not None:
                yield f"{claim} {item}", on_record.class_, share(on_record, float(text))


def run_machine(root: Path, machine: Machine, papers: Sequence[str]) -> tuple[list[str], list[Difference], list[tuple]]:
    """Run all papers as one machine.

    Returns
    -------
    broken : list of str
        Steps that ended badly.
    differing_rows : list of Difference
        Differences from the record, but for files, of which this run makes only a part.
    used : list of tuple
        Rows of `COLUMNS`.
    """
    environment = _environment(machine, processor_flags())
    with tempfile.TemporaryDirectory(prefix="gainsay-") as folder:
        place = Path(folder)
        _copy(root, place)
        with ThreadPoolExecutor(2) as pool:
            broken = [line for lines in pool.map(lambda p: _run_paper(place, p, environment), papers) for line in lines]
        differing_rows: list[Difference] = []
        used: list[tuple] = []
        for paper in () if broken else papers:
            case = read_case(place, paper)
            differing_rows += [row for row in differences(case) if row[1] != "file"]
            used += [(paper, name, class_, part, machine.name) for name, class_, part in shares(case)]
    return broken, differing_rows, used


def _report(used: list[tuple], most: int = 10) -> list[tuple]:
    """Print the largest shares, each quantity once, and return those that are too large."""
    worst: dict[tuple[str, str], tuple] = {}
    for row in sorted(used, key=lambda row: -row[3]):
        worst.setdefault(row[:2], row)
    for paper, name, class_, part, machine in list(worst.values())[:most]:
        print(f"  {100 * part:6.2f} % of its tolerance: {paper} {name} ({class_}), {machine}")
    return [row for row in worst.values() if row[3] > LARGEST_SHARE]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the papers as other machines and return the exit code: 1 where anything differs from the record."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("papers", nargs="*", help="folder names below papers/; default: all")
    parser.add_argument("--quick", action="store_true", help="a short selection of machines")
    parser.add_argument("--here", action="store_true", help="as this machine is: for other versions of the libraries")
    parser.add_argument("--root", type=Path, help="project root; default: the project around the current folder")
    options = parser.parse_args(arguments)
    try:
        root = find_root(options.root)
        papers = options.papers or paper_names(root)
        for paper in papers:
            read_case(root, paper)
    except InputError as error:
        return refuse(error)
    flags, all_used, bad = processor_flags(), [], False
    chosen = [machine for machine in MACHINES if machine.quick or not options.quick]
    for machine in [Machine("as it is", _threads(1))] if options.here else chosen:
        if not set(machine.needs) <= flags:
            print(f"kernels     {machine.name}: not checked, this processor lacks {', '.join(machine.needs)}")
            continue
        broken, differing_rows, used = run_machine(root, machine, papers)
        print(f"kernels     {machine.name}: {len(differing_rows)} differences in {len(papers)} papers", flush=True)
        for line in broken:
            print(f"  {line}")
        for paper, what, item, expected, value, note in differing_rows:
            print(f"  {paper}  {what} {item}: expected {expected or 'nothing'}, found {value or 'nothing'}; {note}")
        all_used += used
        bad |= bool(broken or differing_rows)
    too_large = _report(all_used)
    rows = sorted(all_used, key=lambda row: -row[3])
    write_csv(root / "results" / "kernels.csv", COLUMNS, [(*row[:3], float(row[3]), row[4]) for row in rows])
    print(
        f"kernels     {len(too_large)} numbers use more than {LARGEST_SHARE:.0%} of their tolerance, "
        "see results/kernels.csv"
    )
    return DIFFERENCES if bad or too_large else CLEAN


if __name__ == "__main__":
    sys.exit(main())
