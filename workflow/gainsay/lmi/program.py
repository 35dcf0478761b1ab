"""A semidefinite program as stated, its coordinates, and the check of a point in plain numpy."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from gainsay.errors import InputError
from gainsay.exact.floats import real_number
from gainsay.lmi.affine import Affine, Constraint, Definite, Entrywise, Equal, Values, Variable, affine


class Scale:
    """Typical sizes of unknowns, by name; what is left out is found from the coefficients and from a first solution.

    Parameters
    ----------
    **typical
        A number (size of every entry), a vector t (entries of a symmetric unknown are about t_i t_j; entries of a
        diagonal one t_i) or a pair (rows, columns) of vectors (entries are about rows_i columns_j).
    """

    def __init__(self, **typical: Any) -> None:
        self.typical = typical

    def __repr__(self) -> str:
        return f"Scale({', '.join(self.typical)})"


@dataclass(frozen=True)
class Row:
    """One constraint in coordinates: ``constant + tensor @ x``, an n x n matrix or a list of n entries."""

    constraint: Constraint
    constant: np.ndarray
    tensor: np.ndarray

    @property
    def is_matrix(self) -> bool:
        """Whether the constraint is a matrix inequality."""
        return isinstance(self.constraint, Definite)

    @property
    def size(self) -> int:
        """Rows of the matrix, or number of entries."""
        return self.constant.shape[0]

    def value(self, x: np.ndarray) -> np.ndarray:
        """Matrix or entries at coordinates x."""
        return self.constant + self.tensor @ x

    def extent(self, x: np.ndarray) -> np.ndarray:
        """Absolute sizes that the diagonal or the entries are summed of: margins are relative to these."""
        constant, tensor = self.constant, self.tensor
        if isinstance(self.constraint, Equal):  # homogeneous ones hold at zeros: relative to the sizes around them
            x = np.full(len(x), np.abs(x).max(initial=0.0))
        if self.is_matrix:
            constant, tensor = np.diagonal(constant), np.einsum("iik->ik", tensor)
        extent = np.abs(constant) + np.abs(tensor) @ np.abs(x)
        return np.where(extent > 0, extent, max(extent.max(initial=0.0), 1e-300) * 1e-3)


@dataclass
class Program:
    """Minimise a linear function subject to matrix inequalities.

    Parameters
    ----------
    minimise : Affine, shape (1, 1), optional
        Objective; without one any point inside is a solution.
    subject_to : iterable of constraints
        Constraints, and iterables of them.
    scale : Scale, optional
        Typical sizes where they are known.
    label : str, optional
        Name of the program in messages.
    margin : float, optional
        Least eigenvalue asked of every strict inequality, relative to its block scaled to a diagonal of about one.

    Raises
    ------
    InputError
        If the objective is not a scalar, a coefficient is not a number, the margin is outside 0 to 1, two unknowns have
        one name, or the scale names no unknown.
    """

    minimise: Any = None
    subject_to: Iterable[Any] = ()
    scale: Scale = field(default_factory=Scale)
    label: str = "program"
    margin: float = 1e-6

    def __post_init__(self) -> None:
        self.objective = affine(0.0 if self.minimise is None else self.minimise)
        if self.objective.shape != (1, 1):
            raise InputError("objective", field=self.label, value=self.objective.shape, expected="a scalar expression")
        if not 0 <= real_number(self.margin, f"{self.label}, margin") < 1:
            raise InputError("margin", field=self.label, value=self.margin, expected="at least 0, below 1")
        self.constraints = list(_flat(self.subject_to))
        for label, expression in (("objective", self.objective), *((c.label, c.expression) for c in self.constraints)):
            if not all(np.isfinite(part).all() for part in (expression.constant, *expression.terms.values())):
                raise InputError("coefficient", field=f"{self.label}, {label}", value="nan or inf", expected="numbers")
            if expression.constant.size == 0:
                raise InputError("constraint without entries", field=f"{self.label}, {label}")
        for variable in self.variables:
            if variable.kind == "positive" and not any(_keeps(c, variable) for c in self.constraints):
                self.constraints.append(Definite(f"{variable.name} > 0", variable, True, (("", 1),)))
        labels = [c.label for c in self.constraints]
        for i, label in enumerate(labels):
            if labels.count(label) > 1:
                self.constraints[i] = _renamed(self.constraints[i], f"{label} [{labels[:i].count(label) + 1}]")
        unknown = set(self.scale.typical) - {v.name for v in self.variables}
        if unknown:
            raise InputError("scale names no unknown", field=self.label, value=", ".join(sorted(unknown)))

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """Unknowns in the order in which they occur."""
        seen: dict[Variable, None] = {}
        for expression in (*(c.expression for c in self.constraints), self.objective):
            seen |= dict.fromkeys(expression.terms)
        names = [v.name for v in seen]
        if len(set(names)) != len(names):
            raise InputError("two unknowns of one name", field=self.label, value=", ".join(names))
        return tuple(seen)

    @cached_property
    def places(self) -> dict[Variable, slice]:
        """Where the coordinates of each unknown stand in the vector of all."""
        places, total = {}, 0
        for variable in self.variables:
            places[variable] = slice(total, total + variable.size)
            total += variable.size
        return places

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(v.size for v in self.variables)

    @cached_property
    def cost(self) -> np.ndarray:
        """Coefficients of the objective."""
        return self._tensor(self.objective)[0, 0]

    @cached_property
    def rows(self) -> tuple[Row, ...]:
        """The constraints in coordinates."""
        rows = []
        for constraint in self.constraints:
            constant, tensor = constraint.expression.constant, self._tensor(constraint.expression)
            if not isinstance(constraint, Definite):
                constant, tensor = constant.ravel(), tensor.reshape(constant.size, self.size)
            rows.append(Row(constraint, constant, tensor))
        return tuple(rows)

    def _tensor(self, expression: Affine) -> np.ndarray:
        tensor = np.zeros((*expression.shape, self.size))
        for variable, coefficient in expression.terms.items():
            tensor[:, :, self.places[variable]] = coefficient
        return tensor

    def values(self, x: np.ndarray) -> dict[str, Any]:
        """Matrices by name from coordinates."""
        return {v.name: v.matrix(x[place]) for v, place in self.places.items()}

    def coordinates(self, values: Values) -> np.ndarray:
        """Coordinates from matrices by name."""
        x = np.zeros(self.size)
        for variable, place in self.places.items():
            if variable.name not in values:
                raise InputError("no value for the unknown", field=variable.name, expected=f"shape {variable.shape}")
            x[place] = variable.coordinates(values[variable.name])
        return x

    def check(self, values: Values) -> "Check":
        """Recompute every constraint at a point from its matrices, in numpy, without any solver's word.

        Parameters
        ----------
        values : mapping
            Name of each unknown to its value.

        Returns
        -------
        Check
            Objective, margins and blocks.
        """
        x = self.coordinates(values)
        margins, blocks = {}, {}
        for row in self.rows:
            value = row.constraint.expression.value(values)
            blocks[row.constraint.label] = value
            if not np.isfinite(value).all():
                margins[row.constraint.label] = -np.inf
            elif row.is_matrix:
                d = 1 / np.sqrt(row.extent(x))
                margins[row.constraint.label] = float(np.linalg.eigvalsh(value * np.outer(d, d))[0])
            else:
                relative = value.ravel() / row.extent(x)
                worst = -np.abs(relative).max() if isinstance(row.constraint, Equal) else relative.min()
                margins[row.constraint.label] = float(worst)
        return Check(float(self.objective.value(values)[0, 0]), margins, blocks, self._holds(margins))

    def _holds(self, margins: dict[str, float]) -> bool:
        held = []
        for constraint in self.constraints:
            # rounding of a scaled block is a few 1e-16 a row; equalities and closed inequalities hold to rounding only
            if isinstance(constraint, Definite) and constraint.strict:
                held.append(margins[constraint.label] > 1e-14 * constraint.expression.shape[0])
            elif isinstance(constraint, Entrywise):
                held.append(margins[constraint.label] >= 0)
            else:
                held.append(margins[constraint.label] >= -1e-9)
        return all(held)


@dataclass(frozen=True)
class Check:
    """What a point does to a program, recomputed.

    Attributes
    ----------
    objective : float
        Value of the objective.
    margins : dict
        Label of each constraint to the least eigenvalue of its scaled block (least relative entry, negative residual).
    blocks : dict
        Label of each constraint to its matrix, in the form that is to be positive.
    holds : bool
        Whether every constraint holds.
    """

    objective: float
    margins: dict[str, float]
    blocks: dict[str, np.ndarray]
    holds: bool

    @property
    def worst(self) -> float:
        """The least margin."""
        return min(self.margins.values(), default=np.inf)


def _flat(constraints: Any) -> Iterator[Constraint]:
    if isinstance(constraints, (Definite, Entrywise, Equal)):
        yield constraints
        return
    if not isinstance(constraints, Iterable) or isinstance(constraints, str):
        raise InputError("constraint", value=type(constraints).__name__, expected="F < 0, within(...) or equal(...)")
    for constraint in constraints:
        yield from _flat(constraint)


def _keeps(constraint: Constraint, variable: Variable) -> bool:
    """Whether a constraint is the one that a program adds for a positive unknown."""
    return constraint.label == f"{variable.name} > 0" and set(constraint.expression.terms) == {variable}


def _renamed(constraint: Constraint, label: str) -> Constraint:
    return replace(constraint, label=label)
