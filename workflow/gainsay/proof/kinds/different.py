"""Two formulas are not equal: neither identically, nor, with values for the indeterminates, at that point.

Theorem: formulas that differ at one point are not identical. The witness gives every unknown its value there; the
values are compared exactly, or in balls that do not overlap.
"""

from gainsay.exact.matrix import BALL
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "formulas that differ at one point are not identical"
REQUIRED = ("left", "right")
OPTIONAL = ()
LEVELS = ()
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove that the formulas differ at the witness."""
    scope.bind_witness()
    scope.define()
    left, right = scope.evaluate(scope.field("left")), scope.evaluate(scope.field("right"))
    if left.shape != right.shape:
        return [Proved("identity", "fails")]
    value = left - right
    entries = [x for row in value.rows() for x in row]
    differs = any(not x.contains(0) for x in entries) if value.ring == BALL else any(x != 0 for x in entries)
    if not differs:
        raise scope.fail("left and right are not proved to differ at the witness")
    return [Proved("identity", "fails")]
