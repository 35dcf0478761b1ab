"""Records of the MCAP container, field by field: every length is checked, and errors name the byte."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass

from gainsay.errors import LogError

HEAD = struct.Struct("<BQ")
NAMES = {
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


class Fields:
    """A cursor over the content of one record; `offset` is where the data stand in the file, for errors."""

    def __init__(self, data: bytes, start: int, end: int, where: "Place", offset: int = 0) -> None:
        self.data, self.at, self.end, self.where, self.offset = data, start, end, where, offset

    def _take(self, size: int) -> int:
        start = self.at
        if size > self.end - start:
            raise self.where.error(f"field of {size} bytes, {self.end - start} left in the record", self.offset + start)
        self.at += size
        return start

    def number(self, kind: str) -> int:
        """An integer, by its letter in `struct`."""
        return struct.unpack_from("<" + kind, self.data, self._take(struct.calcsize("<" + kind)))[0]

    def blob(self, kind: str = "I") -> bytes:
        """Bytes behind their number."""
        size = self.number(kind)
        start = self._take(size)
        return bytes(self.data[start : start + size])

    def text(self) -> str:
        """Text behind its number of bytes."""
        start = self.at
        try:
            return self.blob().decode()
        except UnicodeDecodeError:
            raise self.where.error("text that is not UTF-8", self.offset + start) from None

    def pairs(self) -> dict[str, str]:
        """A map of texts, each key once."""
        size = self.number("I")
        end = self._take(size) + size
        inner = Fields(self.data, end - size, end, self.where, self.offset)
        pairs = {}
        while inner.at < end:
            start = inner.at
            key = inner.text()
            if key in pairs:
                raise self.where.error(f"the key {key!r} twice", self.offset + start)
            pairs[key] = inner.text()
        return pairs

    def done(self) -> None:
        """Refuse a record that goes on."""
        if self.at != self.end:
            raise self.where.error(f"{self.end - self.at} bytes too many in the record", self.offset + self.at)


@dataclass(frozen=True)
class Place:
    """Where errors are: the file and, inside a chunk, its start."""

    file: str
    chunk: int | None = None

    def error(self, message: str, offset: int, expected: str = "") -> LogError:
        """Return the error that names a byte."""
        place = f"byte {offset}" if self.chunk is None else f"byte {offset} of the chunk at byte {self.chunk}"
        return LogError(f"broken at {place}: {message}", file=self.file, expected=expected)


def records(data: bytes, start: int, end: int, where: Place, offset: int = 0) -> Iterator[tuple[int, int, int, int]]:
    """Yield opcode, offset, start and end of content of every record between two offsets."""
    at = start
    while at < end:
        if end - at < 9:
            raise where.error(f"{end - at} bytes where a record should start", offset + at)
        opcode, length = HEAD.unpack_from(data, at)
        if opcode not in NAMES:
            raise where.error(f"unknown record type {opcode}", offset + at)
        if length > end - at - 9:
            raise where.error(f"{NAMES[opcode]} of {length} bytes, {end - at - 9} left", offset + at)
        yield opcode, at, at + 9, at + 9 + length
        at += 9 + length
