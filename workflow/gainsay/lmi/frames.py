"""Multipliers as frames and cores, ``Z_j = L_j (I + E_j) L_j'``: their products, steps of the cores, sizes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from flint import fmpq_mat

from gainsay.exact.rational import to_fmpq
from gainsay.lmi.affine import Definite, Equal
from gainsay.lmi.rounding import RightInverse, gamma

__all__ = ["assembled", "congruent", "independent", "largest", "most_lost", "steps_of"]


def steps_of(flat: np.ndarray, cores: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Parts of a step of all cores, symmetric where the cores are."""
    parts, place = [], 0
    for core in cores:
        part = flat[place : place + core.size].reshape(core.shape)
        parts.append((part + part.T) / 2 if core.ndim == 2 else part)
        place += core.size
    return parts


def most_lost(constraint: Any, step: np.ndarray) -> float:
    """What a core of ones loses by a step, at most."""
    if isinstance(constraint, Equal) or not step.size:
        return 0.0
    return float((np.linalg.eigvalsh(step) if step.ndim == 2 else step).max())


def congruent(tensor: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """``frame' T_k frame`` for every k, shape (r, r, k)."""
    n, r = frame.shape
    half = np.tensordot(frame, tensor, (0, 0))  # (r, n, k)
    return np.tensordot(half, frame, (1, 0)).transpose(0, 2, 1) if r and n else np.zeros((r, r, tensor.shape[-1]))


def assembled(constraints: Sequence, frames: Sequence, cores: Sequence) -> tuple[list, list]:
    """Multipliers of frames and cores, and what rounding leaves out of each entry."""
    z, wide = [], []
    for constraint, frame, core in zip(constraints, frames, cores, strict=True):
        large = np.abs(frame)
        if isinstance(constraint, Definite):
            m = frame @ core @ frame.T
            z.append((m + m.T) / 2)
            wide.append(2 * gamma(2 * frame.shape[1] + 1) * (large @ np.abs(core) @ large.T))
        else:
            z.append(frame @ core)
            wide.append(2 * gamma(frame.shape[1]) * (large @ np.abs(core)))
    return z, wide


def largest(constraints: Sequence, multipliers: Sequence[np.ndarray]) -> float:
    """Largest entry of multipliers, those of equations counted little."""
    sizes = [
        (1e-7 if isinstance(c, Equal) else 1.0) * float(np.abs(m).max(initial=0.0))
        for c, m in zip(constraints, multipliers, strict=True)
    ]
    return max(sizes, default=0.0)


def independent(stack: np.ndarray, cost: np.ndarray) -> np.ndarray | None:
    """Coordinates whose equations imply those of all others, exactly; None where this is not so or not known."""
    used = np.flatnonzero(np.abs(stack).max(axis=0, initial=0.0) > 0)
    if cost[np.setdiff1d(np.arange(len(cost)), used)].any():
        return None
    if RightInverse.of(stack[:, used].T) is not None:
        return used
    if stack.size > 60_000:
        return None
    lines = np.unique(np.vstack([stack[:, used]]), axis=0)
    lines = lines[np.abs(lines).max(axis=1) > 0]
    whole = fmpq_mat([[to_fmpq(float(v)) for v in line] for line in np.vstack([lines, cost[None, used]])])
    _, rank = whole.rref()
    reduced, own = fmpq_mat([[to_fmpq(float(v)) for v in line] for line in lines]).rref()
    if own < rank:
        return None  # no multipliers at all: the cost is not in the span of the coefficients
    pivots = [next(j for j in range(len(used)) if reduced[i, j] != 0) for i in range(own)]
    return used[pivots]
