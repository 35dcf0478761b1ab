"""(13) has a solution at some positive scalars, (17) at none: the two are not equivalent, as Theorem 2 says."""

from collections.abc import Mapping

import numpy as np

from gainsay.proof import Certificate, build
from papers.li2021.lmis import Model
from papers.li2021.proofs import PLANT, UNCERTAIN, blocks, full, symmetric

#: scalars at which (13) holds: those of Table 1, but for these two
EPS2, DELTA_M = "0.0001", "0.000001"
SCALARS = (("lam", "number('lambda')"), ("eps1", "number('eps1')"), ("eps2", EPS2), ("dm", DELTA_M))
NAMES = ("a", "b", "e", "d", "w", "pa", "pb", "hi", "ho", "f1", "f2", "f3", "g1", "g2", "g3")
ENTRIES = {
    ("a", "a"): "C.T @ C - r*S", ("a", "b"): "C.T @ C - r*S", ("b", "b"): "C.T @ C - r*(S - N)",
    ("a", "e"): "-S @ B", ("b", "e"): "-(S - N) @ B", ("a", "d"): "S @ B", ("b", "d"): "(S - N) @ B",
    ("a", "w"): "lam * (W @ (A0 + B @ Cf)).T", ("b", "w"): "lam * (W @ A0).T",
    ("a", "pa"): "(A0 + B @ Cf + a*eye(6)).T @ S",
    ("a", "pb"): "(A0 + B @ Cf).T @ (S - N) + C.T @ Fb.T + Fa.T + a*S",
    ("b", "pa"): "(A0 + a*eye(6)).T @ S", ("b", "pb"): "(A0 + a*eye(6)).T @ (S - N) + C.T @ Fb.T",
    ("e", "e"): "-lam**2 * eye(3)", ("e", "w"): "-lam * (W @ B).T",
    ("d", "d"): "-number('gamma')**2 * eye(3)", ("d", "w"): "lam * (W @ B).T", ("w", "w"): "-eye(3)",
    ("pa", "pa"): "-a*S", ("pa", "pb"): "-a*S", ("pb", "pb"): "-a*(S - N)",
    ("a", "hi"): "eps1 * K.T", ("b", "hi"): "eps1 * K.T",
    ("w", "ho"): "lam * W @ L", ("pa", "ho"): "S @ L", ("pb", "ho"): "(S - N) @ L",
    ("hi", "hi"): "-eps1 * eye(12)", ("ho", "ho"): "-eps1 * eye(12)",
    ("a", "f1"): "eps2 * eye(6)", ("a", "f2"): "eps2 * C.T", ("a", "f3"): "eps2 * Cf.T", ("b", "f2"): "eps2 * C.T",
    ("pb", "g1"): "dm * Fa", ("pb", "g2"): "dm * Fb",
    ("w", "g3"): "lam * dm * W @ B", ("pa", "g3"): "dm * S @ B", ("pb", "g3"): "dm * (S - N) @ B",
    **{(x, x): "-eps2 * eye(6)" for x in ("f1", "g1")},
    **{(x, x): "-eps2 * eye(3)" for x in ("f2", "f3", "g2", "g3")},
}  # fmt: skip


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
    return build.feasible_point(
        id="eq13-feasible-elsewhere",
        paper=case.name,
        tables=case,
        statement=f"(13) has a solution at Table 1's lambda, gamma and eps1 with eps2 = {EPS2}, delta_m = {DELTA_M}.",
        definitions=(*PLANT, *UNCERTAIN, *SCALARS),
        unknowns={**symmetric(S=6, N=6), **full(Fa=(6, 6), Fb=(6, 3), Cf=(3, 6))},
        fields={"constraints": [["(13)", f"{blocks(NAMES, ENTRIES)} < 0"], ["S", "S > 0"], ["N", "N < 0"]]},
        point=point(Model.of(case), values),
        quantities={"feasible": "eq13.feasible_elsewhere"},
        faith=("That (13), printed in part, borders (15) with the two pairs of (16) as Lemma 1 says.",),
    )
