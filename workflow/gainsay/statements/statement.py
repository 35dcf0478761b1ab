"""A matrix inequality as its paper prints it: named blocks of formulas, written once in the language of the checker.

One text serves the solver, the certificate and the page. A statement knows its equation number and its source; its
editions (as printed, as corrected) share the text and name the cells that differ.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from gainsay.errors import InputError
from gainsay.proof.formulas import check_name
from gainsay.proof.syntax import Relation, compared, one_line, parse, segment
from gainsay.statements.unknowns import Unknown

__all__ = ["Cell", "Constraint", "Definitions", "Statement", "over", "read_constraint"]

#: names of formulas in order, each over the tables, the unknowns and the names before it; or how a case gives them
Definitions = Mapping[str, str] | Callable[[Any], Mapping[str, str]]


@dataclass(frozen=True)
class Cell:
    """A cell in which two editions of a statement differ; an empty text is a zero or a row that is not there."""

    row: str
    column: str
    printed: str
    corrected: str


@dataclass(frozen=True)
class Constraint:
    """Two formulas and the relation between them, under a name; unknowns and definitions of the statement behind it.

    Attributes
    ----------
    label : str
        Name in programs, certificates and messages: the equation number.
    left, right : str
        Formulas.
    relation : {"<", "<=", "==", ">=", ">"}
        Between symmetric matrices the order is that of quadratic forms.
    statement : Statement or None
        What it was written from.
    """

    label: str
    left: str
    relation: Relation
    right: str = "0"
    statement: "Statement | None" = None

    @property
    def text(self) -> str:
        """The constraint in the language of the checker."""
        return f"{self.left} {self.relation} {self.right}"

    def named(self, label: str) -> "Constraint":
        """Return the same constraint under another name."""
        return replace(self, label=label)


def read_constraint(text: str, label: str | None = None) -> Constraint:
    """Read a constraint such as ``X > 0`` or ``trace(P) == 1``; its label is the text unless one is given.

    Raises
    ------
    CertificateError
        If it is not an expression of the formula language.
    InputError
        If it is not a comparison of two formulas.
    """
    sides = compared(text)
    if sides is None:
        raise InputError("constraint", value=text, expected="two formulas with one of < <= == >= > between them")
    left, relation, right = sides
    return Constraint(label or one_line(text), segment(text, left), relation, segment(text, right))


@dataclass(frozen=True, eq=False)
class Statement:
    """One inequality or matrix of a paper.

    Parameters
    ----------
    label : str
        Equation number, such as ``"(14)"``.
    source : str
        Where it stands: theorem, section.
    rows : sequence of str
        Names of the block rows in the printed order; one row for a matrix without blocks.
    blocks : mapping of (row, column) to str
        Formulas of the blocks on one side of the diagonal; the other side follows by symmetry, what is left out is
        zero.
    unknowns : mapping of str to Unknown
    where : mapping of str to str, or function of a case that gives one
        Definitions in order, each a formula over the tables, the unknowns and the names before it.
    edition : str
        Nothing for the text as printed.
    differences : tuple of Cell
        Cells that differ from the edition it was made of.
    printed_rows : sequence of str
        Block rows of the edition it was made of: they number its cells.
    notation : mapping of str to str
        Names that the paper writes otherwise than the formulas spell them, as TeX.

    Raises
    ------
    InputError
        If a block stands in no row, or stands twice.
    CertificateError
        If a text is not a formula.

    Examples
    --------
    >>> from gainsay.statements import Statement, symmetric
    >>> lyapunov = Statement("(3)", "Theorem 1", ("state",), {("state", "state"): "sym(P@A)"},
    ...                      unknowns={"P": symmetric(2)}, where={"A": "printed('A')"})
    >>> (lyapunov < 0).text
    'sym(P@A) < 0'
    """

    label: str
    source: str
    rows: Sequence[str]
    blocks: Mapping[tuple[str, str], str]
    unknowns: Mapping[str, Unknown]
    where: Definitions = lambda case: {}  # no definitions
    edition: str = ""
    differences: tuple[Cell, ...] = ()
    printed_rows: Sequence[str] = ()
    notation: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.rows or len(set(self.rows)) != len(self.rows):
            raise InputError("block rows", field=self.label, value=", ".join(self.rows), expected="different names")
        for name in self.unknowns:
            check_name(name)
        for (row, column), text in self.blocks.items():
            for name in (row, column):
                if name not in self.rows:
                    known = ", ".join(self.rows)
                    raise InputError(
                        "block row", field=f"{self.label}, block {row},{column}", value=name, expected=known
                    )
            if row != column and (column, row) in self.blocks:
                raise InputError("block given twice", field=self.label, value=f"{row},{column}", expected="one side")
            if "{" not in text:
                parse(text)

    def block(self, row: str, column: str) -> str:
        """Formula of a block of the upper triangle; empty where it is zero."""
        if (row, column) in self.blocks:
            return one_line(self.blocks[row, column])
        mirrored = self.blocks.get((column, row))
        return f"({one_line(mirrored)}).T" if mirrored else ""

    @property
    def formula(self) -> str:
        """The whole matrix in the language of the checker, ``...`` for what symmetry gives."""
        if len(self.rows) == 1:
            return self.block(self.rows[0], self.rows[0]) or "0"
        lines = []
        for i, row in enumerate(self.rows):
            cells = ["..."] * i + [self.block(row, column) or "0" for column in self.rows[i:]]
            lines.append("[" + ", ".join(cells) + "]")
        return "[" + ", ".join(lines) + "]"

    def definitions(self, case: Any) -> dict[str, str]:
        """Definitions in order, as texts of one line."""
        given = self.where(case) if callable(self.where) else self.where
        return {name: one_line(text) for name, text in given.items()}

    def sub(self, *rows: str, label: str | None = None) -> "Statement":
        """Return the principal part of the named block rows, in the order given."""
        for name in rows:
            if name not in self.rows:
                raise InputError("block row", field=self.label, value=name, expected=", ".join(self.rows))
        kept = {place: text for place, text in self.blocks.items() if set(place) <= set(rows)}
        return replace(self, label=label or self.label, rows=rows, blocks=kept)

    def corrected(
        self, blocks: Mapping[tuple[str, str], str], *, without: Iterable[str] = (), edition: str = "corrected"
    ) -> "Statement":
        """Return another edition of the statement.

        Parameters
        ----------
        blocks : mapping of (row, column) to str
            Cells that read otherwise; an empty text takes a block out.
        without : iterable of str
            Block rows that are left out.
        edition : str
            Name of the edition.

        Returns
        -------
        Statement
            Its `differences` name each cell that differs, with both texts.

        Raises
        ------
        InputError
            If there is no such block row, or no cell differs.
        """
        gone = set(without)
        for name in gone - set(self.rows):
            raise InputError("block row", field=self.label, value=name, expected=", ".join(self.rows))
        places: dict[tuple[str, str], str] = dict(self.blocks)
        for (row, column), text in blocks.items():
            places.pop((column, row), None)
            places.pop((row, column), None)
            if text:
                places[row, column] = text
        rows = [row for row in self.rows if row not in gone]
        kept = {place: text for place, text in places.items() if not set(place) & gone}
        other = replace(self, label=f"{self.label} {edition}", rows=rows, blocks=kept, edition=edition, differences=())
        differences = tuple(_differing(self, other))
        if not differences:
            raise InputError("edition", field=self.label, value=edition, expected="a cell that differs")
        return replace(other, differences=differences, printed_rows=self.rows)

    def given(self, label: str | None = None, /, **values: object) -> "Statement":
        """Return the member of a family: every ``{name}`` in label and blocks becomes the value's text.

        Examples
        --------
        >>> from gainsay.statements import Statement, matrix
        >>> row = Statement("(31) {axis}", "", ("input",), {("input", "input"): "Y[{i},0:6]"}, {"Y": matrix(3, 6)})
        >>> row.given(i=1, axis="y").label
        '(31) y'
        """

        def filled(text: str) -> str:
            return re.sub(r"\{(\w+)\}", lambda match: str(values.get(match[1], match[0])), text)

        filled_blocks = {place: filled(text) for place, text in self.blocks.items()}
        return replace(self, label=filled(label or self.label), blocks=filled_blocks)

    def defining(
        self,
        texts: Mapping[str, str] | None = None,
        /,
        *,
        unknowns: Mapping[str, Unknown] | None = None,
        label: str | None = None,
        **more: str,
    ) -> "Statement":
        """Return the statement with definitions added or replaced, in their place where they have one.

        Parameters
        ----------
        texts : mapping of str to str, optional
            Formulas by name; an unknown that is defined is none any more: a substitution.
        unknowns : mapping of str to Unknown, optional
            Those that the definitions bring in.
        label : str, optional
            Name of the new statement.
        **more : str
            Further formulas by name.
        """
        defined = {**(texts or {}), **more}

        def definitions(case: Any) -> dict[str, str]:
            return {**self.definitions(case), **defined}

        kept = {name: unknown for name, unknown in self.unknowns.items() if name not in defined}
        return replace(self, label=label or self.label, where=definitions, unknowns={**kept, **(unknowns or {})})

    def __lt__(self, other: int | str) -> Constraint:
        return self._against(other, "<")

    def __le__(self, other: int | str) -> Constraint:
        return self._against(other, "<=")

    def __gt__(self, other: int | str) -> Constraint:
        return self._against(other, ">")

    def __ge__(self, other: int | str) -> Constraint:
        return self._against(other, ">=")

    def is_zero(self) -> Constraint:
        """Return the equation ``statement == 0``, entry by entry."""
        return self._against(0, "==")

    def _against(self, other: int | str, relation: Relation) -> Constraint:
        if not isinstance(other, str) and (type(other) is not int or other != 0):
            raise InputError("constraint", field=self.label, value=other, expected="0 or a formula on the right side")
        right = one_line(other) if isinstance(other, str) else "0"
        parse(right)
        return Constraint(self.label, self.formula, relation, right, self)


def _differing(printed: Statement, other: Statement) -> Iterator[Cell]:
    rows = list(dict.fromkeys((*printed.rows, *other.rows)))
    for i, row in enumerate(rows):
        for column in rows[i:]:
            texts = [s.block(row, column) if {row, column} <= set(s.rows) else "" for s in (printed, other)]
            if texts[0] != texts[1]:
                yield Cell(row, column, *texts)


def over(text: str, **families: Iterable[object]) -> str:
    """Sum of a formula over the values of the names in it, as text.

    Raises
    ------
    InputError
        If there is nothing to sum: a text does not say of what shape the zero is.

    Examples
    --------
    >>> over("q{k}*A{k}", k=range(1, 4))
    'q1*A1 + q2*A2 + q3*A3'
    """
    terms = [text]
    for name, values in families.items():
        terms = [term.replace(f"{{{name}}}", str(value)) for value in values for term in terms]
        if not terms:
            raise InputError("sum", field=name, value=text, expected="a value to sum over")
    return " + ".join(terms)
