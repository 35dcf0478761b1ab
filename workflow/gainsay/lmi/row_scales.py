"""Scales of the rows of an inequality beside those of P: a change of the units of one and not of the other.

``D F D > 0`` says what F > 0 says, but has the coefficients of no Lyapunov inequality in ``E P E``. The ratios of D to
E are read from coefficients of unknowns that have one entry in a column of P: a row of A is seen through each of them.
"""

import numpy as np

__all__ = ["region_scales", "stein_scales"]

#: ratio that is taken for one
_ONE = 1e-12


def region_scales(value: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """Weights w of rows with which ``w w' value`` may be the form of a region at `basis`; ones where none are seen.

    Parameters
    ----------
    value : ndarray, shape (m n, m n, k)
    basis : ndarray, shape (n, n, k)

    Returns
    -------
    ndarray, shape (m n,)
    """
    n = len(basis)
    columns = _columns(basis)
    blocks = [slice(start, start + n) for start in range(0, len(value), n)]
    return _weights(np.concatenate([_ratios(value[rows, rows], basis, columns) for rows in blocks]))


def _columns(basis: np.ndarray) -> list[dict[int, list[tuple[int, float]]]]:
    """For every column of P and every row: unknowns whose P_k has one entry in the column, there, and the entry."""
    columns: list[dict[int, list[tuple[int, float]]]] = []
    for j in range(len(basis)):
        by_row: dict[int, list[tuple[int, float]]] = {}
        for k in np.flatnonzero(np.count_nonzero(basis[:, j], axis=0) == 1):
            r = int(np.flatnonzero(basis[:, j, k])[0])
            by_row.setdefault(r, []).append((int(k), float(basis[r, j, k])))
        columns.append(by_row)
    return columns


def _ratios(value: np.ndarray, basis: np.ndarray, columns: list[dict[int, list[tuple[int, float]]]]) -> np.ndarray:
    """Ratios of the rows' scales of one block to those of P, each set of rows that P joins to its own unit."""
    n = len(basis)
    used = np.asarray(basis.any(axis=1))
    h, left = np.zeros(n), set(range(n))
    while left:
        reached, seen = [min(left)], {min(left)}
        h[reached[0]] = 1.0
        for j in reached:
            for i in left - seen:
                ratio = _step(value, used, columns, i, j) or 1 / (_step(value, used, columns, j, i) or np.inf)
                if ratio > 0:
                    h[i] = ratio * h[j]
                    reached.append(i)
                    seen.add(i)
        left -= seen
        if len(reached) < n:  # what is not joined has no unit in common: that of its own coefficients
            sizes = [abs(value[i, i, k] / c) / h[i] ** 2 for i in reached for k, c in columns[i].get(i, ())]
            h[reached] *= np.sqrt(max(sizes, default=0.0) or 1.0)
    return h


def _step(
    value: np.ndarray, used: np.ndarray, columns: list[dict[int, list[tuple[int, float]]]], i: int, j: int
) -> float:
    """Ratio of row i to row j; zero where it is not seen.

    Where P_k and P_l have one entry each in the columns j and i, both in row r, entry (p, j) of A'P_k + P_k A is a_rp
    times the one, and entry (p, i) of the other a_rp times the other, in rows p that both leave empty; and twice that
    for p = i.
    """
    for r in columns[j].keys() & columns[i].keys():
        for k, c in columns[j][r]:
            for m, e in columns[i][r]:
                row = np.abs(value[:, j, k] / c)
                row[used[:, k] | used[:, m]] = 0.0
                row[i] = 0.0 if used[i, k] else np.abs(value[i, j, k] / c)
                p = int(np.argmax(row))
                if row[p] > 0:
                    ratio = float((value[p, i, m] / e) / (value[p, j, k] / c)) / (2 if p == i else 1)
                    if ratio > 0:
                        return ratio
    return 0.0


def stein_scales(value: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """Weights w with which ``w w' value`` may be ``P - A'P A`` at `basis`; ones where none are seen.

    At e_i e_i' the form is ``e_i e_i' - a a'``, a the row of A, whose entry i follows from the others.

    Parameters
    ----------
    value, basis : ndarray, shape (n, n, k)
    """
    n, single = len(basis), _single(basis)
    squares = np.ones(n)
    for i in range(n):
        if (i, i) not in single:
            return np.ones(n)
        k = single[i, i]
        form = value[:, :, k] / basis[i, i, k]
        others = -np.diagonal(form).copy()
        others[i] = 0.0
        q = int(np.argmax(others))
        squares[i] = form[i, i] + (form[i, q] ** 2 / others[q] if others[q] > 0 else 0.0)
    return _weights(np.sqrt(np.maximum(squares, 0.0)))


def _single(basis: np.ndarray) -> dict[tuple[int, int], int]:
    """Unknowns that stand in one entry of P (and its mirror image), by that entry."""
    places = {}
    counts = np.count_nonzero(basis, axis=(0, 1))
    for k in np.flatnonzero((counts > 0) & (counts <= 2)):
        i, j = (int(t) for t in np.argwhere(basis[:, :, k])[0])
        if counts[k] == (1 if i == j else 2):
            places[i, j] = int(k)
    return places


def _weights(ratios: np.ndarray) -> np.ndarray:
    if not (np.isfinite(ratios).all() and (ratios > 0).all()) or np.abs(ratios / ratios[0] - 1).max() < _ONE:
        return np.ones(len(ratios))
    return 1 / ratios
