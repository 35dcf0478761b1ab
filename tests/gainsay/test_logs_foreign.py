"""Logs of somebody else, and what is no log: told as far as it goes or refused in one line, in bounds of memory."""

import random
import struct
import tracemalloc
from pathlib import Path

import pytest
import zstandard
from mcap.stream_reader import lz4

from gainsay.cli import main
from gainsay.errors import InputError, LogError
from gainsay.logs import commands
from gainsay.logs.container import LARGEST_CHUNK, MAGIC
from gainsay.logs.foreign import describe
from tests.gainsay.demo_log import write_demo
from tests.gainsay.table_damage import device, folder, loop, nowhere, pipe, post

ROOT = Path(__file__).resolve().parents[2]


def test_a_log_of_somebody_else_is_told_as_far_as_it_goes(tmp_path, capsys):
    """Written by the mcap package; cut short, what was read before stays told."""
    from mcap.writer import CompressionType, Writer

    path = tmp_path / "other.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.NONE, use_chunking=False)
        writer.start(profile="ros2", library="other")
        schema = writer.register_schema("a", "jsonschema", b"{}")
        channel = writer.register_channel("/a.b", "json", schema)
        for second in range(5):
            writer.add_message(channel, second * 10**9, b"{}", second * 10**9)
        writer.finish()
    assert commands.list_logs(tmp_path, str(path)) == 0
    first, topic = capsys.readouterr().out.splitlines()
    assert "not one of ours (profile 'ros2'" in first and "5 messages in 4 s" in first
    assert topic.split() == ["/a.b", "json", "5", "messages"]
    path.write_bytes(path.read_bytes()[:-400])
    assert commands.list_logs(tmp_path, str(path)) == 0
    assert "it breaks off" in capsys.readouterr().out
    path.write_bytes(b"no log at all")
    with pytest.raises(LogError, match="no MCAP file"):
        commands.list_logs(tmp_path, str(path))
    mine = write_demo(tmp_path / "mine.mcap", samples=11)
    assert commands.list_logs(tmp_path, str(mine)) == 0
    assert "mine.mcap: demo mine, 3000 s" in capsys.readouterr().out


def unpacking_to(size, compression):
    """A foreign log of one chunk of so many zeros that says it is small."""
    packer = lz4.LZ4FrameCompressor() if compression == "lz4" else zstandard.ZstdCompressor().compressobj()
    start = packer.begin() if compression == "lz4" else b""
    data = start + b"".join(packer.compress(bytes(1 << 20)) for _ in range(size >> 20)) + packer.flush()
    name = struct.pack("<I", len(compression)) + compression.encode()
    chunk = struct.pack("<QQQI", 0, 1, 1000, 0) + name + struct.pack("<Q", len(data)) + data
    strings = struct.pack("<I5sI3s", 5, b"other", 3, b"lib")
    records = ((1, strings), (6, chunk), (15, bytes(4)), (2, bytes(20)))
    return MAGIC + b"".join(struct.pack("<BQ", opcode, len(body)) + body for opcode, body in records) + MAGIC


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_chunk_of_somebody_else_is_not_unpacked_without_end(tmp_path, compression):
    """55 kB took as much memory as they said: 1.8 GB."""
    path = tmp_path / "bomb.mcap"
    path.write_bytes(unpacking_to(1 << 28, compression))
    tracemalloc.start()
    (line,) = describe(path)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert "it breaks off: a chunk of more than" in line
    assert most < 2.5 * LARGEST_CHUNK


@pytest.mark.parametrize("made", [pipe, loop, nowhere, device, post, folder])
def test_what_is_no_file_is_no_log(tmp_path, made):
    """A pipe was waited for without end, a link to itself was a traceback."""
    path = tmp_path / "a.mcap"
    path.touch()
    made(path, random.Random(1))
    with pytest.raises(InputError):
        list(describe(path))
    for command in (["logs", str(path)], ["replay", str(path)], ["prove", str(path)], ["verify", str(path)]):
        assert main(["--root", str(ROOT), *command]) == 2
    assert main(["--root", str(path), "lint"]) == 2


@pytest.mark.parametrize("text", [b"", MAGIC, MAGIC + MAGIC, MAGIC + bytes(9), MAGIC + b"\1" + b"\xff" * 8, b"\0" * 99])
def test_what_is_no_mcap_file_is_one_line(tmp_path, text):
    path = tmp_path / "a.mcap"
    path.write_bytes(text)
    with pytest.raises(LogError, match="no MCAP file") as caught:
        list(describe(path))
    assert len(str(caught.value)) <= 300
    assert str(caught.value).isprintable()
