"""A matrix inequality on the kernel of a semidefinite coefficient, where the unknown of that coefficient drops out.

A multiplier Z >= 0 with <B, Z> = 0 and B >= 0 has its range in the kernel of B: it is singular whatever else is asked,
and no solver comes near it. With W a basis of the kernel, ``W' F W > 0`` follows from ``F > 0`` and is free of the
unknown; where it has no solution, neither has the program. It is one step of facial reduction of the multipliers.

Reference: J. M. Borwein, H. Wolkowicz, "Regularizing the abstract convex program", J. Math. Anal. Appl. 83 (1981).
"""

from dataclasses import dataclass, replace
from math import lcm

import numpy as np
from flint import fmpq_mat

from gainsay.exact.definite import positive_semidefinite
from gainsay.exact.rational import fraction_of, to_fmpq
from gainsay.lmi.affine import Affine, Definite
from gainsay.lmi.facial import exact_product
from gainsay.lmi.outcomes import Farkas
from gainsay.lmi.program import Program, Row

#: rows of a block up to which its coefficients are looked at
_MOST_ROWS = 60
#: kernels taken one after another
_MOST_KERNELS = 40
#: eigenvalue below which, relative to the largest, a coefficient may be singular
_SINGULAR = 1e-9


@dataclass(frozen=True)
class OnKernel:
    """A program implied by another: one of its blocks is seen on a kernel.

    Attributes
    ----------
    program : Program
    label : str
        The block's.
    basis : ndarray
        Of the kernel, exact.
    """

    program: Program
    label: str
    basis: np.ndarray

    def lifted(self, proof: Farkas) -> Farkas:
        """Multipliers of the program itself."""
        multipliers, W = dict(proof.multipliers), self.basis
        if self.label in multipliers:
            multipliers[self.label] = W @ multipliers[self.label] @ W.T
        return replace(
            proof,
            multipliers=multipliers,
            distance=proof.distance * float(np.linalg.norm(W)) ** 2 * (1 + 1e-12),
            reason=f"{proof.reason}, on the kernel of a semidefinite coefficient of {self.label!r}",
        )


def on_kernels(program: Program) -> list[OnKernel]:
    """What a program says on the kernel of a coefficient, what that says on the kernel of another, and so on."""
    steps: list[OnKernel] = []
    while len(steps) < _MOST_KERNELS and (smaller := _on_kernel(steps[-1].program if steps else program)) is not None:
        steps.append(smaller)
    return steps


def _on_kernel(program: Program) -> OnKernel | None:
    """The program with one block on the kernel of one of its coefficients; None where none is semidefinite."""
    for row in program.rows:
        if not isinstance(row.constraint, Definite) or not 1 < row.size <= _MOST_ROWS:
            continue
        for k in np.flatnonzero(row.tensor.any(axis=(0, 1))):
            basis = _kernel(row.tensor[:, :, k])
            block = None if basis is None else exact_product(program, row, basis, basis)
            if basis is not None and block is not None:
                constraints = [_seen(row, block) if c is row.constraint else c for c in program.constraints]
                smaller = replace(program, minimise=None, subject_to=constraints, scale=type(program.scale)())
                return OnKernel(smaller, row.constraint.label, basis)
    return None


def _seen(row: Row, block: Affine) -> Definite:
    assert isinstance(row.constraint, Definite), "kernels are of matrix inequalities"
    return Definite(row.constraint.label, block, row.constraint.strict, (("", block.shape[0]),))


def _kernel(B: np.ndarray) -> np.ndarray | None:
    """Exact basis, in doubles, of the kernel of a matrix that is proved semidefinite and singular."""
    values = np.linalg.eigvalsh(B)
    size = np.abs(values).max()
    if not size > 0 or np.abs(values).min() > _SINGULAR * size:
        return None
    sign = 1.0 if values[-1] >= -values[0] else -1.0
    if (sign * values).min() < -_SINGULAR * size:
        return None
    exact = fmpq_mat([[to_fmpq(float(sign * v)) for v in line] for line in B])
    if not positive_semidefinite(exact):
        return None
    echelon, rank = exact.rref()
    n = len(B)
    if not 0 < rank < n:
        return None
    pivots = [next(j for j in range(n) if echelon[i, j] != 0) for i in range(rank)]
    columns = []
    for free in (j for j in range(n) if j not in pivots):
        column = [fraction_of(-echelon[pivots.index(i), free]) if i in pivots else int(i == free) for i in range(n)]
        common = lcm(*(x.denominator for x in column))
        whole = [int(x * common) for x in column]
        if any(int(float(x)) != x for x in whole):
            return None
        columns.append([float(x) for x in whole])
    return np.array(columns).T
