"""The past of a delayed signal carried by Chebyshev collocation: a finite-dimensional stand-in for a delay line.

References
----------
D. Breda, S. Maset, R. Vermiglio, Pseudospectral differencing methods for characteristic roots of delay differential
equations, SIAM J. Sci. Comput. 27 (2005) 482-495.
"""

import numpy as np

from gainsay.systems.delay import DelaySystem


def chebyshev(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Chebyshev extreme points on [-1, 1] from 1 down to -1 and their differentiation matrix.

    Parameters
    ----------
    nodes : int
        Degree N; N + 1 points.

    Returns
    -------
    x : ndarray, shape (N + 1,)
    D : ndarray, shape (N + 1, N + 1)
        Trefethen, Spectral Methods in MATLAB, chapter 6.
    """
    k = np.arange(nodes + 1)
    x = np.cos(np.pi * k / nodes)
    weight = np.where((k == 0) | (k == nodes), 2.0, 1.0) * (-1.0) ** k
    difference = x[:, None] - x[None, :] + np.eye(nodes + 1)
    D = np.outer(weight, 1 / weight) / difference
    return x, D - np.diag(D.sum(axis=1))


def discretised(system: DelaySystem, delay: float, nodes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Finite-dimensional (A, B, C) that replaces the delay line by collocation at Chebyshev points.

    Parameters
    ----------
    system : DelaySystem
    delay : float
        s, positive.
    nodes : int
        Collocation degree.

    Returns
    -------
    A, B, C : ndarray
        Shapes (n + r N, n + r N), (n + r N, m), (p, n + r N).
    """
    n, r = system.order, system.Bd.shape[1]
    _, D = chebyshev(nodes)
    D = D * (2 / delay)
    size = n + r * nodes
    A = np.zeros((size, size))
    A[:n, :n] = system.A
    A[:n, size - r :] = system.Bd
    A[n:, :n] = np.kron(D[1:, :1], system.Cd)
    A[n:, n:] = np.kron(D[1:, 1:], np.eye(r))
    B = np.vstack([system.B, np.zeros((r * nodes, system.B.shape[1]))])
    C = np.hstack([system.C, np.zeros((system.C.shape[0], r * nodes))])
    return A, B, C


def finite_system(system: DelaySystem, delay: float, nodes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Collocated (A, B, C); the undelayed ones where the delay is far below every time constant of the loop."""
    if delay * (np.linalg.norm(system.A, 2) + np.linalg.norm(system.A1, 2)) < 1e-12:
        return system.A + system.A1, system.B, system.C
    return discretised(system, delay, nodes)
