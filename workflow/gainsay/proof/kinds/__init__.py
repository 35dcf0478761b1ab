"""The kinds of proof, one module each: its docstring states the theorem, `THEOREM` names it, `prove` applies it.

A module of this package is a kind under its own name. It defines

- ``THEOREM``: what the conclusions rest on, one line;
- ``REQUIRED``, ``OPTIONAL``: names of the certificate's fields;
- ``LEVELS``: those of them whose number is the level that is proved, so that a conclusion carries it ("inputs.bound":
  of each entry of a list); ``FOUND``: those that are free to be found as a witness is;
- ``FAITH`` (may be left out): what the theorem's use takes on faith, one sentence each;
- ``prove(scope) -> list[Proved]``: checks the witness and says what follows; raises `CertificateError` otherwise.
"""

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from gainsay.errors import CertificateError

__all__ = ["Proved", "load", "names"]


@dataclass(frozen=True)
class Proved:
    """What a theorem gives: a relation of what it speaks of to an exact value (text; None for holds and fails)."""

    of: str
    relation: str
    value: str | None = None


@cache
def names() -> tuple[str, ...]:
    """Names of all kinds."""
    return tuple(sorted(module.name for module in iter_modules(__path__)))


def load(name: str) -> ModuleType:
    """Module of a kind.

    Raises
    ------
    CertificateError
        If there is no such kind.
    """
    if name not in names():
        raise CertificateError(f"kind {name!r}: expected one of {', '.join(names())}")
    return import_module(f"{__name__}.{name}")
