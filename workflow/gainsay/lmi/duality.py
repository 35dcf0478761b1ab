"""Lower bounds on an optimum, and refutations: from a solver's multipliers to exact ones that are proved to exist."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gainsay.lmi import backends, scaling
from gainsay.lmi.affine import Definite, Entrywise, Equal, scalar
from gainsay.lmi.centring import central_path, is_small
from gainsay.lmi.multipliers import Multipliers, System
from gainsay.lmi.outcomes import Farkas
from gainsay.lmi.program import Program
from gainsay.lmi.rounding import gamma

# least relative eigenvalues kept of a multiplier, tried in turn
_CUTS = (1e-3, 1e-5, 1e-7, 1e-2, 1e-9)
# parts of the largest possible least eigenvalue that interior multipliers of a large program are asked for
_PUSHES = (0.1, 1e-3)
# gap, relative to the level of phase one, at which multipliers of the central path refute; and the least gap
_GAP, _LEAST_GAP = 1e-3, 1e-10
_REASON = "multipliers proved to exist"


def unscaled(constraints: Sequence, scale: scaling.Scaling, multipliers: Sequence) -> dict[str, np.ndarray]:
    """Multipliers by label, in the coordinates of the program."""
    return {
        constraint.label: multiplier * (np.outer(d, d) if isinstance(constraint, Definite) else d**2)
        for constraint, d, multiplier in zip(constraints, scale.rows, multipliers, strict=True)
    }


def lower_bound(
    program: Program, scale: scaling.Scaling, multipliers: Sequence[np.ndarray], cuts: Sequence[float] = (0.0,)
) -> tuple[float, dict[str, np.ndarray]]:
    """Lower bound on the infimum from multipliers proved to exist near the given ones; -inf where they are not.

    Parameters
    ----------
    program : Program
    scale : Scaling
        Scaling to which the multipliers belong.
    multipliers : sequence of ndarray
        Near solutions of ``cost = sum <coefficients, Z_j>``.
    cuts : sequence of float, optional
        Least relative eigenvalues kept, tried in turn; 0 keeps all, for multipliers that are interior.

    Returns
    -------
    bound : float
    multipliers : dict
        Label of each constraint to its corrected multiplier, in unscaled coordinates.
    """
    coordinates = scaling.exact(program, scale)
    if coordinates is None:
        return -np.inf, {}
    exact, scaled = coordinates
    system = System(scaled, program.constraints, scaled.cost)
    if not system.solvable():
        return -np.inf, {}
    z = [(m + m.T) / 2 if m.ndim == 2 else m for m in scale.multipliers_in(exact, multipliers)]
    bounded = None
    for cut in cuts:
        bounded = system.confined(z, cut) or (system.factored(z, cut) if cut else _restored(system, z))
        if bounded is not None:
            break
    if bounded is None:
        return -np.inf, {}
    bound = float(program.objective.constant[0, 0]) - exact.cost * bounded.high
    bound -= gamma(2) * (abs(float(program.objective.constant[0, 0])) + abs(exact.cost * bounded.high))
    parts = unscaled(program.constraints, exact, bounded.z)
    return bound, {name: exact.cost * value for name, value in parts.items()}


def pushed_inside(program: Program, scale: scaling.Scaling, push: float, setting: str = "clarabel") -> tuple:
    """Multipliers with eigenvalues of at least `push`: the traces of all scaled blocks taken off the objective.

    Returns
    -------
    tuple of (multipliers, Raw)
        The multipliers (None where the solver gave none), and what the solver returned.
    """
    scaled = scaling.apply(program, scale)
    multipliers, raw = _pushed(scaled, program.constraints, push, setting)
    return multipliers, raw


def _pushed(scaled: scaling.Scaled, constraints: Sequence, push: float, setting: str = "clarabel") -> tuple:
    extra = np.zeros(len(scaled.cost))
    shifts: list[np.ndarray] = []
    for constraint, tensor, constant in zip(constraints, scaled.tensors, scaled.constants, strict=True):
        if isinstance(constraint, Definite):
            extra += np.einsum("iik->k", tensor)
            shifts.append(np.eye(len(constant)))
        elif isinstance(constraint, Equal):
            shifts.append(np.zeros(len(constant)))
        else:
            extra += tensor.sum(axis=0)
            shifts.append(np.ones(len(constant)))
    # the equations c = sum <T, Z + push I> are those of the cost without push times the traces
    interior = scaling.Scaled(scaled.cost - push * extra, scaled.constants, scaled.tensors)
    raw = backends.run(interior, constraints, 0.0, setting)
    if not raw.multipliers:
        return None, raw
    return tuple(z + push * s for z, s in zip(raw.multipliers, shifts, strict=True)), raw


@dataclass(frozen=True)
class Level:
    """Phase one: all scaled blocks pushed up together, ``max t, F_j(x) >= t I, t <= 1``.

    Attributes
    ----------
    value : float
        The largest t as the solver says it (nan where it gave none); positive: there is a strict point.
    x : ndarray or None
        The point, scaled coordinates.
    multipliers : tuple of ndarray
        Candidates of a refutation, one a constraint, total trace about one.
    phase : Scaled
        The program of phase one.
    record : dict
        Of the attempt.
    """

    value: float
    x: np.ndarray | None
    multipliers: tuple[np.ndarray, ...]
    phase: scaling.Scaled
    record: dict


def level(scaled: scaling.Scaled, constraints: Sequence, setting: str = "clarabel") -> Level:
    """Solve phase one of a scaled program."""
    size = len(scaled.cost)
    tensors = []
    for constraint, tensor, constant in zip(constraints, scaled.tensors, scaled.constants, strict=True):
        rise = np.zeros((*tensor.shape[:-1], 1))
        if isinstance(constraint, Definite):
            rise[..., 0] = -np.eye(len(constant))
        elif not isinstance(constraint, Equal):
            rise[..., 0] = -1
        tensors.append(np.concatenate([tensor, rise], axis=-1))
    cap = np.zeros((1, size + 1))
    cap[0, size] = -1
    cost = np.zeros(size + 1)
    cost[size] = -1
    phase = scaling.Scaled(cost, (*scaled.constants, np.ones(1)), (*tensors, cap))
    raw = backends.run(phase, (*constraints, _CAP), 0.0, setting)
    if raw.x is None or not raw.multipliers or not all(np.isfinite(m).all() for m in raw.multipliers):
        return Level(float("nan"), None, (), phase, raw.record)
    return Level(float(raw.x[size]), raw.x[:size], raw.multipliers[:-1], phase, raw.record)


_CAP = Entrywise("level <= 1", scalar("level"))


def refutation(program: Program, scale: scaling.Scaling, level: Level, attempts: list) -> Farkas | None:
    """Multipliers that refute a program, proved to exist near those of phase one or, pushed inside, near its."""
    coordinates = scaling.exact(program, scale)
    if coordinates is None:
        return None
    exact, scaled = coordinates
    system = System(scaled, program.constraints, np.zeros(program.size))
    if not system.solvable() or not level.multipliers:
        return None
    proved = _refuting(system, scale.multipliers_in(exact, level.multipliers), _CUTS)
    for multipliers in () if proved is not None else _interior(program, level, attempts):
        proved = _refuting(system, scale.multipliers_in(exact, multipliers), (0.0, 1e-6))
        if proved is not None:
            break
    if proved is None:
        return None
    return Farkas(unscaled(program.constraints, exact, proved.z), proved.high, proved.distance, _REASON)


def _interior(program: Program, level: Level, attempts: list) -> Iterator[Sequence[np.ndarray]]:
    """Multipliers of phase one with room inside their cones, the likeliest to refute first."""
    constraints, rows = (*program.constraints, _CAP), sum(row.size for row in program.rows)
    if is_small(level.phase):
        path = list(central_path(level.phase, constraints, _below(level), _GAP * max(-level.value, _LEAST_GAP) / rows))
        attempts.append({"solver": "central path", "status": f"{len(path)} points", "aim": "interior multipliers"})
        for _, _, multipliers in reversed(path):
            yield multipliers[:-1]
        return
    for push in _PUSHES:
        interior, raw = _pushed(level.phase, constraints, push / rows)
        attempts.append({**raw.record, "aim": "interior multipliers", "asked": push / rows})
        if interior is not None and all(np.isfinite(m).all() for m in interior):
            yield interior[:-1]


def _below(level: Level) -> np.ndarray:
    """A point strictly inside phase one: that of the level, its common margin lowered."""
    assert level.x is not None, "a level with multipliers has a point"
    lowest = 0.0
    for tensor, constant in zip(level.phase.tensors[:-1], level.phase.constants[:-1], strict=True):
        value = constant + tensor[..., :-1] @ level.x
        if tensor[..., -1].any():
            lowest = min(lowest, float(np.linalg.eigvalsh(value)[0] if value.ndim == 2 else value.min()))
    return np.append(level.x, lowest - max(1.0, abs(lowest)))


def refuted_by(
    program: Program, scale: scaling.Scaling, multipliers: Sequence[np.ndarray], cuts: Sequence[float]
) -> Farkas | None:
    """Refutation by multipliers proved to exist near given ones of a scaling."""
    coordinates = scaling.exact(program, scale)
    if coordinates is None or not all(np.isfinite(m).all() for m in multipliers):
        return None
    exact, scaled = coordinates
    system = System(scaled, program.constraints, np.zeros(program.size))
    if not system.solvable():
        return None
    proved = _refuting(system, scale.multipliers_in(exact, multipliers), cuts)
    if proved is None:
        return None
    return Farkas(unscaled(program.constraints, exact, proved.z), proved.high, proved.distance, _REASON)


def _refuting(system: System, multipliers: Sequence[np.ndarray], cuts: Sequence[float]) -> Multipliers | None:
    total = sum(float(np.trace(m)) if m.ndim == 2 else float(np.abs(m).sum()) for m in multipliers)
    if not total > 0:
        return None
    z = [(m + m.T) / (2 * total) if m.ndim == 2 else m / total for m in multipliers]
    for cut in cuts:
        for attempt in (system.confined, system.factored):
            proved = attempt(z, cut)
            if proved is not None and proved.refute:
                return proved
        proved = None if cut else _restored(system, z)
        if proved is not None and proved.refute:
            return proved
    return None


def _restored(system: System, multipliers: Sequence[np.ndarray]) -> Multipliers | None:
    restored = system.restored(multipliers)
    return None if restored is None else system.confined(restored, 0.0)
