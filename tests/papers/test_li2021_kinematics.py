"""(2) to (6) of li2021 as identities, beside a rotation of another library; the printed rotation is refused."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gainsay.errors import CertificateError
from gainsay.tables import read_case
from papers.li2021 import audit
from papers.li2021 import derivations_identities as identities

ROOT = Path(__file__).resolve().parents[2]
ANGLES = {"phi": 0.3, "theta": -0.4, "psi": 0.7}


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "li2021")


def at(text: str) -> np.ndarray:
    letters = {"f": "phi", "t": "theta", "p": "psi"}
    names = {f"s{k}": np.sin(ANGLES[v]) for k, v in letters.items()}
    names |= {f"c{k}": np.cos(ANGLES[v]) for k, v in letters.items()}
    return np.array(eval(text, {}, names))  # a formula of this project's own


def test_rotation_is_that_of_scipy():
    # scipy turns body components into those of the frame, by yaw, pitch and roll about moving axes
    expected = Rotation.from_euler("ZYX", [ANGLES[name] for name in ("psi", "theta", "phi")]).as_matrix().T
    assert np.allclose(at(identities.rotation(identities.ROTATION_32_CORRECTED.formula)), expected, atol=1e-15)
    assert not np.allclose(at(identities.rotation(identities.ROTATION_32.formula)), expected, atol=1e-2)


def test_identities_hold(case):
    found = {c.conclusions[0].quantity: c.conclusions[0].relation for c in identities.kinematics(case)}
    assert found.pop("eq2.printed") == "fails"
    assert set(found.values()) == {"holds"} and len(found) == 6


def test_printed_rotation_is_refused(case, monkeypatch):
    monkeypatch.setattr(identities, "ROTATION_32_CORRECTED", identities.ROTATION_32)
    with pytest.raises(CertificateError, match=r"eq2-rotation"):
        identities.kinematics(case)


def test_radius_of_the_geostationary_orbit():
    # publication: a sidereal day of 86164.1 s gives 42 164 km
    assert np.cbrt(audit.MU_EARTH * (86164.1 / (2 * np.pi)) ** 2) == pytest.approx(42164e3, abs=500)
