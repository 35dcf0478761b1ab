"""What may come out of a program: each outcome says what was proved, and none rests on a solver's status."""

from dataclasses import dataclass
from typing import Any, Never, Self

import numpy as np

from gainsay.errors import ComputationError
from gainsay.lmi.program import Check


class _NotFound:
    """An outcome that is no point and no infimum."""

    attempts: tuple[dict, ...]

    @property
    def excluded(self) -> bool:
        """Whether it is proved that no point exists."""
        return False

    def need(self, where: str) -> Never:
        """Raise `ComputationError` with the attempts: something was to be found here; `where` is the equation."""
        reason = getattr(self, "reason", type(self).__name__.lower())
        raise ComputationError(where, f"{reason} after {len(self.attempts)} attempts", self.attempts)


@dataclass(frozen=True)
class Farkas:
    """Multipliers Z_j >= 0 under which the weighted sum of all blocks is free of unknowns and not positive.

    Attributes
    ----------
    multipliers : dict
        Label of each constraint to its multiplier, in unscaled coordinates, of trace about one altogether in scaled
        ones. Floats beside exact multipliers that are proved to exist.
    value : float
        Upper bound on the sum of <constant part, Z_j> of the exact ones, scaled coordinates. Below zero it refutes all
        programs; zero refutes strict inequalities, one of which carries weight.
    distance : float
        Bound on the distance of the floats to the exact multipliers, scaled coordinates (0 where they are the same).
    reason : str
        How existence was proved.
    """

    multipliers: dict[str, np.ndarray]
    value: float
    distance: float
    reason: str


@dataclass(frozen=True)
class Solved:
    """A point at which every constraint is proved to hold, its floats and the data taken as exact numbers.

    Attributes
    ----------
    values : dict
        Name of each unknown to its matrix, or number. Where the program has equalities, the point proved is an exact
        solution of them within rounding of these floats.
    objective : float
        Objective there (an upper bound on the infimum; see `infimum`).
    check : Check
        Margins and blocks.
    gap : float
        Difference of the solver's primal and dual objective, relative; for the record, not a bound.
    attempts : tuple of dict
        What was tried: solver, scaling, status, margin, iterations, seconds.
    """

    values: dict[str, Any]
    objective: float
    check: Check
    gap: float
    attempts: tuple[dict, ...]

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    def need(self, where: str) -> Self:
        """Return the point; other outcomes raise `ComputationError`, naming the equation `where`."""
        return self

    @property
    def margins(self) -> dict[str, float]:
        """Margin of each constraint."""
        return self.check.margins


@dataclass(frozen=True)
class Infeasible(_NotFound):
    """No point, proved: by multipliers that exist exactly, or by what `reason` in `farkas` says.

    All coefficients are taken as exact numbers, but for inequalities of Lyapunov, of Stein and of a region, in any P,
    of one matrix, whose rounded sums are taken as what they round (the reason says so).
    """

    farkas: Farkas
    attempts: tuple[dict, ...]

    @property
    def excluded(self) -> bool:
        """Whether it is proved that no point exists: it is."""
        return True


@dataclass(frozen=True)
class Unbounded(_NotFound):
    """The objective falls without end: along `ray` from the point `solved`, both proved.

    Attributes
    ----------
    ray : dict
        Direction by name of the unknowns: every constraint keeps holding along it, and the objective falls.
    solved : Solved
        A point inside.
    attempts : tuple of dict
    """

    ray: dict[str, Any]
    solved: Solved
    attempts: tuple[dict, ...]


@dataclass(frozen=True)
class Undecided(_NotFound):
    """Neither a point, nor multipliers of the program itself that exclude it.

    Attributes
    ----------
    label : str
    attempts : tuple of dict
    reason : str
    faces : tuple of Farkas
        Empty where nothing is known of the program. Else no point exists: exact multipliers of value zero confine the
        points to a face, each of the program on the face before, and the last exclude what is left. So it is with a
        weakly infeasible program, of which blocks come as near to holding as one likes: the least change of a number
        may give it a point, and one of its own does not refute it.
    """

    label: str
    attempts: tuple[dict, ...]
    reason: str = "neither a point nor multipliers"
    faces: tuple[Farkas, ...] = ()

    @property
    def excluded(self) -> bool:
        """Whether it is proved that no point exists."""
        return bool(self.faces)


@dataclass(frozen=True)
class Infimum:
    """Enclosure of an infimum: a proved point above, proved multipliers below.

    Attributes
    ----------
    value : float
        The objective at `values`; the middle of the enclosure where that lies outside it; nan where the two sides do
        not enclose it to a tenth of the size of the objective.
    lower, upper : float
        Proved bounds from multipliers (-inf where there are none) and from a point.
    values : dict
        Point of the solver without margin (on the boundary: limits of what strict points approach).
    solved : Solved
        The point behind `upper`.
    multipliers : dict
        The multipliers behind `lower`, by label of the constraint; empty where none passed their check.
    attempts : tuple of dict
    """

    value: float
    lower: float
    upper: float
    values: dict[str, Any]
    solved: Solved
    multipliers: dict[str, np.ndarray]
    attempts: tuple[dict, ...]

    def need(self, where: str) -> Self:
        """Return the infimum; other outcomes raise `ComputationError`, naming the equation `where`."""
        return self

    @property
    def bound(self) -> float:
        """The value where it is enclosed, else the proved upper end."""
        return self.value if np.isfinite(self.value) else self.upper

    @property
    def width(self) -> float:
        """Width of the enclosure relative to the value; absolute where that is zero."""
        size = abs(self.value) if np.isfinite(self.value) else max(abs(self.lower), abs(self.upper))
        return (self.upper - self.lower) / (size or 1.0) if np.isfinite(self.lower) else np.inf


Outcome = Solved | Infeasible | Unbounded | Undecided
