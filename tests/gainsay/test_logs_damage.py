"""A damaged log is refused with the byte where it broke: never another error, never other numbers."""

import os
import random
import re
import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest
import zstandard

from gainsay.errors import LogError
from gainsay.logs import LogWriter, read_log
from gainsay.logs.container import MAGIC
from tests.gainsay.demo_log import write_demo

#: what docs/robustness.md says of these campaigns
TRIED = [
    {
        "what": "logs",
        "how": "truncated, bits flipped, parts cut out, doubled, zeroed or taken from another log",
        "fast": 200, "slow": 1000, "night": 1000,
        "promise": "refused in one line that names a byte of the file, or every double, message, attachment and piece "
        "of provenance as written",
    },
    {
        "what": "small logs that unpack to much",
        "how": "zeros in a chunk, 64 MB and 1.8 GB of them",
        "fast": 0, "slow": 2, "night": 2,
        "promise": "refused within 300 MB of memory of the whole process",
    },
]  # fmt: skip


def content(log):
    """All that is read of a log, comparable."""
    signals = {topic: (log[topic].fields, log[topic].time.tobytes(), log[topic].values.tobytes()) for topic in log}
    viewers = {
        topic: [(time, message.SerializeToString()) for time, message in log.messages(topic)]
        for topic in log.topics
        if topic not in log
    }
    return signals, viewers, dict(log.metadata), dict(log.attachments)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A log of many small chunks, of every kind of content, and another one to splice from."""
    folder = tmp_path_factory.mktemp("whole")
    first = write_demo(folder / "first.mcap", samples=61).read_bytes()
    with LogWriter(folder / "second.mcap", provenance={"paper": "b"}, attachments={"n": b"1"}, chunk_size=400) as log:
        for start in range(20):
            time = np.arange(5.0) + 5.0 * start
            log.signal("/a", {"x": "m", "y": "m"}, time, np.stack([time, -time], axis=1))
            log.event(5.0 * start, "tick", "tick")
    return first, (folder / "second.mcap").read_bytes()


def damaged(data, other, rng):
    """One damaged copy: truncated, flipped or spliced."""
    kind = rng.choice(["truncated", "flipped", "flipped", "spliced", "cut", "doubled", "zeroed"])
    at = rng.randrange(len(data))
    size = rng.choice([1, 8, 9, 60, 500, 3000])
    if kind == "truncated":
        return data[:at]
    if kind == "flipped":
        copy = bytearray(data)
        for _ in range(rng.choice([1, 1, 2, 5])):
            copy[rng.randrange(len(copy))] ^= 1 << rng.randrange(8)
        return bytes(copy)
    if kind == "spliced":
        start = rng.randrange(len(other))
        part = other[start : start + size]
        return data[:at] + part + data[at + rng.choice([0, len(part)]) :]
    if kind == "cut":
        return data[:at] + data[at + size :]
    if kind == "doubled":
        return data[: at + size] + data[at:]
    return data[:at] + bytes(min(size, len(data) - at)) + data[at + size :]


def refused(data, path, truth):
    """Read a copy: it must be refused with an offset inside it, or hold exactly what the whole file holds."""
    path.write_bytes(data)
    try:
        found = content(read_log(path))
    except LogError as error:
        text = str(error)
        assert "\n" not in text
        offset = re.search(r"broken at byte (\d+)", text)
        assert offset, text
        assert int(offset[1]) <= len(data)
        return True
    assert found == truth
    return False


def campaign(whole, tmp_path, count, seed):
    rng = random.Random(seed)
    path = tmp_path / "copy.mcap"
    unharmed = 0
    for data, other in (whole, whole[::-1]):
        path.write_bytes(data)
        truth = content(read_log(path))
        for _ in range(count // 2):
            unharmed += not refused(damaged(data, other, rng), path, truth)
    return unharmed


def test_some_damaged_copies(whole, tmp_path):
    # Splices of a byte onto its equal change nothing and may pass; they are few.
    assert campaign(whole, tmp_path, TRIED[0]["fast"], seed=1) < 10


@pytest.mark.slow
def test_many_damaged_copies(whole, tmp_path):
    assert campaign(whole, tmp_path, TRIED[0]["slow"], seed=2) < 50


@pytest.mark.slow
def test_every_single_byte_counts(whole, tmp_path):
    """No byte of a log is free: changing any one of them is noticed, and so is ending the file before any of them."""
    data = whole[1]
    path = tmp_path / "copy.mcap"
    path.write_bytes(data)
    truth = content(read_log(path))
    for at in range(len(data)):
        copy = bytearray(data)
        copy[at] ^= 0x11
        assert refused(bytes(copy), path, truth), at
        assert refused(data[:at], path, truth), at


def records(data):
    """Offsets of the records of the data section, walked here independently."""
    at, found = 8, []
    while True:
        opcode, length = struct.unpack_from("<BQ", data, at)
        found.append((opcode, at, at + 9 + length))
        at += 9 + length
        if opcode == 15:
            return found


def sealed(body):
    """A data section with its CRC right, and a summary section that has only a footer."""
    data = body + struct.pack("<BQI", 15, 4, zlib.crc32(body))
    footer = struct.pack("<BQQQ", 2, 20, len(data), len(data))
    return data + footer + struct.pack("<I", zlib.crc32(footer)) + MAGIC


def resealed(data, body):
    """`body` in place of the data section of `data`, with the CRCs and offsets that depend on it put right."""
    end = records(data)[-1][2]
    summary = data[end:-37]
    start = len(body) + 13
    offsets = struct.unpack_from("<Q", data, len(data) - 37 + 17)[0] - end + start
    footer = struct.pack("<BQQQ", 2, 20, start, offsets)
    crc = zlib.crc32(footer, zlib.crc32(summary))
    data_end = struct.pack("<BQI", 15, 4, zlib.crc32(body))
    return body + data_end + summary + footer + struct.pack("<I", crc) + MAGIC


def test_truncation_names_the_record_that_is_cut(whole, tmp_path):
    data = whole[1]
    _, start, end = next(r for r in records(data) if r[0] == 6)
    path = tmp_path / "cut.mcap"
    path.write_bytes(data[: end - 7])
    with pytest.raises(LogError, match=rf"cut\.mcap: broken at byte {start}: Chunk of {end - start - 9} bytes"):
        read_log(path)


def test_a_flip_in_a_chunk_names_the_chunk(whole, tmp_path):
    data = bytearray(whole[1])
    chunks = [r for r in records(data) if r[0] == 6]
    _, start, end = chunks[3]
    data[(start + end) // 2] ^= 4
    path = tmp_path / "flip.mcap"
    path.write_bytes(data)
    with pytest.raises(LogError, match=rf"broken at byte {start}: "):
        read_log(path)


@pytest.mark.parametrize("change", ["drop", "double", "swap", "foreign", "shorten"])
def test_whole_chunks_moved_under_right_checksums(whole, tmp_path, change):
    """CRCs put right again do not help: message numbers, schemas and counts tell."""
    data, other = whole[1], whole[0]
    found = records(data)
    chunks = [r for r in found if r[0] == 6]
    first, second = chunks[2], chunks[3]
    head, tail = data[: first[1]], data[second[2] : found[-1][1]]
    one, two = data[first[1] : first[2]], data[second[1] : second[2]]
    between = data[first[2] : second[1]]
    _, start, end = next(r for r in records(other) if r[0] == 6)
    body = {
        "drop": head + between + two + tail,
        "double": head + one + one + between + two + tail,
        "swap": head + two + between + one + tail,
        "foreign": head + other[start:end] + between + two + tail,
        "shorten": data[: chunks[-1][1]],
    }[change]
    path = tmp_path / "moved.mcap"
    path.write_bytes(resealed(data, head + one + between + two + tail))
    read_log(path)  # resealing itself is right
    path.write_bytes(resealed(data, body))
    with pytest.raises(LogError, match=r"broken at byte \d+"):
        read_log(path)


def test_no_summary_no_log(whole, tmp_path):
    data = whole[1]
    path = tmp_path / "a.mcap"
    path.write_bytes(sealed(data[: records(data)[-1][1]]))
    with pytest.raises(LogError, match="no statistics"):
        read_log(path)


@pytest.mark.parametrize(
    "data", [b"", MAGIC, MAGIC + MAGIC, b"hello world, no log at all", bytes(100), MAGIC + b"\xff" * 64]
)
def test_what_is_no_log(tmp_path, data):
    (tmp_path / "a.mcap").write_bytes(data)
    with pytest.raises(LogError, match=r"a\.mcap: broken at byte \d+"):
        read_log(tmp_path / "a.mcap")


def test_a_log_of_somebody_else(tmp_path):
    from mcap.writer import Writer

    with (tmp_path / "a.mcap").open("wb") as stream:
        writer = Writer(stream, enable_data_crcs=True)
        writer.start()
        writer.finish()
    with pytest.raises(LogError, match="profile"):
        read_log(tmp_path / "a.mcap")


def record(opcode, body):
    return struct.pack("<BQ", opcode, len(body)) + body


def chunk(packed, size, crc=0):
    return record(6, struct.pack("<QQQI", 0, 0, size, crc) + struct.pack("<I4sQ", 4, b"zstd", len(packed)) + packed)


HEADER = MAGIC + record(1, struct.pack("<I7sI7s", 7, b"gainsay", 7, b"gainsay"))


def zeros(size):
    """So many zeros, compressed a part at a time."""
    made = zstandard.ZstdCompressor(level=1).compressobj(size=size)
    part = bytes(1 << 20)
    return b"".join(made.compress(part) for _ in range(size >> 20)) + made.flush()


@pytest.mark.parametrize("size", [(1 << 26) + 1, 1 << 31, 1 << 40, (1 << 64) - 1])
def test_a_chunk_that_claims_too_much_is_refused_before_it_is_opened(tmp_path, monkeypatch, size):
    monkeypatch.setattr("zstandard.ZstdDecompressor", None)  # opening it would break
    (tmp_path / "a.mcap").write_bytes(sealed(HEADER + chunk(b"x", size)))
    with pytest.raises(
        LogError, match=rf"broken at byte \d+: chunk of {size} bytes after 0: expected at most 67108864"
    ):
        read_log(tmp_path / "a.mcap")


def test_chunks_that_claim_too_much_together_are_refused(whole, tmp_path, monkeypatch):
    monkeypatch.setattr("gainsay.logs.chunks.LARGEST_LOG", 1500)
    (tmp_path / "a.mcap").write_bytes(whole[1])
    with pytest.raises(
        LogError, match=r"broken at byte \d+: chunk of \d+ bytes after \d+: expected at most .* 1500 in all"
    ):
        read_log(tmp_path / "a.mcap")


@pytest.mark.parametrize("claimed", [1 << 20, 1 << 25])
def test_a_chunk_that_holds_more_than_it_claims_is_refused(tmp_path, claimed):
    (tmp_path / "a.mcap").write_bytes(sealed(HEADER + chunk(zeros(1 << 26), claimed)))
    with pytest.raises(LogError, match="holds another size"):
        read_log(tmp_path / "a.mcap")


BOMB = """
import sys
from pathlib import Path
from gainsay.errors import LogError
from gainsay.logs import read_log
try:
    read_log(Path(sys.argv[1]))
except LogError as error:
    print(error)
# of this program alone: ru_maxrss would count what started it
peak = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM:"))
print(int(peak.split()[1]) // 1024)
"""


@pytest.mark.slow
@pytest.mark.parametrize("size", [1 << 26, 1800 << 20])
def test_a_small_file_takes_little_memory_whatever_it_unpacks_to(tmp_path, size):
    """1.8 GB of zeros in 58 kB, and the most that a chunk may hold: refused in under 300 MB of a whole process."""
    path = tmp_path / "a.mcap"
    path.write_bytes(sealed(HEADER + chunk(zeros(size), size, zlib.crc32(bytes(size)) if size <= 1 << 26 else 0)))
    assert path.stat().st_size < 200_000
    done = subprocess.run([sys.executable, "-c", BOMB, str(path)], capture_output=True, text=True, check=True)
    refusal, most = done.stdout.splitlines()
    print(f"a log of {path.stat().st_size} bytes that unpacks to {size >> 20} MB: {most} MB, {refusal}")
    assert "broken at byte" in refusal
    assert int(most) < 300


@pytest.mark.parametrize(
    ("kind", "topic", "fields", "count"),
    [
        ("extreme", "/extremes", ("a", "a_time", "a_second"), 0),
        ("extreme", "/extremes", ("a", "a_time", "a_second"), 2),
        ("extreme", "/extremes", ("a", "a_second", "a_time"), 1),
        ("extreme", "/extremes", ("a", "a_time"), 1),
        ("extreme", "/extremes", (), 1),
        ("extreme", "/elsewhere", ("a", "a_time", "a_second"), 1),
        ("summary", "/summary", ("a",), 3),
        ("summary", "/summary", (), 1),
        ("summary", "/elsewhere", ("a",), 1),
        ("bound", "/bounds/a", ("lower",), 1),
        ("bound", "/bounds/a", ("lower", "middle"), 2),
        ("bound", "/bounds/a", (), 2),
        ("bound", "/elsewhere", ("lower",), 2),
    ],
)
def test_a_topic_of_a_kind_holds_what_its_kind_holds(tmp_path, kind, topic, fields, count):
    """A log may say of any topic that it is an extreme; one without a value, or with many, has no value to read."""
    path = tmp_path / "a.mcap"
    with LogWriter(path, provenance={}) as log:
        log._numbers(topic, dict.fromkeys(fields, "N"), kind, np.arange(float(count)), np.zeros((count, len(fields))))
    with pytest.raises(LogError, match=rf"a\.mcap: {count} messages of .* on {topic}, of the kind {kind}: expected"):
        read_log(path)


def test_time_that_runs_back_is_refused(tmp_path):
    """Right checksums, numbers and counts do not help: the writer would not have written it."""
    path = tmp_path / "a.mcap"
    with LogWriter(path, provenance={}) as log:
        log.signal("/a", {"x": "m"}, [0.0, 1.0, 2.0], np.zeros((3, 1)))
    data = path.read_bytes()
    _, start, end = next(r for r in records(data) if r[0] == 6)
    plain = zstandard.ZstdDecompressor().decompress(data[start + 9 + 28 + 8 + 8 : end])
    for time, refused_ in ((2.0, False), (1.0, False), (0.5, True)):
        # The last of three messages of 49 bytes: log time, publish time, tag, seconds, tag, value.
        stamp = struct.pack("<QQBd", round(time * 1e9), round(time * 1e9), 9, time)
        other = plain[: -49 + 15] + stamp + plain[-49 + 15 + len(stamp) :]
        made = chunk(zstandard.ZstdCompressor().compress(other), len(other), zlib.crc32(other))
        path.write_bytes(resealed(data, data[:start] + made + data[end : records(data)[-1][1]]))
        if refused_:
            with pytest.raises(LogError, match=r"message of /a: number or time"):
                read_log(path)
        else:
            assert read_log(path)["/a"].time.tolist() == [0.0, 1.0, time]


def test_what_is_no_file_is_no_log(tmp_path):
    path = tmp_path / "a.mcap"
    for make in (path.mkdir, lambda: os.mkfifo(path), lambda: path.symlink_to("a.mcap"),
                 lambda: path.symlink_to("/dev/zero")):  # fmt: skip
        make()
        with pytest.raises(LogError, match=r"a\.mcap: .*expected a (regular|readable) file"):
            read_log(path)
        path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()


def test_no_file(tmp_path):
    with pytest.raises(LogError, match="file not found"):
        read_log(tmp_path / "a.mcap")
