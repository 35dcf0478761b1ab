"""Damaged tables: each copy is refused in one short line, or read as what a second reader finds in it.

The seed is part of the test.
"""

import os
import random
import shutil
from collections import Counter
from pathlib import Path

import pytest

from gainsay.errors import InputError
from gainsay.tables import read_case
from tests.gainsay.table_damage import BYTES, NEVER, PLACES, TEXTS, Malformed, second_reading

ROOT = Path(__file__).resolve().parents[2]
#: what docs/robustness.md says of this campaign
TRIED = [
    {
        "what": "tables of the papers",
        "how": "bytes, digits, names, quotes, lines and codings changed; a link, a pipe, a device, a folder or nothing "
        "in place of the file",
        "fast": 40, "slow": 300, "night": 3000,
        "promise": "refused in one line of at most 300 characters, or read as a second reader reads the same bytes, "
        "cell by cell and digit by digit",
    }
]  # fmt: skip
COUNT = TRIED[0]["night" if os.environ.get("GAINSAY_NIGHT") else "slow"]
SEED, BATCHES = 20261125, 10
PAPERS = ("li2021", "pinheiro2013", "wan2014", "zhang2013")


def copied(to, paper):
    """A project with a copy of the tables of one paper."""
    shutil.copytree(
        ROOT / "papers" / paper, to / "papers" / paper, ignore=shutil.ignore_patterns("*.py", "__pycache__")
    )
    (to / "Snakefile").touch()
    return to


def tried(root, paper, draw):
    """Damage one file of a copy and read it; returns the damage and what became of it."""
    folder_ = root / "papers" / paper
    kinds = [sorted(folder_.glob(p)) for p in ("*.csv", "*.toml", "printed/*.csv", "designs/*.json")]
    path = draw.choice(draw.choice([found for found in kinds if found]))
    before = path.read_bytes()
    damages = draw.choice([BYTES, TEXTS, TEXTS, PLACES])
    done = []
    for _ in range(1 if damages is PLACES else draw.choice([1, 1, 2])):
        damage = draw.choice(damages)
        try:
            damage(path, draw)
        except (ValueError, IndexError):
            continue  # the second damage finds nothing left to damage
        done.append(damage.__name__)
    what = f"{path.relative_to(root)} after {done}"
    try:
        case = read_case(root, paper)
    except InputError as error:
        found = "refused"
        assert len(str(error)) <= 300, what
        assert str(error).isprintable(), what
    except Exception as error:  # whatever is no refusal is what this looks for: it fails with the damage named
        pytest.fail(f"{what}: {type(error).__name__}: {error}"[:2000])
    else:
        found = "read"
        assert not NEVER & set(done), what
        try:
            second_reading(folder_, case)
        except (Malformed, AssertionError, UnicodeDecodeError) as error:
            pytest.fail(f"{what}: read as something else: {error!r}"[:2000])
    finally:
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        else:
            path.unlink(missing_ok=True)
        path.write_bytes(before)
    return done, found


def campaign(tmp_path, papers, count, draw):
    """Damage copies one after the other; returns how many were refused and read, and how many of each damage."""
    roots = {paper: copied(tmp_path / paper, paper) for paper in papers}
    outcomes, damages = Counter(), Counter()
    for _ in range(count):
        paper = draw.choice(papers)
        done, found = tried(roots[paper], paper, draw)
        outcomes[found] += 1
        damages.update(done)
    for paper, root in roots.items():  # put back as it was, it is read
        second_reading(root / "papers" / paper, read_case(root, paper))
    return outcomes, damages


def test_some_damaged_copies_are_refused_or_read_as_they_stand(tmp_path):
    outcomes, _ = campaign(tmp_path, ("wan2014",), TRIED[0]["fast"], random.Random(SEED))
    assert outcomes["refused"] > 20
    assert outcomes["read"] > 0


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(BATCHES))
def test_damaged_copies_are_refused_or_read_as_they_stand(tmp_path, batch):
    outcomes, damages = campaign(tmp_path, PAPERS, COUNT // BATCHES, random.Random(f"{SEED} {batch}"))
    print(f"damaged tables, batch {batch}: {dict(outcomes)}; {dict(damages)}")
    assert outcomes["refused"] > outcomes.total() // 3
    assert outcomes["read"] > 0
