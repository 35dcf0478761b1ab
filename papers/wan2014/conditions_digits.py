"""What the printed digits of (43) and (44) leave open: a consistent point, and ranges near the optimum."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from gainsay.errors import ComputationError
from gainsay.lmi import Program, ranges
from gainsay.tables import Case
from gainsay.tables.reading import PrintedMatrix
from papers.wan2014.statements import near_optimal

#: near-optimal means a cost of at most this times the infimum
NEAR = 1.001
#: an entry is identified if its range near the optimum is within this part of its size, to either side
IDENTIFIED = 0.1
#: printed values and their half units
Box = tuple[np.ndarray, np.ndarray]
_UPPER = [(i, j) for i in range(6) for j in range(i, 6)]


def _box(printed: PrintedMatrix) -> Box:
    rows = printed.rows
    return printed.floats, np.array([[float(x.half_unit) for x in row] for row in rows])


def consistent_point(case: Case, target: float = 0.95, rounds: int = 30) -> tuple[np.ndarray, np.ndarray]:
    """Find X and K that round to (43) and (44) such that K X rounds to Y of (43), by sequential linear programs.

    Returns
    -------
    X, K : ndarray, shapes (6, 6) and (3, 6)
        Within `target` half units of every printed digit, and so is K X.

    Raises
    ------
    ComputationError
        If none was found; that proves nothing.
    """
    (X0, hx), (Y0, hy), (K0, hk) = (_box(case.printed(name)) for name in "XYK")
    X, K, reach = X0.copy(), K0.copy(), 1.0

    def distance(X: np.ndarray, K: np.ndarray) -> float:
        return max(np.abs((X - X0) / hx).max(), np.abs((K - K0) / hk).max(), np.abs((K @ X - Y0) / hy).max())

    best = distance(X, K)
    for _ in range(rounds):
        if best <= target:
            return X, K
        step = _step(X, K, (X0, hx), (Y0, hy), (K0, hk), reach)
        if distance(X + step[0], K + step[1]) < best:
            X, K, reach = X + step[0], K + step[1], 2 * reach
            best = distance(X, K)
        else:
            reach /= 2
    raise ComputationError("(44)", f"no X, Y, K within the printed digits found; {best:.3g} half units remain")


def _step(
    X: np.ndarray, K: np.ndarray, box_x: Box, box_y: Box, box_k: Box, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Step of the linearised problem: least largest distance from all printed digits, in half units."""
    (X0, hx), (Y0, hy), (K0, hk) = box_x, box_y, box_k
    count = len(_UPPER) + 18
    rows, right = [], []

    def demand(coefficients: np.ndarray, value: float) -> None:
        for sign in (1, -1):
            rows.append(np.append(sign * coefficients, -1.0))
            right.append(sign * value)

    for k, (i, j) in enumerate(_UPPER):
        demand(np.eye(count)[k], (X0[i, j] - X[i, j]) / hx[i, j])
    product = K @ X
    for i in range(3):
        for j in range(6):
            demand(np.eye(count)[len(_UPPER) + 6 * i + j], (K0[i, j] - K[i, j]) / hk[i, j])
            coefficients = np.zeros(count)
            for m in range(6):
                coefficients[len(_UPPER) + 6 * i + m] += hk[i, m] * X[m, j]
                pair = min(m, j), max(m, j)
                coefficients[_UPPER.index(pair)] += K[i, m] * hx[pair]
            demand(coefficients / hy[i, j], (Y0[i, j] - product[i, j]) / hy[i, j])
    cost = np.append(np.zeros(count), 1.0)
    bounds = [(-reach, reach)] * count + [(0, None)]
    step = linprog(cost, A_ub=np.array(rows), b_ub=right, bounds=bounds, method="highs")
    dx = np.zeros((6, 6))
    for k, (i, j) in enumerate(_UPPER):
        dx[i, j] = dx[j, i] = step.x[k] * hx[i, j]
    return dx, step.x[len(_UPPER) : count].reshape(3, 6) * hk


@dataclass(frozen=True)
class Spread:
    """Ranges of the entries of a matrix near the optimum, each end attained by a checked point.

    Attributes
    ----------
    low, high : ndarray
    identified : ndarray of bool
        Whether half the range is below `IDENTIFIED` times the entry's size at the optimum.
    """

    low: np.ndarray
    high: np.ndarray
    identified: np.ndarray


def _spread(low: np.ndarray, high: np.ndarray, optimum: np.ndarray) -> Spread:
    return Spread(low, high, (high - low) / 2 < IDENTIFIED * np.abs(optimum))


def spreads(case: Case, optimum: dict, rho: float) -> dict[str, Spread]:
    """Range every entry of X, Y (linear programs) and K (sequential ones) over all points of cost below NEAR rho.

    An entry of K is ranged by linearisations (Y - K0 X) X0^-1 at the last point found: its ends are attained, but may
    fall short of the true ones. The second linearisation is for the entries that still look identified after the
    first: of the others it could change nothing.

    Parameters
    ----------
    case : Case
    optimum : dict
        X, Y, eps of the sub-problem in the paper's units, at the optimum.
    rho : float
        Its infimum.
    """
    program = near_optimal(case, NEAR * rho).program()
    unknown = {variable.name: variable for variable in program.places}
    near = {**optimum, "inverse_rho": 1 / rho}
    places = {"X": [*_UPPER], "Y": [(i, j) for i in range(3) for j in range(6)]}
    result, visited = {}, []
    for name in ("X", "Y"):
        low, high = np.full(unknown[name].shape, np.nan), np.full(unknown[name].shape, np.nan)
        entries = [unknown[name][i, j] for i, j in places[name]]
        for (i, j), span in zip(places[name], ranges(program, entries, near), strict=True):
            low[i, j], high[i, j] = span.low, span.high
            visited += [point for point in (span.at_low, span.at_high) if point]
            if name == "X":
                low[j, i], high[j, i] = span.low, span.high
        result[name] = _spread(low, high, optimum[name])
    K0 = np.linalg.solve(optimum["X"], optimum["Y"].T).T
    gains = [K0, *(np.linalg.solve(point["X"], point["Y"].T).T for point in visited)]
    ends = np.array([np.min(gains, axis=0), np.max(gains, axis=0)])
    points = {(side, place): (optimum["X"], K0) for side in (0, 1) for place in places["Y"]}
    looked_at = list(places["Y"])
    for _ in range(2):
        for side in (0, 1):
            _push(program, unknown, near, side, looked_at, points, ends)
        identified = _spread(ends[0], ends[1], K0).identified
        looked_at = [place for place in looked_at if identified[place]]
    result["K"] = _spread(ends[0], ends[1], K0)
    return result


def _push(program: Program, unknown: dict, near: dict, side: int, places: list, points: dict, ends: np.ndarray) -> None:
    """Move one end of entries of K outwards by a linearisation each at the last point found."""
    X, Y = unknown["X"], unknown["Y"]
    linear = []
    for i, j in places:
        X0, K = points[side, (i, j)]
        linear.append((Y[i, :] - K[i : i + 1] @ X) @ np.linalg.solve(X0, np.eye(6)[:, j : j + 1]))
    for (i, j), span in zip(places, ranges(program, linear, near, sides=(side,)), strict=True):
        point = (span.at_low, span.at_high)[side]
        if point:
            k = np.linalg.solve(point["X"], point["Y"].T).T
            points[side, (i, j)] = point["X"], k
            ends[side, i, j] = (min, max)[side](ends[side, i, j], k[i, j])
