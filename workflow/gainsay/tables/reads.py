"""What a computation read of what the paper leaves out: recorded while it runs, never listed by hand.

A value that was computed before a parameter was read cannot depend on it. So what stands in the record when a quantity
is written down covers all that it depends on, as long as it was computed where it is recorded.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_ACTIVE: ContextVar[tuple[set[str], ...]] = ContextVar("_ACTIVE", default=())


@contextmanager
def recording() -> Iterator[set[str]]:
    """Record the names of the parameters read inside; they count for what records around it as well.

    Examples
    --------
    >>> with recording() as names:
    ...     note("gravity")
    >>> names
    {'gravity'}
    """
    names: set[str] = set()
    token = _ACTIVE.set((*_ACTIVE.get(), names))
    try:
        yield names
    finally:
        _ACTIVE.reset(token)


@contextmanager
def apart(before: set[str]) -> Iterator[set[str]]:
    """Record what is read inside apart from what is around it: what was read before counts, the rest ends here.

    Parameters
    ----------
    before : set of str
        Names read before: what is computed inside may depend on them.
    """
    names = set(before)
    token = _ACTIVE.set((names,))
    try:
        yield names
    finally:
        _ACTIVE.reset(token)


def note(name: str) -> None:
    """Note that a parameter was read."""
    for names in _ACTIVE.get():
        names.add(name)
