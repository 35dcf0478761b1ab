"""One statement of each theorem: a text from which come the solver's program, the certificate and the page."""

from gainsay.statements.derivations import Step, implication
from gainsay.statements.identities import differing, identical
from gainsay.statements.program import Stated
from gainsay.statements.proving import enclose, optimum, prove
from gainsay.statements.statement import Cell, Constraint, Statement, over, read_constraint
from gainsay.statements.unknowns import Unknown, diagonal, matrix, positive, scalar, symmetric

__all__ = [
    "Cell",
    "Constraint",
    "Stated",
    "Statement",
    "Step",
    "Unknown",
    "diagonal",
    "differing",
    "enclose",
    "identical",
    "implication",
    "matrix",
    "optimum",
    "over",
    "positive",
    "prove",
    "read_constraint",
    "scalar",
    "symmetric",
]
