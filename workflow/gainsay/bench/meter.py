"""Where the CPU seconds of a task go: bare solves, bare integrations, imports, and the rest.

Measured around the calls themselves: a solver's own run, an integrator's with its right-hand side, the first import of
a module. What is counted inside another counted part is taken out of that one.
"""

import builtins
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import wraps
from typing import Any

KINDS = ("solves", "integrations", "imports")


class Meter:
    """CPU seconds of this process by kind.

    Parameters
    ----------
    kinds : sequence of str
        What is told apart.

    Attributes
    ----------
    seconds : dict
        Kind to seconds.
    """

    def __init__(self, kinds: Sequence[str] = KINDS) -> None:
        self.seconds = dict.fromkeys(kinds, 0.0)
        self._within: list[float] = []  # seconds counted inside each call that is running

    def around(self, kind: str, call: Callable) -> Callable:
        """The same call, counted."""

        @wraps(call)
        def counted(*arguments: Any, **named: Any) -> Any:
            self._within.append(0.0)
            begun = time.process_time()
            try:
                return call(*arguments, **named)
            finally:
                seconds = time.process_time() - begun
                self.seconds[kind] += seconds - self._within.pop()
                if self._within:
                    self._within[-1] += seconds

        return counted

    def _importing(self, plain: Callable) -> Callable:
        counted = self.around("imports", plain)

        def imported(name: str, *rest: Any, **named: Any) -> Any:
            return (plain if name in sys.modules else counted)(name, *rest, **named)

        return imported

    @contextmanager
    def imports(self) -> Iterator[None]:
        """Count imports inside the block."""
        plain = builtins.__import__
        builtins.__import__ = self._importing(plain)
        try:
            yield
        finally:
            builtins.__import__ = plain

    @contextmanager
    def calls(self) -> Iterator[None]:
        """Count Clarabel and the integrators of `gainsay.simulation` inside the block."""
        import scipy.integrate

        from gainsay.lmi import backends
        from gainsay.simulation import batch, delay_steps, linear, periodic

        places: list[tuple[Any, str, Callable[..., Any]]] = [
            (backends, "bare_solve", self.around("solves", backends.bare_solve)),
            (scipy.integrate, "solve_ivp", self.around("integrations", scipy.integrate.solve_ivp)),
        ]
        places += [
            (kind, name, self.around("integrations", getattr(kind, name)))
            for kind, name in (
                (periodic.PeriodicSolution, "__init__"),
                (linear.Response, "__init__"),
                (batch.Stepper, "segment"),
                (delay_steps.Steps, "of"),  # a bound method of the class: counted, it takes the same arguments
                (delay_steps.Steps, "run"),
            )
        ]
        with replaced([(owner, name, staticmethod(c) if name == "of" else c) for owner, name, c in places]):
            yield


@contextmanager
def replaced(places: Sequence[tuple[Any, str, Any]]) -> Iterator[None]:
    """Put other values in the place of some attributes, each an owner, a name and a value, inside the block."""
    kept = [(owner, name, vars(owner)[name]) for owner, name, _ in places]
    for owner, name, value in places:
        setattr(owner, name, value)
    try:
        yield
    finally:
        for owner, name, plain in kept:
            setattr(owner, name, plain)
