"""A paper's derivations: one statement follows from others, proved for all matrices at once."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gainsay.errors import InputError
from gainsay.lmi import Variable
from gainsay.proof import Certificate, build
from gainsay.proof.formulas import names_in
from gainsay.statements.floats import Floats
from gainsay.statements.statement import Constraint, read_constraint
from gainsay.statements.unknowns import Unknown

__all__ = ["Step", "implication"]


@dataclass(frozen=True)
class Step:
    """One term of a conclusion: ``scale * factor' H factor``.

    Parameters
    ----------
    of : str
        Label of the hypothesis H; nothing for the identity, which makes the term a square.
    factor : str
        Formula of the congruence's matrix.
    scale : str
        Formula of a product of positive numbers.
    left_inverse : str
        Formula L; where the conclusion is strict, the sum of L @ factor over strict hypotheses is the identity.
    """

    of: str
    factor: str
    scale: str = "1"
    left_inverse: str = ""

    def entry(self) -> dict[str, str]:
        """Return the entry of the certificate's field ``by``."""
        given = {"of": self.of, "with": self.factor, "scale": self.scale, "left_inverse": self.left_inverse}
        return {key: text for key, text in given.items() if key in ("of", "with") or text not in ("", "1")}


def implication(
    case: Any,
    *,
    id: str,
    quantity: str = "",
    sentence: str,
    given: Iterable[Constraint | str],
    then: Constraint | str,
    by: Sequence[Step],
    invertible: Iterable[str] = (),
    positive: Iterable[str] = (),
    symmetric: Iterable[str] = (),
    expand: Mapping[str, str] | None = None,
    unknowns: Mapping[str, Unknown] | None = None,
    faith: Sequence[str] = (),
) -> Certificate:
    """Certificate that one inequality follows from others, whatever the entries of the matrices in it.

    Parameters
    ----------
    case : gainsay.tables.Case
    id, quantity, sentence, faith
        Of the certificate; the quantity, which may be left empty, is 1 where it follows.
    given : iterable of Constraint or str
        Hypotheses: constraints of statements, or texts.
    then : Constraint or str
        Conclusion.
    by : sequence of Step
        How: the conclusion is the sum of these terms.
    invertible, positive : iterable of str
        Unknowns and matrices of the plant that have an inverse; numbers above zero. Positive unknowns of the
        statements need no mention.
    symmetric : iterable of str
        Matrices of the plant that are symmetric; those of the case are held against it.
    expand : mapping of str to str, optional
        Definitions that the derivation uses, in order: substitutions, names for long blocks.
    unknowns : mapping of str to Unknown, optional
        Those of texts, and of what only the derivation names.

    Returns
    -------
    Certificate
        Of kind ``implication``. Definitions of the statements are unknown matrices of the same shape here: the
        derivation holds for every plant.

    Raises
    ------
    CertificateError
        If it does not follow by these terms.
    InputError
        If a matrix that is said to be symmetric is none, or a name has no shape.
    """
    hypotheses = [read_constraint(c) if isinstance(c, str) else c for c in given]
    goal = read_constraint(then) if isinstance(then, str) else then
    shapes: dict[str, Unknown] = dict(unknowns or {})
    definitions: dict[str, str] = {}
    for constraint in (*hypotheses, goal):
        if constraint.statement is not None:
            shapes |= constraint.statement.unknowns
            definitions |= constraint.statement.definitions(case)
    expanded = dict(expand or {})
    texts = [*(c.text for c in hypotheses), goal.text, *expanded.values()]
    texts += [text for step in by for text in (step.factor, step.scale, step.left_inverse) if text]
    names = set().union(*map(names_in, texts)) - set(expanded)
    opaque = _plant(case, definitions, shapes, names - set(shapes), set(symmetric))
    used = {name: unknown for name, unknown in {**shapes, **opaque}.items() if name in names}
    return build.certificate(
        "implication",
        id=id,
        statement=sentence,
        tables=case,
        definitions=expanded,
        unknowns={name: unknown.entry() for name, unknown in used.items()},
        fields={
            "given": [[c.label, c.text] for c in hypotheses],
            "then": goal.text,
            "by": [step.entry() for step in by],
            "invertible": sorted(set(invertible) & set(used)),
            "positive": sorted({*positive, *(n for n, u in used.items() if u.positive)} & set(used)),
        },
        quantities={"implication": quantity} if quantity else {},
        faith=faith,
    )


def _plant(
    case: Any, definitions: Mapping[str, str], unknowns: Mapping[str, Unknown], names: set[str], symmetric: set[str]
) -> dict[str, Unknown]:
    """Shapes of the definitions that a derivation treats as unknown matrices."""
    variables: dict[str, Variable] = {name: unknown.variable(name) for name, unknown in unknowns.items()}
    floats = Floats(case, definitions, variables)
    entries = {}
    for name in sorted(names):
        if name not in definitions:
            raise InputError(
                "name without a shape", field="derivation", value=name, expected="an unknown or a definition"
            )
        value = floats.value(name)
        rows, columns = value.shape
        if name in symmetric:
            skew = value - value.T if rows == columns else None
            if skew is None or abs(skew.constant).max() > 0 or any(abs(c).max() > 0 for c in skew.terms.values()):
                raise InputError("symmetric matrix", field="derivation", value=name, expected="its own transpose")
        entries[name] = Unknown(rows, columns, "symmetric" if name in symmetric else "full")
    return entries
