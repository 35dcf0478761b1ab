"""Campaigns give the same bytes however their points are cut into chunks, in whatever order, however often killed."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.campaigns import Plan, store
from gainsay.campaigns.box import OPEN, PROVED, REFUTED, branch
from gainsay.campaigns.draws import counted_draws
from gainsay.campaigns.scan import grid_scan
from gainsay.campaigns.status import progress, rate
from gainsay.campaigns.store import about_chunk, chunk_path, folder, gather, gathered, manifest_doubt, write_chunk
from gainsay.errors import InputError
from gainsay.tables import read_case
from gainsay.tables.models import Campaign
from tests.gainsay.table_damage import BYTES, PLACES

#: what docs/robustness.md says of damaged campaigns
TRIED = [
    {
        "what": "chunks of campaigns",
        "how": "bytes as in tables; a bit of what the file says of itself; a link, a pipe, a device, a folder or "
        "nothing in its place",
        "fast": 24, "slow": 0, "night": 0,
        "promise": "refused in one line and made again, or table and manifest the same to the byte",
    }
]  # fmt: skip
SEED = 20261126
SCAN = Campaign(name="plane", kind="scan", inputs="x=0..1; y=1..10 log", resolution="13x7", seed="", block="5",
                chunk="20", claim="", question="q")  # fmt: skip
DRAWS = Campaign(name="luck", kind="draws", inputs="factor=0..1", resolution="1003", seed="7", block="10", chunk="50",
                 claim="", question="q")  # fmt: skip


def product(case, points):
    """Batched on purpose: the last bits of a matrix product hang on the size of its batch."""
    rows = np.array([[float(p["x"]), float(p["y"]), 1.0] for p in points])
    return (rows @ np.array([[0.1, 0.7], [0.3, 0.2], [1 / 3, 0.9]]) @ np.array([0.123, 0.456])).ravel()


def below(case, block):
    drawn = block.generator().random(block.size)
    return {"low": (int((drawn < 0.25).sum()), 0), "open": (int((drawn < 0.5).sum()), int((drawn > 0.99).sum()))}


EVALUATIONS = {
    "scan": grid_scan(("x", "y"), "z", product, 1.0),
    "draws": counted_draws(("factor",), "below", {"low": "a quarter", "open": "a half"}, below),
}


def plan(case, row, **parts):
    return Plan(case, row.model_copy(update=parts), EVALUATIONS[row.kind], "0123456789abcdef")


def made(plan_):
    """The bytes of everything gathered."""
    gather(plan_)
    files = [folder(plan_) / f"{plan_.row.name}.{ending}" for ending in ("parquet", "json")]
    return [path.read_bytes() for path in files]


@pytest.fixture
def case(project):
    return read_case(project.root, "toy")


@pytest.mark.parametrize("row", [SCAN, DRAWS], ids=["scan", "draws"])
def test_results_are_the_same_whatever_the_chunks_and_their_order(case, row):
    first = plan(case, row)
    for number in range(first.chunks):
        write_chunk(first, number)
    expected = made(first)

    @settings(max_examples=6, deadline=None)
    @given(st.integers(3, 60), st.randoms(use_true_random=False))
    def same(blocks, order):
        other = plan(case, row, chunk=str(blocks * int(row.block)))
        numbers = list(range(other.chunks)) * 2  # every chunk twice: one that is done again changes nothing
        order.shuffle(numbers)
        for number in numbers:
            write_chunk(other, number)
        assert made(other) == expected

    same()


def test_draws_depend_on_seed_and_block_alone(case):
    blocks = list(plan(case, DRAWS).blocks())
    assert [b.first for b in blocks[:3]] == [0, 10, 20]
    assert blocks[-1].size == 3
    values = [b.generator().random(10) for b in blocks[:4]]
    assert len({v.tobytes() for v in values}) == 4
    assert np.array_equal(values[2], list(plan(case, DRAWS, chunk="500").blocks())[2].generator().random(10))
    assert not np.array_equal(values[2], list(plan(case, DRAWS, seed="8").blocks())[2].generator().random(10))
    assert not np.array_equal(values[2], blocks[2].generator(1).random(10))


def test_counts_are_exact(case):
    whole = plan(case, DRAWS)
    for number in range(whole.chunks):
        write_chunk(whole, number)
    told = gather(whole)
    drawn = np.concatenate([b.generator().random(b.size) for b in whole.blocks()])
    assert told["counts"]["draws"] == 1003
    assert told["counts"]["low_below"] == int((drawn < 0.25).sum())
    assert told["counts"]["open_unresolved"] == int((drawn > 0.99).sum())
    rows = list(gathered(whole, ["index", "low_below"]))
    assert sum(int(batch["low_below"].sum()) for batch in rows) == told["counts"]["low_below"]


def test_a_chunk_that_is_missing_damaged_or_of_other_tables_is_refused(case):
    whole = plan(case, SCAN)
    for number in range(whole.chunks):
        write_chunk(whole, number)
    path = chunk_path(whole, 2)
    content = path.read_bytes()
    path.unlink()
    with pytest.raises(InputError, match="chunk-0000002"):
        gather(whole)
    broken = bytearray(content)
    broken[40] ^= 0xFF
    path.write_bytes(bytes(broken))
    with pytest.raises(InputError, match="damaged and removed"):
        gather(whole)
    assert not path.exists(), "the next run makes it again"
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(InputError, match="chunk of a campaign"):
        gather(whole)
    path.write_bytes(chunk_path(whole, 1).read_bytes())
    with pytest.raises(InputError, match="another chunk"):
        gather(whole)
    path.write_bytes(content)
    gather(whole)
    other = replace(whole, digest="f" * 16)
    chunk_path(other, 0).parent.mkdir(parents=True)
    for number in range(whole.chunks):
        chunk_path(other, number).write_bytes(chunk_path(whole, number).read_bytes())
    with pytest.raises(InputError, match="another chunk"):
        gather(other)


def flipped_after_its_pages(content, draw):
    """A bit of what a Parquet file says of itself, which no checksum covers."""
    copy, length = bytearray(content), int.from_bytes(content[-8:-4], "little")
    copy[len(copy) - 9 - draw.randrange(length)] ^= 1 << draw.randrange(8)
    return bytes(copy)


@pytest.mark.parametrize(("way", "count"), [(flipped_after_its_pages, TRIED[0]["fast"] // 2),
                                            (None, TRIED[0]["fast"] // 2)], ids=["metadata", "anywhere"])  # fmt: skip
def test_a_damaged_chunk_is_refused_or_counts_the_same(case, way, count):
    whole, draw = plan(case, DRAWS, chunk="500"), random.Random(SEED)
    for number in range(whole.chunks):
        write_chunk(whole, number)
    expected = made(whole)
    path = chunk_path(whole, 1)
    content = path.read_bytes()
    refused = 0
    for number in range(count):
        path.write_bytes(content)
        if way is None:
            draw.choice(BYTES)(path, draw) if number % 4 else draw.choice(PLACES)(path, draw)
        else:
            path.write_bytes(way(content, draw))
        progress(whole)
        try:
            assert made(whole) == expected, number
        except InputError as error:
            refused += 1
            assert len(str(error)) <= 300
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        else:
            path.unlink(missing_ok=True)
    assert refused > 0
    path.write_bytes(content.replace(b'"points": 500', b'"points": 501'))
    with pytest.raises(InputError, match="it counts what is not in its rows"):
        gather(whole)


KILLED = """
import os, signal, sys
from pathlib import Path
sys.path.insert(0, {tests!r})
import importlib.util
spec = importlib.util.spec_from_file_location("toy_campaigns", {file!r})
module = importlib.util.module_from_spec(spec); spec.loader.exec_module(module)
case = module.read_case(Path({root!r}), "toy")
plan = module.plan(case, module.DRAWS)
blocks = 0
inner = plan.evaluation.block
def dying(case, block):
    global blocks
    blocks += 1
    if blocks == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return inner(case, block)
module.write_chunk(module.replace(plan, evaluation=module.replace(plan.evaluation, block=dying)), 1)
"""


def test_a_chunk_that_is_killed_leaves_nothing_that_counts_and_is_done_again(case):
    whole = plan(case, DRAWS)
    for number in range(whole.chunks):
        write_chunk(whole, number)
    expected = made(whole)
    chunk_path(whole, 1).unlink()
    code = KILLED.format(tests=str(Path(__file__).parent), file=__file__, root=str(case.root))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == -signal.SIGKILL, done.stderr
    assert not chunk_path(whole, 1).exists()
    assert list(chunk_path(whole, 1).parent.glob(".*.part")), "killed while it wrote"
    write_chunk(whole, 1)
    assert made(whole) == expected


def test_rows_stand_in_groups_of_one_size_however_they_come(case):
    """A group a row would have its header and its checksum each, and be read one by one."""
    import pyarrow.parquet

    rows = 2 * 64 + 7
    whole = plan(case, SCAN, resolution=f"{rows}x1", block="1", chunk=str(rows))
    whole = replace(whole, evaluation=replace(whole.evaluation, group=64))
    write_chunk(whole, 0)
    gather(whole)
    for path in (chunk_path(whole, 0), folder(whole) / "plane.parquet"):
        read = pyarrow.parquet.ParquetFile(path)
        groups = [read.metadata.row_group(k).num_rows for k in range(read.metadata.num_row_groups)]
        assert groups == [64, 64, 7]
        assert read.read()["index"].to_pylist() == list(range(rows))


def test_the_same_chunk_written_twice_at_once_is_whole(case):
    """As when a job that was taken for lost runs still while it is made again, on another machine."""
    whole = plan(case, DRAWS, chunk="2000")
    write_chunk(whole, 0)
    expected = chunk_path(whole, 0).read_bytes()
    read = next(store._rows(whole, 0, about_chunk(chunk_path(whole, 0), case.root)))
    with store._Writer(chunk_path(whole, 0), whole) as one, store._Writer(chunk_path(whole, 0), whole) as other:
        for file in (one, other):
            file.write(read)
            file.note(
                store._about(
                    whole, 0, 1003, whole.evaluation.count({n: read[n].to_pylist() for n in read.column_names})
                )
            )
    assert chunk_path(whole, 0).read_bytes() == expected
    assert not list(chunk_path(whole, 0).parent.glob(".*.part"))


@pytest.mark.parametrize(
    ("change", "wrong"),
    [
        ({"counts": {"draws": 1003}}, "another counts"),
        ({"told": {"low": "none"}}, "another told"),
        ({"points": 1}, "another points"),
        ({"table": {"file": "luck.parquet", "sha256": "0" * 64}}, "another table"),
        ({"more": 1}, "another more"),
        ({"depends_on": "f" * 16}, "of other tables or code"),
        ({"question": "Why?"}, ""),
    ],
)
def test_a_manifest_that_says_what_its_table_does_not_is_found(case, change, wrong):
    whole = plan(case, DRAWS)
    for number in range(whole.chunks):
        write_chunk(whole, number)
    manifest = gather(whole)
    assert manifest_doubt(whole) == ""
    (folder(whole) / "luck.json").write_text(json.dumps({**manifest, **change}))
    assert wrong in manifest_doubt(whole)
    assert bool(manifest_doubt(whole)) == bool(wrong)


def test_a_table_that_is_another_one_is_found(case):
    for seed in ("7", "8"):
        whole = plan(case, DRAWS, seed=seed)
        chunk_path(whole, 0).parent.mkdir(parents=True, exist_ok=True)
        for number in range(whole.chunks):
            write_chunk(whole, number)
        gather(whole)
        if seed == "7":
            manifest = (folder(whole) / "luck.json").read_bytes()
    (folder(whole) / "luck.json").write_bytes(manifest)
    assert "another counts, seed, table, told" in manifest_doubt(whole)


def test_a_figure_stays_small_however_many_points_there_are(case):
    from matplotlib.figure import Figure

    small = plan(case, SCAN)
    assert (small.step, small.label(0), list(small.side(0))[-1]) == (1, "x", 1.0)
    large = plan(case, SCAN, resolution="450x7")
    assert (large.step, large.label(0), len(large.side(0)), len(large.side(1))) == (3, "x (one of 3 values)", 150, 3)
    index = np.arange(450 * 7)
    figure = Figure()
    large.evaluation.draw(
        figure, large, iter([{"index": part, "z": part.astype(float)} for part in np.split(index, 9)])
    )
    shown = figure.axes[0].collections[0].get_array().reshape(3, 150)
    assert (shown == np.add.outer(3 * np.arange(3), 7 * 3 * np.arange(150))).all()


def test_memory_does_not_grow_with_the_number_of_rows(case):
    import tracemalloc

    most = []
    for rows in (4_000, 16_000):
        many = plan(case, SCAN, resolution=f"{rows // 100}x100", block="200", chunk="2000")
        tracemalloc.start()
        for number in range(many.chunks):
            write_chunk(many, number)
        gather(many)
        most.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert most[1] < 1.3 * most[0]  # a table held whole would take four times as much


def test_status_counts_chunks_and_tells_rate_and_time_left(case):
    whole = plan(case, DRAWS)
    assert progress(whole) == "luck: 0 of 21 chunks"
    for number in range(3):
        write_chunk(whole, number)
        os.utime(chunk_path(whole, number), (1000 + 60 * number,) * 2)
    line = progress(whole, now=1125)
    # two chunks in 120 s; 18 are left: 1080 s
    assert line.startswith("luck: 3 of 21 chunks, 1 a minute, 18 min left, so far: 150 draws, ")
    # a chunk a minute: nothing for five minutes is said
    assert "none for" not in progress(whole, now=1419)
    silent = progress(whole, now=1600)
    assert ", none for 8 min (where no job is in the queue: stop Snakemake and start it again, " in silent
    assert "what is there stays), so far: 150 draws, " in silent
    assert rate([1000.0], 1001.0) == 0
    assert rate([0.0, 1.0], 100.0) == pytest.approx(0.01)  # nothing for long: the rate falls
    for number in range(3, whole.chunks):
        write_chunk(whole, number)
    assert "21 of 21 chunks, done: 1003 draws" in progress(whole)
    assert about_chunk(chunk_path(whole, 20), case.root)["points"] == 3


def quarter_disk(low, high):
    """Whether boxes lie in the unit disk: proved by their far corner, refuted by their middle."""
    far = (np.maximum(np.abs(low), np.abs(high)) ** 2).sum(axis=1)
    middle = (((low + high) / 2) ** 2).sum(axis=1)
    outcome = np.where(far <= 1, PROVED, np.where(middle > 1, REFUTED, OPEN))
    return outcome, np.argmax(high - low, axis=1)


@pytest.mark.parametrize("deepest", [0, 1, 6, 12])
def test_volumes_of_a_box_add_up_and_enclose_the_quarter_of_a_disk(deepest):
    found, parts, point = branch(np.zeros(2), np.ones(2), quarter_disk, deepest)
    assert sum(np.prod(high - low) for low, high in parts) == found["proved"] / 2**deepest
    assert (point is None) == (deepest < 2)
    assert point is None or (point**2).sum() > 1
    assert found["proved"] + found["refuted"] + found["open"] == 2**deepest
    # area of a quarter of the unit disk: pi / 4
    assert found["proved"] / 2**deepest <= np.pi / 4
    if deepest == 12:
        assert found["proved"] / 2**12 > np.pi / 4 - 0.05
        assert found["refuted"] / 2**12 > 1 - np.pi / 4 - 0.05


def test_a_row_of_another_kind_or_with_other_inputs_is_refused(case):
    with pytest.raises(InputError, match="expected scan"):
        Plan(case, SCAN.model_copy(update={"kind": "map"}), EVALUATIONS["scan"])
    with pytest.raises(InputError, match="a range of y too"):
        plan(case, SCAN, inputs="x=0..1")
    with pytest.raises(InputError, match="chunk 5: expected 0 to 4"):
        write_chunk(plan(case, SCAN), 5)


@pytest.mark.parametrize(
    ("type_", "values"), [("int64", [1.5]), ("float64", ["1.5"]), ("string", [1]), ("int64", [None])]
)
def test_a_column_of_another_type_is_refused_and_leaves_nothing(case, type_, values):
    columns = {**dict.fromkeys(("x", "y"), "float64"), "z": type_}
    wrong = replace(
        EVALUATIONS["scan"], columns=columns, block=lambda case, of: {"x": [0.0], "y": [0.0], "z": values},
        count=lambda columns: {},
    )  # fmt: skip
    whole = Plan(case, SCAN, wrong, "0123456789abcdef")
    with pytest.raises(InputError, match="column z"):
        write_chunk(whole, 0)
    assert not list(chunk_path(whole, 0).parent.glob("*"))


def test_the_manifest_says_nothing_of_chunks_time_or_machine(case):
    whole = plan(case, SCAN)
    for number in range(whole.chunks):
        write_chunk(whole, number)
    manifest = gather(whole)
    assert "chunk" not in manifest
    said = json.dumps(manifest)
    assert str(case.root) not in said
    assert time.strftime("%Y-%m") not in said
