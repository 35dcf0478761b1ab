"""A plant whose matrices hold uncertain numbers of a box: its corners, samples and hull, and proofs over all of it.

The matrices are formulas over the tables and the uncertain numbers, affine in each of these, the others held; products
of different ones are allowed. So a moment of inertia that multiplies and divides stands in the box twice, as itself and
as the inverse of itself, each in its own range: a box that holds every plant, and some that are none. Then each matrix
is everywhere in the box a convex combination of what it is at the corners, so that one Lyapunov matrix for these proves
the whole box, for numbers that vary with time as well. The checker makes the corners itself, from the formulas and the
ends of the ranges.

Reference
---------
S. Boyd, L. El Ghaoui, E. Feron, V. Balakrishnan, Linear Matrix Inequalities in System and Control Theory, SIAM 1994,
chapter 5.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from gainsay.errors import InputError, one_of
from gainsay.exact.rational import exact, to_text
from gainsay.lmi import BlockMatrix, Definite, Program, Solved, solve, sym, symmetric
from gainsay.proof import Certificate, build
from gainsay.statements.floats import Floats

__all__ = ["UncertainPlant"]

#: least margin of one Lyapunov matrix over a box, so that it survives rounding
_ROOM = 1e-5


@dataclass(frozen=True)
class UncertainPlant:
    """Matrices as formulas in uncertain numbers, each of a range.

    Attributes
    ----------
    case : gainsay.tables.Case
    definitions : mapping of str to str
        Formulas by name, in order, over the tables and the uncertain numbers.
    ranges : mapping of str to (str, str)
        Formulas over the tables, the least and the greatest value of each uncertain number.

    Raises
    ------
    InputError
        If there is no uncertain number, or a least value above the greatest.
    CertificateError
        If an end is no exact number over the tables.

    Examples
    --------
    A mass of 2 kg within 10 % on a spring of 5 to 6 N/m, damped by 3 N s/m; 1/m is the uncertain number:

    >>> from gainsay.proof.scope import MappingTables
    >>> plant = UncertainPlant(
    ...     MappingTables(numbers={"mass": 2}),
    ...     {"A": "[[0, 1], [-k*per_mass, -3*per_mass]]"},
    ...     {"per_mass": ("1/(1.1*number('mass'))", "1/(0.9*number('mass'))"), "k": ("5", "6")},
    ... )
    >>> plant.at("A", per_mass="1/2", k=5)
    array([[ 0. ,  1. ],
           [-2.5, -1.5]])
    >>> low, high = plant.hull("A")
    >>> [round(float(x), 3) for x in (low[1][0], high[1][0])]
    [-3.333, -2.273]
    >>> proof = plant.left_of("A", ["-0.4", "-0.3"], id="decay", statement="The spring settles.")
    >>> [(c.of, c.relation, c.value) for c in proof.conclusions]
    [('abscissa', 'less_than', '-0.4'), ('stable', 'holds', None)]
    """

    case: Any
    definitions: Mapping[str, str]
    ranges: Mapping[str, tuple[str, str]]

    def __post_init__(self) -> None:
        if not self.ranges:
            raise InputError("uncertain plant", field="ranges", value="nothing", expected="an uncertain number")
        for name, (low, high) in self.ends.items():
            if low > high:
                raise InputError("uncertain plant", field=name, value=f"{low}..{high}", expected="low <= high")

    @cached_property
    def ends(self) -> dict[str, tuple[Fraction, Fraction]]:
        """Least and greatest value of each uncertain number, exact."""
        tables = Floats(self.case, {}, {})
        pairs = {name: (tables.exact(low), tables.exact(high)) for name, (low, high) in self.ranges.items()}
        return {name: (low.value(), high.value()) for name, (low, high) in pairs.items()}

    @cached_property
    def corners(self) -> tuple[dict[str, Fraction], ...]:
        """Exact values of the uncertain numbers at each corner, those of the last one changing first."""
        return tuple(dict(zip(self.ends, point, strict=True)) for point in product(*self.ends.values()))

    def _floats(self, point: Mapping[str, object]) -> Floats:
        if set(point) != set(self.ranges):
            unknown = next((name for name in point if name not in self.ranges), "")
            expected = one_of(unknown, self.ranges) if unknown else f"a value of each of {', '.join(self.ranges)}"
            raise InputError("uncertain plant", value=unknown or list(point), expected=expected)
        values = {name: to_text(exact(value)) for name, value in point.items()}
        return Floats(self.case, {**values, **self.definitions}, {})

    def at(self, matrix: str, **point: object) -> np.ndarray:
        """Doubles nearest to a formula at one point, which need not be in the box.

        Parameters
        ----------
        matrix : str
            Formula.
        **point
            An exact number, a decimal as text or a float for each uncertain number.

        Raises
        ------
        InputError
            If an uncertain number has no value, or a value has no uncertain number.
        """
        return self._floats(point).constant(matrix)

    def at_corners(self, matrix: str) -> np.ndarray:
        """Doubles nearest to a formula at every corner, shape (2^k, m, n)."""
        return np.array([self._floats(corner).constant(matrix) for corner in self.corners])

    def samples(self, matrix: str, count: int, seed: int) -> np.ndarray:
        """Doubles nearest to a formula at points drawn evenly from the box, shape (count, m, n)."""
        generator = np.random.default_rng(seed)
        low, high = np.array([[float(end) for end in pair] for pair in self.ends.values()]).T
        points = low + (high - low) * generator.random((count, len(low)))
        return np.array([self.at(matrix, **dict(zip(self.ends, point, strict=True))) for point in points])

    def hull(self, matrix: str) -> tuple[list[list[Fraction]], list[list[Fraction]]]:
        """Exact least and greatest value of every entry over the box, as rows of fractions: both stand at corners."""
        values = [self._floats(corner).exact(matrix) for corner in self.corners]
        m, n = values[0].shape
        entries = [[[value.take([i], [j]).value() for value in values] for j in range(n)] for i in range(m)]
        return [[min(x) for x in row] for row in entries], [[max(x) for x in row] for row in entries]

    def left_of(self, matrix: str, alphas: Sequence[str], **parts: Any) -> Certificate:
        """Certify by one Lyapunov matrix that all eigenvalues lie left of alpha everywhere in the box.

        Parameters
        ----------
        matrix : str
            Formula of a square matrix.
        alphas : sequence of str
            Formulas over the tables, 1/s, the strictest first: the first that one matrix can prove is certified.
        **parts
            id, statement, quantities (of ``abscissa``, ``stable``), faith: as for `gainsay.proof.build.certificate`.

        Raises
        ------
        InputError
            If there is no alpha.
        ComputationError
            If no Lyapunov matrix is found for the last alpha.
        CertificateError
            If the proof is not accepted: the matrix is not affine in each uncertain number.
        """
        vertices = self.at_corners(matrix)

        def decay(P: Any, alpha: float) -> list[Definite]:
            return [sym(P @ A) - 2 * alpha * P < 0 for A in vertices]

        alpha, P = self._first(alphas, len(vertices[0]), decay)
        return self._certificate("lyapunov", {"matrix": matrix, "alpha": alpha}, P, parts)

    def in_disk(self, matrix: str, centre: str, radii: Sequence[str], **parts: Any) -> Certificate:
        """Certify by one Lyapunov matrix that |s + centre| < radius for all eigenvalues s everywhere in the box.

        Parameters and errors as for `left_of`, centre and radii in 1/s; a quantity of ``radius``.
        """
        (shift,) = Floats(self.case, {}, {}).constant(centre).ravel()
        vertices = self.at_corners(matrix)
        moved = vertices + shift * np.eye(vertices.shape[1])

        def within(P: Any, radius: float) -> list[Definite]:
            return [A.T @ P @ A - radius**2 * P < 0 for A in moved]

        radius, P = self._first(radii, len(moved[0]), within)
        return self._certificate("stein", {"matrix": matrix, "shift": centre, "radius": radius}, P, parts)

    def norm_below(self, system: Mapping[str, str], gammas: Sequence[str], **parts: Any) -> Certificate:
        """Certify by one Lyapunov matrix that the L2 gain is below gamma everywhere in the box.

        Parameters and errors as for `left_of`, the system as formulas of ``A``, ``B``, ``C`` and, where it is not zero,
        ``D``; quantities of ``norm``, ``stable``.
        """
        A, B, C, *D = (self.at_corners(system[name]) for name in "ABCD" if name in system)
        D = D or [np.zeros((len(A), C.shape[1], B.shape[2]))]

        def bounded(P: Any, gamma: float) -> Iterator[Definite]:
            for a, b, c, d in zip(A, B, C, *D, strict=True):
                F = BlockMatrix("bounded real lemma", "x", "w")
                F["x", "x"], F["x", "w"] = sym(P @ a) + c.T @ c, P @ b + c.T @ d
                F["w", "w"] = d.T @ d - gamma**2 * np.eye(b.shape[1])
                yield F < 0

        gamma, P = self._first(gammas, A.shape[1], bounded)
        return self._certificate("bounded_real", {**system, "gamma": gamma}, P, parts)

    def _first(
        self, levels: Sequence[str], size: int, inequalities: Callable[[Any, float], Iterable[Definite]]
    ) -> tuple[str, np.ndarray]:
        """The first level for which one P > 0 meets the inequalities, and that P."""
        if not levels:
            raise InputError("uncertain plant", field="levels", value="none", expected="at least one to prove")
        label = f"one Lyapunov matrix for {len(self.corners)} corners"
        for level in levels:
            P = symmetric("P", size)
            (value,) = Floats(self.case, {}, {}).constant(level).ravel()
            outcome = solve(Program(subject_to=[*inequalities(P, float(value)), P > 0], label=label, margin=_ROOM))
            if isinstance(outcome, Solved):
                break
        return level, outcome.need(label)["P"]

    def _certificate(
        self, kind: str, fields: Mapping[str, str], P: np.ndarray, parts: Mapping[str, Any]
    ) -> Certificate:
        return build.certificate(
            kind,
            tables=self.case,
            definitions=self.definitions,
            fields={**fields, "ranges": [[name, *pair] for name, pair in self.ranges.items()]},
            witness={"P": P},
            **parts,
        )
