"""Matrices put together from blocks."""

from collections.abc import Sequence
from typing import Any

from flint import arb, arb_mat, fmpq

from gainsay.exact.matrix import BALL, POLYNOMIAL, RATIONAL, Matrix, RingError, fits
from gainsay.exact.rational import rational_matrix

__all__ = ["block", "diagonal", "kron"]


def _as_rows(matrices: Sequence[Matrix]) -> tuple[str, Any, list[list[list[Any]]]]:
    """Bring matrices to one ring: the ring, its zero, and the rows of each matrix."""
    rings = {m.ring for m in matrices}
    if POLYNOMIAL in rings:
        context = next(m for m in matrices if m.ring == POLYNOMIAL).entry(0, 0).context()
        zero = Matrix.number(0).to_polynomial(context).entry(0, 0)
        return POLYNOMIAL, zero, [m.to_polynomial(context).rows() for m in matrices]
    if BALL in rings:
        return BALL, arb(0), [m.to_ball().rows() for m in matrices]
    return RATIONAL, fmpq(0), [m.rows() for m in matrices]


def block(rows: Sequence[Sequence[Matrix | None]]) -> Matrix:
    """Block matrix; the number 0 fills a block of any size, None stands for the transpose of the mirrored block.

    Raises
    ------
    RingError
        If the blocks do not fit together.
    """
    count = len(rows[0]) if rows else 0
    if not count or any(len(row) != count for row in rows):
        counts = ", ".join(str(len(row)) for row in rows)
        raise RingError(f"block rows differ in length: {counts or 'no'} blocks")
    grid: list[list[Matrix]] = []
    for i, row in enumerate(rows):
        line: list[Matrix] = []
        for j, entry in enumerate(row):
            mirrored = rows[j][i] if entry is None and j < len(rows) and i < len(rows[j]) else None
            placed = mirrored.T if mirrored is not None else entry
            if placed is None:
                raise RingError(f"block ({i}, {j}) stands for the transpose of a block that is not given")
            line.append(placed)
        grid.append(line)

    def fills(entry: Matrix) -> bool:
        return entry.is_number and entry.ring == RATIONAL and entry.data[0, 0] == 0

    heights = [max((m.shape[0] for m in line if not fills(m)), default=1) for line in grid]
    widths = [max((line[j].shape[1] for line in grid if not fills(line[j])), default=1) for j in range(count)]
    fits((sum(heights), sum(widths)))
    places = [(i, j) for i, line in enumerate(grid) for j, entry in enumerate(line) if not fills(entry)]
    for i, j in places:
        if grid[i][j].shape != (heights[i], widths[j]):
            raise RingError(f"block ({i}, {j}) has shape {grid[i][j].shape}, expected {(heights[i], widths[j])}")
    ring, zero, parts = _as_rows([grid[i][j] for i, j in places])
    entries = [[zero] * sum(widths) for _ in range(sum(heights))]
    for (i, j), part in zip(places, parts, strict=True):
        top, left = sum(heights[:i]), sum(widths[:j])
        for k, row in enumerate(part):
            entries[top + k][left : left + widths[j]] = row
    if ring == POLYNOMIAL:
        return Matrix(entries)
    return Matrix(arb_mat(entries) if ring == BALL else rational_matrix(entries))


def diagonal(blocks: Sequence[Matrix]) -> Matrix:
    """Block-diagonal matrix; numbers are blocks of size one."""
    zero = Matrix.number(0)
    return block([[m if i == j else zero for j in range(len(blocks))] for i, m in enumerate(blocks)])


def kron(left: Matrix, right: Matrix) -> Matrix:
    """Kronecker product."""
    fits((left.shape[0] * right.shape[0], left.shape[1] * right.shape[1]))
    return block([[right.scaled(Matrix.number(x)) for x in row] for row in left.rows()])
