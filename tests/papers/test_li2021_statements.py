"""A second transcription of the inequalities of li2021, from the text's LaTeX, held against the statements."""

from pathlib import Path

import numpy as np
import pytest

from gainsay.errors import CertificateError
from gainsay.statements.floats import Floats
from gainsay.tables import read_case
from papers.li2021 import derivations, derivations_appendix2
from papers.li2021 import statements as st

CASE = read_case(Path(__file__).resolve().parents[2], "li2021")
RNG = np.random.default_rng(5)


def drawn(statement) -> dict[str, np.ndarray]:
    """A random value for every letter of a statement; the numbers positive."""
    found = {}
    for name, unknown in statement.unknowns.items():
        value = RNG.normal(size=(unknown.rows, unknown.columns)).round(3)
        value = value + value.T if unknown.structure == "symmetric" else value
        found[name] = abs(value) + 0.5 if unknown.positive else value
    return found


def value(statement, at: dict[str, np.ndarray]) -> np.ndarray:
    texts = {name: str([[float(x) for x in row] for row in matrix]) for name, matrix in at.items()}
    texts |= {name: repr(float(at[name][0, 0])) for name, unknown in statement.unknowns.items() if unknown.positive}
    rest = {name: text for name, text in statement.definitions(CASE).items() if name not in texts}
    return Floats(CASE, {**texts, **rest}, {}).constant(statement.formula)


def star(rows) -> np.ndarray:
    """Symmetric block matrix from its upper triangle; a 0 fills, each row starts at its diagonal."""
    n = len(rows)
    heights = [rows[i][0].shape[0] for i in range(n)]
    grid = [[np.zeros((heights[i], heights[j])) for j in range(n)] for i in range(n)]
    for i, row in enumerate(rows):
        for j, block in enumerate(row, start=i):
            if not np.isscalar(block):
                grid[i][j], grid[j][i] = block, block.T
    return np.block(grid)


def agree(statement, transcribed) -> None:
    at = drawn(statement)
    plain = {name: (float(m[0, 0]) if statement.unknowns[name].positive else m) for name, m in at.items()}
    assert np.allclose(value(statement, at), star(transcribed(**plain)), rtol=1e-12, atol=1e-12)


def I(n):  # noqa: E743  # the paper's letter
    return np.eye(n)


def eq12(P, A_t, B_t, E_t, C_t, W_t, a, r, lam, g):
    return [
        [-r * P, -P @ E_t, P @ B_t, lam * A_t.T @ W_t.T, C_t.T, (A_t + a * I(12)).T @ P],
        [-(lam**2) * I(3), 0, -lam * E_t.T @ W_t.T, 0, 0],
        [-g * I(3), lam * B_t.T @ W_t.T, 0, 0],
        [-I(3), 0, 0],
        [-I(3), 0],
        [-a * P],
    ]


def corner(P, A, C, W, lam):
    return A.T @ P + P @ A + lam**2 * A.T @ W.T @ W @ A + C.T @ C


def eq_a4(P, A_t, B_t, E_t, C_t, W_t, a, r, lam, g):
    l2 = lam**2
    return [
        [corner(P, A_t, C_t, W_t, lam), -P @ E_t - l2 * A_t.T @ W_t.T @ W_t @ E_t,
         P @ B_t + l2 * A_t.T @ W_t.T @ W_t @ B_t],
        [l2 * E_t.T @ W_t.T @ W_t @ E_t - l2 * I(3), -l2 * E_t.T @ W_t.T @ W_t @ B_t],
        [l2 * B_t.T @ W_t.T @ W_t @ B_t - g * I(3)],
    ]  # fmt: skip


def eq_a5(P, A_t, B_t, E_t, C_t, W_t, a, r, lam, g):
    rows = eq_a4(P, A_t, B_t, E_t, C_t, W_t, a, r, lam, g)
    b2 = r * a  # r is b^2/a
    rows[0][0] = A_t.T @ P @ A_t / a + (a**2 - b2) / a * P + corner(P, A_t, C_t, W_t, lam)
    return rows


def eq_a1(P, A_t, a, r):
    return [[(A_t + a * I(12)).T @ (P / a) @ (A_t + a * I(12)) - r * P]]


def eq15(S, N, A, B1, B2, C, E, W0, Ad, Bd, Cd, a, r, lam, g):
    Y = S - N
    one_one = np.block([[-r * S + C.T @ C, -r * S + C.T @ C], [-r * S + C.T @ C, -r * Y + C.T @ C]])
    psi14 = np.vstack([lam * A.T @ W0.T + lam * Cd.T @ B1.T @ W0.T, lam * A.T @ W0.T])
    psi15 = np.block([
        [A.T @ S + Cd.T @ B1.T @ S + a * S, A.T @ Y + C.T @ Bd.T @ N + Cd.T @ B1.T @ Y + Ad.T @ N + a * S],
        [A.T @ S + a * S, A.T @ Y + C.T @ Bd.T @ N + a * Y],
    ])  # fmt: skip
    return [
        [one_one, np.vstack([-S @ E, -Y @ E]), np.vstack([S @ B2, Y @ B2]), psi14, psi15],
        [-(lam**2) * I(3), 0, -lam * E.T @ W0.T, 0],
        [-g * I(3), lam * B2.T @ W0.T, 0],
        [-I(3), 0],
        [np.block([[-a * S, -a * S], [-a * S, -a * Y]])],
    ]


def eq13(divided):
    def rows(S, N, Fa, Fb, Cf, A0, B1, B2, C, E, W0, L, K, a, r, lam, g, eps1, eps2, dm):
        # the where-list of Theorem 1; the border as (16) and Lemma 1 give it
        found = eq15(S, N, A0, B1, B2, C, E, W0, 0 * Fa, 0 * Fb, Cf, a, r, lam, g)
        found[0][4] = np.block([
            [A0.T @ S + Cf.T @ B1.T @ S + a * S,
             A0.T @ (S - N) + C.T @ Fb.T + Cf.T @ B1.T @ (S - N) + Fa.T + a * S],
            [A0.T @ S + a * S, A0.T @ (S - N) + C.T @ Fb.T + a * (S - N)],
        ])  # fmt: skip
        o = np.zeros
        one_six = np.vstack([eps1 * K.T, eps1 * K.T])
        psi1, psi2 = lam * W0 @ L, np.vstack([S @ L, (S - N) @ L])
        psi3 = np.block([[I(6), C.T, Cf.T], [o((6, 6)), C.T, o((6, 3))]])
        psi4 = np.hstack([o((3, 6)), o((3, 3)), lam * dm * W0 @ B1])
        psi5 = np.block([[o((6, 6)), o((6, 3)), dm * S @ B1], [dm * Fa, dm * Fb, dm * (S - N) @ B1]])
        first, second = (1, eps2) if divided else (eps2, 1)
        found[0] += [one_six, 0, first * psi3, 0]
        found[1] += [0, 0, 0, 0]
        found[2] += [0, 0, 0, 0]
        found[3] += [0, psi1, 0, second * psi4]
        found[4] += [0, psi2, 0, second * psi5]
        return [*found, [-eps1 * I(12), 0, 0, 0], [-eps1 * I(12), 0, 0], [-eps2 * I(12), 0], [-eps2 * I(12)]]

    return rows


def eq17(divided, thin):
    # "(17) where Xi is (13) less the coupling C_f' B1' (S - N) in (1, 5)", and what goes with it in S; Lemma 2 puts
    # Phi, Psi in a border of -2 I with 1/lambda1, lambda1
    def rows(S, N, Fa, Fb, Cf, A0, B1, B2, C, E, W0, L, K, a, r, lam, g, eps1, eps2, dm, lam1):
        found = eq13(divided)(S, N, Fa, Fb, Cf, A0, B1, B2, C, E, W0, L, K, a, r, lam, g, eps1, eps2, dm)
        Y = S - N
        found[0][4] = found[0][4] - np.vstack([np.hstack([Cf.T @ B1.T @ S, Cf.T @ B1.T @ Y]), np.zeros((6, 12))])
        phi, psi = (Cf.T, np.vstack([S @ B1, Y @ B1])) if thin else (Cf.T @ B1.T, np.vstack([S, Y]))
        width = phi.shape[1]
        last = [np.vstack([phi, np.zeros((6, width))]) / lam1, 0, 0, 0, lam1 * psi, 0, 0, 0, 0]
        return [*([*row, cell] for row, cell in zip(found, last, strict=True)), [-2 * I(width)]]

    return rows


def all_gains(uncertain):
    # (12) times diag(T, I, I, I, I, T), T = [[X, I], [V', 0]], with products of P, T and the loop by their blocks
    def rows(X, Y, Ah, Fb, Ch, A0, B1, B2, C, E, W0, L, K, a, r, lam, g, eps1):
        TPT = np.block([[X, I(6)], [I(6), Y]])
        TPAT = np.block([[A0 @ X + B1 @ Ch, A0], [Ah, Y @ A0 + Fb @ C]])
        TP_B, AT, CT = (lambda M: np.vstack([M, Y @ M])), np.hstack([A0 @ X + B1 @ Ch, A0]), np.hstack([C @ X, C])
        found = [
            [-r * TPT, -TP_B(E), TP_B(B2), lam * (W0 @ AT).T, CT.T, (TPAT + a * TPT).T],
            [-(lam**2) * I(3), 0, -lam * (W0 @ E).T, 0, 0],
            [-g * I(3), lam * (W0 @ B2).T, 0, 0],
            [-I(3), 0, 0],
            [-I(3), 0],
            [-a * TPT],
        ]
        if not uncertain:
            return found
        into = [eps1 * np.hstack([K @ X, K]).T, 0, 0, 0, 0, 0]
        out = [0, 0, 0, lam * W0 @ L, 0, TP_B(L)]
        found = [[*row, one, two] for row, one, two in zip(found, into, out, strict=True)]
        return [*found, [-eps1 * I(12), 0], [-eps1 * I(12)]]

    return rows


def eq19(S, N, Cf, u_max, theta, eps3, dm):
    return [
        [-(u_max**2) * I(3) + eps3 * dm**2 * I(3), -Cf, 0, 0],
        [-S / theta, -S / theta, Cf.T],
        [-(S - N) / theta, 0],
        [-eps3 * I(3)],
    ]


def eq20(S, N, x0, theta):
    return [[-theta * I(1), -x0.T, -x0.T], [-S, -S], [-(S - N)]]


def eq_b2(P, K_t, u_max, theta):
    return [[-(u_max**2) * I(3), -K_t], [-P / theta]]


def eq_b3(S, N, Cd, u_max, theta):
    return [[-(u_max**2) * I(3), -Cd, 0], [-S / theta, -S / theta], [-(S - N) / theta]]


def eq_b5(P, xi0, theta):
    return [[-theta * I(1), -xi0.T], [-P]]


@pytest.mark.parametrize(
    ("statement", "transcribed"),
    [
        (st.EQ12, eq12), (st.EQ_A1, eq_a1), (st.EQ_A4, eq_a4), (st.EQ_A5, eq_a5), (st.EQ15, eq15),
        (st.equation_13(False), eq13(False)), (st.equation_13(True), eq13(True)), (st.EQ19, eq19), (st.EQ20, eq20),
        *((st.equation_17(divided, thin), eq17(divided, thin)) for divided in (False, True) for thin in (False, True)),
        (st.all_gains(False), all_gains(False)), (st.all_gains(True), all_gains(True)),
        (st.EQ_B2, eq_b2), (st.EQ_B3, eq_b3), (st.EQ_B5, eq_b5),
    ],
    ids=lambda x: getattr(x, "label", None) or "",
)  # fmt: skip
def test_statement_is_the_second_transcription(statement, transcribed):
    for _ in range(3):
        agree(statement, transcribed)


def test_a_changed_cell_is_noticed():
    changed = st.EQ12.corrected({("2", "4"): "lam * E_t.T @ W_t.T"})
    with pytest.raises(AssertionError):
        agree(changed, eq12)


class Kept:
    """Takes the certificates of a task."""

    def __init__(self) -> None:
        self.relations: dict[str, str] = {}

    def prove(self, certificate, **_) -> None:
        self.relations |= {c.quantity: c.relation for c in certificate.conclusions}

    def certificate(self, certificate) -> None:
        self.relations[certificate.id] = certificate.conclusions[0].relation

    def say(self, *_) -> None:
        pass


def test_derivations_hold():
    kept = Kept()
    for work in (*derivations.TASKS, *derivations_appendix2.TASKS):
        work(CASE, kept)
    assert set(kept.relations.values()) == {"holds"} and len(kept.relations) == 18


@pytest.mark.parametrize("derive", [derivations.to_all_gains, lambda case: derivations.from_all_gains(case, True)])
def test_the_form_for_all_gains_is_12_and_no_other(monkeypatch, derive):
    wrong = st.EQ12.corrected({("2", "4"): "lam * E_t.T @ W_t.T"}).defining(label="(12)")
    monkeypatch.setattr(derivations, "EQ12", wrong)
    with pytest.raises(CertificateError, match="not proved to be the sum"):
        derive(CASE)


def test_a_wrong_sign_is_no_derivation(monkeypatch):
    # (15) with the sign of one block turned does not follow from (12)
    wrong = st.EQ15.corrected({("1a", "3"): "-S @ B2"})
    monkeypatch.setattr(derivations, "EQ15", wrong)
    with pytest.raises(CertificateError, match="not proved to be the sum"):
        derivations.structure(CASE, Kept())


def test_entries_of_the_rotation_and_of_g0():
    # -s phi c psi + c phi s theta c psi of (2); n^2 J20 - J10 of G0(3,3)
    sf, cf, st_, cp = RNG.normal(size=4)
    at = {"sf": sf, "cf": cf, "st": st_, "cp": cp}
    texts = {name: repr(float(number)) for name, number in at.items()}
    assert Floats(CASE, texts, {}).constant(st.ROTATION_32.formula) == pytest.approx(-sf * cp + cf * st_ * cp)
    n, J10, J20 = (CASE.number(name) for name in ("orbital_rate", "J10", "J20"))
    assert Floats(CASE, dict(st.PLANT), {}).constant(st.G0_33.formula) == pytest.approx(n**2 * J20 - J10)


def test_letters_stand_for_the_numbers_of_the_paper():
    # g is gamma^2: the bounded real lemma bounds the square of the gain (Lemma 2)
    letters = Floats(CASE, st.TABLES, {})
    assert letters.constant("g") == pytest.approx(CASE.number("gamma") ** 2, rel=1e-15)
    for letter, name in (("lam", "lambda"), ("eps1", "eps1"), ("eps2", "eps2"), ("dm", "delta_m")):
        assert letters.constant(letter) == pytest.approx(CASE.number(name), rel=1e-15)
