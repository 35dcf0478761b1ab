"""Programs of many coefficients, where each run of a solver counts: what its first runs give is proved at once."""

import numpy as np

from gainsay.lmi import backends, duality, scaling
from gainsay.lmi.outcomes import Infeasible, Infimum, Outcome, Solved
from gainsay.lmi.points import proved_point
from gainsay.lmi.program import Program

# coefficients from which a program is large
_LARGE = 200_000
# parts of the way from the optimum to a point inside, tried in turn for a point near the optimum
_WAY = (1e-5, 1e-4, 1e-3, 1e-2)
# least relative eigenvalues kept of a solver's multipliers
_CUTS = (0.0, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3)
# width of an enclosure, relative to the size of the objective, that is narrow enough
_NARROW = 1e-6


def is_large(program: Program) -> bool:
    """Whether a run of the solver takes longer than any proof."""
    return sum(row.tensor.size for row in program.rows) >= _LARGE


def answer(program: Program, scale: scaling.Scaling, attempts: list) -> Outcome | None:
    """A point or a refutation from one run, proved; None where it gives neither."""
    raw = backends.run(scaling.apply(program, scale), program.constraints, program.margin)
    attempts.append({**raw.record, "aim": "large"})
    if "PrimalInfeasible" in raw.record["status"] and raw.multipliers:
        proof = duality.refuted_by(program, scale, raw.multipliers, _CUTS)
        return None if proof is None else Infeasible(proof, tuple(attempts))
    if raw.x is None or "Infeasible" in raw.record["status"]:
        return None
    gap = abs(raw.primal - raw.dual) / max(abs(raw.primal), 1e-12)
    point = proved_point(program, scale, raw.x * scale.unknowns, gap)
    return None if point is None else Solved(point.values, point.objective, point.check, gap, tuple(attempts))


def enclosed(
    program: Program, scale: scaling.Scaling, inside: Solved, flat: backends.Raw, attempts: list
) -> Infimum | None:
    """Narrow enclosure from a point inside and the solver's optimum `flat`; None where it is not narrow."""
    lower, multipliers = duality.lower_bound(program, scale, flat.multipliers, _CUTS)
    if not np.isfinite(lower) or flat.x is None:
        return None
    optimum, start = flat.x * scale.unknowns, program.coordinates(inside.values)
    for part in _WAY:
        point = proved_point(program, scale, optimum + part * (start - optimum), inside.gap)
        if point is None:
            continue
        width = point.objective - lower
        if not width < _NARROW * max(abs(point.objective), scale.cost):
            return None
        best = Solved(point.values, point.objective, point.check, point.gap, tuple(attempts))
        middle = (lower + point.objective) / 2
        return Infimum(middle, lower, point.objective, program.values(optimum), best, multipliers, tuple(attempts))
    return None
