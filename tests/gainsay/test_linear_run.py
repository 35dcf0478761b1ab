"""A run declared in one call: the oscillator, in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest

from gainsay.errors import InputError
from gainsay.logs import LogWriter, linear_run, read_log
from gainsay.simulation.linear import Response

A = np.array([[0.0, 1.0], [-1.0, -0.2]])


def oscillator(case, steps):
    return Response(A, np.array([1.0, 0.0]), 10.0, steps)


def signals(case):
    return {"/mass": ({"x": "m", "v": "m/s"}, np.eye(2)), "/force": ({"u": "N"}, [[-1, -0.2]])}


def numbers(case, found):
    return {"run.undershoot": found.largest(np.array([-1.0, 0.0])).value, "run.mesh": float(len(found.time))}


def declared(*names):
    rows = {name: SimpleNamespace(unit="m", step="simulation") for name in names}
    paper = SimpleNamespace(runs={"nominal": "released from 1 m"})
    return SimpleNamespace(
        name="toy", paper=paper, quantities=rows | {"audit.x": SimpleNamespace(unit="1", step="audit")}
    )


def logged(tmp_path, case, numbers=numbers, **more):
    run = linear_run("nominal", oscillator, signals, numbers, steps=200, **more)
    with LogWriter(tmp_path / "nominal.mcap", provenance={"about": "toy"}) as log:
        run.simulate(case, {}, log)
    return run, read_log(tmp_path / "nominal.mcap")


def test_a_run_is_logged_and_measured_from_its_log(tmp_path):
    def more(case, log):
        log.bound("most", "N", upper=1.0)

    run, log = logged(tmp_path, declared("run.undershoot", "run.mesh"), also=more)
    assert [(event.time, event.text) for event in log.events] == [(0.0, "released from 1 m")]
    assert log.bounds["most"] == {"upper": 1.0}
    found = run.measure(declared("run.undershoot", "run.mesh"), log)
    # closed form: of e^(-d t) (cos v t + d/v sin v t) with d = 0.1, v^2 = 1 - d^2 the least is -e^(-pi d/v)
    undershoot = np.exp(-np.pi * 0.1 / np.sqrt(0.99))
    assert found["run.undershoot"].value == pytest.approx(undershoot, rel=1e-10)
    assert found["run.undershoot"].lower <= found["run.undershoot"].value <= found["run.undershoot"].upper
    # the band is the distance of two meshes: of 200 and of 340 steps
    assert (found["run.mesh"].lower, found["run.mesh"].upper) == pytest.approx((61, 341))
    assert np.array_equal(log["/force"].column("u"), -log["/mass"].column("x") - 0.2 * log["/mass"].column("v"))


@pytest.mark.parametrize(("names", "meant"), [(["run.mesh", "run.undershot"], "'run.undershot'"), (["run.mesh"], "")])
def test_a_number_that_is_no_quantity_is_refused(tmp_path, names, meant):
    with pytest.raises(InputError, match=f"number of a run 'run.undershoot': expected .*{meant}"):
        logged(tmp_path, declared(*names))
    assert not (tmp_path / "nominal.mcap").exists()


@pytest.mark.parametrize(
    ("A", "end", "peak"),
    [
        # closed forms: w e^(-z w t) sin(w t) peaks near a quarter turn; e^(-a t) - e^(-2 a t) at ln 2/a, at a quarter
        ([[0, 1.0], [-1e6, -2e-3]], 20.0, np.exp(-1e-6 * np.arccos(1e-6))),
        ([[-1e3, 1e3], [-1e3, -1e3]], 10.0, np.exp(-np.pi / 4) * np.sqrt(0.5)),
        ([[-1e3, 1e3], [0, -2e3]], 10.0, 0.25),
    ],
)
def test_a_band_holds_what_the_mesh_of_the_log_passes_over(tmp_path, A, end, peak):
    A = np.array(A)
    start = np.array([0.0, 1e3 if A[0, 0] == 0 else 1.0])
    run = linear_run(
        "nominal",
        lambda case, steps: Response(A, start, end, steps),
        signals,
        lambda case, found: {"run.peak": found.largest(np.array([1.0, 0.0])).value},
    )
    with LogWriter(tmp_path / "nominal.mcap", provenance={"about": "toy"}) as log:
        run.simulate(declared("run.peak"), {}, log)
    measured = run.measure(declared("run.peak"), read_log(tmp_path / "nominal.mcap"))["run.peak"]
    assert measured.lower <= peak <= measured.upper


def test_a_run_of_a_mode_that_no_mesh_follows_is_refused(tmp_path):
    fast = Response(np.array([[-1e6]]), np.array([1.0]), 10.0, 50)
    run = linear_run("nominal", lambda case, steps: fast, lambda case: {"/x": ({"x": "m"}, [[1.0]])}, numbers)
    log = LogWriter(tmp_path / "nominal.mcap", provenance={"about": "toy"})
    with pytest.raises(InputError, match=r"run nominal.* modes 1.*without modes"), log:
        run.simulate(declared("run.undershoot"), {}, log)
