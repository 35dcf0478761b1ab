"""Sparse linear equations over the rationals: the nearest-looking exact solution of equations that floats satisfy."""

from collections.abc import Mapping, Sequence

from flint import fmpq

__all__ = ["Unsolvable", "complete"]


class Unsolvable(ValueError):
    """Linear equations that have no solution."""


def complete(
    equations: Sequence[tuple[Mapping[int, fmpq], fmpq]], values: Sequence[fmpq], scales: Sequence[float]
) -> list[fmpq]:
    """Change as few values as there are independent equations, so that all hold exactly.

    Gauss-Jordan elimination, shortest equation first. In each the value to be changed is, among those whose change is
    small in relation to its scale, the one that occurs in the fewest equations: so the rationals stay short.

    Parameters
    ----------
    equations : sequence of (coefficients by index, right side)
    values : sequence of fmpq
        Values that satisfy the equations nearly.
    scales : sequence of float
        Size of a change of each value that would do no harm, relative to the others.

    Returns
    -------
    list of fmpq

    Raises
    ------
    Unsolvable
        If the equations contradict each other.
    """
    rows = [({i: c for i, c in coefficients.items() if c != 0}, right) for coefficients, right in equations]
    solved: list[tuple[int, dict[int, fmpq], fmpq]] = []
    while rows:
        counts: dict[int, int] = {}
        for coefficients, _ in rows:
            for i in coefficients:
                counts[i] = counts.get(i, 0) + 1
        place = min(range(len(rows)), key=lambda k: len(rows[k][0]))
        coefficients, right = rows.pop(place)
        if not coefficients:
            if right != 0:
                raise Unsolvable("linear equations without a solution")
            continue
        sizes = {i: abs(_float(c)) * scales[i] for i, c in coefficients.items()}
        most = max(sizes.values())
        pivot = min((i for i in sizes if sizes[i] >= 0.1 * most), key=lambda i: (counts[i], i))
        unit = 1 / coefficients.pop(pivot)
        row = {i: c * unit for i, c in coefficients.items()}
        right = right * unit
        rows = [_without(entry, pivot, row, right) for entry in rows]
        solved = [(i, *_without((c, r), pivot, row, right)) for i, c, r in solved]
        solved.append((pivot, row, right))
    result = list(values)
    for pivot, row, right in solved:
        result[pivot] = right - sum((c * values[i] for i, c in row.items()), fmpq(0))
    return result


def _float(value: fmpq) -> float:
    return int(value.p) / int(value.q)


def _without(
    entry: tuple[dict[int, fmpq], fmpq], pivot: int, row: Mapping[int, fmpq], right: fmpq
) -> tuple[dict[int, fmpq], fmpq]:
    coefficients, value = entry
    if pivot not in coefficients:
        return entry
    factor = coefficients.pop(pivot)
    for i, c in row.items():
        new = coefficients.get(i, fmpq(0)) - factor * c
        if new == 0:
            coefficients.pop(i, None)
        else:
            coefficients[i] = new
    return coefficients, value - factor * right
