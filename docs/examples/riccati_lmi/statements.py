"""The Riccati inequality (1) and its Schur complement (2), each once."""

from gainsay.statements import Statement, symmetric

#: formulas over the tables, which the checker evaluates exactly
DATA = {"A": "printed('A')", "B": "printed('B')", "Q": "printed('Q')"}

RICCATI = Statement(
    "(1)",
    "data",
    rows=("x",),
    blocks={("x", "x"): "A.T@X + X@A + X@B@B.T@X + Q"},
    unknowns={"X": symmetric(3)},
    where=DATA,
)
SCHUR = Statement(
    "(2)",
    "data",
    rows=("x", "w"),
    blocks={("x", "x"): "A.T@X + X@A + Q", ("x", "w"): "X@B", ("w", "w"): "-1"},
    unknowns={"X": symmetric(3)},
    where=DATA,
)
