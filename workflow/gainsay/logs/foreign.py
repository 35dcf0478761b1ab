"""What can be told of an MCAP file that is not one of ours: read as far as it can be, nothing is concluded from it."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from mcap.exceptions import McapError
from mcap.records import Channel, Header, Message
from mcap.stream_reader import StreamReader

from gainsay.errors import LogError, one_line
from gainsay.logs.container import PROFILE
from gainsay.logs.reader import read_log


def describe(path: Path) -> Iterator[str]:
    """Yield lines on a single file: whose it is, then its topics with their encoding and number of messages.

    Raises
    ------
    LogError
        The file is missing or no MCAP file, or one of ours and damaged.
    """
    try:
        with path.open("rb") as stream:
            records = StreamReader(stream, emit_chunks=False).records
            header = next((record for record in records if isinstance(record, Header)), None)
            if header is None:
                raise LogError("no MCAP file", file=path.name)
            if header.profile == PROFILE:
                log = read_log(path)
                yield f"{path.name}: {log.metadata.get('paper', '')} {log.metadata.get('run', '')}, {log.duration:g} s"
                yield from (f"  {topic}  {log.count(topic)} messages" for topic in log.topics)
                return
            yield from _foreign(path, header, records)
    except OSError as error:
        raise LogError(error.strerror or "cannot be read", file=str(path)) from None
    except (McapError, ValueError, EOFError) as error:
        if isinstance(error, LogError):
            raise
        raise LogError(f"no MCAP file: {one_line(str(error)) or type(error).__name__}", file=path.name) from None


def _foreign(path: Path, header: Header, records: Iterator[object]) -> Iterator[str]:
    channels: dict[int, Channel] = {}
    counts: Counter[int] = Counter()
    first: int | None = None
    last = 0
    broken = ""
    try:
        for record in records:
            if isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                counts[record.channel_id] += 1
                first = record.log_time if first is None else min(first, record.log_time)
                last = max(last, record.log_time)
    except Exception as error:  # a file of somebody else may break any reader; what was read before that is told
        broken = f"; it breaks off: {one_line(str(error)) or type(error).__name__}"
    duration = 0.0 if first is None else (last - first) / 1e9
    yield (
        f"{path.name}: not one of ours (profile {header.profile!r}, written by {header.library!r}): "
        f"{sum(counts.values())} messages in {duration:g} s{broken}"
    )
    for channel in channels.values():
        yield one_line(f"  {channel.topic}  {channel.message_encoding}  {counts[channel.id]} messages")
