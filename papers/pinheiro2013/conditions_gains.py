"""Gains of the least trace of Q under (21) for many plants at once, each its only stationary point.

For a fixed gain the least X of (21) solves a Riccati equation, and the trace of Q becomes a function f of the gain
alone. It is not convex, but where its derivative vanishes it is least: from such a gain the segment in X and Y to a
better point of the convex program (21) would descend at once, and f lies below the program's value along it and touches
it at the start. There is one such gain: the trace of (C2 X - D22 Y) X^-1 (C2 X - D22 Y)' is linear between two points
only if both have the same C2 - D22 K, and D22 has full column rank. So a gain that meets the first-order condition is
the answer whatever way led to it, and Newton's step at it measures what is missing.

References
----------
D. S. Bernstein, W. M. Haddad, "LQG control with an H-infinity performance bound: a Riccati equation approach", IEEE
Transactions on Automatic Control 34(3), 1989: the coupled equations.
Y. Sun, M. Fazel, "Learning optimal controllers by policy gradient: global optimality via convex parameterization", IEEE
Conference on Decision and Control, 2021: stationary points of problems that are convex in other variables.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from gainsay.errors import ComputationError, InputError
from papers.pinheiro2013.plant import GeneralizedPlant

#: relative size of Newton's step below which a gain is taken, and at which no further step is tried
ACCURATE, FINISHED = 1e-9, 1e-13
#: size below which a step is taken whole
_CLOSE = 1e-6
#: most steps, and most halvings of one
_STEPS, _HALVINGS = 60, 40
#: gains between the H2 gain and the one that reaches every level, of which the best is the start
_STARTS = 9
#: least curvature that a step goes by, in units of that of the H2 problem
_CURVATURE = 1e-3


@dataclass(frozen=True, eq=False)
class Stack:
    """Plants of one group of axes, each with its level; every attribute has one entry for each plant.

    Of the input w only products are kept, since nothing else of it matters.

    Attributes
    ----------
    A, B2, C1, D12, C2, D22 : ndarray
        Of (19), stacked.
    BB, BD : ndarray
        B1 B1' and B1 D11'.
    R : ndarray
        gamma^2 I - D11 D11'.
    limit : ndarray
        Gains that reach every level above the infimum.
    """

    A: np.ndarray
    B2: np.ndarray
    C1: np.ndarray
    D12: np.ndarray
    C2: np.ndarray
    D22: np.ndarray
    BB: np.ndarray
    BD: np.ndarray
    R: np.ndarray
    limit: np.ndarray

    def __getitem__(self, chosen: np.ndarray) -> "Stack":
        return replace(self, **{field.name: getattr(self, field.name)[chosen] for field in fields(self)})


def stack(plants: Sequence[GeneralizedPlant], levels: Sequence[float], limits: Sequence[np.ndarray]) -> Stack:
    """Stack plants with their levels and the gains that reach them.

    Raises
    ------
    InputError
        If a level does not exceed the norm of D11, below which no gain goes.
    """

    def each(measure: Callable[[GeneralizedPlant], np.ndarray]) -> np.ndarray:
        return np.array([measure(plant) for plant in plants])

    DD = each(lambda p: p.D11 @ p.D11.T)
    R = np.array(levels)[:, None, None] ** 2 * np.eye(DD.shape[-1]) - DD
    least = np.linalg.eigvalsh(R)[:, 0]
    if not least.min() > 0:
        raise InputError(
            "level", field="gamma", value=float(levels[int(least.argmin())]), expected="above the norm of D11"
        )
    return Stack(
        each(lambda p: p.A),
        each(lambda p: p.B2),
        each(lambda p: p.C1),
        each(lambda p: p.D12),
        each(lambda p: p.C2),
        each(lambda p: p.D22),
        each(lambda p: p.B1 @ p.B1.T),
        each(lambda p: p.B1 @ p.D11.T),
        R,
        np.array(limits),
    )


def _t(M: np.ndarray) -> np.ndarray:
    return np.swapaxes(M, -1, -2)


def _lyapunov(S: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """Solve S X + X S' + Q = 0 for stacks (N, n, n); Q may hold several right sides a matrix, (N, k, n, n)."""
    n = S.shape[-1]
    eye = np.eye(n)
    operator = np.einsum("...ij,kl->...ikjl", S, eye) + np.einsum("ij,...kl->...ikjl", eye, S)
    sides = Q.reshape(len(S), -1, n * n)
    solution = np.linalg.solve(operator.reshape(len(S), n * n, n * n), -_t(sides))
    return _t(solution).reshape(Q.shape)


def _stable(A: np.ndarray) -> np.ndarray:
    """Whether the poles lie to the left of the axis by more than rounding."""
    poles = np.linalg.eigvals(A)
    return poles.real.max(axis=-1) < -1e-12 * np.abs(poles).max(axis=-1)


def riccati(A: np.ndarray, Q: np.ndarray, G: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Solve A X + X A' + Q + X G X = 0 with A + X G stable for stacks, from the Hamiltonian's stable subspace.

    Two steps of Newton's method follow, which take back what nearly equal eigenvectors cost.

    Returns
    -------
    X : ndarray, shape (N, n, n)
    holds : ndarray of bool
        Whether a stabilising X > 0 was found, with a residual of rounding.
    """
    n = A.shape[-1]
    values, vectors = np.linalg.eig(
        np.concatenate([np.concatenate([_t(A), G], axis=-1), np.concatenate([-Q, -A], axis=-1)], axis=-2)
    )
    order = np.argsort(values.real, axis=-1)[:, None, :n]
    basis = np.take_along_axis(vectors, order, axis=-1)
    margin = 1e-12 * np.abs(values).max(axis=-1, keepdims=True)
    holds = (values.real < -margin).sum(axis=-1) == n
    top = basis[:, :n]
    # An eigenvalue on the axis, or a subspace that is no graph, has no X: its place is filled and marked.
    holds &= np.linalg.cond(top) < 1 / np.finfo(float).eps
    top = np.where(holds[:, None, None], top, np.eye(n))
    X = _t(np.linalg.solve(_t(top), _t(basis[:, n:]))).real
    X = np.where(holds[:, None, None], 0.5 * (X + _t(X)), np.eye(n))
    holds &= _stable(A + X @ G)
    for _ in range(2):  # from a stabilising X every step of Newton's gives another
        S = np.where(holds[:, None, None], A + X @ G, -np.eye(n))
        X = _lyapunov(S, Q - X @ G @ X)
        X = 0.5 * (X + _t(X))
    residual = np.abs(A @ X + X @ _t(A) + Q + X @ G @ X).max(axis=(-1, -2))
    size = (np.abs(A) @ np.abs(X)).max(axis=(-1, -2))
    holds &= _stable(A + X @ G)
    return X, holds & (residual < 1e-9 * size) & (np.linalg.eigvalsh(X)[:, 0] > 0)


def h2_gains(plants: Stack) -> np.ndarray:
    """Gains of the H2 limit, gamma to infinity."""
    weight = np.linalg.inv(_t(plants.D22) @ plants.D22)
    S, holds = riccati(_t(plants.A), _t(plants.C2) @ plants.C2, -plants.B2 @ weight @ _t(plants.B2))
    if not holds.all():
        raise ComputationError("H2 limit", f"no stabilising solution of the Riccati equation of plant {holds.argmin()}")
    return weight @ _t(plants.B2) @ S


def _closed(plants: Stack, K: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return plants.A - plants.B2 @ K, plants.C1 - plants.D12 @ K, plants.C2 - plants.D22 @ K


def covariances(plants: Stack, K: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least X of (21) for each gain and the trace of Q with it, infinite where the gain does not reach the level.

    The loop A is stable then: from v*A = s v* and X > 0 follows 2 Re s v*X v = -v*(B B' + L R L')v, which vanishes only
    with v*L, and then s is a pole of the stable A + L C.
    """
    A, C, C2 = _closed(plants, K)
    RC, RD = np.linalg.solve(plants.R, C), np.linalg.solve(plants.R, _t(plants.BD))
    X, holds = riccati(A + plants.BD @ RC, plants.BB + plants.BD @ RD, _t(C) @ RC)
    return X, np.where(holds, np.einsum("...ij,...jk,...ik->...", C2, X, C2), np.inf)


def _derivatives(plants: Stack, K: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative of the trace by the gain, shapes (N, m, n) and (N, m n, m n).

    With L = (X C' + B D') R^-1, S = A + L C stable and P S + S'P + C2'C2 = 0 the first is -2 G X, G = (B2 + L D12)'P
    + D22'C2; the second differentiates these equations once more.
    """
    count, m, n = K.shape
    A, C, C2 = _closed(plants, K)
    L = _t(np.linalg.solve(plants.R, C @ X + _t(plants.BD)))
    S, inputs = A + L @ C, plants.B2 + L @ plants.D12
    P = _lyapunov(_t(S), _t(C2) @ C2)
    G = _t(inputs) @ P + _t(plants.D22) @ C2
    E = np.broadcast_to(np.eye(m * n).reshape(m * n, m, n), (count, m * n, m, n))
    X_, P_, G_, C2_ = X[:, None], P[:, None], G[:, None], C2[:, None]
    dC, dC2 = -plants.D12[:, None] @ E, -plants.D22[:, None] @ E
    turned = (-inputs[:, None] @ E) @ X_
    dX = _lyapunov(S, turned + _t(turned))
    dL = _t(np.linalg.solve(plants.R[:, None], C[:, None] @ dX + dC @ X_))
    dS = -inputs[:, None] @ E + dL @ C[:, None]
    changed = P_ @ dS + _t(C2_) @ dC2
    dP = _lyapunov(_t(S), changed + _t(changed))
    dG = _t(dL @ plants.D12[:, None]) @ P_ + _t(inputs)[:, None] @ dP + _t(plants.D22)[:, None] @ dC2
    second = -2 * (dG @ X_ + G_ @ dX)
    return -2 * G @ X, second.reshape(count, m * n, m * n)


def _steps(plants: Stack, K: np.ndarray, X: np.ndarray, trace: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Newton's steps in units of the curvature of the H2 problem, 2 D22'D22 (x) X, made to descend.

    Returns
    -------
    steps : ndarray, shape (N, m, n)
    slopes : ndarray, shape (N,)
        Derivative of the trace along each, negative.
    sizes : ndarray, shape (N,)
        Root of what the step costs in these units over the trace, or the largest change of an entry over the gain's
        largest, whichever is larger.
    """
    count, m, n = K.shape
    first, second = _derivatives(plants, K, X)
    R = _t(plants.D22) @ plants.D22
    # Columns of `unit` have length one in the metric.
    left, right = np.linalg.inv(_t(np.linalg.cholesky(2 * R))), np.linalg.inv(_t(np.linalg.cholesky(X)))
    unit = np.einsum("...ij,...kl->...ikjl", left, right).reshape(count, m * n, m * n)
    curvature = _t(unit) @ (0.5 * (second + _t(second))) @ unit
    values, vectors = np.linalg.eigh(curvature)
    along = _t(vectors) @ (_t(unit) @ first.reshape(count, -1, 1))
    lengths = -along[..., 0] / np.maximum(np.abs(values), _CURVATURE)
    steps = (unit @ vectors @ lengths[..., None]).reshape(K.shape)
    slopes = (along[..., 0] * lengths).sum(axis=-1)
    entries = np.abs(steps).max(axis=(-1, -2)) / np.abs(K).max(axis=(-1, -2))
    return steps, slopes, np.maximum(np.sqrt((lengths**2).sum(axis=-1) / trace), entries)


def least_trace_gains(plants: Stack) -> tuple[np.ndarray, np.ndarray]:
    """Find the gain of the least trace of Q for every plant by Newton's method, from the best of some known gains.

    Parameters
    ----------
    plants : Stack

    Returns
    -------
    K : ndarray, shape (N, m, n)
    errors : ndarray, shape (N,)
        Relative size of Newton's step at each, to first order its distance from the optimum.

    Raises
    ------
    ComputationError
        If a gain is not stationary to `ACCURATE`.
    """
    first, count = h2_gains(plants), len(plants.limit)
    shares = np.concatenate([[1.0], np.arange(_STARTS - 1) / (_STARTS - 1)])[:, None, None, None]
    trials = np.where(shares == 1, plants.limit, first + shares * (plants.limit - first))
    X, traces = covariances(plants[np.tile(np.arange(count), _STARTS)], trials.reshape(-1, *first.shape[1:]))
    traces = traces.reshape(_STARTS, count)
    best = traces.argmin(axis=0), np.arange(count)
    K, X, trace = trials[best], X.reshape(_STARTS, count, *X.shape[1:])[best], traces[best]
    if not np.isfinite(trace).all():
        raise ComputationError("(21)", f"no gain at hand reaches the level of plant {np.isfinite(trace).argmin()}")
    K, X, _ = _newton(plants, K, X, trace, _CLOSE)
    # Once more with states whose covariance is the identity: a small entry of a gain may govern a slow pole.
    T = np.linalg.cholesky(X)
    whitened = _in_states(plants, T)
    K, _, errors = _newton(whitened, K @ T, *covariances(whitened, K @ T))
    if not errors.max() < ACCURATE:
        raise ComputationError("(21)", f"the gain of plant {errors.argmax()} has a Newton step of {errors.max():.1e}")
    return _t(np.linalg.solve(_t(T), _t(K))), errors


def _in_states(plants: Stack, T: np.ndarray) -> Stack:
    """Plants in other states, x = T x'."""
    to = np.linalg.inv(T)
    return replace(
        plants,
        A=to @ plants.A @ T,
        B2=to @ plants.B2,
        C1=plants.C1 @ T,
        C2=plants.C2 @ T,
        BB=to @ plants.BB @ _t(to),
        BD=to @ plants.BD,
        limit=plants.limit @ T,
    )


def _newton(
    plants: Stack, K: np.ndarray, X: np.ndarray, trace: np.ndarray, finished: float = FINISHED
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Newton's method from gains that reach the level, with their covariances and traces, until a step is small.

    Returns
    -------
    K, X : ndarray
    errors : ndarray
        Relative size of the step that is left.
    """
    K, X, trace = K.copy(), X.copy(), trace.copy()
    errors, left = np.full(len(K), np.inf), np.arange(len(K))
    for _ in range(_STEPS):
        steps, slopes, sizes = _steps(plants[left], K[left], X[left], trace[left])
        # Close to the optimum a step squares its error, until rounding alone is left.
        goes_on = (sizes > finished) & ((sizes > _CLOSE) | (sizes < 0.5 * errors[left]))
        errors[left] = sizes
        left = left[goes_on]
        if not len(left):
            break
        steps, slopes, sizes = steps[goes_on], slopes[goes_on], sizes[goes_on]
        begin, before, tried = K[left], trace[left], np.arange(len(left))
        for halvings in range(_HALVINGS):
            share, now = 0.5**halvings, left[tried]
            K[now] = begin[tried] + share * steps[tried]
            X[now], trace[now] = covariances(plants[now], K[now])
            # What a full step near the optimum gains is less than the rounding of the trace.
            enough = np.where(
                sizes[tried] < _CLOSE,
                np.isfinite(trace[now]),
                trace[now] <= before[tried] + 1e-4 * share * slopes[tried],
            )
            tried = tried[~enough]
            if not len(tried):
                break
    return K, X, np.where(np.isfinite(trace), errors, np.inf)
