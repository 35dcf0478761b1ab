"""The inequalities of output feedback in the variables X, Y, Ah, Bh, Ch, in which they are linear."""

from gainsay.statements import Statement, matrix, symmetric

#: the plant, as formulas that the checker evaluates exactly
PLANT = {name: f"printed('{name}')" for name in ("A", "B1", "B2", "Cinf", "Dinf", "C2", "D2", "C", "D")}
UNKNOWNS = {"X": symmetric(3), "Y": symmetric(3), "Ah": matrix(3, 3), "Bh": matrix(3, 1), "Ch": matrix(1, 3)}
#: rows of plant and controller: Lyapunov's inequality of the loop after the congruence with [X, I; M', 0]
LOOP = {
    ("x", "x"): "sym(A@X + B2@Ch)",
    ("x", "v"): "A + Ah.T",
    ("v", "v"): "sym(Y@A + Bh@C)",
    ("x", "w"): "B1",
    ("v", "w"): "Y@B1 + Bh@D",
    ("w", "w"): "-1",
}
#: the Lyapunov matrix of the loop after the same congruence
LYAPUNOV = {("x", "x"): "X", ("x", "v"): "eye(3)", ("v", "v"): "Y"}

COUPLING = Statement("(X, Y)", "Example 7", ("x", "v"), LYAPUNOV, UNKNOWNS, PLANT)

#: < 0: the H-infinity norm is below a level, a member of the family for each
BOUNDED_REAL = Statement(
    "(H-infinity)",
    "Example 7",
    ("x", "v", "w", "z"),
    LOOP | {("x", "z"): "(Cinf@X + Dinf@Ch).T", ("v", "z"): "Cinf.T", ("z", "z"): "-{level}**2 * eye(2)"},
    UNKNOWNS,
    PLANT,
)
#: < 0 and > 0: the squared H2 norm is below the trace of Q
GRAMIAN = Statement("(H2)", "Example 7", ("x", "v", "w"), LOOP, UNKNOWNS, PLANT)
OUTPUT = Statement(
    "(H2 output)",
    "Example 7",
    ("x", "v", "z"),
    LYAPUNOV | {("x", "z"): "(C2@X + D2@Ch).T", ("v", "z"): "C2.T", ("z", "z"): "Q"},
    UNKNOWNS | {"Q": symmetric(3)},
    PLANT,
)
H2 = (GRAMIAN < 0, OUTPUT > 0)
MIXED = (*H2, BOUNDED_REAL.given(level="number('gamma')") < 0, "trace(Q) < number('h2_level')**2")
