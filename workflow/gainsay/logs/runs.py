"""What a paper declares of one run, and what is measured from its log."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gainsay.errors import InputError

if TYPE_CHECKING:
    from gainsay.logs.reader import Log
    from gainsay.logs.writer import LogWriter

Simulate = Callable[[Any, Mapping[str, Mapping[str, Any]], "LogWriter"], None]
Measure = Callable[[Any, "Log"], Mapping[str, "Measured"]]


@dataclass(frozen=True)
class Measured:
    """One quantity computed from a log alone.

    Attributes
    ----------
    value : float
        Its value, in the unit that quantities.csv declares.
    method : str
        How it was obtained, in one line.
    lower, upper : float or None
        An enclosure or error band, where there is one.
    """

    value: float
    method: str
    lower: float | None = None
    upper: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", float(self.value))
        for name in ("lower", "upper"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, float(getattr(self, name)))
        low = -math.inf if self.lower is None else self.lower
        high = math.inf if self.upper is None else self.upper
        if not self.method or "\n" in self.method:
            raise InputError("method of a measured quantity", value=self.method, expected="one line")
        if not math.isnan(self.value) and not low <= self.value <= high:
            raise InputError("measured value", value=self.value, expected=f"inside its own band {low!r}..{high!r}")


@dataclass(frozen=True)
class RunSpec:
    """One run of a paper: how it is simulated, and what is read from its log; paper.toml says what it is.

    Attributes
    ----------
    name : str
        Lower-case name ``[a-z0-9_]+``: file name of the log and part of its application id in viewers.
    simulate : callable
        ``simulate(case, designs, log)`` writes the whole run into the `LogWriter`.
    measure : callable
        ``measure(case, log)`` returns every quantity of the run, computed from its `Log` alone.
    """

    name: str
    simulate: Simulate
    measure: Measure

    def __post_init__(self) -> None:
        if not self.name or not set(self.name) <= set("abcdefghijklmnopqrstuvwxyz0123456789_"):
            raise InputError("run name", value=self.name, expected="lower-case letters, digits and underscores")


def located(log: "Log", name: str, method: str, *, times: float = 1.0, rounding: float = 0.0) -> Measured:
    """Located extreme of a log with the band that its second method gives.

    Parameters
    ----------
    log : Log
    name : str
        Of the extreme.
    method : str
        Both methods, in one line.
    times : float, optional
        Band over the difference of the two values.
    rounding : float, optional
        What is added to the band, relative to the value.

    Raises
    ------
    KeyError
        If the log has no extreme of that name.
    """
    _, value, second = log.extremes[name]
    band = times * abs(value - second) + rounding * abs(value)
    return Measured(value, method, value - band, value + band)


def measuring(prefix: str, names: Iterable[str], method: str, *, times: float = 1.0) -> Measure:
    """Return the function that measures located extremes as quantities ``<prefix>.<name>``, banded as by `located`."""
    fixed_names = tuple(names)

    def measure(case: Any, log: "Log") -> dict[str, Measured]:
        return {f"{prefix}.{name}": located(log, name, method, times=times) for name in fixed_names}

    return measure
