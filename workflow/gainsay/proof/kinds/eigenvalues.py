"""All eigenvalues, enclosed, and a measure of them bounded from both sides.

Theorem: a fixed-point argument encloses each eigenvalue in a ball of its own (all must be simple). From the balls:

- ``abscissa``: largest real part;
- ``radius``: largest |s + a| (field ``shift``);
- ``nearest``: distance of the nearest eigenvalue from a point (field ``points``, one [re, im]);
- ``matching``: largest distance between an eigenvalue and its partner among as many points (field ``points``, list of
  [re, im]), for the matching that makes it smallest.

Fields: ``matrix``, ``measure``, and those above. No witness; the checker finds the enclosures itself.
Reference: S. M. Rump, "Verification methods: rigorous results using floating-point arithmetic", Acta Numerica 19
(2010) 287-449; as done by acb_mat_eig_simple of FLINT.
"""

from bisect import bisect_left
from fractions import Fraction

from flint import acb, arb

from gainsay.exact.ball import decimal_above, decimal_below, eigenvalues, lower, upper
from gainsay.exact.rational import to_fmpq, to_text
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "enclosures of all eigenvalues, each simple"
REQUIRED = ("matrix", "measure")
OPTIONAL = ("shift", "points")
LEVELS = ()
FOUND = ()


def _points(scope: Scope) -> list[acb]:
    raw = scope.field("points")
    if not isinstance(raw, list) or any(not isinstance(p, list) or len(p) != 2 for p in raw) or not raw:
        raise scope.fail("field 'points': expected pairs [re, im]")
    return [acb(arb(to_fmpq(scope.number(re))), arb(to_fmpq(scope.number(im)))) for re, im in raw]


def matched(costs: list[list[Fraction]]) -> Fraction:
    """Least bound under which a perfect matching exists: the smallest possible largest cost of a pair."""
    bounds = sorted({x for row in costs for x in row})
    return bounds[bisect_left(bounds, True, key=lambda bound: _matches(costs, bound))]


def _matches(costs: list[list[Fraction]], bound: Fraction) -> bool:
    """Whether every row finds a column of its own at a cost within the bound."""
    partner: dict[int, int] = {}

    def place(i: int, seen: set[int]) -> bool:
        for j, cost in enumerate(costs[i]):
            if cost <= bound and j not in seen:
                seen.add(j)
                if j not in partner or place(partner[j], seen):
                    partner[j] = i
                    return True
        return False

    return all(place(i, set()) for i in range(len(costs)))


def prove(scope: Scope) -> list[Proved]:
    """Enclose the eigenvalues and bound the measure."""
    scope.define()
    a = scope.evaluate(scope.field("matrix"))
    if a.shape[0] != a.shape[1]:
        raise scope.fail(f"matrix of shape {a.shape}: eigenvalues need a square one")
    roots = eigenvalues(a.to_ball().data)
    measure = scope.field("measure")
    for name, measures in (("shift", ("radius",)), ("points", ("nearest", "matching"))):
        if name in scope.certificate.fields and measure not in measures:
            raise scope.fail(f"field {name!r} has no meaning for the measure {measure!r}")
    if measure == "abscissa":
        low, high = max(lower(s.real) for s in roots), max(upper(s.real) for s in roots)
    elif measure == "radius":
        shift = arb(to_fmpq(scope.number(scope.field("shift"))))
        moduli = [abs(s + shift) for s in roots]
        low, high = max(lower(m) for m in moduli), max(upper(m) for m in moduli)
    elif measure in ("nearest", "matching"):
        points = _points(scope)
        costs = [[abs(s - p) for p in points] for s in roots]
        if measure == "nearest":
            if len(points) != 1:
                raise scope.fail("field 'points': expected one point")
            low, high = min(lower(c[0]) for c in costs), min(upper(c[0]) for c in costs)
        else:
            if len(points) != len(roots):
                raise scope.fail(f"field 'points': {len(points)} points for {len(roots)} eigenvalues")
            low, high = (matched([[end(c) for c in row] for row in costs]) for end in (lower, upper))
    else:
        raise scope.fail(f"measure {measure!r}: expected abscissa, radius, nearest or matching")
    return [Proved(measure, "inside", f"{to_text(decimal_below(low))}..{to_text(decimal_above(high))}")]
