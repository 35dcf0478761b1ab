"""The certificate: a JSON file that states something, names its data, and holds an exact witness.

Format, version 2 (keys sorted, two spaces, UTF-8, a final newline; the same certificate gives the same bytes):

============== ==========================================================================================
``format``      "gainsay certificate"
``version``     2
``id, paper``   the certificate's own id, and the paper's folder name
``statement``   one sentence for people; that it says what the conclusions say is on faith
``kind``        the kind of proof: a module of `gainsay.proof.kinds`, whose docstring states the theorem
``precision``   bits of the balls
``definitions`` list of [name, formula], each over the tables, the unknowns and the names before it; names are ASCII
                identifiers that mean nothing else, formulas are ASCII on one line
``unknowns``    name -> {"shape": [m, n], "structure": "symmetric" | "full" | "diagonal" | "skew"}
``fields``      the kind's own fields: formulas, constraints, bounds
``witness``     name -> matrix of exact rationals as text ("-8.8129e-4", "1/3"), in nested lists
``data``        every table entry read, with its value: {"number": {name: text}, "plausible":
                {name: "low..high"}, "printed": {name: rows}, "half_units": {name: rows},
                "design": {"name.entry": rows}}
``conclusions`` list of {"of", "quantity", "relation", "value"}: `of` is what the kind proves something about
                ("norm", "cost", ...), `quantity` the id it is in quantities.csv ("" where it is about the
                certificate's formulas alone); value exact text or null; at least one
``faith``       what no check covers, one sentence each
``digest``      "sha256:" and the digest of the rest: guards against accidents, proves nothing
============== ==========================================================================================

What a check means: the data equal the tables', the formulas are evaluated anew from the tables, the kind's theorem is
applied to them with the witness, and every conclusion follows from what was proved. So a changed statement, datum or
witness is refused unless the mathematics still holds; that the formulas are the paper's stays on faith.

A file is read strictly: no key twice, no floats, no text with control characters or halves of characters, nothing
beyond the limits of size below.
"""

import hashlib
import json
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from gainsay.errors import CertificateError

__all__ = ["RELATIONS", "Certificate", "Conclusion", "plain"]

FORMAT, VERSION = "gainsay certificate", 2
#: bytes of a file, values in it, levels of nesting, characters of a text
LARGEST_FILE, MOST_VALUES, DEEPEST, LONGEST_TEXT = 4_000_000, 200_000, 12, 20_000
RELATIONS = ("at_most", "at_least", "less_than", "greater_than", "holds", "fails", "inside")
_KEYS = (
    *("format", "version", "id", "paper", "statement", "kind", "precision", "definitions"),
    *("unknowns", "fields", "witness", "data", "conclusions", "faith", "digest"),
)

# What no check covers, in any certificate.
SENTENCE_ON_FAITH = "That its sentence says what its conclusions say."
ON_FAITH = (
    "That the formulas of this certificate are those of the paper.",
    "That the quantities it concludes on are what its formulas describe.",
    SENTENCE_ON_FAITH,
)

_PAPER = re.compile(r"[a-z][a-z0-9_]{0,63}", re.ASCII)
_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,127}", re.ASCII)
_OF = re.compile(r"[A-Za-z_][A-Za-z0-9_.]{0,127}", re.ASCII)


@dataclass(frozen=True)
class Conclusion:
    """Something proved about a quantity.

    Parameters
    ----------
    quantity : str
        Id in quantities.csv, or nothing where it is about the certificate's formulas alone.
    relation : str
        One of `RELATIONS`; holds and fails speak of boolean quantities.
    value : str or None
        Exact decimal or ratio in the quantity's unit ("low..high" for inside); None for holds and fails.
    of : str
        What the kind of proof proves this about: "norm", "cost", "feasible", ...
    """

    quantity: str
    relation: str
    value: str | None = None
    of: str = ""


@dataclass(frozen=True)
class Certificate:
    """A statement with its exact witness; the format stands in the module's docstring."""

    id: str
    paper: str
    statement: str
    kind: str
    fields: Mapping[str, Any]
    definitions: Sequence[tuple[str, str]] = ()
    unknowns: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    witness: Mapping[str, Any] = field(default_factory=dict)
    conclusions: Sequence[Conclusion] = ()
    faith: Sequence[str] = ON_FAITH
    data: Mapping[str, Any] = field(default_factory=dict)
    precision: int = 128

    def body(self) -> dict[str, Any]:
        """Everything but the digest, as plain JSON values."""
        return {
            "format": FORMAT,
            "version": VERSION,
            "id": self.id,
            "paper": self.paper,
            "statement": self.statement,
            "kind": self.kind,
            "precision": self.precision,
            "definitions": [[name, text] for name, text in self.definitions],
            "unknowns": plain(self.unknowns),
            "fields": plain(self.fields),
            "witness": plain(self.witness),
            "data": plain(self.data),
            "conclusions": [asdict(c) for c in self.conclusions],
            "faith": list(self.faith),
        }

    def digest(self) -> str:
        """Digest of the body."""
        return _digest(self.body())

    def to_json(self, compact: bool = False) -> str:
        """Text of the file.

        Parameters
        ----------
        compact : bool, optional
            In one line, for programs: a tenth of the time of one that people read.
        """
        body = self.body()
        whole = {**body, "digest": _digest(body)}
        return _packed(whole) if compact else json.dumps(whole, sort_keys=True, indent=2, ensure_ascii=False) + "\n"

    def write(self, path: Path) -> None:
        """Write the file; the caller sees to it that it appears whole or not at all."""
        path.write_text(self.to_json(), encoding="utf-8")

    def changed(self, **parts: Any) -> "Certificate":
        """Copy with some parts replaced."""
        return replace(self, **parts)

    @classmethod
    def from_json(cls, text: str, name: str = "certificate") -> "Certificate":
        """Read the text of a file.

        Raises
        ------
        CertificateError
            If it is not a certificate of this version, or its digest is not that of its contents.
        """
        if len(text) > LARGEST_FILE:
            raise CertificateError(f"{name}: {len(text)} characters, expected at most {LARGEST_FILE}")
        try:
            raw = json.loads(
                text, parse_float=_no_float, parse_constant=_no_float, parse_int=_short, object_pairs_hook=_once
            )
        except (ValueError, RecursionError, MemoryError) as error:
            raise CertificateError(
                f"{name}: not readable as JSON without floats ({error})".replace("\n", " ")
            ) from error
        if not isinstance(raw, dict) or raw.get("format") != FORMAT:
            raise CertificateError(f"{name}: not a {FORMAT}")
        if type(raw.get("version")) is not int or raw["version"] != VERSION:
            raise CertificateError(f"{name}: version {raw.get('version')!r}, expected {VERSION}")
        for key in _KEYS:
            if key not in raw:
                raise CertificateError(f"{name}: {key} is missing")
        for key in raw:
            if key not in _KEYS:
                raise CertificateError(f"{name}: unknown key {key!r}")
        certificate = cls._from_body(raw, name)
        if raw["digest"] != _digest({key: value for key, value in raw.items() if key != "digest"}):
            raise CertificateError(f"{name}: the digest does not match the contents: the file was changed")
        return certificate

    def validated(self) -> "Certificate":
        """The same certificate, once its parts have the form that a file must have.

        Raises
        ------
        CertificateError
            If they do not.
        """
        named = isinstance(self.id, str) and _ID.fullmatch(self.id)
        return self._from_body(self.body(), self.id if named else "certificate")

    @classmethod
    def _from_body(cls, raw: dict[str, Any], name: str) -> "Certificate":
        try:
            _readable({key: value for key, value in raw.items() if key != "digest"})
        except ValueError as error:
            raise CertificateError(f"{name}: {error}") from error

        def expect(key: str, types: type | tuple[type, ...]) -> Any:
            if not isinstance(raw[key], types) or isinstance(raw[key], bool):
                raise CertificateError(f"{name}: {key} has the wrong type {type(raw[key]).__name__}")
            return raw[key]

        for key in ("id", "paper", "statement", "kind"):
            expect(key, str)
        for key in ("unknowns", "fields", "witness", "data"):
            expect(key, dict)
        for key in ("definitions", "conclusions", "faith"):
            expect(key, list)
        for key, pattern in (("id", _ID), ("paper", _PAPER), ("kind", _PAPER)):
            if not pattern.fullmatch(raw[key]):
                raise CertificateError(f"{name}: {key} {raw[key][:80]!r} is not a plain name")
        bits = expect("precision", int)
        if not 53 <= bits <= 4096:
            raise CertificateError(f"{name}: precision {bits}, expected 53 to 4096 bits")
        if any(
            not isinstance(p, list) or len(p) != 2 or not all(isinstance(x, str) for x in p) for p in raw["definitions"]
        ):
            raise CertificateError(f"{name}: definitions must be pairs of a name and a formula")
        if any(not isinstance(x, str) for x in raw["faith"]):
            raise CertificateError(f"{name}: faith must be texts")
        conclusions = []
        for entry in raw["conclusions"]:
            if not isinstance(entry, dict) or set(entry) != {"of", "quantity", "relation", "value"}:
                raise CertificateError(f"{name}: a conclusion has the keys of, quantity, relation, value")
            if entry["relation"] not in RELATIONS:
                raise CertificateError(
                    f"{name}: relation {entry['relation']!r}, expected one of {', '.join(RELATIONS)}"
                )
            if not all(isinstance(entry[k], str) for k in ("of", "quantity")) or not isinstance(
                entry["value"], str | None
            ):
                raise CertificateError(f"{name}: a conclusion holds texts")
            if (entry["quantity"] and not _ID.fullmatch(entry["quantity"])) or not _OF.fullmatch(entry["of"]):
                raise CertificateError(f"{name}: a conclusion on {entry['quantity'][:80]!r}, of {entry['of'][:80]!r}")
            conclusions.append(Conclusion(**entry))
        return cls(
            id=raw["id"],
            paper=raw["paper"],
            statement=raw["statement"],
            kind=raw["kind"],
            fields=raw["fields"],
            definitions=tuple((n, t) for n, t in raw["definitions"]),
            unknowns=raw["unknowns"],
            witness=raw["witness"],
            conclusions=tuple(conclusions),
            faith=tuple(raw["faith"]),
            data=raw["data"],
            precision=bits,
        )


def _no_float(text: str) -> Any:
    raise ValueError(f"{text[:40]} is not exact: numbers are texts here")


def _short(text: str) -> int:
    if len(text) > 9:
        raise ValueError(f"the integer {text[:20]}... is too long")
    return int(text)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Object of JSON, refused where a key stands twice."""
    result = dict(pairs)
    if len(result) != len(pairs):
        twice = next(key for key in result if sum(key == k for k, _ in pairs) > 1)
        raise ValueError(f"the key {twice[:40]!r} stands twice")
    return result


def _readable(value: Any) -> None:
    """Refuse what is nested too deep or too large, and texts that do not show what they hold."""
    level, count = [value], 0
    for _ in range(DEEPEST + 1):
        below = []
        for item in level:
            if isinstance(item, str):
                _visible(item)
            elif isinstance(item, dict):
                below += [*item, *item.values()]
            elif isinstance(item, list):
                below += item
        count += len(below)
        if count > MOST_VALUES:
            raise ValueError(f"more than {MOST_VALUES} values")
        if not below:
            return
        level = below
    raise ValueError(f"nested deeper than {DEEPEST} levels")


def _visible(text: str) -> None:
    """Refuse control characters, line breaks, marks that turn the writing direction, and halves of characters."""
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"a text of {len(text)} characters, at most {LONGEST_TEXT}")
    if text.isascii() and text.isprintable():
        return
    for character in text:
        if unicodedata.category(character)[0] == "C" or unicodedata.category(character) in ("Zl", "Zp"):
            raise ValueError(f"a text holds the character U+{ord(character):04X}, which does not show")
    if not unicodedata.is_normalized("NFC", text):
        raise ValueError(f"the text {text[:40]!r} is not in normal form (NFC)")


def plain(value: Any) -> Any:
    """Value as plain JSON: nested dicts and lists of texts, booleans, integers and None."""
    if value is None or isinstance(value, str | bool) or type(value) is int:
        return value
    if isinstance(value, list | tuple):  # texts, which are nearly all there is, without a call each
        return [v if type(v) is str else plain(v) for v in value]
    if isinstance(value, Mapping):
        return {str(k): v if type(v) is str else plain(v) for k, v in value.items()}
    raise CertificateError(f"{value!r} cannot stand in a certificate: write numbers as exact texts")


def _packed(value: Any) -> str:
    return json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))


def _digest(body: Mapping[str, Any]) -> str:
    return "sha256:" + hashlib.sha256(_packed(body).encode()).hexdigest()
