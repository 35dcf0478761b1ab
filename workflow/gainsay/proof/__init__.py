"""Certificates and their independent checker: python-flint is all it imports, and only when something is checked.

Public names: `Certificate`, `Conclusion`, `Proof`, `by_ends`, `check`, `check_file`, `formulas_digest`, and the
builders of `gainsay.proof.build`.
"""

from importlib import import_module
from typing import Any

_HOMES = {
    "Certificate": "certificate",
    "Conclusion": "certificate",
    "MappingTables": "scope",
    "Proof": "checker",
    "by_ends": "stated",
    "check": "checker",
    "check_file": "checker",
    "formulas_digest": "stated",
    "read_certificate": "checker",
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"gainsay.proof.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
