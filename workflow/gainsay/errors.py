"""The typed errors of Gainsay: one line each, naming file, row, field, value and what was expected."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from pathlib import Path

#: characters of a message at most, of the file in it, and of a part that repeats what was found
LONGEST, LONGEST_FILE, LONGEST_PART = 300, 200, 100


def one_line(text: str, longest: int = LONGEST) -> str:
    """Return a text as one line of at most so many characters, without anything that a terminal would obey.

    What is too long loses its middle: ends say more.

    Examples
    --------
    >>> one_line("0123456789", 7)
    '012…789'
    """
    shown = "".join(c if c.isprintable() else " " for c in text)
    half = (longest - 1) // 2
    return shown if len(shown) <= longest else f"{shown[: longest - 1 - half]}…{shown[len(shown) - half :]}"


class GainsayError(Exception):
    """Base of every error that Gainsay raises on purpose."""


class InputError(GainsayError, ValueError):
    """Bad input, found before anything was computed; commands end with exit code 2.

    Parameters
    ----------
    message : str, optional
        What is wrong; may be empty where value and expectation say it all.
    file : str or Path, optional
        The file at fault, relative to the project root where it lies inside it.
    row : int, optional
        Line number in the file, the header being line 1.
    field : str, optional
        Column, key or field.
    value : object, optional
        The value as found.
    expected : str, optional
        What would have been accepted.
    """

    def __init__(
        self,
        message: str = "",
        *,
        file: str | Path | None = None,
        row: int | None = None,
        field: str | None = None,
        value: object = None,
        expected: str = "",
    ) -> None:
        self.message, self.file, self.row = message, file, row
        self.field, self.value, self.expected = field, value, expected
        super().__init__(self._line())

    def _line(self) -> str:
        place = "" if self.file is None else one_line(str(self.file), LONGEST_FILE)
        if self.row is not None:
            place += f":{self.row}"
        parts = [place] if place else []
        what = [self.message] if self.message else []
        if self.field is not None:
            what.append(one_line(str(self.field), LONGEST_PART))
        if self.value is not None:
            what.append(_shown(self.value))
        if what:
            parts.append(" ".join(what))
        if self.expected:
            parts.append(f"expected {self.expected}")
        return one_line(": ".join(parts))


def _shown(value: object) -> str:
    """Show a value as found, shortened; a number too long to be written out has no text of its own."""
    try:
        return one_line(repr(value), LONGEST_PART)
    except (ValueError, RecursionError):
        return "a value too large to be shown"


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the name that an unknown one may have meant; nothing where none is near."""
    close = get_close_matches(name, list(known), n=1, cutoff=0.6)
    return close[0] if close else ""


def one_of(name: str, known: Iterable[str], most: int = 12) -> str:
    """Say what would have been accepted for an unknown name: the nearest one where there is one near, else the names.

    Examples
    --------
    >>> one_of("robst", ["lqr", "robust"])
    "'robust'? It is one of lqr, robust"
    >>> one_of("wan", ["lqr", "robust"])
    'one of lqr, robust'
    """
    names = list(dict.fromkeys(known))
    listed = ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
    near = nearest(name, names)
    return f"{near!r}? It is one of {listed}" if near else f"one of {listed or 'none'}"


#: module -> the extra of this package that brings it
EXTRAS = {"rerun": "view", "pandas": "view", "snakemake": "workflow", "rocrate": "crate", "pyarrow": "campaigns"}


def missing_extra(module: str) -> str:
    """Say how to install what an optional module needs.

    Examples
    --------
    >>> missing_extra("snakemake")
    "the extra workflow: pip install 'gainsay[workflow]'"
    """
    return f"the extra {EXTRAS[module]}: pip install 'gainsay[{EXTRAS[module]}]'"


class LogError(InputError):
    """A log that cannot be read as it should; names the byte where it broke where that is known."""


class CertificateError(GainsayError, ValueError):
    """A certificate that is malformed, tampered with or does not prove what it states."""


class ComputationError(GainsayError, ArithmeticError):
    """A computation of ours that broke: recorded as `failed` with its attempts, never as a verdict.

    Parameters
    ----------
    where : str
        The equation or item of the paper.
    message : str
        What broke.
    attempts : sequence of dict, optional
        What was tried: solver, status, margin, iterations.
    """

    def __init__(self, where: str, message: str, attempts: Sequence[dict] = ()) -> None:
        self.where, self.message, self.attempts = where, message, tuple(attempts)
        super().__init__(one_line(f"{where}: {message}"))
