"""A program stated once: its text for certificates, its matrices for the solver, under the same names."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from gainsay import lmi
from gainsay.errors import InputError
from gainsay.lmi import BlockMatrix, Definite, Equal, Program, Scale, Solved, equal, within
from gainsay.proof.formulas import check_name, names_in
from gainsay.statements.floats import Floats
from gainsay.statements.statement import Constraint, read_constraint
from gainsay.statements.unknowns import Unknown

__all__ = ["Stated"]


@dataclass(frozen=True)
class Stated:
    """Minimise a formula subject to constraints, for the tables of one case.

    Parameters
    ----------
    case : gainsay.tables.Case or any `gainsay.proof.scope.Tables`
    subject_to : iterable of Constraint or str
        Constraints of statements (``EQ14 < 0``), texts (``"X > 0"``), and iterables of them. A positive unknown is
        kept above zero by a constraint ``name > 0`` that is added where it is not given.
    minimise : str, optional
        Formula of the objective.
    unknowns, where
        Beside those of the statements; definitions given here come first.
    boxes : mapping of str to str
        Unknown to the printed matrix to whose digits it rounds.
    bounds : mapping of str to float
        Unknown to a bound on the modulus of its entries: a wish of the solver's program that no certificate states.
    label : str
        Name of the program in messages.
    scale, margin
        As for `gainsay.lmi.Program`.

    Raises
    ------
    InputError
        If two statements mean different things by one name, or two constraints have one label.
    CertificateError
        If a name belongs to the formula language.
    """

    case: Any
    subject_to: Iterable[Any]
    minimise: str | None = None
    unknowns: Mapping[str, Unknown] = field(default_factory=dict)
    where: Mapping[str, str] = field(default_factory=dict)
    boxes: Mapping[str, str] = field(default_factory=dict)
    bounds: Mapping[str, float] = field(default_factory=dict)
    label: str = "program"
    scale: Scale = field(default_factory=Scale)
    margin: float = 1e-6

    def __post_init__(self) -> None:
        listed = list(_flat(self.subject_to))
        unknowns: dict[str, Unknown] = dict(self.unknowns)
        definitions: dict[str, str] = dict(self.where)
        for constraint in listed:
            if constraint.statement is not None:
                _join(unknowns, constraint.statement.unknowns, constraint.label, "unknown")
                _join(definitions, constraint.statement.definitions(self.case), constraint.label, "definition")
        texts = [constraint.text for constraint in listed] + ([self.minimise] if self.minimise else [])
        definitions = _used(definitions, texts)
        used = set().union(*(names_in(text) for text in (*texts, *definitions.values())))
        unknowns = {name: unknown for name, unknown in unknowns.items() if name in used}
        labels = [constraint.label for constraint in listed]
        for name, unknown in unknowns.items():
            if unknown.positive and f"{name} > 0" not in labels:
                listed.append(read_constraint(f"{name} > 0"))
                labels.append(f"{name} > 0")
        twice = next((label for label in labels if labels.count(label) > 1), None)
        if twice is not None:
            raise InputError("two constraints of one label", field=self.label, value=twice, expected="different labels")
        for name in (*self.boxes, *self.bounds):
            if name not in unknowns:
                raise InputError(
                    "box or bound of no unknown", field=self.label, value=name, expected=", ".join(unknowns)
                )
        object.__setattr__(self, "subject_to", tuple(listed))
        object.__setattr__(self, "unknowns", unknowns)
        object.__setattr__(self, "where", definitions)

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """The constraints in order, those of positive unknowns last."""
        return tuple(self.subject_to)

    def changed(self, **parts: Any) -> "Stated":
        """Return the program with some parts replaced."""
        return replace(self, **parts)

    def floats(self, before: Floats | None = None) -> Floats:
        """Return the evaluator of the program's formulas over the unknowns of the LMI layer.

        Parameters
        ----------
        before : Floats, optional
            Of the program at other parameters: what means the same there is not evaluated again.
        """
        unknowns = {name: unknown.variable(name) for name, unknown in self.unknowns.items()}
        return Floats(self.case, self.where, unknowns, before)

    def program(self, floats: Floats | None = None) -> Program:
        """Return the program of the solver: constraints under the same labels, coefficients rounded once.

        Parameters
        ----------
        floats : Floats, optional
            The program's evaluator; a new one unless given.

        Raises
        ------
        InputError
            If a formula is not affine in the unknowns, or shapes do not fit.
        """
        floats = self.floats() if floats is None else floats
        constraints: list[Any] = [
            floats.constraint(held.label, held.text, partial(_constraint, held, floats)) for held in self.constraints
        ]
        for name, printed in self.boxes.items():
            rows = self.case.printed(printed).rows
            low, high = (np.array([[float(getattr(x, end)) for x in row] for row in rows]) for end in ("low", "high"))
            constraints.append(within(floats.unknowns[name], low, high, f"digits of {name}"))
        for name, bound in self.bounds.items():
            limit = np.full(floats.unknowns[name].shape, bound)
            constraints.append(within(floats.unknowns[name], -limit, limit, f"bound on {name}"))
        objective = None if self.minimise is None else floats.value(self.minimise)
        return Program(objective, constraints, self.scale, self.label, self.margin)

    def solve(self, near: Mapping[str, Any] | None = None) -> lmi.outcomes.Outcome:
        """Look for a point: see `gainsay.lmi.solve`."""
        return lmi.solve(self.program(), near=near)

    def infimum(self, margins: tuple[float, ...] | None = None) -> Any:
        """Enclose the infimum: see `gainsay.lmi.infimum`."""
        return lmi.infimum(self.program(), margins)

    def by_margin(self) -> lmi.outcomes.Outcome:
        """Look for a point, or for multipliers, with room to be rounded: see `gainsay.lmi.by_margin`."""
        return lmi.by_margin(self.program())

    def point(self, values: Mapping[str, Any]) -> Solved:
        """Return values found by other means as a point, recomputed; that it holds is for the certificate to say."""
        program = self.program()
        check = program.check(values)
        return Solved(dict(values), check.objective, check, np.nan, ())

    def fields(self) -> dict[str, Any]:
        """Return the fields of a certificate of kind ``feasible``, ``farkas`` or ``dual_bound``."""
        fields: dict[str, Any] = {"constraints": [[c.label, c.text] for c in self.constraints]}
        if self.minimise is not None:
            fields["minimise"] = self.minimise
        if self.boxes:
            fields["boxes"] = dict(self.boxes)
        return fields

    def parts(self) -> dict[str, Any]:
        """Return tables, definitions, unknowns and fields for the builders of `gainsay.proof.build`."""
        return {
            "tables": self.case,
            "definitions": dict(self.where),
            "unknowns": {name: unknown.entry() for name, unknown in self.unknowns.items()},
            "fields": self.fields(),
        }


def _flat(constraints: Iterable[Any]) -> Iterable[Constraint]:
    for constraint in constraints:
        if isinstance(constraint, Constraint):
            yield constraint
        elif isinstance(constraint, str):
            yield read_constraint(constraint)
        else:
            yield from _flat(constraint)


def _join(known: dict[str, Any], more: Mapping[str, Any], label: str, what: str) -> None:
    for name, value in more.items():
        check_name(name)
        if known.setdefault(name, value) != value:
            raise InputError(f"{what} of another meaning", field=f"{label}, {name}", value=value, expected=known[name])


def _used(definitions: Mapping[str, str], texts: Iterable[str]) -> dict[str, str]:
    """Definitions that the texts use, directly or through others, in their order."""
    wanted = set().union(*map(names_in, texts)) if texts else set()
    for name in reversed(list(definitions)):
        if name in wanted:
            wanted |= names_in(definitions[name])
    return {name: text for name, text in definitions.items() if name in wanted}


def _constraint(constraint: Constraint, floats: Floats) -> Definite | Equal:
    if constraint.relation == "==":
        left, right = floats.value(constraint.left), floats.value(constraint.right)
        return equal(left, right, constraint.label)
    left, right = _side(constraint, floats), floats.value(constraint.right)
    strict = constraint.relation in ("<", ">")
    larger, smaller = (left, right) if ">" in constraint.relation else (right, left)
    return Definite.difference(larger, smaller, strict).named(constraint.label)


def _side(constraint: Constraint, floats: Floats) -> Any:
    """Left side: of a statement as named block rows, so that messages and scalings speak of them."""
    statement = constraint.statement
    if statement is None or len(statement.rows) == 1:
        return floats.value(constraint.left)
    whole = BlockMatrix(constraint.label, *statement.rows)
    for i, row in enumerate(statement.rows):
        for column in statement.rows[i:]:
            text = statement.block(row, column)
            if text:
                whole[row, column] = floats.value(text)
    return whole
