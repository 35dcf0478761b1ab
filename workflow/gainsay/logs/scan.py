"""Strict reading of the MCAP container: every length, CRC, count and order is checked, and errors name the byte.

Readers made for live recordings skip what they do not know. A log that numbers are taken from is held to more:
whatever `container.Container` would not have written is refused. A file is read once from its beginning to its end,
a record at a time, so that neither its size nor what it claims to hold decides how much memory that takes.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from typing import Any, BinaryIO

import numpy as np

from gainsay.logs.chunks import ChunkPlace, RawChannel, RawLog, doubles, messages_again, open_chunk, read_chunk
from gainsay.logs.container import LARGEST_RECORD, MAGIC, PROFILE
from gainsay.logs.records import HEAD, NAMES, Fields, Place, records

__all__ = ["RawChannel", "RawLog", "again", "columns_of", "scan"]

_FOOTER = 37  # bytes of footer and magic at the end


class _Source:
    """A file read forward, with the CRC of what was read."""

    def __init__(self, stream: BinaryIO, where: Place) -> None:
        self._stream, self._where = stream, where
        self.size, self.at, self.crc = os.fstat(stream.fileno()).st_size, 0, 0

    @property
    def left(self) -> int:
        return self.size - self.at

    def take(self, count: int) -> bytes:
        data = read_at(self._stream, self.at, count, self._where)
        self.crc = zlib.crc32(data, self.crc)
        self.at += count
        return data


def read_at(stream: BinaryIO, at: int, count: int, where: Place) -> bytes:
    """Read bytes that the file should have at a place."""
    try:
        stream.seek(at)
        data = stream.read(count)
    except OSError as error:
        raise where.error((error.strerror or "cannot be read").lower(), at) from None
    if len(data) < count:
        raise where.error("the file became shorter while it was read", at + len(data))
    return data


def scan(stream: BinaryIO, file: str) -> RawLog:
    """Read a whole file and check it.

    Parameters
    ----------
    stream : binary file
        At its beginning, seekable.
    file : str
        Its name, for errors.

    Raises
    ------
    LogError
        Whatever is wrong, with the byte where it broke.
    """
    where = Place(file)
    source = _Source(stream, where)
    if source.size < len(MAGIC) or source.take(len(MAGIC)) != MAGIC:
        raise where.error("no MCAP magic", 0)
    log = RawLog()
    while _read_record(source, log, where):
        pass
    _read_summary(source, log, where)
    return log


def _read_record(source: _Source, log: RawLog, where: Place) -> bool:
    """Read a record of the data section; return whether more are to come."""
    at, crc = source.at, source.crc
    if not source.left:
        raise where.error("the file ends before its data section does", at, "a DataEnd record")
    if source.left < HEAD.size:
        raise where.error(f"{source.left} bytes where a record should start", at)
    opcode, length = HEAD.unpack(source.take(HEAD.size))
    if opcode not in NAMES:
        raise where.error(f"unknown record type {opcode}", at)
    if length > source.left:
        raise where.error(f"{NAMES[opcode]} of {length} bytes, {source.left} left", at)
    if length > LARGEST_RECORD:
        raise where.error(f"{NAMES[opcode]} of {length} bytes", at, f"at most {LARGEST_RECORD}")
    data = source.take(length)
    fields = Fields(data, 0, length, where, at + HEAD.size)
    if opcode == 1:
        profile = fields.text()
        fields.text()
        if at != len(MAGIC) or profile != PROFILE:
            raise where.error(f"header with profile {profile!r}", at, f"profile {PROFILE!r} at byte 8")
    elif opcode == 6:
        plain, sum_ = open_chunk(fields, at, log, where)
        log.size += len(plain)
        channels = read_chunk(plain, log, Place(where.file, at))
        log.chunks.append(ChunkPlace(at, at + HEAD.size, source.at, sum_, channels))
    elif opcode == 7:
        return True  # an index, for readers that seek
    elif opcode == 9:
        _read_attachment(fields, data, at, log, where)
    elif opcode == 12:
        name = fields.text()
        if name in log.metadata:
            raise where.error(f"metadata {name!r} twice", at)
        log.metadata[name] = fields.pairs()
        log.describe(length, at, where)
    elif opcode == 15:
        if length != 4:
            raise where.error(f"DataEnd of {length} bytes", at, "4")
        if fields.number("I") != crc:
            raise where.error("CRC of the data section before it does not match", at)
    else:
        raise where.error(f"{NAMES[opcode]} where it does not belong", at)
    fields.done()
    return opcode != 15


def _read_attachment(fields: Fields, data: bytes, at: int, log: RawLog, where: Place) -> None:
    fields.number("Q"), fields.number("Q")
    name, _ = fields.text(), fields.text()
    if name in log.attachments:
        raise where.error(f"attachment {name!r} twice", at)
    log.attachments[name] = fields.blob("Q")
    log.describe(len(data), at, where)
    if fields.number("I") != zlib.crc32(memoryview(data)[:-4]):
        raise where.error(f"CRC of attachment {name!r} does not match", at)


def _read_summary(source: _Source, log: RawLog, where: Place) -> None:
    """Check the summary, its CRC, the footer and the closing magic, and the counts that it states."""
    start = source.at
    if source.left > LARGEST_RECORD:
        raise where.error(f"summary of {source.left} bytes", start, f"at most {LARGEST_RECORD}")
    data = source.take(source.left)
    tail = len(data) - _FOOTER
    if tail < 0 or data[-8:] != MAGIC:
        raise where.error("no footer and magic at the end", start + max(tail, 0))
    opcode, length, summary, offsets, crc = struct.unpack_from("<BQQQI", data, tail)
    if (opcode, length, summary) != (2, 20, start) or not start <= offsets <= start + tail:
        raise where.error("footer does not fit the file", start + tail)
    if crc != zlib.crc32(memoryview(data)[: tail + 25]):
        raise where.error("CRC of the summary section does not match", start)
    for opcode, at, inner, end in records(data, 0, tail, where, start):
        if opcode == 11:
            _check_statistics(Fields(data, inner, end, where, start), at + start, log, where)
            return
    raise where.error("no statistics in the summary section", start)


def _check_statistics(fields: Fields, at: int, log: RawLog, where: Place) -> None:
    """Compare the counts that the summary states with what was read."""
    stated = tuple(fields.number(kind) for kind in "QHIIII")
    fields.number("Q"), fields.number("Q")
    size = fields.number("I")
    counts = {fields.number("H"): fields.number("Q") for _ in range(size // 10)}
    fields.done()
    read = {number: channel.count for number, channel in log.channels.items() if channel.count}
    sizes = (
        sum(read.values()),
        len(log.schemas),
        len(log.channels),
        len(log.attachments),
        len(log.metadata),
        len(log.chunks),
    )
    if stated != sizes or counts != read:
        raise where.error("counts of the statistics differ from the content", at)


def again(stream: BinaryIO, file: str, log: RawLog, channel: RawChannel) -> Iterator[Any]:
    """Read the messages of a channel again, chunk by chunk: blocks of records, or time and bytes of each message.

    Raises
    ------
    LogError
        If the file is not any more what was checked.
    """
    for chunk in log.chunks:
        if channel.id not in chunk.channels:
            continue
        where = Place(file)
        data = read_at(stream, chunk.start, chunk.end - chunk.start, where)
        plain, crc = open_chunk(Fields(data, 0, len(data), where, chunk.start), chunk.at, RawLog(), where)
        if crc != chunk.crc:
            raise where.error("the chunk changed after it was checked", chunk.at)
        yield from messages_again(plain, channel, log, Place(file, chunk.at))


def columns_of(stream: BinaryIO, file: str, log: RawLog, channel: RawChannel, columns: range) -> np.ndarray:
    """Return some columns (N, k) of a channel of doubles, the time being column 0; read again where not kept."""
    values, row = np.empty((channel.count, len(columns))), 0
    kept = (block[:, columns.start : columns.stop] for block in channel.blocks)
    for block in kept if log.keeps else (doubles(block, columns) for block in again(stream, file, log, channel)):
        values[row : row + len(block)] = block
        row += len(block)
    return values
