"""The inequality (3), once: the solver's program, the certificate and the page come from this text."""

from gainsay.statements import Statement, matrix, symmetric
from papers.example.plant import LOOP

INEQUALITY_3 = Statement(
    "(3)",
    "Theorem 1",
    rows=("state",),
    blocks={("state", "state"): "sym(A@X - B@Y) + 2 * number('decay') * X"},
    unknowns={"X": symmetric(2), "Y": matrix(1, 2)},
    where=LOOP,
)
