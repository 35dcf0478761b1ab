"""Every eigenvalue lies left of a vertical line.

Theorem (Lyapunov): if P > 0 and P A + A' P < 2 alpha P, then every eigenvalue of A has real part less than alpha; with
<= at most alpha. For a list of matrices and one P this holds for every matrix of their convex hull, and for alpha <= 0
every solution of x' = A(t) x with A(t) in the hull satisfies x' P x <= exp(2 alpha t) x(0)' P x(0).

Fields: ``matrix`` (a formula, over the uncertain numbers of ``ranges`` if there are any, or a list of vertices),
``alpha``. Witness: ``P``.
Reference: S. Boyd, L. El Ghaoui, E. Feron, V. Balakrishnan, Linear Matrix Inequalities in System and Control Theory,
SIAM 1994, sections 5.1 and 5.2.
"""

from gainsay.exact.matrix import Matrix
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import define, demand, order_holds, sym, vertices
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "Lyapunov's inequality with decay rate"
REQUIRED = ("matrix", "alpha")
OPTIONAL = ("ranges",)
LEVELS = ("alpha",)
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove the bound on the spectral abscissa."""
    ends = define(scope)
    matrices = vertices(scope, "matrix", ends)
    alpha = scope.number(scope.field("alpha"))
    p = scope.symmetric_witness("P", matrices[0].shape[0])
    demand(scope, p, ">", "P")
    strict = True
    for number, a in enumerate(matrices, 1):
        form = sym(p @ a) - p.scaled(Matrix.number(2 * alpha))
        what = f"P A + A' P - 2 alpha P (vertex {number})"
        if not order_holds(scope, form, "<", what):
            demand(scope, form, "<=", what)
            strict = False
    result = [Proved("abscissa", "less_than" if strict else "at_most", to_text(alpha))]
    if alpha < 0 or (alpha == 0 and strict):
        result.append(Proved("stable", "holds"))
    return result
