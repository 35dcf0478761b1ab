"""The condition that bounds the torque of li2021, against the forms that it is to stand for."""

import numpy as np

from gainsay.exact.matrix import Matrix
from gainsay.lmi import Infeasible
from gainsay.proof import MappingTables, formulas
from gainsay.proof.scope import Reader
from gainsay.statements.floats import nearest
from papers.li2021.statements_torque import DATA, falling, torque_within

RNG = np.random.default_rng(7)
OF_CHANNEL = (0, 1, 1, 2)
SHAPES = {"A": (3, 3), "H": (3, 4), "Cz": (4, 3), "Dw": (4, 4), "k": (2, 3), "x0": (3, 1)}


def drawn():
    """Small integers over eight: sums of their products are exact in doubles."""
    return {name: RNG.integers(-8, 9, SHAPES[name]) / 8 for name in DATA}


def test_the_form_is_the_derivative_with_the_multiplied_channels():
    # d/dt xi'P xi + z'D z - w'D w along xi' = A xi + H w, z = Cz xi + Dw w, written out by hand
    data, statement = drawn(), falling(3, OF_CHANNEL)
    P = RNG.integers(-8, 9, (3, 3))
    P, d = P + P.T, RNG.integers(1, 9, 3)
    tables = Reader(
        MappingTables(printed={name: [[repr(float(x)) for x in row] for row in data[name]] for name in DATA}), "test"
    )
    names = {"P": Matrix.of(P.tolist()), **{f"d{i}": Matrix.of([[int(x)]]) for i, x in enumerate(d)}}
    for name, text in statement.definitions(None).items():
        names[name] = formulas.evaluate(text, names, tables)
    form = nearest(formulas.evaluate(statement.formula, names, tables))
    for _ in range(5):
        xi, w = RNG.integers(-4, 5, 3), RNG.integers(-4, 5, 4)
        z, weights = data["Cz"] @ xi + data["Dw"] @ w, d[list(OF_CHANNEL)]
        expected = 2 * xi @ P @ (data["A"] @ xi + data["H"] @ w) + z @ (weights * z) - w @ (weights * w)
        joined = np.concatenate([xi, w])
        assert joined @ form @ joined == expected


def test_the_least_bound_of_a_free_loop_is_its_largest_output():
    # closed form: xi' = -a xi without channels to speak of, k = 1, x0 = 2: the output is largest at the start, 2
    tiny = 1e-3
    data = {
        "A": np.array([[-1.0]]),
        "H": np.array([[tiny]]),
        "Cz": np.array([[tiny]]),
        "Dw": np.zeros((1, 1)),
        "k": np.array([[1.0]]),
        "x0": np.array([[2.0]]),
    }
    point = torque_within(data, (0,), "4.004").solve().need("toy")
    assert 4 < 4 * point["P"].item() < 4.004
    assert isinstance(torque_within(data, (0,), "4").solve(), Infeasible)
