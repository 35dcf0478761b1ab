"""No P > 0 satisfies a Lyapunov or Stein inequality, since a matrix of the wrong inertia does.

Theorem: let L(X) = X A + A' X + B' X B (B may be left out; A = -I/2 makes it Stein's B' X B - X). Let the constraints
say T' F T = -L(P) - Q and U' G U = P - R with constant Q, R >= 0 for F >= 0 and G >= 0 among them, so that L(P) <= 0
and P >= 0, one of them strictly. If L(S) < 0 and z' S z <= 0 for some z != 0, then no P satisfies the constraints.
(P is then positive definite: were P x = 0, x' L(P) x = x' B' P B x >= 0, against L(P) < 0. Of the matrices S + t P,
t >= 0, the first that is not indefinite is singular and >= 0; with x in its kernel x' L(S + t P) x >= 0, against
L(S) + t L(P) < 0.)

This proves what Farkas' lemma does where its multipliers lie on an irrational invariant subspace of A and have no exact
neighbours. It holds for every A and B with a matrix S of that kind: those with an eigenvalue outside the region.

Fields: ``constraints``; ``unknown``, the name of P; ``inequality`` and ``positive``, the labels of F and G. Witness:
``drift`` (A), ``jump`` (B, may be left out), ``inertia`` (S), ``direction`` (z), ``inequality`` (T), ``positive`` (U).
Reference: A. Ostrowski, H. Schneider, "Some theorems on the inertia of general matrices", Journal of Mathematical
Analysis and Applications 4 (1962) 72-84.
"""

from typing import Any

from flint import fmpq

from gainsay.exact.definite import positive_definite, positive_semidefinite, quadratic_form
from gainsay.exact.matrix import BALL, Matrix
from gainsay.proof.duality import constraints
from gainsay.proof.inequalities import demand, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "the inertia theorem of Ostrowski and Schneider, for Lyapunov's and Stein's inequality"
REQUIRED = ("constraints", "unknown", "inequality", "positive")
OPTIONAL = ()
LEVELS = ()
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove that no point satisfies the constraints."""
    scope.bind_indeterminates()
    scope.define()
    name = scope.field("unknown")
    (size, _), structure = scope.unknown_shapes().get(name, ((0, 0), ""))
    if structure != "symmetric":
        raise scope.fail(f"field 'unknown': expected a symmetric unknown, found {name!r}")
    p, a = scope.names[name], scope.witness("drift", (size, size))
    b = scope.witness("jump", (size, size)) if "jump" in scope.certificate.witness else None

    def operator(x: Matrix) -> Matrix:
        return sym(x @ a) if b is None else sym(x @ a) + b.T @ x @ b

    strict = [_says(scope, "inequality", -operator(p)), _says(scope, "positive", p)]
    if not any(strict):
        raise scope.fail("one of the two constraints must be strict")
    s = scope.symmetric_witness("inertia", size)
    demand(scope, operator(s), "<", "L(S)")
    z = [row[0] for row in scope.witness("direction", (size, 1)).rows()]
    if all(x == 0 for x in z) or quadratic_form(s.data, z) > 0:
        raise scope.fail("witness 'direction': expected z != 0 with z' S z <= 0")
    return [Proved("feasible", "fails")]


def _says(scope: Scope, field: str, wanted: Matrix) -> bool:
    """Whether a constraint says that `wanted` is positive definite; refused unless it says that it is >= 0."""
    label = scope.field(field)
    text = dict(constraints(scope)).get(label)
    if text is None:
        raise scope.fail(f"field {field!r}: no constraint is called {label!r}")
    form, relation = scope.constraint(text)
    if relation == "==" or form.ring == BALL:
        raise scope.fail(f"constraint {label!r}: expected an inequality of rational data")
    if not form.equals(form.T):
        raise scope.fail(f"constraint {label!r} is not symmetric")
    factor = scope.witness(field, (form.shape[0], wanted.shape[0]))
    rest = wanted - factor.T @ (-form if relation in ("<", "<=") else form) @ factor
    constant = [[_constant(scope, x, f"constraint {label!r}") for x in row] for row in rest.rows()]
    slack = Matrix.of(constant).data
    if not positive_semidefinite(slack):
        raise scope.fail(f"constraint {label!r} does not say that its part is definite")
    injective = positive_definite((factor.T @ factor).data)
    return (relation in ("<", ">") and injective) or positive_definite(slack)


def _constant(scope: Scope, entry: Any, what: str) -> fmpq:
    if isinstance(entry, fmpq):
        return entry
    terms = entry.to_dict()
    if any(any(exponents) for exponents in terms):
        raise scope.fail(f"{what} is not that inequality in the unknown alone")
    return sum(terms.values(), fmpq(0))
