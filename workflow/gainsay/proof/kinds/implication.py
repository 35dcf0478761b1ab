"""One inequality follows from others: a congruence, a Schur complement, a completed square, a substitution.

Theorem: let H_i >= 0 (or H_i > 0) and let G be the sum of s_i T_i' H_i T_i with numbers s_i > 0. Then G >= 0; and
G > 0 if over the strict ones some L_i have sum L_i T_i = I: no T_i v is zero for all of them then. F < 0 counts as
-F > 0. A term without a hypothesis is the square T' T. The identity is one between sums of words in unknown matrices
(`gainsay.exact.words`): it holds for all entries and all sizes, wherever the inverses that it names exist.

- congruence: one term, T invertible; a Schur complement is the congruence with [[I, 0], [-C^-1 B', I]];
- completed square: G = H + sum of s_i (X_i - ...)' D_i (X_i - ...), D_i > 0;
- substitution: the definitions say what the new unknowns are in the old ones.

Fields: ``given`` (pairs of a name and a constraint), ``then`` (a constraint), ``by`` (list of {"of": name of a
hypothesis or "", "with": T, "scale": s, "left_inverse": L}; ``scale`` is a product of positive numbers, and
``left_inverse`` is needed where the conclusion is strict), ``invertible`` and ``positive`` (names of unknowns).

Reference: S. Boyd, L. El Ghaoui, E. Feron, V. Balakrishnan, "Linear Matrix Inequalities in System and Control Theory",
SIAM 1994, section 2.1.
"""

from collections.abc import Mapping
from typing import Any

from gainsay.errors import CertificateError
from gainsay.exact.words import Letter, Words, identity, nothing
from gainsay.proof import derivation, formulas
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope
from gainsay.proof.syntax import compared, segment

THEOREM = "a sum of congruences of positive matrices is positive"
REQUIRED = ("given", "then", "by")
OPTIONAL = ("invertible", "positive")
LEVELS = ()
FOUND = ()

_SYMMETRY = {"symmetric": 1, "diagonal": 1, "skew": -1, "full": 0}


def prove(scope: Scope) -> list[Proved]:
    """Prove that the conclusion follows from the hypotheses."""
    letters = unknowns(scope)
    names = definitions(scope, letters)
    given = {name: inequality(scope, text, names, letters) for name, text in hypotheses(scope)}
    goal, strict = inequality(scope, scope.field("then"), names, letters)
    total = whole = nothing(*goal.shape, letters)
    for term in terms(scope):
        form, is_strict = hypothesis(scope, given, term, names, letters)
        factor = derivation.evaluate(term["with"], names, letters)
        total = total + positive_number(scope, term, names, letters) * (factor.T @ form @ factor)
        if is_strict and "left_inverse" in term:
            whole = whole + derivation.evaluate(term["left_inverse"], names, letters) @ factor
    if not total.equals(goal):
        raise scope.fail("the conclusion is not proved to be the sum of the terms")
    if strict and not whole.equals(identity(goal.shape[0], letters)):
        raise scope.fail("a strict conclusion needs strict hypotheses whose factors have left inverses that sum to one")
    return [Proved("implication", "holds")]


def unknowns(scope: Scope) -> dict[str, Letter]:
    """Letters of the unknowns."""
    invertible = {*listed(scope, "invertible"), *listed(scope, "positive")}
    shapes = scope.unknown_shapes()
    for name in invertible:
        if name not in shapes or shapes[name][0][0] != shapes[name][0][1]:
            raise scope.fail(f"{name!r} is declared invertible or positive, but is not a square unknown")
    for name in listed(scope, "positive"):
        if shapes[name][0] != (1, 1):
            raise scope.fail(f"{name!r} is declared a positive number, but is a matrix")
    return {
        name: Letter(name, *shape, 1 if shape == (1, 1) else _SYMMETRY[structure], name in invertible)
        for name, (shape, structure) in shapes.items()
    }


def listed(scope: Scope, field: str) -> list[str]:
    """Names in a field."""
    names = scope.certificate.fields.get(field, [])
    if not isinstance(names, list | tuple) or any(not isinstance(name, str) for name in names):
        raise scope.fail(f"field {field!r}: expected a list of names")
    return list(names)


def definitions(scope: Scope, letters: Mapping[str, Letter]) -> dict[str, Words]:
    """Expressions of the definitions, in order."""
    names: dict[str, Words] = {}
    for name, text in scope.certificate.definitions:
        formulas.check_name(name)
        if name in names or name in letters:
            raise scope.fail(f"the name {name!r} is defined twice")
        names[name] = derivation.evaluate(text, names, letters)
    return names


def hypotheses(scope: Scope) -> list[tuple[str, str]]:
    """Pairs of a name and a constraint."""
    raw = scope.field("given")
    if not isinstance(raw, list) or any(
        not isinstance(pair, list | tuple) or len(pair) != 2 or not all(isinstance(x, str) for x in pair)
        for pair in raw
    ):
        raise scope.fail("field 'given': expected pairs of a name and a constraint")
    if len({name for name, _ in raw}) != len(raw) or any(not name for name, _ in raw):
        raise scope.fail("field 'given': expected different names")
    return [(name, text) for name, text in raw]


def terms(scope: Scope) -> list[dict[str, str]]:
    """The terms of the sum."""
    raw: Any = scope.field("by")
    known = {"of", "with", "scale", "left_inverse"}
    if (
        not isinstance(raw, list)
        or not raw
        or any(
            not isinstance(term, Mapping)
            or not {"of", "with"} <= set(term) <= known
            or any(not isinstance(x, str) for x in term.values())
            for term in raw
        )
    ):
        raise scope.fail("field 'by': expected terms with 'of', 'with' and, where needed, 'scale', 'left_inverse'")
    return [dict(term) for term in raw]


def inequality(
    scope: Scope, text: str, names: Mapping[str, Words], letters: Mapping[str, Letter]
) -> tuple[Words, bool]:
    """The matrix that an inequality says is positive, and whether strictly."""
    sides = compared(text)
    if sides is None or sides[1] == "==":
        raise scope.fail(f"constraint {text[:60]!r}: expected one of < <= >= > between two formulas")
    relation = sides[1]
    left, right = (derivation.evaluate(segment(text, side), names, letters) for side in (sides[0], sides[2]))
    if right.is_number and right.is_zero:
        difference = left
    elif left.is_number and left.is_zero:
        difference = -right
    else:
        difference = left - right
    if not difference.equals(difference.T):
        raise CertificateError(f"constraint {text[:60]!r}: not symmetric")
    return (difference if ">" in relation else -difference), "=" not in relation


def hypothesis(
    scope: Scope,
    given: Mapping[str, tuple[Words, bool]],
    term: Mapping[str, str],
    names: Mapping[str, Words],
    letters: Mapping[str, Letter],
) -> tuple[Words, bool]:
    """The positive matrix of a term: a hypothesis, or the identity."""
    if term["of"]:
        if term["of"] not in given:
            raise scope.fail(f"a term of {term['of'][:60]!r}, which is not a hypothesis")
        return given[term["of"]]
    return identity(derivation.evaluate(term["with"], names, letters).shape[0], letters), True


def positive_number(
    scope: Scope, term: Mapping[str, str], names: Mapping[str, Words], letters: Mapping[str, Letter]
) -> Words:
    """Factor of a term: a positive rational times powers of positive unknowns."""
    factor = derivation.evaluate(term.get("scale", "1"), names, letters)
    product = factor.monomial()
    if product is None:
        raise scope.fail(f"scale {term.get('scale')!r}: expected a product of positive numbers")
    powers, coefficient = product
    positive = listed(scope, "positive")
    if coefficient <= 0 or any(name not in positive and power % 2 for name, power in powers):
        raise scope.fail(f"scale {term.get('scale')!r} is not proved positive")
    for name, _ in powers:
        if name not in positive and not letters[name].invertible:
            raise scope.fail(f"scale {term.get('scale')!r} may be zero")
    return factor
