"""(13) has a solution at some positive scalars, (17) at none: the two are not equivalent, as Theorem 2 says."""

from collections.abc import Mapping

import numpy as np

from gainsay.proof import Certificate, build
from gainsay.statements import Stated
from papers.li2021.conditions import Model
from papers.li2021.statements import TABLES, THEOREM_1, equation_13

#: scalars at which (13) holds: those of Table 1, but for these two
EPS2, DELTA_M = "0.0001", "0.000001"


def point(model: Model, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """S, N, Fa, Fb, Cf of Theorem 1 from X, Y, Ah, Bh, Ch of `lmis.lemma3_synthesis`."""
    A, B, C = model.A, model.B, model.C
    X = (values["X"] + values["X"].T) / 2
    S = np.linalg.inv((values["Y"] + values["Y"].T) / 2)
    S = (S + S.T) / 2
    Cf, Fb = values["Ch"] @ S, values["Bh"]
    Fa = values["Ah"] @ S - (X @ A + Fb @ C + X @ B @ Cf)
    return {"S": S, "N": S - X, "Fa": Fa, "Fb": Fb, "Cf": Cf}


def certificate(case, values: Mapping[str, np.ndarray]) -> Certificate:
    """A solution of (13), in the reading in which eps2 multiplies psi_3; 1/eps2 serves the other reading."""
    eq13 = equation_13(divided=False).defining(**{**TABLES, "eps2": EPS2, "dm": DELTA_M})
    return build.feasible_point(
        id="eq13-feasible-elsewhere",
        paper=case.name,
        statement=f"(13) has a solution at Table 1's lambda, gamma and eps1 with eps2 = {EPS2}, delta_m = {DELTA_M}.",
        point=point(Model.of(case), values),
        quantities={"feasible": "eq13.feasible_elsewhere"},
        faith=("That (13), which is lost, reads as rebuilt: a condition that gives (15), as Lemma 1 says.",),
        **Stated(case, [eq13 < 0, "S > 0", "N < 0"], unknowns=THEOREM_1).parts(),
    )
