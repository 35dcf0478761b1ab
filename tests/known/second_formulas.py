"""Formulas of certificates in 40 digits, boxes and intervals at drawn points: for the second judge of the tests."""

import ast
from itertools import product

import mpmath as mp
import numpy as np
from scipy import linalg

mp.mp.dps = 40
SLACK = mp.mpf(10) ** -25


class Untrue(AssertionError):
    """What a certificate concludes is not true."""


def number(text):
    top, _, bottom = text.strip().partition("/")
    return mp.mpf(top) / mp.mpf(bottom) if bottom else mp.mpf(top)


def matrix(rows):
    if isinstance(rows, str):
        rows = [[rows]]
    return np.array([[number(x) for x in row] for row in rows], dtype=object)


def doubles(m):
    return np.array(m, dtype=float)


def parsed(text):
    """Tree of a formula, its literals with their text: a double would not hold all their digits."""
    text = text.strip()
    node = ast.parse(text, mode="eval").body
    for part in ast.walk(node):
        if isinstance(part, ast.Constant):
            part.text = text[part.col_offset : part.end_col_offset]
    return node


class Formulas:
    """Formulas of a certificate over given values of its unknowns; every box is one drawn matrix of it."""

    def __init__(self, plain, data, values, draw):
        self.data, self.draw, self.boxes = data, draw, {}
        self.names = {"pi": np.array([[mp.pi()]], dtype=object), **values}
        for name, text in plain["definitions"]:
            self.names[name] = self.value(text)

    def value(self, text):
        return self.visit(parsed(text))

    def constraint(self, text):
        node = parsed(text)
        left, right = self.visit(node.left), self.visit(node.comparators[0])
        relation = {ast.Lt: "<", ast.LtE: "<=", ast.Eq: "==", ast.GtE: ">=", ast.Gt: ">"}[type(node.ops[0])]
        if right.shape == (1, 1) and right[0, 0] == 0:
            return left, relation
        if left.shape == (1, 1) and left[0, 0] == 0:
            return -right, relation
        assert left.shape == right.shape
        return left - right, relation

    def number(self, text):
        value = self.value(str(text))
        assert value.shape == (1, 1)
        return value[0, 0]

    def visit(self, node):
        match node:
            case ast.Constant(value=int() | float()):
                return np.array([[mp.mpf(node.text)]], dtype=object)
            case ast.Name(id=name):
                return self.names[name]
            case ast.UnaryOp(op=ast.USub()):
                return -self.visit(node.operand)
            case ast.UnaryOp(op=ast.UAdd()):
                return self.visit(node.operand)
            case ast.Attribute(attr="T"):
                return self.visit(node.value).T
            case ast.BinOp(op=ast.Pow()):
                base, result = self.visit(node.left), None
                for _ in range(node.right.value):
                    result = base if result is None else result.dot(base)
                return np.array([[mp.mpf(int(i == j)) for j in range(len(base))] for i in range(len(base))],
                                dtype=object) if result is None else result  # fmt: skip
            case ast.BinOp():
                return self.operate(node.op, self.visit(node.left), self.visit(node.right))
            case ast.List(elts=lines):
                return self.block([[self.cell(x) for x in line.elts] for line in lines])
            case ast.Subscript():
                return self.part(self.visit(node.value), node.slice)
            case ast.Call(func=ast.Name(id=name)):
                return self.call(name, node.args)
        raise AssertionError(ast.dump(node))

    def operate(self, op, a, b):
        match op:
            case ast.Add() | ast.Sub():
                assert a.shape == b.shape
                return a + b if isinstance(op, ast.Add) else a - b
            case ast.MatMult():
                return a.dot(b)
            case ast.Div():
                return a / b[0, 0]
            case ast.Mult():
                return b * a[0, 0] if a.shape == (1, 1) else a * b[0, 0]
        raise AssertionError(op)

    def cell(self, node):
        return None if isinstance(node, ast.Constant) and node.value is ... else self.visit(node)

    def block(self, rows):
        rows = [[rows[j][i].T if x is None else x for j, x in enumerate(row)] for i, row in enumerate(rows)]

        def fills(x):
            return x.shape == (1, 1) and x[0, 0] == 0

        high = [max([x.shape[0] for x in row if not fills(x)], default=1) for row in rows]
        wide = [max([row[j].shape[1] for row in rows if not fills(row[j])], default=1) for j in range(len(rows[0]))]
        grid = [[np.full((h, w), mp.mpf(0), dtype=object) if fills(x) else x for x, w in zip(row, wide, strict=True)]
                for row, h in zip(rows, high, strict=True)]  # fmt: skip
        return np.vstack([np.hstack(row) for row in grid])

    def part(self, value, node):
        parts = list(node.elts) if isinstance(node, ast.Tuple) else [node]
        if len(parts) == 1:
            parts = [*parts, ast.Slice()] if value.shape[1] == 1 else [ast.Slice(), *parts]
        places = []
        for part, size in zip(parts, value.shape, strict=True):
            if isinstance(part, ast.Slice):
                low = part.lower.value if part.lower else 0
                places.append(range(low, part.upper.value if part.upper else size))
            else:
                places.append([part.value])
        return value[np.ix_(*places)]

    def box(self, name):
        if name not in self.boxes:
            middle, half = matrix(self.data["printed"][name]), matrix(self.data["half_units"][name])
            turns = [[mp.mpf(self.draw.uniform(-1, 1)) for _ in row] for row in middle]
            self.boxes[name] = middle + half * np.array(turns, dtype=object)
        return self.boxes[name]

    def call(self, name, args):
        match name:
            case "number":
                return matrix(self.data["number"][args[0].value])
            case "printed":
                return matrix(self.data["printed"][args[0].value])
            case "box":
                return self.box(args[0].value)
            case "design":
                return matrix(self.data["design"][f"{args[0].value}.{args[1].value}"])
            case "interval":
                low, high = (self.visit(x)[0, 0] for x in args)
                return np.array([[low + (high - low) * mp.mpf(self.draw.random())]], dtype=object)
            case "plausible" | "ends":
                low, high = map(number, self.data["plausible"][args[0].value].split(".."))
                between = [low + (high - low) * mp.mpf(self.draw.random())]
                return np.array([between if name == "plausible" else [low, high]], dtype=object)
            case "eye" | "zeros":
                m, n = args[0].value, args[-1].value
                return np.array([[mp.mpf(int(name == "eye" and i == j)) for j in range(n)] for i in range(m)],
                                dtype=object)  # fmt: skip
            case "unit":
                return self.call("eye", args[:1])[:, [args[1].value]]
            case "take":
                return self.visit(args[0])[np.ix_(*[[x.value for x in a.elts] for a in args[1:]])]
        values = [self.visit(x) for x in args]
        match name:
            case "block":
                return values[0]
            case "col":
                return self.block([[x] for x in values])
            case "row":
                return self.block([values])
            case "diag":
                zero = np.array([[mp.mpf(0)]], dtype=object)
                if all(x.shape[0] == x.shape[1] for x in values):
                    return self.block([[x if i == j else np.full((x.shape[0], y.shape[1]), mp.mpf(0), dtype=object)
                                        for j, y in enumerate(values)] for i, x in enumerate(values)])  # fmt: skip
                return self.block([[x if i == j else zero for j in range(len(values))] for i, x in enumerate(values)])
            case "sym":
                return values[0] + values[0].T
            case "trace":
                return np.array([[sum(values[0].diagonal())]], dtype=object)
            case "inverse":
                return np.array((mp.matrix(values[0].tolist()) ** -1).tolist(), dtype=object)
            case "kron":
                return np.kron(*values)
            case "sqrt" | "sin" | "cos" | "exp" | "log":
                return np.vectorize(getattr(mp, name), otypes=[object])(values[0])
        raise AssertionError(name)


def spectrum(m):
    """Extreme eigenvalues of a symmetric matrix in 40 digits."""
    m = (m + m.T) / 2
    values = mp.eigsy(mp.matrix(m.tolist()), eigvals_only=True)
    return min(values), max(values)


def ordered(form, relation):
    if relation == "==":
        return all(abs(x) <= SLACK for x in form.ravel())
    assert form.shape[0] == form.shape[1]
    scale = max([abs(x) for x in form.ravel()] + [SLACK])
    low, high = spectrum(form)
    return low > -SLACK * scale if relation in (">", ">=") else high < SLACK * scale


def given_point(plain):
    return {name: matrix(plain["witness"][name]) for name in plain["unknowns"]}


def drawn_point(plain, draw):
    point = {}
    for name, raw in plain["unknowns"].items():
        (m, n), structure = raw.get("shape", [1, 1]), raw.get("structure", "full")
        rows = np.array([[mp.mpf(draw.randint(-40, 40)) / 8 for _ in range(n)] for _ in range(m)], dtype=object)
        if structure == "symmetric":
            rows = rows + rows.T
        elif structure == "skew":
            rows = rows - rows.T
        elif structure == "diagonal":
            rows = rows * np.eye(m, dtype=int)
        point[name] = rows
    return point


def in_boxes(plain, data, draw, point):
    for name, printed in plain["fields"].get("boxes", {}).items():
        middle, half = matrix(data["printed"][printed]), matrix(data["half_units"][printed])
        turns = np.array([[mp.mpf(draw.uniform(-1, 1)) for _ in row] for row in middle], dtype=object)
        if plain["unknowns"][name].get("structure") == "symmetric":
            turns = np.triu(turns) + np.triu(turns, 1).T
        point[name] = middle + half * turns
    return point


def bottleneck(costs):
    from scipy.optimize import linear_sum_assignment

    for bound in np.unique(costs):
        chosen = linear_sum_assignment((costs > bound).astype(float))
        if not (costs > bound)[chosen].any():
            return mp.mpf(float(bound))
    return mp.inf


def gain(a, b, c, d, grid=400):
    """Largest singular value over a grid of frequencies, and at its best point refined."""
    scale = np.abs(linalg.eigvals(a))
    low, high = max(scale.min(), 1e-9) / 100, scale.max() * 100 + 1e-9
    points = [0.0, *np.geomspace(low, high, grid), *np.abs(linalg.eigvals(a).imag)]
    return max(linalg.norm(c @ linalg.solve(1j * w * np.eye(len(a)) - a, b) + d, 2) for w in points)


def contraction(p, q, draw):
    m = np.array([[draw.gauss(0, 1) for _ in range(q)] for _ in range(p)])
    return m / linalg.norm(m, 2)


def uncertainties(blocks, draw, count=25):
    """Drawn admissible Delta, the corners of a few numbers among them."""

    def one(pick):
        parts = [np.eye(e[1]) * pick() if e[0] == "repeated" else contraction(e[1], e[2], draw) for e in blocks]
        return linalg.block_diag(*parts)

    corners = list(product((-1.0, 1.0), repeat=min(len(blocks), 4)))
    for corner in corners:
        values = iter(corner + tuple(draw.choice((-1.0, 1.0)) for _ in blocks))
        yield one(lambda values=values: next(values))
    for _ in range(count):
        yield one(lambda: draw.uniform(-1, 1))


def listed(at, text):
    return [at.value(t) for t in (text if isinstance(text, list) else [text])]
