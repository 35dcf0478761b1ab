"""Each input that a paper leaves out is swapped for another plausible one: what moves must have recorded the read."""

import os
import shutil
import sys
import time
from importlib import import_module
from pathlib import Path

import pytest

from gainsay.results import Results, run_tasks
from gainsay.tables import paper_names, read_case
from gainsay.tables.files import read_records
from gainsay.tables.units import to_si

ROOT = Path(__file__).parents[2]
#: tasks that take longer are not run again for every input, s of the processor
LONGEST = 2.0


def swapped(row) -> str:
    """Another plausible value: the end of the range farther from the value, or another entry of the list."""
    low, dots, high = row.plausible.partition("..")
    if row.type == "number" and dots:
        return max((low, high), key=lambda end: abs(float(end) - float(row.value)))
    others = [word for word in row.plausible.split("|") if word != row.value]
    return others[-1] if others else row.value


def copied(paper: str, root: Path) -> Path:
    """A project with the tables of one paper, without its record: swapped inputs are not those of the claims."""
    (root / "Snakefile").touch()
    shutil.copytree(
        ROOT / "papers" / paper, root / "papers" / paper, ignore=shutil.ignore_patterns("*.py", "recorded*")
    )
    return root / "papers" / paper / "parameters.csv"


def computed(case, step: str, function) -> tuple[dict[str, tuple], set[tuple[str, str]], bool]:
    """Quantities of one task, what each read, and whether the task came to its end."""
    run_tasks(Results(case, step), [function])
    parts = case.results / "parts"
    rows = read_records(parts / f"{step}.quantities.csv", case.root)
    reads = read_records(parts / f"{step}.reads.csv", case.root)
    broke = read_records(parts / f"{step}.failures.csv", case.root)
    values = {row["quantity"]: (row["value"], row["lower"], row["upper"]) for row in rows}
    return values, {(row["quantity"], row["parameter"]) for row in reads}, not broke


@pytest.mark.slow
@pytest.mark.skipif("GAINSAY_NIGHT" not in os.environ, reason="minutes a paper: make nightly")
@pytest.mark.parametrize("paper", paper_names(ROOT))
def test_what_moves_with_an_assumed_input_had_recorded_it(paper, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    table = copied(paper, tmp_path)
    case, text = read_case(tmp_path, paper), table.read_text()
    tasks = {}
    for step in ("synthesis", "audit"):
        for function in import_module(f"papers.{paper}.{step}").TASKS:
            begun = time.process_time()
            values, reads, whole = computed(case, step, function)
            if whole and time.process_time() - begun < LONGEST:
                tasks[step, function] = values, reads
    moved, tracked, untracked = set(), set(), set()
    for name, row in case.assumed.items():
        old, new = f"{name},{row.type},{row.value},", f"{name},{row.type},{swapped(row)},"
        assert text.count(f"\n{old}") == 1
        table.write_text(text.replace(f"\n{old}", f"\n{new}"))
        changed = read_case(tmp_path, paper)
        for (step, function), (before, reads) in tasks.items():
            after, _, whole = computed(changed, step, function)
            if not whole:
                continue  # what was searched or certified at one value may not hold at another
            here = {(quantity, name) for quantity in after if after[quantity] != before.get(quantity)}
            moved |= here
            untracked |= here - reads
            tracked |= {pair for pair in reads if pair[1] == name}
    table.write_text(text)
    never = sorted(tracked - moved)
    print(
        f"\n{paper}: {len(tasks)} tasks, {len(moved)} quantities move with an input, {len(never)} read one and never do"
    )
    print("\n".join(f"  {quantity} never moves with {name}" for quantity, name in never), file=sys.stdout)
    assert untracked == set()


def test_a_swap_is_another_plausible_value():
    case = read_case(ROOT, "wan2014")
    for name, row in case.assumed.items():
        value = swapped(row)
        assert value != row.value or len(row.plausible.split("|")) == 1, name
        if row.type == "number" and ".." in row.plausible:
            assert to_si(row.unit) and float(value) != float(row.value)
