"""The past of delayed signals carried by Chebyshev collocation: a finite-dimensional stand-in for delay lines.

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


def finite_system(system: DelaySystem, delay: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Finite-dimensional (A, B, C) that replaces each delay line by collocation at Chebyshev points of its own.

    A signal whose delay is far below every time constant of the loop is taken undelayed.

    Parameters
    ----------
    system : DelaySystem
    delay : ndarray, shape (r,)
        Of each delayed signal, s.
    nodes : int
        Collocation degree N.

    Returns
    -------
    A, B, C : ndarray
        Shapes (n + q N, n + q N), (n + q N, m), (p, n + q N) for q signals that are delayed.
    """
    n = system.order
    fastest = np.linalg.norm(system.A, 2) + np.linalg.norm(system.Bd, 2) * np.linalg.norm(system.Cd, 2)
    late = delay * fastest >= 1e-12
    q, rates = int(late.sum()), 2 / delay[late]
    _, D = chebyshev(nodes)
    size = n + q * nodes
    A = np.zeros((size, size))
    A[:n, :n] = system.A + system.delayed(~late).astype(float)
    A[:n, size - q :] = system.Bd[:, late]
    A[n:, :n] = np.kron(D[1:, :1], rates[:, None] * system.Cd[late])
    A[n:, n:] = np.kron(D[1:, 1:], np.diag(rates))
    B = np.vstack([system.B, np.zeros((q * nodes, system.B.shape[1]))])
    C = np.hstack([system.C, np.zeros((system.C.shape[0], q * nodes))])
    return A, B, C
