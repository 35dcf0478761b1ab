"""Bounds on the structured singular value for real and complex, repeated and full blocks.

Theorem (Fan, Tits, Doyle): let D > 0 and G be Hermitian, block diagonal, D commuting with every perturbation of the
structure, G with the real repeated ones and zero beside the others. If

    beta^2 D - M* D M - i (G M - M* G) > 0,

then I - M Delta is regular for every Delta of the structure with |Delta| <= 1/beta: were w = Delta M w, w != 0, then
w* G M w would be real and w* M* D M w >= beta^2 w* D w, so that w* (...) w <= 0.

References
----------
M. K. H. Fan, A. L. Tits, J. C. Doyle, "Robustness in the presence of mixed parametric uncertainty and unmodeled
dynamics", IEEE Trans. Automatic Control 36 (1991) 25-38.
P. M. Young, M. P. Newlin, J. C. Doyle, "Practical computation of the mixed mu problem", American Control Conference
1992, 2190-2194.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, get_args

import numpy as np
from flint import acb, acb_mat, arb, ctx
from numpy.typing import ArrayLike
from scipy.linalg import block_diag, matrix_balance
from scipy.optimize import minimize

from gainsay.errors import ComputationError, InputError
from gainsay.exact.definite import hermitian_positive_definite
from gainsay.exact.floats import real_number
from gainsay.lmi import Affine, Program, Solved, affine, equal, scalar, solve, sym, symmetric, trace
from gainsay.systems.margins import uncertain_matrix

Kind = Literal["real", "complex", "full"]
#: directions in which a small perturbation is sought, and of these the best from which a search begins
_DIRECTIONS, _STARTS = 32, 12
#: divisions by the largest eigenvalue of M Delta that turn it towards one
_TURNS = 8
#: upper ends below this part of the norm are not looked for
_SMALLEST = 1e-6
#: eigenvalues of M Delta below this part of the numbers in Delta pass for zero
_ZERO = 1e-13
#: least singular value of I - M Delta that passes for zero
_SINGULAR = 1e-9


@dataclass(frozen=True)
class Block:
    """A block of the perturbation.

    Parameters
    ----------
    kind : str
        "real" or "complex", a number times the unit matrix, or "full", any complex matrix.
    size : int
        Rows, and columns.

    Raises
    ------
    InputError
        If the kind is unknown or the size no positive whole number.
    """

    kind: Kind
    size: int = 1

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise InputError("block", field="kind", value=self.kind, expected=" | ".join(get_args(Kind)))
        if type(self.size) is not int or self.size < 1:
            raise InputError("block", field="size", value=self.size, expected="a whole number, at least 1")


@dataclass(frozen=True, eq=False)
class MixedBounds:
    """Bounds on the structured singular value.

    Attributes
    ----------
    lower : float
        1 / |Delta| of the perturbation found; 0 where none was. The value is at least that for a matrix that differs
        from M by rounding, not more than 1e-9 of its norm when rows and columns are balanced.
    upper : float
        Proved by D and G.
    perturbation : ndarray, shape (n, n), complex
        Delta of the structure for which I - M Delta is singular to rounding; nan where none was found.
    D, G : ndarray, shape (n, n), complex
        The Hermitian scalings of the theorem at `upper`.
    """

    lower: float
    upper: float
    perturbation: np.ndarray
    D: np.ndarray
    G: np.ndarray


def mixed_bounds(M: ArrayLike, blocks: Sequence[Block], *, tolerance: float = 1e-4) -> MixedBounds:
    """Bounds on the structured singular value of a matrix for blocks of any kind.

    For full complex blocks alone `gainsay.systems.margins.structured_bounds` is quicker.

    Parameters
    ----------
    M : array_like, shape (n, n)
        Complex.
    blocks : sequence of Block
        Down the diagonal; their sizes add up to n.
    tolerance : float
        The search for the upper end stops this part above a level for which no scalings were found, or at 1e-6 of the
        norm of M when rows and columns are balanced.

    Returns
    -------
    MixedBounds
        With one block `upper` tends to the value itself, with many it may stay above. `lower` is the best of a search.

    Raises
    ------
    InputError
        If the matrix is not square and finite, the blocks do not add up, or the tolerance is not between 0 and 1.
    ComputationError
        If no upper end is proved.

    Examples
    --------
    >>> rotation = [[0, 1], [-1, 0]]  # eigenvalues i and -i
    >>> mixed_bounds(rotation, [Block("real", 2)]).upper < 1e-5  # no real number times the unit matrix
    True
    >>> round(mixed_bounds(rotation, [Block("complex", 2)]).upper, 3)
    1.0
    """
    matrix = _checked(M, blocks)
    if not 0 < real_number(tolerance, "tolerance") < 1:
        raise InputError("", field="tolerance", value=tolerance, expected="between 0 and 1")
    if not matrix.any():
        return MixedBounds(0.0, 0.0, np.full_like(matrix, np.nan), np.eye(len(matrix), dtype=complex), 0 * matrix)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        unit, T, scaled = _balanced(matrix, blocks)
        enough = float(np.linalg.norm(scaled, 2)) * (1 - tolerance)
        lower, perturbation = _Search(scaled, blocks).smallest(enough)
        level, D, G = _least_level(scaled, blocks, lower, tolerance)
        upper, both = float(np.nextafter(unit * level, np.inf)), np.outer(T, T)
        bounds = MixedBounds(unit * lower, upper, perturbation / unit, both * D, unit * both * G)
    if np.isinf(bounds.perturbation).any() or not _proved(matrix, bounds.upper, bounds.D, bounds.G):
        raise ComputationError("structured singular value", f"no proof of the upper end {upper!r} in double precision")
    return bounds


def _checked(M: ArrayLike, blocks: Sequence[Block]) -> np.ndarray:
    """The matrix in complex doubles, if the blocks fit it."""
    matrix = uncertain_matrix(M)
    known = isinstance(blocks, Sequence) and all(isinstance(block, Block) for block in blocks)
    if not known or sum(block.size for block in blocks) != len(matrix):
        raise InputError("blocks", value=blocks, expected=f"Blocks whose sizes add up to {len(matrix)}")
    return matrix


def _places(blocks: Sequence[Block]) -> list[slice]:
    return [slice(a, b) for a, b in pairwise(np.cumsum([0, *(block.size for block in blocks)]).tolist())]


def _balanced(M: np.ndarray, blocks: Sequence[Block]) -> tuple[float, np.ndarray, np.ndarray]:
    """Powers of two u and T, one a block, and T M T^-1 / u, which is balanced and of about unit norm.

    T commutes with the perturbations: the structured singular value stays but for u, D becomes T D T, and so does G.
    """
    places, largest = _places(blocks), _power(float(np.abs(M).max()))
    sizes = [[float(np.abs(M[rows, columns] / largest).max()) for columns in places] for rows in places]
    if np.isfinite(sizes).all():
        _, (inverse, _) = matrix_balance(sizes, permute=False, separate=True)
        T = np.repeat(1 / inverse, [block.size for block in blocks])
        scaled = M / largest * T[:, None] / T[None, :]
        if np.isfinite(scaled).all() and scaled.any():
            rest = _power(float(np.linalg.norm(scaled, 2)))
            return largest * rest, T, scaled / rest
    raise ComputationError("structured singular value", "entries too far apart for double precision")


def _power(x: float) -> float:
    """The power of two at or below a positive number."""
    return float(2.0 ** (np.frexp(x)[1] - 1))


# --- the upper end


def _least_level(
    M: np.ndarray, blocks: Sequence[Block], lower: float, tolerance: float
) -> tuple[float, np.ndarray, np.ndarray]:
    """The least proved level found between a lower bound and the norm, with its scalings."""
    high = float(np.linalg.norm(M, 2)) * (1 + 1e-9)
    best = (high, np.eye(len(M), dtype=complex), np.zeros_like(M))
    if not _proved(M, *best):
        raise ComputationError("structured singular value", f"no proof of the norm {high!r}")
    low = max(lower, _SMALLEST * high)
    level = low * (1 + 0.9 * tolerance)  # often the two ends meet
    while best[0] > low * (1 + tolerance):
        scalings = _scalings(M, blocks, level)
        if scalings is not None and _proved(M, level, *scalings):
            best = (level, *scalings)
        else:
            low = level
        level = float(np.sqrt(low * best[0]))
    return best


def _scalings(M: np.ndarray, blocks: Sequence[Block], level: float) -> tuple[np.ndarray, np.ndarray] | None:
    """D and G of the theorem at a level, by rounded numbers, as real matrices of twice the size."""
    D, G = affine(np.zeros((2 * len(M),) * 2)), affine(np.zeros((2 * len(M),) * 2))
    for number, (block, place) in enumerate(zip(blocks, _places(blocks), strict=True)):
        if block.kind == "full":
            one = np.diag([float(place.start <= i < place.stop) for i in range(len(M))])
            D = D + scalar(f"d{number}") * _real(one)
        else:
            D = D + _hermitian(f"D{number}", place, len(M))
        if block.kind == "real":
            G = G + _hermitian(f"G{number}", place, len(M))
    m, turn = _real(M), _real(1j * np.eye(len(M)))
    form = level**2 * D - m.T @ D @ m - sym(turn @ G @ m)
    # Homogeneous in D and G: of size one in D, as far inside as can be.
    margin, unit = scalar("margin"), np.eye(2 * len(M))
    held = [form - margin * unit >= 0, D - margin * unit >= 0, equal(trace(D), float(len(M)), "size")]
    outcome = solve(Program(minimise=-margin, subject_to=held, label="scalings of a structured singular value"))
    if not isinstance(outcome, Solved):
        return None
    return _complex(D.value(outcome.values)), _complex(G.value(outcome.values))


def _real(M: np.ndarray) -> np.ndarray:
    """The real matrix [[Re, -Im], [Im, Re]]: sums, products and adjoints become those of real matrices."""
    return np.block([[M.real, -M.imag], [M.imag, M.real]])


def _complex(M: np.ndarray) -> np.ndarray:
    """The Hermitian matrix of which this is the real one."""
    n = len(M) // 2
    whole = M[:n, :n] + 1j * M[n:, :n]
    return (whole + whole.conj().T) / 2


def _hermitian(name: str, place: slice, n: int) -> Affine:
    """Unknown Hermitian matrix on a diagonal block of an n x n matrix, as a real one."""
    real, imaginary = np.eye(2 * n)[:, :n][:, place], np.eye(2 * n)[:, n:][:, place]
    size = place.stop - place.start
    H = symmetric(name, size) if size > 1 else scalar(name)
    total = affine(np.zeros((2 * n, 2 * n)))
    for E in (real, imaginary):
        total = total + (E @ H @ E.T if size > 1 else H * (E @ E.T))
    for i in range(size):
        for j in range(i):
            skew = np.outer(real[:, i], imaginary[:, j]) - np.outer(real[:, j], imaginary[:, i])
            total = total + scalar(f"{name} skew {i} {j}") * (skew + skew.T)
    return total


def _proved(M: np.ndarray, level: float, D: np.ndarray, G: np.ndarray) -> bool:
    """Prove the two inequalities of the theorem in balls, D and G taken as the doubles that they are."""
    with ctx.workprec(256):
        m, d, g = (_balls(matrix) for matrix in (M, D, G))
        adjoint = m.conjugate().transpose()
        form = d * acb(arb(level) ** 2) - adjoint * d * m - (g * m - adjoint * g) * acb(0, 1)
        return hermitian_positive_definite(d) and hermitian_positive_definite(form)


def _balls(M: np.ndarray) -> acb_mat:
    return acb_mat([[acb(float(x.real), float(x.imag)) for x in row] for row in M])


# --- the lower end


class _Search:
    """A small perturbation that makes I - M Delta singular.

    Numbers p describe a perturbation: one for a real block, two for a complex one, and two vectors for a full one,
    whose worst perturbations are of rank one. Directions are stretched until an eigenvalue of M Delta is one; from the
    best of them the largest norm t among the blocks is made small under det(I - M Delta) = 0.
    """

    def __init__(self, M: np.ndarray, blocks: Sequence[Block]) -> None:
        self.M, self.unit = M, np.eye(len(M))
        parts = [{"real": 1, "complex": 2, "full": 4 * block.size}[block.kind] for block in blocks]
        pieces = [slice(a, b) for a, b in pairwise(np.cumsum([0, *parts]).tolist())]
        self.count, self.blocks = sum(parts), list(zip(blocks, pieces, strict=True))
        # the determinant is real then: an equation 0 = 0 would leave the search without a direction
        self.real = not M.imag.any() and all(block.kind == "real" for block in blocks)
        self.best, self.perturbation = 0.0, np.full_like(M, np.nan)

    def smallest(self, enough: float) -> tuple[float, np.ndarray]:
        """1 over the norm of the perturbation, and itself; the search ends where that is enough."""
        source = np.random.default_rng(0)
        starts = []
        for direction in source.normal(size=(_DIRECTIONS, self.count)):
            for start in (self._stretched(direction), self._turned(direction)):
                starts.append((self._kept(start), start))
        for _, start in sorted(starts, key=lambda pair: -pair[0])[:_STARTS]:
            if self.best >= enough:
                break
            self._kept(self._shrunk(start))
        return self.best, self.perturbation

    def _delta(self, p: np.ndarray) -> np.ndarray:
        return block_diag(*(_matrix(block, p[piece]) for block, piece in self.blocks))

    def _squares(self, p: np.ndarray) -> np.ndarray:
        """Squares of the norms of the blocks."""
        return np.array([_square(block, p[piece]) for block, piece in self.blocks])

    def _kept(self, p: np.ndarray) -> float:
        """1 over the norm of a perturbation that does it, which is remembered where it is the best; 0 of any other."""
        Delta = self._delta(p)
        product = self.M @ Delta
        size = float(np.linalg.norm(Delta, 2)) if np.isfinite(product).all() else 0.0
        if size == 0 or np.linalg.svd(self.unit - product, compute_uv=False)[-1] > _SINGULAR:
            return 0.0
        if 1 / size > self.best:
            self.best, self.perturbation = 1 / size, Delta
        return 1 / size

    def _stretched(self, p: np.ndarray) -> np.ndarray:
        """The same direction at a length where I - M Delta is singular, if it has one."""
        values = np.linalg.eigvals(self.M @ self._delta(p))
        return self._over(p, values[np.abs(values.imag) <= 1e-12 * np.abs(values)].real)

    def _turned(self, p: np.ndarray) -> np.ndarray:
        """A perturbation where I - M Delta is nearly singular: complex blocks are turned too, until that settles."""
        for _ in range(_TURNS):
            p = self._over(p, np.linalg.eigvals(self.M @ self._delta(p)))
        return p

    def _over(self, p: np.ndarray, values: np.ndarray) -> np.ndarray:
        """The perturbation divided by the largest of some values; real blocks by its modulus and sign."""
        if not len(values) or np.abs(values).max() <= _ZERO * np.abs(p).max():
            return p
        value = complex(values[np.argmax(np.abs(values))])
        return np.concatenate([_divided(block, p[piece], value) for block, piece in self.blocks])

    def _shrunk(self, p: np.ndarray) -> np.ndarray:
        """A perturbation near by of locally least norm, if the solver is right; `_kept` looks."""

        def determinant(q: np.ndarray) -> np.ndarray:
            value = np.linalg.det(self.unit - self.M @ self._delta(q[:-1]))
            return np.array([value.real] if self.real else [value.real, value.imag])

        def room(q: np.ndarray) -> np.ndarray:
            return q[-1] ** 2 - self._squares(q[:-1])

        start = np.append(p, np.sqrt(self._squares(p).max()))
        held = [{"type": "eq", "fun": determinant}, {"type": "ineq", "fun": room}]
        with np.errstate(all="ignore"):
            options = {"maxiter": 100, "ftol": 1e-13}
            return minimize(lambda q: q[-1], start, method="SLSQP", constraints=held, options=options).x[:-1]


def _matrix(block: Block, p: np.ndarray) -> np.ndarray:
    if block.kind == "full":
        left, right = (half[: block.size] + 1j * half[block.size :] for half in np.split(p, 2))
        return np.outer(left, right.conj())
    return (p[0] if block.kind == "real" else p[0] + 1j * p[1]) * np.eye(block.size)


def _square(block: Block, p: np.ndarray) -> float:
    """Square of the norm of a block."""
    if block.kind == "full":
        left, right = np.split(p, 2)
        return float(left @ left) * float(right @ right)
    return float(p @ p)


def _divided(block: Block, p: np.ndarray, value: complex) -> np.ndarray:
    """Numbers of the block divided by a complex value, of which a real block takes modulus and sign."""
    if block.kind == "real":
        return p / np.copysign(abs(value), value.real)
    turned, rest = (p, p[:0]) if block.kind == "complex" else np.split(p, 2)
    half = len(turned) // 2
    quotient = (turned[:half] + 1j * turned[half:]) / value
    return np.concatenate([quotient.real, quotient.imag, rest])
