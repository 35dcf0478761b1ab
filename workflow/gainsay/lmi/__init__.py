"""Linear matrix inequalities as papers print them: named blocks, scaling inside, results that are recomputed."""

from gainsay.lmi.affine import (
    Affine,
    Definite,
    Entrywise,
    Equal,
    Variable,
    affine,
    diagonal,
    matrix,
    positive,
    scalar,
    sym,
    symmetric,
    trace,
)
from gainsay.lmi.blocks import BlockMatrix, block_diagonal, equal, within
from gainsay.lmi.common_margin import by_margin
from gainsay.lmi.enclosure import infimum
from gainsay.lmi.interior import interior_multipliers
from gainsay.lmi.outcomes import Farkas, Infeasible, Infimum, Solved, Unbounded, Undecided
from gainsay.lmi.program import Check, Program, Scale
from gainsay.lmi.solving import find_point, solve
from gainsay.lmi.sweep import Range, Threshold, ranges, sweep, threshold

__all__ = [
    "Affine",
    "BlockMatrix",
    "Check",
    "Definite",
    "Entrywise",
    "Equal",
    "Farkas",
    "Infeasible",
    "Infimum",
    "Program",
    "Range",
    "Scale",
    "Solved",
    "Threshold",
    "Unbounded",
    "Undecided",
    "Variable",
    "affine",
    "block_diagonal",
    "by_margin",
    "diagonal",
    "equal",
    "find_point",
    "infimum",
    "interior_multipliers",
    "matrix",
    "positive",
    "ranges",
    "scalar",
    "solve",
    "sweep",
    "sym",
    "symmetric",
    "threshold",
    "trace",
    "within",
]
