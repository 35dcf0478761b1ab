"""The edges of the theorems: beside each accepted certificate one that breaks a single condition and nothing else.

Every expected answer is a closed form of a scalar or two-state example, given beside it.
"""

import numpy as np
import pytest
from scipy import linalg

from gainsay.errors import CertificateError
from gainsay.proof import MappingTables, build

TABLES = MappingTables(
    numbers={"b": "2"}, printed={"v": [["0.50", "0.25"]], "w": [["2.0", "3.0"]], "s": [["1.0", "0.50"], ["0.5", "1.0"]]}
)
X, ROW, S = {"x": {}}, {"x": {"shape": [1, 2]}}, {"x": {"shape": [2, 2], "structure": "symmetric"}}


def accepted(kind, fields, witness=None, unknowns=None, definitions=()):
    try:
        made = build.certificate(kind, id="c", statement="s", tables=TABLES, fields=fields, witness=witness,
                                 unknowns=unknowns, definitions=definitions)  # fmt: skip
    except CertificateError:
        return None
    return {(c.of, c.relation, c.value) for c in made.conclusions}


def cases(kind, *listed):
    return [pytest.param(kind, *case, id=f"{kind}-{k}") for k, case in enumerate(listed)]


def feasible(text, x):
    return {"constraints": [["a", text]]}, {"x": x}, X


def farkas(*constraints, witness, unknowns=None, **more):
    listed = [[name, text] for name, text in zip("abc", constraints, strict=False)]
    return {"constraints": listed, **more}, dict(zip("abc", witness, strict=False)), unknowns or X


BOX = {"boxes": {"x": "v"}}
SPRING = {"A": "-1", "Q": "2", "x0": "2"}  # x' = -x from 2: V = x^2 decays exactly as the cost 2 x^2 grows
LAG = {"A": "-1", "B": "1", "C": "1"}  # G = 1 / (s + 1): |G(i)| = 2^-1/2, norm 1, H2 norm 2^-1/2
PAIR = {"A": "-1", "H": "1", "Cz": "0.5", "blocks": [["repeated", 1]]}  # poles of -1 + lambda / 2: -1.5 to -0.5
FULL = {**PAIR, "blocks": [["full", 1, 1]]}
ARCS = {**PAIR, "arcs": ["0", "1/2", "1"], "shift": "1"}
ROWS = {"P": "1", "d": [["1"], ["1"]]}

SYMMETRIC = {"P": {"shape": [2, 2], "structure": "symmetric"}}


def inertia(first, second, drift, wrong, unknowns=None, size=1, **more):
    """Constraints in P, scalar unless unknowns say otherwise: whole constraints, unless congruences are given."""
    fields = {"constraints": [["F", first], ["G", second]], "unknown": "P", "inequality": "F", "positive": "G"}
    unit = [["1" if i == j else "0" for j in range(size)] for i in range(size)]
    witness = {"drift": drift, "inertia": wrong, "direction": [["1"]] + [["0"]] * (size - 1),
               "inequality": unit, "positive": unit, **more}  # fmt: skip
    return fields, witness, unknowns or {"P": {"structure": "symmetric"}}


FLAT, UP = [["1", "0"], ["0", "-1"]], [["-1", "0"], ["0", "1"]]
STEIN = {"jump": "2"}
# P - 4 P, by the congruence with (1, -2)
COMPLETED = {"jump": "2", "inequality": [["1"], ["-2"]]}

TRUE = [
    *cases("wrong_inertia", inertia("2*P < 0", "P > 0", "1", "-1"), inertia("2*P < 0", "P >= 0", "1", "-1"),
           inertia("2*P <= 0", "P > 0", "1", "-1"), inertia("0 < -2*P", "0 < P", "1", "-1"),
           inertia("2*P <= -1", "P >= 0", "1", "-1"), inertia("2*P <= 0", "P >= 1", "1", "-1"),
           inertia("4*P < P", "P > 0", "-0.5", "-1", **STEIN),
           inertia("[[P, 2*P], [..., P]] > 0", "P > 0", "-0.5", "-1", **COMPLETED),
           inertia("diag(-1, 2*P) < 0", "P > 0", "1", "-1", inequality=[["0"], ["1"]]),
           inertia("sym(P @ diag(1, -1)) < 0", "P > 0", FLAT, UP, SYMMETRIC, 2)),
    *cases("definite", ({"constraint": "1 > 0"},), ({"constraint": "0 >= 0"},), ({"constraint": "-1 < 0"},),
           ({"constraint": "0 <= 0"},), ({"constraint": "1 < 2"},),
           ({"constraint": "2 > 1"},),
           ({"constraint": "[[1, 1], [1, 1]] >= 0"},), ({"constraint": "[[0, 0], [0, 1]] >= 0"},),
           ({"constraint": "sqrt(2)*[[2, 1], [1, 2]] > 0"},), ({"constraint": "0 < sqrt(2)"},)),
    *cases("not_definite", ({"constraint": "0 > 0"}, {"z": "1"}), ({"constraint": "-1 >= 0"}, {"z": "1"}),
           ({"constraint": "0 < 0"}, {"z": "1"}), ({"constraint": "1 <= 0"}, {"z": "-1"}),
           ({"constraint": "-sqrt(2) > 0"}, {"z": "1"})),
    *cases("feasible", feasible("x > 1", "1.1"), feasible("x >= 1", "1"), feasible("x == 1", "1"),
           feasible("x < 1", "0.9"),
           feasible("x <= 1", "1"),
           ({"constraints": [["a", "1 > 0"]], **BOX}, {"x": [["0.495", "0.255"]]}, ROW),
           ({"constraints": [["a", "1 > 0"]], **BOX}, {"x": [["0.505", "0.245"]]}, ROW)),
    *cases("farkas", farkas("x > 1", "x <= 1", witness="11"), farkas("x > 1", "x < 1", witness="11"),
           farkas("x >= 2", "x <= 1", witness="11"), farkas("x == 1", "x >= 2", witness=["-1", "1"]),
           farkas("2*x > 2", "x <= 1", witness=["0.5", "1"]), farkas("0 > 1", witness="1"),
           farkas("0 > 0", witness="1"),
           farkas("x @ col(1, 0) >= 0.506", witness="1", unknowns=ROW, **BOX),
           farkas("x @ col(1, 0) <= 0.494", witness="1", unknowns=ROW, **BOX),
           farkas("x @ col(1, 0) > 0.505", witness="1", unknowns=ROW, **BOX),
           farkas("x @ col(2, -1) >= 0.766", witness="1", unknowns=ROW, **BOX),
           # the printed s gives x12 twice, to two digits and to one: within [0.495, 0.505]
           farkas("x[0, 1] >= 0.506", witness="1", unknowns=S, boxes={"x": "s"}),
           farkas("x[0, 1] <= 0.494", witness="1", unknowns=S, boxes={"x": "s"}),
           farkas("-[[1, x], [x, 0]] >= 0", witness=[[["1", "0"], ["0", "0"]]])),
    *cases("linear_box", ({"constraints": [["a", "x >= row(0.506, 0)"]], "answer": "fails", **BOX},
           {"a": [["1", "0"]]}, ROW),
           ({"constraints": [["a", "x == row(0.5, 0.25)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]}, ROW),
           ({"constraints": [["a", "x < row(0.51, 0.26)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]}, ROW),
           ({"constraints": [["a", "x >= row(0.5, 0.25)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]}, ROW),
           ({"constraints": [["a", "x <= row(0.5, 0.25)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]}, ROW),
           ({"constraints": [["a", "x > row(0.49, 0.24)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]},
           ROW)),
    *cases("dual_bound", ({"constraints": [["a", "x >= 1"]], "minimise": "2*x", "bound": "2"}, {"a": "2"}, X),
           ({"constraints": [["a", "x <= 1"]], "maximise": "2*x", "bound": "2"}, {"a": "2"}, X),
           ({"constraints": [["a", "x >= 1"]], "minimise": "2*x", "bound": "1.9"}, {"a": "2"}, X)),
    *cases("identity", ({"left": "x**2", "right": "x*x"}, {}, X),
           ({"left": "x**2", "right": "1", "modulo": ["x - 1"]}, {"x": "1"}, X)),
    *cases("different", ({"left": "x", "right": "2*x"}, {"x": "1"}, X), ({"left": "sqrt(2)", "right": "1.5"},)),
    *cases("enclosed", ({"formula": "sqrt(2)", "low": "1.41", "high": "1.42"},),
           ({"formula": "1", "low": "1", "high": "1"},)),
    *cases("lyapunov", ({"matrix": "-1", "alpha": "-1"}, {"P": "1"}),
           ({"matrix": ["-1", "-2"], "alpha": "-0.9"}, {"P": "1"})),
    *cases("stein", ({"matrix": "-1", "shift": "0", "radius": "1"}, {"P": "1"}),
           ({"matrix": "-1", "shift": "2", "radius": "1.1"}, {"P": "1"})),
    *cases("descriptor_disk",
           ({"matrix": "-1", "descriptor": "2", "shift": "0", "radius": "0.51"}, {"P": "1", "K": "0.5"}),
           ({"matrix": "-1", "descriptor": "-1", "shift": "-2", "radius": "1.1"}, {"P": "1", "K": "-1"})),
    *cases("unstable", ({"matrix": "1", "alpha": "0.9"}, {"P": "-1", "z": "1"}),
           ({"matrix": "diag(1, -1)", "alpha": "0"}, {"P": [["-1", "0"], ["0", "1"]], "z": [["1"], ["1"]]}),
           ({"matrix": "2", "shift": "0", "radius": "1.9"}, {"P": "-1", "z": "1"})),
    *cases("bounded_real", ({**LAG, "gamma": "1.01"}, {"P": "1"}),
           ({**LAG, "C": "0", "D": "1", "gamma": "1.01"}, {"P": "0.001"})),
    *cases("norm_at_least", ({**LAG, "frequency": "1", "gamma": "0.7071"}, {"u": [["1", "0"]]}),
           ({**LAG, "frequency": "1", "gamma": "0.7071"}, {"u": [["0.6", "-0.8"]]}),
           ({**LAG, "frequency": "0", "gamma": "1"}, {"u": [["0", "1"]]}),
           ({**LAG, "D": "1", "frequency": "0", "gamma": "2"}, {"u": [["1", "0"]]})),
    *cases("h2", ({**LAG, "bound": "0.7072"}, {"P": "0.50001"}),
           ({**LAG, "bound": "0.7072", "lower": "0.7071"}, {"P": "0.50001", "S": "0.5"})),
    *cases("not_an_eigenvalue", ({"matrix": "diag(-1, -2)", "real": "0", "imaginary": "0"},),
           ({"matrix": "[[0, 1], [-1, 0]]", "real": "0", "imaginary": "1.001"},)),
    *cases("positive_on_interval", ({"constraint": "(x - 1)**2 - 0.25 > 0", "low": "-1", "high": "0.4"}, {}, X),
           ({"constraint": "0 > x*x - 4", "low": "-1.9", "high": "1.9"}, {}, X),
           ({"constraint": "[[2 - x, 1], [1, 2 - x]] > 0", "low": "0", "high": "0.9"}, {}, X),
           ({"constraint": "x > 0", "low": "1", "high": "1"}, {}, X)),
    *cases("quadratic_bound", ({**SPRING, "cost": "4"}, {"P": "1"}),
           ({**SPRING, "inputs": [{"of": "u", "row": "3", "bound": "6"}]}, {"P": "1"}),
           ({"A": "-1"}, {"P": "1"}), ({**PAIR, "Q": "0.5", "x0": "2", "cost": "4"}, {"P": "1", "D1": "2"}),
           ({**FULL, "Dw": "0.1"}, {"P": "1", "D1": "1.5"})),
    *cases("robust_disk", ({**PAIR, "shift": "1", "radius": "0.51"}, {"P": "1", "D1": "1.02"}),
           ({**FULL, "shift": "1", "radius": "0.6"}, {"P": "1", "D1": "1.2"})),
    *cases("robust_norm", ({**PAIR, "B": "1", "C": "1", "gamma": "2.1"}, {"P": "2", "D1": "4"}),),
    *cases("contour", ({**ARCS, "radius": "0.51"}, ROWS),
           ({**ARCS, "blocks": [["full", 1, 1]], "radius": "0.51"}, ROWS)),
]  # fmt: skip

FALSE = [
    *cases("definite", ({"constraint": "0 > 0"},), ({"constraint": "-1 >= 0"},), ({"constraint": "0 < 0"},),
           ({"constraint": "1 <= 0"},), ({"constraint": "1 == 0"},), ({"constraint": "0 == 0"},),
           ({"constraint": "2 < 1"},), ({"constraint": "1 > 2"},),
           ({"constraint": "1 > 1"},), ({"constraint": "[[1, 2], [2, 1]] > 0"},),
           ({"constraint": "[[1, 2], [2, 1]] >= 0"},),
           ({"constraint": "[[0, 1], [1, 0]] >= 0"},), ({"constraint": "[[0, 1], [1, 1]] >= 0"},),
           ({"constraint": "[[1, 0], [0, -1]] >= 0"},), ({"constraint": "[[1, 1], [0, 1]] > 0"},),
           ({"constraint": "row(1, 1) > 0"},), ({"constraint": "sqrt(2)*[[1, 2], [2, 1]] > 0"},),
           ({"constraint": "interval(-1, 1) >= 0"},), ({"constraint": "sqrt(2)**2 == 2"},),
           ({"constraint": "pi < 3"},)),
    *cases("not_definite", ({"constraint": "1 > 0"}, {"z": "1"}), ({"constraint": "0 >= 0"}, {"z": "1"}),
           ({"constraint": "-1 < 0"}, {"z": "1"}), ({"constraint": "0 <= 0"}, {"z": "1"}),
           ({"constraint": "-1 > 0"}, {"z": "0"}), ({"constraint": "1 == 0"}, {"z": "1"}),
           ({"constraint": "interval(-1, 1) > 0"}, {"z": "1"})),
    *cases("feasible", feasible("x > 1", "1"), feasible("x >= 1", "0.9"), feasible("x == 1", "1.1"),
           feasible("x < 1", "1"),
           feasible("x <= 1", "1.1"),
           ({"constraints": [["a", "x > 0"], ["b", "x > 2"]]}, {"x": "1"}, X),
           *(({"constraints": [["a", "1 > 0"]], **BOX}, {"x": [list(point)]}, ROW)
             for point in (("0.4949", "0.25"), ("0.5051", "0.25"), ("0.5", "0.2449"), ("0.5", "0.2551"))),
           ({"constraints": [["a", "1 > 0"]]}, {"x": [["1", "2"], ["3", "1"]]}, S),
           ({"constraints": [["a", "1 > 0"]]}, {"x": [["1", "2"], ["2", "1"]]},
           {"x": {"shape": [2, 2], "structure": "skew"}}),
           ({"constraints": [["a", "1 > 0"]]}, {"x": [["1", "2"], ["0", "1"]]},
           {"x": {"shape": [2, 2], "structure": "diagonal"}})),
    *cases("farkas", farkas("x >= 1", "x <= 1", witness="11"), farkas("x > 1", "x <= 2", witness="11"),
           farkas("x > 1", "x <= 1", witness=["-1", "-1"]), farkas("x > 1", "x <= 1", witness=["1", "2"]),
           farkas("x > 1", "x <= 1", witness=["0", "0"]), farkas("x > 1", "x <= 1", witness=[]),
           farkas("x == 1", "x >= 0.9", witness=["-1", "1"]), farkas("0 >= 0", witness="1"),
           farkas("x @ col(1, 0) >= 0.504", witness="1", unknowns=ROW, **BOX),
           farkas("x @ col(1, 0) >= 0.505", witness="1", unknowns=ROW, **BOX),
           farkas("x @ col(1, 0) <= 0.496", witness="1", unknowns=ROW, **BOX),
           farkas("x @ col(2, -1) >= 0.764", witness="1", unknowns=ROW, **BOX),
           farkas("x[0, 1] >= 0.504", witness="1", unknowns=S, boxes={"x": "s"}),
           farkas("x[0, 1] <= 0.496", witness="1", unknowns=S, boxes={"x": "s"}),
           # within the box of w the product is near 6 and the square near 4: what is not affine is not bounded
           farkas("x[0, 0] * x[0, 1] >= 5", witness="1", unknowns=ROW, boxes={"x": "w"}),
           farkas("x[0, 0]**2 >= 3", witness="1", unknowns=ROW, boxes={"x": "w"}),
           farkas("x[0, 0]**2 * x[0, 1] >= 5", witness="1", unknowns=ROW, boxes={"x": "w"}),
           farkas("x*x >= 1", witness="1"), farkas("x*x <= -1", witness="1"),
           farkas("-[[1, x], [x, 0]] >= 0", witness=[[["1", "0"], ["0", "-1"]]]),
           farkas("[[0, 1], [0, 0]] > 0", witness=[[["1", "-5"], ["-5", "100"]]]),
           farkas("x > 1", witness="1")),
    *cases("linear_box", ({"constraints": [["a", "x >= row(0.504, 0)"]], "answer": "fails", **BOX},
           {"a": [["1", "0"]]}, ROW),
           ({"constraints": [["a", "x >= row(0.506, 0)"]], "answer": "fails", **BOX}, {"a": [["1", "-9"]]}, ROW),
           ({"constraints": [["a", "x == row(0.51, 0.25)"]], "answer": "holds", **BOX}, {"x": [["0.51", "0.25"]]},
           ROW),
           ({"constraints": [["a", "x == row(0.5, 0.25)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.251"]]},
           ROW),
           ({"constraints": [["a", "x > row(0.5, 0.24)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]}, ROW),
           ({"constraints": [["a", "x < row(0.51, 0.25)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]}, ROW),
           ({"constraints": [["a", "x >= row(0.5, 0.251)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]},
           ROW),
           ({"constraints": [["a", "x <= row(0.5, 0.249)"]], "answer": "holds", **BOX}, {"x": [["0.5", "0.25"]]},
           ROW),
           ({"constraints": [["a", "x == row(0.5, 0.25)"]], "answer": "perhaps", **BOX}, {"x": [["0.5", "0.25"]]},
           ROW)),
    *cases("dual_bound", ({"constraints": [["a", "x >= 1"]], "minimise": "2*x", "bound": "2.1"}, {"a": "2"}, X),
           ({"constraints": [["a", "x <= 1"]], "maximise": "2*x", "bound": "1.9"}, {"a": "2"}, X),
           ({"constraints": [["a", "x >= 1"]], "minimise": "2*x", "bound": "2"}, {"a": "1"}, X),
           ({"constraints": [["a", "x <= 1"]], "minimise": "2*x", "bound": "2"}, {"a": "-2"}, X),
           ({"constraints": [["a", "x >= 1"]], "bound": "2"}, {"a": "2"}, X),
           ({"constraints": [["a", "x >= 1"]], "minimise": "2*x", "maximise": "2*x", "bound": "2"}, {"a": "2"}, X)),
    *cases("identity", ({"left": "x**2", "right": "x"}, {}, X),
           ({"left": "x**2", "right": "2", "modulo": ["x - 1"]}, {"x": "1"}, X),
           ({"left": "x**2", "right": "1", "modulo": ["x - 1"]}, {"x": "2"}, X),
           ({"left": "row(x, x)", "right": "row(x, 2*x)"}, {}, X),
           ({"left": "col(x, x)", "right": "col(x, 2*x)"}, {}, X)),
    *cases("different", ({"left": "x", "right": "2*x"}, {"x": "0"}, X),
           ({"left": "sqrt(2)", "right": "interval(1, 2)"},)),
    *cases("enclosed", ({"formula": "sqrt(2)", "low": "1.42"},), ({"formula": "sqrt(2)", "high": "1.41"},),
           ({"formula": "1", "low": "1.1"},), ({"formula": "interval(0, 1)", "low": "0.5"},),
           ({"formula": "row(1, 1)"},)),
    *cases("lyapunov", ({"matrix": "-1", "alpha": "-1.1"}, {"P": "1"}),
           ({"matrix": "-1", "alpha": "-0.9"}, {"P": "-1"}),
           ({"matrix": "1", "alpha": "0"}, {"P": "-1"}), ({"matrix": ["-1", "1"], "alpha": "-0.9"}, {"P": "1"}),
           ({"matrix": ["1", "-1"], "alpha": "-0.9"}, {"P": "1"}), ({"matrix": "-1", "alpha": "-0.9"}, {"P": "0"}),
           ({"matrix": [], "alpha": "0"}, {"P": "1"})),
    *cases("descriptor_disk",
           ({"matrix": "-1", "descriptor": "2", "shift": "0", "radius": "0.5"}, {"P": "1", "K": "0.5"}),
           ({"matrix": "-1", "descriptor": "2", "shift": "0", "radius": "0.51"}, {"P": "1", "K": "-0.5"}),
           ({"matrix": "0", "descriptor": "0", "shift": "0", "radius": "1"}, {"P": "1", "K": "1"}),
           ({"matrix": "1", "descriptor": "0", "shift": "0", "radius": "9"}, {"P": "1", "K": "1"})),
    *cases("stein", ({"matrix": "-1", "shift": "0", "radius": "0.9"}, {"P": "1"}),
           ({"matrix": "-1", "shift": "0", "radius": "1.1"}, {"P": "-1"}),
           ({"matrix": "-1", "shift": "2", "radius": "-1.1"}, {"P": "1"}),
           ({"matrix": "0", "shift": "0", "radius": "0"}, {"P": "1"}),
           ({"matrix": "-1", "shift": "-2", "radius": "1.1"}, {"P": "1"})),
    # stable, where P is a point; a direction of zero; two closed constraints, which P = 0 satisfies; a constant of the
    # other sign, an equation, another matrix; no congruence; not symmetric; S of the right inertia
    *cases("wrong_inertia", inertia("-2*P < 0", "P > 0", "-1", "1"), inertia("2*P < 0", "P > 0", "1", "-1",
           direction="0"), inertia("2*P <= 0", "P >= 0", "1", "-1"), inertia("2*P < 1", "P > 0", "1", "-1"),
           inertia("2*P < 0", "P > -1", "1", "-1"), inertia("2*P == 0", "P > 0", "1", "-1"),
           inertia("2*P < 0", "P > 0", "0.9", "-1"), inertia("-2*P < 0", "P > 0", "1", "-1"),
           inertia("2*P < 0", "P < 0", "1", "-1"), inertia("2*P < 0", "P > 0", "1", "1"),
           inertia("P < 4*P", "P > 0", "0.5", "-1", jump="1"), inertia("P/4 < P", "P > 0", "-0.5", "-1", jump="0.5"),
           inertia("4*P < P", "P > 0", "-0.5", "1", **STEIN), inertia("2*P*P < 0", "P > 0", "1", "-1"),
           inertia("2*P <= 0", "P >= 0", "1", "-1", positive="0"),
           inertia("sym(P @ diag(1, -1)) < 0", "P > 0", FLAT, FLAT, SYMMETRIC, 2),
           inertia("P @ diag(2, -2) < 0", "P > 0", FLAT, UP, SYMMETRIC, 2),
           inertia("sym(P @ diag(1, -1)) < 0", "P > 0", FLAT, UP, {"P": {"shape": [2, 2]}}, 2),
           inertia("sym(P @ diag(1, -1)) < 0", "P > 0", FLAT, [["-1", "0"], ["1", "1"]], SYMMETRIC, 2),
           inertia("sqrt(2)*P < 0", "P > 0", "1", "-1")),
    *cases("unstable", ({"matrix": "1", "alpha": "1.1"}, {"P": "-1", "z": "1"}),
           ({"matrix": "-1", "alpha": "0"}, {"P": "1", "z": "1"}),
           ({"matrix": "-1", "alpha": "0"}, {"P": "1", "z": "0"}),
           ({"matrix": "2", "shift": "0", "radius": "2.1"}, {"P": "-1", "z": "1"}),
           ({"matrix": "0.5", "shift": "0", "radius": "1"}, {"P": "1", "z": "1"}),
           ({"matrix": "2", "shift": "0", "radius": "-1"}, {"P": "-1", "z": "1"}),
           ({"matrix": "diag(-1, -2)", "alpha": "0"}, {"P": [["1", "0"], ["0", "1"]], "z": [["1"], ["0"]]})),
    *cases("bounded_real", ({**LAG, "gamma": "0.99"}, {"P": "1"}), ({**LAG, "A": "1", "gamma": "1.01"}, {"P": "-1"}),
           ({**LAG, "gamma": "-1.01"}, {"P": "1"}), ({**LAG, "C": "0", "D": "1", "gamma": "0.99"}, {"P": "0.001"}),
           ({**LAG, "A": ["-1", "-0.5"], "gamma": "1.01"}, {"P": "1"}),
           ({**LAG, "A": ["-1", "-1"], "B": ["1", "1", "1"], "gamma": "1.01"}, {"P": "1"})),
    *cases("norm_at_least", ({**LAG, "frequency": "1", "gamma": "0.7072"}, {"u": [["1", "0"]]}),
           ({**LAG, "frequency": "1", "gamma": "0.7071"}, {"u": [["0", "0"]]}),
           ({**LAG, "frequency": "1", "gamma": "-1"}, {"u": [["1", "0"]]}),
           ({**LAG, "D": "-1", "frequency": "0", "gamma": "0.1"}, {"u": [["1", "0"]]}),
           ({**LAG, "A": "0", "frequency": "0", "gamma": "1"}, {"u": [["1", "0"]]})),
    *cases("h2", ({**LAG, "bound": "0.707"}, {"P": "0.50001"}), ({**LAG, "bound": "0.7072"}, {"P": "0.49999"}),
           ({**LAG, "bound": "-0.7072"}, {"P": "0.50001"}),
           ({**LAG, "bound": "0.7072", "lower": "0.7072"}, {"P": "0.50001", "S": "0.5"}),
           ({**LAG, "bound": "0.7072", "lower": "0.7071"}, {"P": "0.50001", "S": "0.51"}),
           ({**LAG, "bound": "0.7072", "lower": "-0.1"}, {"P": "0.50001", "S": "0.5"})),
    *cases("not_an_eigenvalue", ({"matrix": "diag(-1, -2)", "real": "-1", "imaginary": "0"},),
           ({"matrix": "[[0, 1], [-1, 0]]", "real": "0", "imaginary": "1"},),
           ({"matrix": "row(1, 1)", "real": "0", "imaginary": "0"},)),
    *cases("positive_on_interval", ({"constraint": "(x - 1)**2 - 0.25 > 0", "low": "0", "high": "2"}, {}, X),
           ({"constraint": "(x - 1)**2 > 0", "low": "0", "high": "2"}, {}, X),
           ({"constraint": "(x - 1)**2 > 0", "low": "0", "high": "1"}, {}, X),
           ({"constraint": "(x - 1)**2 > 0", "low": "1", "high": "2"}, {}, X),
           ({"constraint": "x > 0", "low": "2", "high": "1"}, {}, X),
           ({"constraint": "x - 3 > 0", "low": "1", "high": "2"}, {}, X),
           ({"constraint": "x >= 0", "low": "1", "high": "2"}, {}, X),
           ({"constraint": "0 > x*x - 4", "low": "-1.9", "high": "2.1"}, {}, X),
           ({"constraint": "[[2 - x, 1], [1, 2 - x]] > 0", "low": "0", "high": "3.5"}, {}, X),
           ({"constraint": "[[x, 1], [0, x]] > 0", "low": "1", "high": "2"}, {}, X)),
    *cases("quadratic_bound", ({**SPRING, "cost": "3.99"}, {"P": "1"}), ({**SPRING, "cost": "4"}, {"P": "0.99"}),
           ({**SPRING, "cost": "4", "A": "-0.99"}, {"P": "1"}), ({**SPRING, "cost": "4", "A": "1"}, {"P": "-1"}),
           ({**SPRING, "inputs": [{"of": "u", "row": "3", "bound": "5.99"}]}, {"P": "1"}),
           ({**SPRING, "inputs": [{"of": "u", "row": "3", "bound": "-6"}]}, {"P": "1"}),
           ({"A": "-1", "Q": "-1", "x0": "2", "cost": "4"}, {"P": "1"}),
           ({"A": "-1", "Q": "-1", "x0": "2", "inputs": [{"of": "u", "row": "1", "bound": "2"}]}, {"P": "1"}),
           ({"A": "1"}, {"P": "-1"}), ({**PAIR, "Q": "0.5", "x0": "2", "cost": "4"}, {"P": "1", "D1": "0.1"}),
           ({**PAIR, "Q": "0.5", "x0": "2", "cost": "4"}, {"P": "1", "D1": "-2"}),
           ({**PAIR, "Cz": "2", "Q": "0", "x0": "2", "cost": "4"}, {"P": "1", "D1": "1.02"}),
           ({**FULL, "Dw": "1"}, {"P": "1", "D1": "1.5"})),
    *cases("robust_disk", ({**PAIR, "shift": "1", "radius": "0.49"}, {"P": "1", "D1": "1.02"}),
           ({**PAIR, "shift": "1", "radius": "0.51"}, {"P": "1", "D1": "-0.5"}),
           ({**PAIR, "shift": "1", "radius": "-0.51"}, {"P": "1", "D1": "1.02"}),
           ({**PAIR, "shift": "1", "radius": "0.51"}, {"P": "-1", "D1": "1.02"})),
    *cases("robust_norm", ({**PAIR, "B": "1", "C": "1", "gamma": "1.9"}, {"P": "2", "D1": "4"}),
           ({**PAIR, "B": "1", "C": "1", "gamma": "-2.1"}, {"P": "2", "D1": "4"}),
           ({**PAIR, "A": "1", "B": "1", "C": "1", "gamma": "2.1"}, {"P": "-2", "D1": "4"})),
    *cases("contour", ({**ARCS, "radius": "0.49"}, ROWS),
           ({**ARCS, "radius": "0.51", "arcs": ["0", "1/2", "0.9"]}, ROWS),
           ({**ARCS, "radius": "0.51", "arcs": ["0.1", "1/2", "1"]}, ROWS),
           ({**ARCS, "radius": "0.51", "arcs": ["0", "1", "1"]}, ROWS),
           ({**ARCS, "radius": "0.51"}, {**ROWS, "d": [["-1"], ["1"]]}),
           ({**ARCS, "radius": "0.51"}, {**ROWS, "P": "-1"}),
           ({**ARCS, "radius": "0.51"}, {**ROWS, "d": [["1"], ["0"]]}), ({**ARCS, "radius": "-0.51"}, ROWS),
           ({**ARCS, "radius": "0.51", "A": "1"}, ROWS),
           ({**ARCS, "radius": "0.51", "blocks": [["full", 1, 1]]}, {**ROWS, "g": [["1"], ["1"]]}),
           ({**ARCS, "radius": "0.51", "Dw": "2"}, ROWS)),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "parts"), [pytest.param(c.values[0], c.values[1:], id=c.id) for c in TRUE])
def test_what_holds_is_accepted(kind, parts):
    assert accepted(kind, *parts)


@pytest.mark.parametrize(("kind", "parts"), [pytest.param(c.values[0], c.values[1:], id=c.id) for c in FALSE])
def test_what_does_not_hold_is_refused(kind, parts):
    assert accepted(kind, *parts) is None


@pytest.mark.parametrize(
    ("kind", "fields", "witness", "stable"),
    [
        ("lyapunov", {"matrix": "-1", "alpha": "0"}, {"P": "1"}, True),
        ("lyapunov", {"matrix": "-1", "alpha": "1"}, {"P": "1"}, False),
        ("lyapunov", {"matrix": "0", "alpha": "0"}, {"P": "1"}, False),
        ("lyapunov", {"matrix": "-1", "alpha": "-1"}, {"P": "1"}, True),
        ("stein", {"matrix": "-1", "shift": "1", "radius": "1"}, {"P": "1"}, True),
        ("stein", {"matrix": "-1", "shift": "1", "radius": "1.1"}, {"P": "1"}, False),
        ("stein", {"matrix": "0", "shift": "1", "radius": "1"}, {"P": "1"}, False),
        ("robust_disk", {**PAIR, "shift": "1", "radius": "1"}, {"P": "1", "D1": "1.02"}, True),
        ("robust_disk", {**PAIR, "shift": "1", "radius": "1.1"}, {"P": "1", "D1": "1.02"}, False),
        ("contour", {**ARCS, "radius": "1"}, ROWS, True),
        ("contour", {**ARCS, "radius": "1.1"}, ROWS, False),
        ("quadratic_bound", {"A": "-1"}, {"P": "1"}, True),
        ("quadratic_bound", {"A": "-1", "Q": "2"}, {"P": "1"}, False),  # not strict
        ("quadratic_bound", {"A": "0"}, {"P": "1"}, False),
        ("quadratic_bound", {"A": "-1", "Q": "-1"}, {"P": "1"}, False),  # dV/dt < x^2 shows nothing
    ],
)
def test_stability_is_concluded_only_where_it_follows(kind, fields, witness, stable):
    found = accepted(kind, fields, witness)
    if found is None:  # nothing at all was proved
        found = set()
    assert (("stable", "holds", None) in found) == stable


def test_stability_fails_only_right_of_the_axis():
    assert ("stable", "fails", None) in accepted("unstable", {"matrix": "1", "alpha": "0"}, {"P": "-1", "z": "1"})
    left = accepted("unstable", {"matrix": "-1", "alpha": "-2"}, {"P": "-1", "z": "1"})
    assert left == {("abscissa", "greater_than", "-2")}


def test_strict_and_not():
    assert accepted("lyapunov", {"matrix": "-1", "alpha": "-1"}, {"P": "1"}) >= {("abscissa", "at_most", "-1")}
    assert accepted("lyapunov", {"matrix": "-1", "alpha": "-0.9"}, {"P": "1"}) >= {("abscissa", "less_than", "-0.9")}
    assert accepted("enclosed", {"formula": "1", "low": "1", "high": "2"}) == {
        ("value", "at_least", "1"), ("value", "less_than", "2"), ("value", "inside", "1..1")}  # fmt: skip
    assert accepted("enclosed", {"formula": "1", "low": "0", "high": "1"}) == {
        ("value", "greater_than", "0"), ("value", "at_most", "1"), ("value", "inside", "1..1")}  # fmt: skip


def test_the_distance_from_the_eigenvalues_is_from_below_and_close():
    found = accepted("not_an_eigenvalue", {"matrix": "diag(-1, -2)", "real": "0", "imaginary": "0"})
    ((_, relation, value),) = [c for c in found if c[0] == "distance"]
    assert relation == "at_least"
    assert 0.999 < float(value) <= 1  # the nearest eigenvalue is -1


# Two springs, x1'' + 0.2 x1' + (1 + k1 a) x1 = 0 and x2'' + 0.2 x2' + (4 + k2 b) x2 = 0, real a and b within [-1, 1]:
# stable exactly for k1 < 1 and k2 < 4. Complex a would allow k1 < 0.2 only (the damping at resonance), so G is needed.
SPRINGS = {"A": "diag([[0, 1], [-1, -0.2]], [[0, 1], [-4, -0.2]])", "Cz": "[[1, 0, 0, 0], [0, 0, 1, 0]]",
           "arcs": ["0", "1"], "alpha": "0", "scale": "1"}  # fmt: skip


def springs(k1, k2, g, blocks=(("repeated", 1), ("repeated", 1)), d=("1", "1")):
    a = linalg.block_diag([[0, 1], [-1, -0.2]], [[0, 1], [-4, -0.2]])
    p = linalg.solve_continuous_lyapunov(a.T, -np.eye(4))
    fields = {**SPRINGS, "H": f"[[0, 0], [-{k1}, 0], [0, 0], [0, -{k2}]]", "blocks": [list(b) for b in blocks]}
    return accepted("contour", fields, {"P": (p + p.T) / 2, "d": [list(d)], "g": [list(g)]})


def test_real_parameters_need_their_own_multipliers():
    # 1 - |M|^2 + 2 g Im M > 0 on the whole axis, M = k / (w0^2 - w^2 + 0.2 i w): by hand for these g
    assert springs("0.5", "1", ("2", "1.5"))
    assert springs("0.5", "1", ("4", "3"), d=("2", "2"))
    assert springs("0.1", "1", ("0", "1.5"))
    assert springs("0.1", "1", ("0", "1.5"), blocks=(("full", 1, 1), ("repeated", 1)))
    # at w = 1 the first form is 0.04 + 0.2 g - 0.25 over 0.04: it needs g > 1.05
    assert springs("0.5", "1", ("1.1", "1.5"))
    assert springs("0.5", "1", ("1", "1.5")) is None
    assert springs("0.5", "1", ("0", "1.5")) is None
    assert springs("0.5", "1", ("2", "0")) is None
    assert springs("0.5", "1", ("-2", "1.5")) is None
    assert springs("0.5", "1", ("2", "1.5"), blocks=(("full", 1, 1), ("repeated", 1))) is None


@pytest.mark.parametrize("g", ["0", "1", "2", "20", "1000"])
def test_no_multiplier_proves_an_unstable_spring_stable(g):
    assert springs("1.05", "1", (g, "1.5")) is None
    assert springs("0.5", "4.1", ("2", g)) is None
