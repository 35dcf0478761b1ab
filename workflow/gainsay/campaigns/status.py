"""Where a campaign stands: chunks done, rate, time left, what was found so far."""

import time
from collections import Counter
from pathlib import Path

from gainsay.campaigns.plan import Plan
from gainsay.campaigns.store import about_chunk, chunk_path
from gainsay.errors import InputError

#: chunks whose times tell the rate: the last ones done
_RECENT = 20
#: how often the time between chunks nothing may come before it is said, and for how many seconds at least
_OVERDUE, _SILENT = 5, 60.0
#: what to do where nothing comes: a scheduler may have lost a job without a word, and then Snakemake waits for it
_LOST = "where no job is in the queue: stop Snakemake and start it again, what is there stays"
_UNITS = ((86400, "d"), (3600, "h"), (60, "min"), (1, "s"))


def spelled(seconds: float) -> str:
    """Say a time in its largest unit.

    Examples
    --------
    >>> spelled(5400)
    '1.5 h'
    """
    size, unit = next(((s, u) for s, u in _UNITS if seconds >= s), _UNITS[-1])
    return f"{seconds / size:.2g} {unit}"


def rate(done: list[float], now: float) -> float:
    """Chunks a second from the times at which chunks were done; 0 where fewer than two are."""
    recent = sorted(done)[-_RECENT:]
    span = (now if now - recent[-1] > recent[-1] - recent[0] else recent[-1]) - recent[0] if len(recent) > 1 else 0.0
    return (len(recent) - 1) / span if span > 0 else 0.0


def silence(done: list[float], now: float) -> float:
    """Seconds since the last chunk where they are long beside the time between chunks, else 0.

    A job that its scheduler lost never ends: that nothing comes is all there is to see.
    """
    recent = sorted(done)[-_RECENT:]
    if len(recent) < 2:
        return 0.0
    idle = now - recent[-1]
    return idle if idle > max(_SILENT, _OVERDUE * (recent[-1] - recent[0]) / (len(recent) - 1)) else 0.0


def progress(plan: Plan, now: float | None = None) -> str:
    """Return one line on a campaign, from the files of its chunks alone.

    Parameters
    ----------
    plan : Plan
    now : float, optional
        Seconds since the epoch; the clock unless given.
    """
    now = time.time() if now is None else now
    place: Path = chunk_path(plan, 0).parent
    states: Counter[str] = Counter()
    times = []
    for path in sorted(place.glob("chunk-*.parquet")):
        try:
            states.update(about_chunk(path, plan.case.root)["counts"])
        except InputError:
            continue
        times.append(path.stat().st_mtime)
    so_far = ", ".join(f"{count} {name}" for name, count in states.items())
    line = f"{plan.row.name}: {len(times)} of {plan.chunks} chunks"
    if len(times) == plan.chunks:
        return f"{line}, done: {so_far}"
    speed = rate(times, now) if times else 0.0
    if speed:
        line += f", {speed * 60:.3g} a minute, {spelled((plan.chunks - len(times)) / speed)} left"
    idle = silence(times, now)
    line += f", none for {spelled(idle)} ({_LOST})" if idle else ""
    return f"{line}, so far: {so_far}" if so_far else line
