"""Every eigenvalue of an uncertain matrix lies in a disk, for every constant admissible uncertainty.

Theorem: let A(Delta) = A + H Delta (I - Dw Delta)^-1 Cz with Delta constant and structured as in `gainsay.proof.lft`.
If P > 0 and [A + a I, H]' P [A + a I, H] - b^2 diag(P, 0) + [z; w]' M [z; w] < 0 as a form in (x, w),
z = Cz x + Dw w, then every eigenvalue s of every A(Delta) satisfies |s + a| < b: on w = Delta z it is Stein's
inequality.

Fields: ``A``, ``H``, ``Cz``, ``Dw``, ``blocks``, ``shift`` (a), ``radius`` (b). Witness: ``P``, ``D1``, ...,
``G1``, ...
Reference: M. Chilali, P. Gahinet, P. Apkarian, "Robust pole placement in LMI regions", IEEE Transactions on Automatic
Control 44 (1999) 2257-2270.
"""

from gainsay.exact.blocks import block
from gainsay.exact.matrix import Matrix, eye, zeros
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import demand
from gainsay.proof.kinds import Proved
from gainsay.proof.lft import read_lft
from gainsay.proof.scope import Scope

THEOREM = "Stein's inequality with the S-procedure"
REQUIRED = ("A", "H", "Cz", "blocks", "shift", "radius")
OPTIONAL = ("Dw",)
LEVELS = ("radius",)
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove the disk."""
    scope.define()
    a = scope.evaluate(scope.field("A"))
    n = a.shape[0]
    shift, radius = scope.number(scope.field("shift")), scope.number(scope.field("radius"))
    if radius <= 0:
        raise scope.fail("field 'radius' must be positive")
    p = scope.symmetric_witness("P", n)
    demand(scope, p, ">", "P")
    lft = read_lft(scope, n)
    count = lft.h.shape[1]
    moved = block([[a + eye(n).scaled(Matrix.number(shift)), lft.h]])
    x, w = block([[eye(n), zeros(n, count)]]), block([[zeros(count, n), eye(count)]])
    z = block([[lft.cz, lft.dw]])
    form = moved.T @ p @ moved - (x.T @ p @ x).scaled(Matrix.number(radius**2)) + lft.form(z, w)
    demand(scope, form, "<", "Stein's form with the multipliers")
    result = [Proved("radius", "less_than", to_text(radius))]
    return [*result, Proved("stable", "holds")] if radius <= shift else result
