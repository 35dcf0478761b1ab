"""Multipliers that are checked: lower bounds on an optimum, and Farkas candidates of infeasibility.

A solver's multipliers satisfy their linear equations to its tolerance only. They are corrected here to rounding,
and count only if they are still positive afterwards. An exact proof is the business of `gainsay.proof`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gainsay.lmi import backends, scaling
from gainsay.lmi.affine import scalar
from gainsay.lmi.blocks import Definite, Entrywise, Equal
from gainsay.lmi.program import Program


@dataclass(frozen=True)
class Farkas:
    """Multipliers Z_j >= 0 under which the weighted sum of all blocks is free of unknowns and not positive.

    Attributes
    ----------
    multipliers : dict
        Label of each constraint to its multiplier, in unscaled coordinates, of trace about one altogether.
    value : float
        Sum of <constant part, Z_j>, scaled coordinates: at most 0 proves that strict inequalities cannot all hold.
    residual : float
        Largest coefficient left before an unknown, relative to the largest it has in a block (total trace one).
    least : float
        Least eigenvalue (or entry) of the multipliers, scaled coordinates, total trace one.
    """

    multipliers: dict[str, np.ndarray]
    value: float
    residual: float
    least: float

    @property
    def holds(self) -> bool:
        """Whether the candidate holds to rounding."""
        return self.residual < 1e-12 and self.least > -1e-13 and self.value < 1e-13


def _pairing(constraints: Sequence, tensors: Sequence, multipliers: Sequence) -> np.ndarray:
    total = 0.0
    for constraint, tensor, multiplier in zip(constraints, tensors, multipliers, strict=True):
        if isinstance(constraint, Definite):
            total = total + np.einsum("ijk,ij->k", tensor, multiplier)
        else:
            total = total + multiplier @ tensor
    return total


def _sizes(program: Program, scaled: scaling.Scaled) -> np.ndarray:
    """Largest coefficient of each coordinate."""
    return np.max([np.abs(t).reshape(-1, program.size).max(axis=0, initial=0.0) for t in scaled.tensors], axis=0)


def _constant(multipliers: Sequence, constants: Sequence) -> float:
    return float(sum(np.sum(z * c) for z, c in zip(multipliers, constants, strict=True)))


def _least(constraints: Sequence, multipliers: Sequence) -> float:
    least = [np.inf]
    for constraint, multiplier in zip(constraints, multipliers, strict=True):
        if isinstance(constraint, Definite):
            least.append(np.linalg.eigvalsh(multiplier)[0])
        elif not isinstance(constraint, Equal):
            least.append(multiplier.min())
    return float(min(least))


def lower_bound(
    program: Program, scale: scaling.Scaling, multipliers: Sequence[np.ndarray]
) -> tuple[float, dict[str, np.ndarray]]:
    """Lower bound on the infimum from corrected multipliers, checked positive; -inf where they are not.

    Parameters
    ----------
    program : Program
    scale : Scaling
        Scaling to which the multipliers belong.
    multipliers : sequence of ndarray
        Interior enough that the correction to ``cost = sum <coefficients, Z_j>`` leaves them positive.

    Returns
    -------
    bound : float
    multipliers : dict
        Label of each constraint to its corrected multiplier, in unscaled coordinates.
    """
    scaled = scaling.apply(program, scale)
    constraints = program.constraints
    z = [np.array(m) for m in multipliers]
    for _ in range(3):
        rest = scaled.cost - _pairing(constraints, scaled.tensors, z)
        stack = np.vstack([t.reshape(-1, program.size) for t in scaled.tensors])
        step = stack @ np.linalg.lstsq(stack.T @ stack, rest, rcond=None)[0]
        place = 0
        for number, part in enumerate(z):
            z[number] = part + step[place : place + part.size].reshape(part.shape)
            place += part.size
    rest = np.abs(scaled.cost - _pairing(constraints, scaled.tensors, z))
    sizes = _sizes(program, scaled) * max(float(np.abs(m).max(initial=0.0)) for m in z)
    if (rest > 1e-12 * (sizes + np.abs(scaled.cost))).any() or _least(constraints, z) < 0:
        return -np.inf, {}
    bound = float(program.objective.constant[0, 0] - scale.cost * _constant(z, scaled.constants))
    return bound, {name: scale.cost * value for name, value in _unscaled(program, scale, z).items()}


def _unscaled(program: Program, scale: scaling.Scaling, multipliers: Sequence) -> dict[str, np.ndarray]:
    unscaled = {}
    for constraint, d, multiplier in zip(program.constraints, scale.rows, multipliers, strict=True):
        unscaled[constraint.label] = multiplier * (np.outer(d, d) if isinstance(constraint, Definite) else d**2)
    return unscaled


def pushed_inside(program: Program, scale: scaling.Scaling, push: float, setting: str = "clarabel") -> tuple:
    """Multipliers with eigenvalues of at least `push`: the traces of all scaled blocks taken off the objective.

    Returns
    -------
    tuple of (multipliers, Raw)
        The multipliers (None where the solver gave none), and what the solver returned.
    """
    scaled = scaling.apply(program, scale)
    extra = np.zeros(program.size)
    shifts = []
    for constraint, tensor, constant in zip(program.constraints, scaled.tensors, scaled.constants, strict=True):
        if isinstance(constraint, Definite):
            extra += np.einsum("iik->k", tensor)
            shifts.append(np.eye(len(constant)))
        elif isinstance(constraint, Equal):
            shifts.append(np.zeros(len(constant)))
        else:
            extra += tensor.sum(axis=0)
            shifts.append(np.ones(len(constant)))
    # the equations c = sum <T, Z + push I> are those of the cost without push times the traces
    pushed = scaling.Scaled(scaled.cost - push * extra, scaled.constants, scaled.tensors)
    raw = backends.run(pushed, program.constraints, 0.0, setting)
    if not raw.multipliers:
        return None, raw
    return tuple(z + push * s for z, s in zip(raw.multipliers, shifts, strict=True)), raw


def farkas(program: Program, scale: scaling.Scaling, setting: str = "clarabel") -> tuple[float, Farkas | None, tuple]:
    """Push all scaled blocks up together: ``max t, F_j(x) >= t I, t <= 1``; its multipliers are a Farkas candidate.

    Returns
    -------
    level : float
        The largest t as the solver says it (nan where it gave none); positive: there is a strict point.
    candidate : Farkas or None
        Multipliers, confined to their range and corrected so that no unknown is left; to be judged by `Farkas.holds`.
    raw : tuple of (ndarray or None, dict)
        The point in scaled coordinates, and the record of the attempt.
    """
    scaled = scaling.apply(program, scale)
    size = program.size
    tensors, constants = [], []
    for constraint, tensor, constant in zip(program.constraints, scaled.tensors, scaled.constants, strict=True):
        level = np.zeros((*tensor.shape[:-1], 1))
        if isinstance(constraint, Definite):
            level[..., 0] = -np.eye(len(constant))
        elif not isinstance(constraint, Equal):
            level[..., 0] = -1
        tensors.append(np.concatenate([tensor, level], axis=-1))
        constants.append(constant)
    cap = np.zeros((1, size + 1))
    cap[0, size] = -1
    cost = np.zeros(size + 1)
    cost[size] = -1
    phase = scaling.Scaled(cost, (*constants, np.ones(1)), (*tensors, cap))
    raw = backends.run(phase, (*program.constraints, Entrywise("level <= 1", scalar("level"))), 0.0, setting)
    if raw.x is None or len(raw.multipliers) == 0:
        return float("nan"), None, (None, raw.record)
    candidates = [
        _confined(program, scaled, raw.multipliers[:-1], threshold, homogeneous)
        for homogeneous in (False, True)
        for threshold in (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
    ]
    found = [c for c in candidates if c is not None]
    best = next((c for c in found if c[1].holds), min(found, key=lambda c: c[1].residual, default=None))
    candidate = None
    if best is not None:
        z, candidate = best
        candidate = Farkas(_unscaled(program, scale, z), candidate.value, candidate.residual, candidate.least)
    return float(raw.x[size]), candidate, (raw.x[:size], raw.record)


def _confined(
    program: Program, scaled: scaling.Scaled, multipliers: Sequence, threshold: float, homogeneous: bool
) -> tuple | None:
    """Keep the range of each multiplier above `threshold` and solve the equations inside it, by least squares.

    Where only the homogeneous part is infeasible the multipliers must vanish on every row with a positive constant:
    `homogeneous` leaves such rows out where the solver's multiplier is negligible there.
    """
    constraints = program.constraints
    top = max((np.abs(m).max(initial=0.0) for m in multipliers), default=0.0)
    if not top > 0:
        return None
    columns, starts, frames = [], [], []
    for constraint, tensor, constant, multiplier in zip(
        constraints, scaled.tensors, scaled.constants, multipliers, strict=True
    ):
        if isinstance(constraint, Definite):
            weightless = (np.abs(np.diagonal(constant)) > 0) & (np.abs(np.diagonal(multiplier)) < 1e-6 * top)
            kept = np.flatnonzero(~(weightless & homogeneous))
            eigenvalues, vectors = np.linalg.eigh((multiplier + multiplier.T)[np.ix_(kept, kept)] / 2)
            frame = np.zeros((len(multiplier), len(kept)))
            frame[kept] = vectors
            frame = frame[:, eigenvalues > threshold * top]
            core = np.einsum("ia,ijk,jb->abk", frame, tensor, frame, optimize=True)
            starts.append(frame.T @ multiplier @ frame)
            columns.append(core.reshape(-1, program.size))
        else:
            keep = np.abs(multiplier) > threshold * top
            frame = np.eye(len(multiplier))[:, keep]
            starts.append(multiplier[keep])
            columns.append(tensor[keep])
        frames.append(frame)
    stack = np.vstack(columns)
    core = np.concatenate([s.ravel() for s in starts])
    for _ in range(3):
        core = core - np.linalg.lstsq(stack.T, stack.T @ core, rcond=1e-13)[0]
    z, place = [], 0
    for constraint, frame, start in zip(constraints, frames, starts, strict=True):
        part = core[place : place + start.size].reshape(start.shape)
        place += start.size
        if isinstance(constraint, Definite):
            z.append(frame @ (part + part.T) @ frame.T / 2)
        else:
            z.append(frame @ part)
    total = sum(float(np.trace(m)) if m.ndim == 2 else float(np.abs(m).sum()) for m in z)
    if not total > 0:
        return None
    z = [m / total for m in z]
    rest = np.abs(_pairing(constraints, scaled.tensors, z))
    sizes = _sizes(program, scaled)
    residual = float(np.max(rest / np.where(sizes > 0, sizes, 1.0), initial=0.0))
    return z, Farkas({}, _constant(z, scaled.constants), residual, _least(constraints, z))
