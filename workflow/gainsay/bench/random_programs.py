"""Random matrix inequalities whose outcome is known, with a stated distance to the boundary, from a seed."""

from dataclasses import dataclass

import numpy as np

from gainsay.lmi.affine import Affine, Definite, scalar
from gainsay.lmi.program import Program


@dataclass(frozen=True)
class Drawn:
    """A program and what is known of it.

    Attributes
    ----------
    program : Program
    feasible : bool
    distance : float
        Feasible: least eigenvalue of a block of norm one at some point. Infeasible: minus the constant that multipliers
        of trace one leave, whose least eigenvalue is at least a tenth of their mean.
    """

    program: Program
    feasible: bool
    distance: float


def draw(rng: np.random.Generator, rows: int, unknowns: int, feasible: bool, distance: float) -> Drawn:
    """Draw ``C + sum x_k A_k > 0`` of so many rows and unknowns.

    The A_k are symmetric Gaussian. Feasible: C is chosen so that the block is what it should be at a Gaussian point.
    Infeasible: A_k and C are made orthogonal to, and negative on, a definite matrix; their rounding moves it by 1e-15.
    """

    def symmetric() -> np.ndarray:
        m = rng.standard_normal((rows, rows))
        return m + m.T

    A = [symmetric() for _ in range(unknowns)]
    spread = symmetric()
    values, vectors = np.linalg.eigh(spread)
    if feasible:
        wanted = distance + (1 - distance) * (values - values[0]) / (values[-1] - values[0])
        point = rng.standard_normal(unknowns)
        C = (vectors * wanted) @ vectors.T - sum(x * a for x, a in zip(point, A, strict=True))
    else:
        weights = 0.1 + 0.9 * rng.random(rows)
        Z = (vectors * (weights / weights.sum())) @ vectors.T
        size = np.sum(Z * Z)
        A = [a - np.sum(a * Z) / size * Z for a in A]
        C = symmetric()
        C = C - (np.sum(C * Z) + distance) / size * Z
    C = (C + C.T) / 2
    terms = {scalar(f"x{k}"): ((a + a.T) / 2)[:, :, None] for k, a in enumerate(A)}
    block = Definite("block", Affine(C, terms), True, (("", rows),))
    return Drawn(Program(subject_to=[block], label=f"random, {rows} rows"), feasible, distance)


def draws(seed: int, count: int, most: int) -> list[Drawn]:
    """So many programs of 2 to `most` rows, half of them infeasible, at distances from 1e-4 to 1."""
    rng = np.random.default_rng(seed)
    samples = []
    for number in range(count):
        rows = int(rng.integers(2, most + 1))
        unknowns = int(rng.integers(1, min(rows * (rows + 1) // 2, 61)))
        samples.append(draw(rng, rows, unknowns, number % 2 == 0, 10.0 ** rng.uniform(-4, 0)))
    return samples
