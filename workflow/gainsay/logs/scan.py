"""Strict reading of the MCAP container: every length, CRC, count and order is checked, and errors name the byte.

Readers made for live recordings skip what they do not know. A log that numbers are taken from is held to more:
whatever `container.Container` would not have written is refused.
"""

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import zstandard

from gainsay.errors import LogError
from gainsay.logs.container import COMPRESSION, MAGIC, PROFILE
from gainsay.logs.schemas import signal_record, signal_schema

_HEAD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQQ")
_NAMES = {
    1: "Header",
    2: "Footer",
    3: "Schema",
    4: "Channel",
    5: "Message",
    6: "Chunk",
    7: "MessageIndex",
    8: "ChunkIndex",
    9: "Attachment",
    10: "AttachmentIndex",
    11: "Statistics",
    12: "Metadata",
    13: "MetadataIndex",
    14: "SummaryOffset",
    15: "DataEnd",
}
_LARGEST_CHUNK = 1 << 31


@dataclass
class RawChannel:
    """A channel as found, with what was read of it so far."""

    id: int
    topic: str
    schema_name: str
    schema_data: bytes
    metadata: dict[str, str]
    width: int | None = None  # doubles a message, the time included; None where messages are not fixed-width
    count: int = 0
    blocks: list[np.ndarray] = field(default_factory=list)
    messages: list[tuple[int, bytes]] = field(default_factory=list)


@dataclass
class RawLog:
    """Contents of a file, checked as far as the container goes."""

    channels: dict[int, RawChannel] = field(default_factory=dict)
    schemas: dict[int, tuple[str, bytes]] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    chunks: int = 0


class _Fields:
    """A cursor over the content of one record."""

    def __init__(self, data: bytes | memoryview, start: int, end: int, where: "_Place") -> None:
        self.data, self.at, self.end, self.where = data, start, end, where

    def _take(self, size: int) -> int:
        start = self.at
        if size > self.end - start:
            raise self.where.error(f"field of {size} bytes, {self.end - start} left in the record", start)
        self.at += size
        return start

    def number(self, kind: str) -> int:
        return struct.unpack_from("<" + kind, self.data, self._take(struct.calcsize("<" + kind)))[0]

    def blob(self, kind: str = "I") -> bytes:
        size = self.number(kind)
        start = self._take(size)
        return bytes(self.data[start : start + size])

    def text(self) -> str:
        start = self.at
        try:
            return self.blob().decode()
        except UnicodeDecodeError:
            raise self.where.error("text that is no UTF-8", start) from None

    def pairs(self) -> dict[str, str]:
        size = self.number("I")
        end = self._take(size) + size
        inner = _Fields(self.data, end - size, end, self.where)
        found = {}
        while inner.at < end:
            key = inner.text()
            found[key] = inner.text()
        return found

    def done(self) -> None:
        if self.at != self.end:
            raise self.where.error(f"{self.end - self.at} bytes too many in the record", self.at)


@dataclass(frozen=True)
class _Place:
    """Where errors are: the file and, inside a chunk, its start."""

    file: str
    chunk: int | None = None

    def error(self, message: str, offset: int, expected: str | None = None) -> LogError:
        place = f"byte {offset}" if self.chunk is None else f"byte {offset} of the chunk at byte {self.chunk}"
        return LogError(f"broken at {place}: {message}", file=self.file, expected=expected)


def _records(data: bytes | memoryview, start: int, end: int, where: _Place) -> Iterator[tuple[int, int, int, int]]:
    """Yield opcode, offset, start and end of content of every record between two offsets."""
    at = start
    while at < end:
        if end - at < 9:
            raise where.error(f"{end - at} bytes where a record should start", at)
        opcode, length = _HEAD.unpack_from(data, at)
        if opcode not in _NAMES:
            raise where.error(f"unknown record type {opcode}", at)
        if length > end - at - 9:
            raise where.error(f"{_NAMES[opcode]} of {length} bytes, {end - at - 9} left", at)
        yield opcode, at, at + 9, at + 9 + length
        at += 9 + length


def scan(data: bytes, file: str) -> RawLog:
    """Read a whole file.

    Parameters
    ----------
    data : bytes
        Content of the file.
    file : str
        Its name, for errors.

    Raises
    ------
    LogError
        Whatever is wrong, with the byte where it broke.
    """
    where = _Place(file)
    if data[:8] != MAGIC:
        raise where.error("no MCAP magic", 0)
    log = RawLog()
    layout = _outline(data, where)
    _check_sums(data, layout, where)
    for opcode, at, start, end in layout[:-1]:
        fields = _Fields(data, start, end, where)
        if opcode == 1:
            profile = fields.text()
            fields.text()
            if at != 8 or profile != PROFILE:
                raise where.error(f"header with profile {profile!r}", at, f"profile {PROFILE!r} at byte 8")
        elif opcode == 6:
            _read_chunk(_open_chunk(fields, at, where), log, _Place(file, at))
        elif opcode == 9:
            fields.number("Q"), fields.number("Q")
            name, _ = fields.text(), fields.text()
            log.attachments[name] = fields.blob("Q")
            if fields.number("I") != zlib.crc32(memoryview(data)[start : end - 4]):
                raise where.error(f"CRC of attachment {name!r} does not match", at)
        elif opcode == 12:
            name = fields.text()
            log.metadata[name] = fields.pairs()
        elif opcode != 7:
            raise where.error(f"{_NAMES[opcode]} where it does not belong", at)
        if opcode not in (6, 7):
            fields.done()
    _check_statistics(data, layout[-1], log, where)
    return log


def _outline(data: bytes, where: _Place) -> list[tuple[int, int, int, int]]:
    """List the records of the data section up to and including DataEnd."""
    found = []
    for record in _records(data, 8, len(data), where):
        found.append(record)
        if record[0] == 15:
            return found
    raise where.error("the file ends before its data section does", len(data), "a DataEnd record")


def _check_sums(data: bytes, layout: list[tuple[int, int, int, int]], where: _Place) -> None:
    """Check the CRC of the data section and of the summary, the footer and the closing magic."""
    view = memoryview(data)
    _, at, start, end = layout[-1]
    if end - start != 4:
        raise where.error(f"DataEnd of {end - start} bytes", at, "4")
    if struct.unpack_from("<I", data, start)[0] != zlib.crc32(view[:at]):
        for opcode, chunk, inner, stop in layout:
            if opcode == 6:
                _open_chunk(_Fields(data, inner, stop, where), chunk, where)  # names the chunk if it is a chunk
        raise where.error("CRC of the data section before it does not match", at)
    tail = len(data) - 37
    if tail < end or data[-8:] != MAGIC:
        raise where.error("no footer and magic at the end", max(tail, end))
    opcode, length, summary, offsets, crc = struct.unpack_from("<BQQQI", data, tail)
    if (opcode, length, summary) != (2, 20, end) or not end <= offsets <= tail:
        raise where.error("footer does not fit the file", tail)
    if crc != zlib.crc32(view[tail : tail + 25], zlib.crc32(view[end:tail])):
        raise where.error("CRC of the summary section does not match", end)


def _open_chunk(fields: _Fields, at: int, where: _Place) -> bytes:
    """Decompress a chunk and check its size and CRC."""
    fields.number("Q"), fields.number("Q")
    size, crc, kind = fields.number("Q"), fields.number("I"), fields.text()
    packed = fields.blob("Q")
    fields.done()
    if kind != COMPRESSION or size > _LARGEST_CHUNK:
        raise where.error(f"chunk of {size} bytes compressed by {kind!r}", at, f"{COMPRESSION!r}")
    try:
        if zstandard.frame_content_size(packed) != size:
            raise where.error(f"chunk of {size} bytes holds another size", at)
        plain = zstandard.ZstdDecompressor().decompress(packed)
    except zstandard.ZstdError:
        raise where.error("chunk does not decompress", at) from None
    if len(plain) != size or zlib.crc32(plain) != crc:
        raise where.error("CRC of the chunk does not match", at)
    return plain


def _read_chunk(data: bytes, log: RawLog, where: _Place) -> None:
    log.chunks += 1
    at = 0
    while at < len(data):
        opcode, start, body, end = next(_records(data, at, len(data), where))
        if opcode == 5:
            at = _read_messages(data, start, body, end, log, where)
            continue
        fields = _Fields(data, body, end, where)
        if opcode == 3:
            number, name, encoding = fields.number("H"), fields.text(), fields.text()
            if number == 0 or number in log.schemas or encoding != "protobuf":
                raise where.error(f"schema {number} encoded as {encoding!r}", start, "a new one in protobuf")
            log.schemas[number] = name, fields.blob()
        elif opcode == 4:
            number, schema, topic, encoding = fields.number("H"), fields.number("H"), fields.text(), fields.text()
            if number in log.channels or schema not in log.schemas or encoding != "protobuf":
                raise where.error(f"channel {number} ({topic}) of schema {schema}", start, "a new one, schema known")
            if any(known.topic == topic for known in log.channels.values()):
                raise where.error(f"topic {topic} twice", start)
            log.channels[number] = _channel(number, topic, log.schemas[schema], fields.pairs(), start, where)
        else:
            raise where.error(f"{_NAMES[opcode]} inside a chunk", start)
        fields.done()
        at = end


def _channel(
    number: int, topic: str, schema: tuple[str, bytes], metadata: dict[str, str], start: int, where: _Place
) -> RawChannel:
    """Build a channel; one with units must have the schema that its topic and fields imply."""
    made = RawChannel(number, topic, *schema, metadata)
    fields = [key.removeprefix("unit.") for key in metadata if key.startswith("unit.")]
    if fields:
        try:
            fits = fields[0] == "time" and signal_schema(topic, tuple(fields[1:])) == schema
        except (ValueError, TypeError):
            fits = False
        if not fits:
            raise where.error(f"schema of {topic} is not that of its fields", start)
        made.width = len(fields)
    return made


def _read_messages(data: bytes, start: int, body: int, end: int, log: RawLog, where: _Place) -> int:
    """Read the message at `start` and all that follow it on the same channel; return where they end."""
    if end - body < _MESSAGE.size:
        raise where.error(f"message of {end - body} bytes", start, "at least 22")
    number, sequence, time, published = _MESSAGE.unpack_from(data, body)
    channel = log.channels.get(number)
    if channel is None:
        raise where.error(f"message on unknown channel {number}", start)
    if channel.width is None:
        if sequence != channel.count or time != published:
            raise where.error(f"message {sequence} of {channel.topic} at {time}", start, f"number {channel.count}")
        channel.messages.append((time, data[body + _MESSAGE.size : end]))
        channel.count += 1
        return end
    dtype, constants = signal_record(channel.width)
    if end - start != dtype.itemsize:
        raise where.error(f"message of {end - body} bytes on {channel.topic}", start, str(dtype.itemsize - 9))
    block = np.frombuffer(data, dtype, count=(len(data) - start) // dtype.itemsize, offset=start)
    block = block[: _run(block, number)]
    for name, value in constants:
        wrong = np.flatnonzero(block[name] != value)
        if len(wrong):
            row = int(wrong[0])
            raise where.error(f"message of {channel.topic}: {name}", start + row * dtype.itemsize, str(value))
    expected = np.arange(channel.count, channel.count + len(block), dtype=np.uint64)
    seconds = block["v1"]
    with np.errstate(invalid="ignore"):
        good = (block["sequence"] == expected) & (seconds >= 0.0) & (seconds < 9.2e9)
        stamps = np.rint(np.where(good, seconds, 0.0) * 1e9).astype(np.uint64)
    good &= (block["log_time"] == stamps) & (block["publish_time"] == stamps)
    if not good.all():
        row = int(np.flatnonzero(~good)[0])
        raise where.error(
            f"message of {channel.topic}: number or time", start + row * dtype.itemsize, f"number {int(expected[row])}"
        )
    columns = np.empty((len(block), channel.width))
    for column in range(channel.width):
        columns[:, column] = block[f"v{column + 1}"]
    channel.blocks.append(columns)
    channel.count += len(block)
    return start + len(block) * dtype.itemsize


def _run(block: np.ndarray, number: int) -> int:
    """Length of the run of records at the start of `block` that are messages on channel `number`.

    Looks ahead in growing steps: topics that alternate cost a look each, a long run only a few.
    """
    done, step = 0, 16
    while done < len(block):
        part = block[done : done + step]
        other = np.flatnonzero(
            (part["opcode"] != 5) | (part["length"] != block.itemsize - 9) | (part["channel"] != number)
        )
        if len(other):
            return done + int(other[0])
        done += len(part)
        step *= 8
    return done


def _check_statistics(data: bytes, data_end: tuple[int, int, int, int], log: RawLog, where: _Place) -> None:
    """Compare the counts that the summary states with what was read."""
    for opcode, at, start, end in _records(data, data_end[3], len(data) - 37, where):
        if opcode == 11:
            fields = _Fields(data, start, end, where)
            stated = tuple(fields.number(kind) for kind in "QHIIII")
            fields.number("Q"), fields.number("Q")
            size = fields.number("I")
            counts = {fields.number("H"): fields.number("Q") for _ in range(size // 10)}
            fields.done()
            read = {number: channel.count for number, channel in log.channels.items() if channel.count}
            sizes = (sum(read.values()), len(log.schemas), len(log.channels))
            sizes += (len(log.attachments), len(log.metadata), log.chunks)
            if stated != sizes or counts != read:
                raise where.error("counts of the statistics differ from the content", at)
            return
    raise where.error("no statistics in the summary section", data_end[3])
