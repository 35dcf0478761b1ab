"""An upper bound on the norm of an uncertain system, for every admissible uncertainty, also time-varying.

Theorem: let x' = A x + H w + B d, z = Cz x + Dw w + Dd d, y = C x + Ew w + D d, w = Delta(t) z with Delta structured
as in `gainsay.proof.lft`. If P > 0 and the form dV/dt + y' y - gamma^2 d' d + [z; w]' M [z; w] in (x, w, d) is < 0,
V = x' P x, then the system is exponentially stable and its norm from d to y (L2 to L2; for constant Delta the
H-infinity norm) is less than gamma.

Fields: ``A``, ``B``, ``C``, ``D``, ``H``, ``Cz``, ``Dw``, ``Dd``, ``Ew``, ``blocks``, ``gamma``; ``D``, ``Dw``,
``Dd``, ``Ew`` may be left out. Witness: ``P``, ``D1``, ..., ``G1``, ...
Reference: Boyd et al., Linear Matrix Inequalities in System and Control Theory, SIAM 1994, section 6.3.
"""

from gainsay.exact.blocks import block
from gainsay.exact.matrix import Matrix, eye, zeros
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import demand, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.lft import read_lft
from gainsay.proof.scope import Scope

THEOREM = "the bounded real lemma with the S-procedure"
REQUIRED = ("A", "B", "C", "H", "Cz", "blocks", "gamma")
OPTIONAL = ("D", "Dw", "Dd", "Ew")
LEVELS = ("gamma",)
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove the bound on the norm."""
    scope.define()
    a, b, c = (scope.evaluate(scope.field(name)) for name in "ABC")
    gamma = scope.number(scope.field("gamma"))
    if gamma <= 0:
        raise scope.fail("field 'gamma' must be positive")
    n, inputs, outputs = a.shape[0], b.shape[1], c.shape[0]
    p = scope.symmetric_witness("P", n)
    demand(scope, p, ">", "P")
    lft = read_lft(scope, n)
    count = lft.h.shape[1]

    def given(name: str, rows: int, columns: int) -> Matrix:
        return scope.evaluate(scope.field(name)) if name in scope.certificate.fields else zeros(rows, columns)

    x = block([[eye(n), zeros(n, count), zeros(n, inputs)]])
    w = block([[zeros(count, n), eye(count), zeros(count, inputs)]])
    d = block([[zeros(inputs, n), zeros(inputs, count), eye(inputs)]])
    z = block([[lft.cz, lft.dw, given("Dd", lft.cz.shape[0], inputs)]])
    y = block([[c, given("Ew", outputs, count), given("D", outputs, inputs)]])
    rate = block([[a, lft.h, b]])
    form = sym(x.T @ p @ rate) + y.T @ y - (d.T @ d).scaled(Matrix.number(gamma**2)) + lft.form(z, w)
    demand(scope, form, "<", "the bounded real form with the multipliers")
    return [Proved("norm", "less_than", to_text(gamma)), Proved("stable", "holds")]
