import hashlib
import itertools
import struct
import subprocess
import sys
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import NonSeekingReader, make_reader

from gainsay.errors import InputError, LogError
from gainsay.logs import Appendage, Body, LogWriter, read_log
from gainsay.logs.sampling import moving_samples
from gainsay.logs.schemas import foxglove_class, signal_schema
from tests.gainsay.demo_log import write_demo

UNITS = {"x": "m", "y": "m/s"}


def write(path, **kwargs):
    return LogWriter(path, provenance={"paper": "none"}, **kwargs)


def bits(array):
    return np.ascontiguousarray(array).view(np.uint64).tolist()


any_double = st.floats(allow_nan=True, allow_infinity=True, allow_subnormal=True, width=64)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.floats(0, 9e9), any_double, any_double), max_size=40),
    st.integers(1, 5),
    st.integers(200, 5000),
)
def test_every_double_comes_back_bit_for_bit(tmp_path_factory, rows, blocks, chunk):
    """Law: read(write(x)) = x, whatever the doubles, the split into blocks and the chunk size."""
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    data = np.array(sorted(rows, key=lambda row: row[0])).reshape(-1, 3)
    with write(path, chunk_size=chunk) as log:
        for part in np.array_split(data, blocks):
            log.signal("/a/b", UNITS, part[:, 0], part[:, 1:])
            log.signal("/c", {"v": "1"}, part[:, 0], part[:, :1])
    back = read_log(path)
    assert bits(back["/a/b"].time) == bits(data[:, 0])
    assert bits(back["/a/b"].values) == bits(data[:, 1:])
    assert bits(back["/c"].column("v")) == bits(data[:, 0])


def test_payload_of_a_nan_survives(tmp_path):
    """The mantissa of a NaN is kept: 0x7ff8dead00000001 is one of the quiet NaNs of IEEE 754."""
    odd = struct.unpack("<d", struct.pack("<Q", 0x7FF8DEAD00000001))[0]
    with write(tmp_path / "a.mcap") as log:
        log.signal("/a", {"x": "1"}, [0.0], [[odd]])
    assert bits(read_log(tmp_path / "a.mcap")["/a"].values) == [[0x7FF8DEAD00000001]]


@pytest.mark.parametrize("count", [1, 13, 14, 15, 16, 40, 300])
def test_wide_signals_agree_with_the_reference_reader(tmp_path, count):
    """Oracle: the mcap package reads the container, protobuf the messages; from 15 components tags take two bytes."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    fields = {f"c{number}": "1" for number in range(count)}
    values = np.random.default_rng(1).normal(size=(7, count))
    path = tmp_path / "a.mcap"
    with write(path) as log:
        log.signal("/wide", fields, np.arange(7.0), values)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(descriptor_pb2.FileDescriptorSet.FromString(signal_schema("/wide", tuple(fields))[1]).file[0])
    kind = message_factory.GetMessageClass(pool.FindMessageTypeByName("gainsay.wide"))
    with path.open("rb") as stream:
        rows = []
        for _, channel, message in NonSeekingReader(stream, validate_crcs=True).iter_messages():
            decoded = kind.FromString(message.data)
            assert message.log_time == message.publish_time == round(decoded.time * 1e9)
            assert channel.metadata["unit.c0"] == "1"
            rows.append([getattr(decoded, name) for name in fields])
    assert rows == values.tolist()
    assert read_log(path)["/wide"].values.tolist() == values.tolist()


def test_everything_a_log_holds(tmp_path):
    time = np.array([0.0, 0.1, 0.30000000000000004])
    path = tmp_path / "run.mcap"
    with LogWriter(path, provenance={"paper": "p", "seed": 3}, attachments={"parameters.csv": b"name\n"}) as log:
        log.signal("/state", UNITS, time, np.ones((3, 2)))
        log.bound("thrust", "N", lower=-40.0, upper=40.0)
        log.event(0.25, "late", "second", level="warning")
        log.event(0.05, "early", "first")
        log.extreme("peak", 0.1 + 1e-13, 1 / 3, "N", second=0.3, limit=0.25)
        log.extreme("least", 0.2, -0.25, "N", second=-0.25, limit=0.25)
        log.extremes(
            {"rounded": (0.2, -0.25 * (1 + 1e-12), "N")}, {"rounded": (0.1, -0.2, "N")}, limits={"rounded": 0.25}
        )
        log.summary("cost", 2 / 3, "1")
        log.transform("lvlh", "chaser", time, np.eye(3), [[0, 0, 0, 1]] * 3)
    log = read_log(path)
    assert log.metadata == {"paper": "p", "seed": "3"}
    assert log.attachments == {"parameters.csv": b"name\n"}
    assert log["/state"].units == UNITS
    assert log["/state"].frame()["y"].tolist() == [1.0] * 3
    assert log["/state"].frame().index.tolist() == time.tolist()
    assert log.extremes["rounded"] == (0.2, -0.25 * (1 + 1e-12), -0.2)
    assert {name: log.extremes[name] for name in ("peak", "least")} == {
        "peak": (0.1 + 1e-13, 1 / 3, 0.3), "least": (0.2, -0.25, -0.25)
    }  # fmt: skip
    assert log.summaries == {"cost": 2 / 3}
    assert log.bounds == {"thrust": {"lower": -40.0, "upper": 40.0}}
    assert log["/bounds/thrust"].time.tolist() == [0.0, time[-1]]
    assert [(e.name, e.text, e.level) for e in log.events] == [
        ("early", "first", "info"),
        ("peak", "extreme peak: 0.333333 N at 0.1 s, beyond the limit of 0.25 N", "warning"),
        ("least", "extreme least: -0.25 N at 0.2 s", "info"),  # the limit itself is kept
        ("rounded", "extreme rounded: -0.25 N at 0.2 s", "info"),  # and passed by rounding alone
        ("late", "second", "warning"),
    ]
    assert log.frames == {"chaser": "lvlh"}
    assert log.duration == time[-1]
    assert log.count("/state") == 3
    assert log.kind("/tf/chaser") == "transforms"


def test_transforms_parse_as_foxglove_messages(tmp_path):
    """Padded varints are ordinary varints: protobuf gives back the seconds, nanoseconds, names and numbers."""
    time = np.array([0.0, 0.5, 127.999999999, 128.0, 16384.25, 3e6])
    shift = np.random.default_rng(2).normal(size=(6, 3))
    turn = np.random.default_rng(3).normal(size=(6, 4))
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    with write(tmp_path / "a.mcap") as log:
        log.transform("lvlh", "chaser_with_a_long_name", time, shift, turn)
        log.transform("lvlh", "fixed", [0.0], [[1.0, 2.0, 3.0]])
    log = read_log(tmp_path / "a.mcap")
    messages = log.messages("/tf/chaser_with_a_long_name")
    assert len(messages) == 6
    for row, (at, message) in enumerate(messages):
        (made,) = message.transforms
        assert made.timestamp.seconds * 10**9 + made.timestamp.nanos == round(time[row] * 1e9)
        assert at == pytest.approx(time[row], abs=1e-9)
        assert (made.parent_frame_id, made.child_frame_id) == ("lvlh", "chaser_with_a_long_name")
        assert [made.translation.x, made.translation.y, made.translation.z] == shift[row].tolist()
        assert [made.rotation.x, made.rotation.y, made.rotation.z, made.rotation.w] == turn[row].tolist()
        again = foxglove_class("FrameTransforms").FromString(message.SerializeToString())
        assert again == message
    ((_, fixed),) = log.messages("/tf/fixed")
    assert fixed.transforms[0].rotation.w == 1.0
    assert log.frames == {"chaser_with_a_long_name": "lvlh", "fixed": "lvlh"}


def test_scene_elements_are_foxglove_entities(tmp_path):
    body = Body((1.0, 2.0, 3.0), (Appendage((0, 1, 0), (0, 1, 0), (0, 0, 1), 4.0, 1.0, (0.5, 0.1)),))
    with write(tmp_path / "a.mcap") as log:
        log.line("path", "lvlh", np.eye(3), "truth")
        log.marker("target", "lvlh", (0, 0, 0), 2.0, "target", label="target")
        log.axes("lvlh", 3.0)
        log.arrows("thrust", "lvlh", np.arange(2000.0), np.tile([0.0, 3.0, 4.0], (2000, 1)), 2.0, "thrust")
        log.body("chaser", "chaser", body, [0.0, 1.0], [[0.0, 0.0], [1.0, 1.0]])
    log = read_log(tmp_path / "a.mcap")
    ((_, path),) = log.messages("/scene/path")
    assert [(p.x, p.y, p.z) for p in path.entities[0].lines[0].points] == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    arrows = log.messages("/scene/thrust")
    assert len(arrows) == 400
    assert arrows[-1][0] == 1999.0
    made = arrows[0][1].entities[0].arrows[0]
    # |(0, 3, 4)| = 5, drawn at 2 m a unit
    assert made.shaft_length + made.head_length == pytest.approx(10.0)
    # rotating the x axis by the quaternion gives the direction (0, 3, 4)/5
    q = made.pose.orientation
    turned = [1 - 2 * (q.y**2 + q.z**2), 2 * (q.x * q.y + q.w * q.z), 2 * (q.x * q.z - q.w * q.y)]
    assert turned == pytest.approx([0.0, 0.6, 0.8])
    tips = [m.entities[0].triangles[0].points[-1].z for _, m in log.messages("/scene/chaser")]
    # bending modes are scaled to 1 at the tip, so it moves by the sum of its tip deflections
    assert tips == pytest.approx([0.0, 0.6])


def test_equal_calls_give_equal_bytes(tmp_path):
    digests = set()
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        digests.add(hashlib.sha256(write_demo(tmp_path / name / "spiral.mcap", samples=301).read_bytes()).hexdigest())
    assert len(digests) == 1


def test_blocks_make_no_difference_to_what_is_read(tmp_path):
    values = np.random.default_rng(4).normal(size=(1000, 2))
    time = np.linspace(0.0, 9.0, 1000)
    for name, size in (("one", 1000), ("many", 1)):
        with write(tmp_path / f"{name}.mcap") as log:
            for start in range(0, 1000, size):
                some = slice(start, start + size)
                log.signal("/a", UNITS, time[some], values[some])
                log.signal("/b", {"v": "1"}, time[some], values[some, :1])
    one, many = read_log(tmp_path / "one.mcap"), read_log(tmp_path / "many.mcap")
    assert one["/a"].values.tobytes() == many["/a"].values.tobytes() == values.tobytes()
    assert one["/b"].values.tobytes() == many["/b"].values.tobytes()


def test_chunks_follow_each_other_in_time_whatever_the_order_of_writing(tmp_path):
    """Oracle: the chunk index and the seeking reader of the mcap package; no message is lost."""
    time = np.linspace(0.0, 99.0, 1000)
    with write(tmp_path / "a.mcap", chunk_size=5000) as log:
        log.signal("/a", UNITS, time, np.ones((1000, 2)))
        log.transform("lvlh", "chaser", time[::7], np.zeros((len(time[::7]), 3)))
        log.signal("/b", UNITS, time[:500], np.ones((500, 2)))
        log.event(50.0, "half", "half")
        log.signal("/b", UNITS, time[500:], np.ones((500, 2)))
    with (tmp_path / "a.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        chunks = reader.get_summary().chunk_indexes
        assert len(chunks) > 10
        spans = [(chunk.message_start_time, chunk.message_end_time) for chunk in chunks]
        assert all(before[1] < after[0] for before, after in itertools.pairwise(spans))
        found = Counter(channel.topic for _, channel, _ in reader.iter_messages())
    assert found == {"/a": 1000, "/b": 1000, "/tf/chaser": 143, "/events": 1}
    assert read_log(tmp_path / "a.mcap")["/b"].time.tolist() == time.tolist()


def test_plots_have_their_own_unit(tmp_path):
    """An angle of one radian is 180/pi degrees (SI brochure, table 8)."""
    with write(tmp_path / "a.mcap") as log:
        log.signal("/angles", {"roll": "rad"}, [0.0], [[1.0]], shown="deg")
        with pytest.raises(InputError, match="unit of /b for plots"):
            log.signal("/b", {"x": "m"}, [0.0], [[1.0]], shown="deg")
    log = read_log(tmp_path / "a.mcap")
    assert log["/angles"].values.tolist() == [[1.0]]
    assert log["/angles_deg"].units == {"roll": "deg"}
    assert log["/angles_deg"].values[0, 0] == pytest.approx(57.29577951308232, rel=1e-15)


def test_samples_are_kept_where_a_signal_moves():
    """Straight lines between the kept samples follow sin(5 t) within one percent of its range, and what is quiet."""
    time = np.arange(30001) * 0.01
    values = np.stack([np.sin(5 * time) * (time < 100), time], axis=1)
    kept = moving_samples(values)
    assert kept[0] == 0 and kept[-1] == 30000 and len(kept) < 4500
    assert np.count_nonzero(kept > 11000) < 330  # straight lines: every 64th sample
    line = np.interp(time[:9900], time[kept], values[kept, 0])
    assert np.abs(line - values[:9900, 0]).max() <= 0.01 * 2
    assert np.abs(np.interp(time, time[kept], values[kept, 1]) - values[:, 1]).max() < 1e-9
    assert moving_samples(values[:1]).tolist() == [0]


def test_index_finds_messages_of_one_topic(tmp_path):
    """Oracle: the seeking reader of the mcap package goes by our chunk and message indexes."""
    with write(tmp_path / "a.mcap", chunk_size=500) as log:
        for start in range(10):
            log.signal("/a", UNITS, [float(start)], [[start, start]])
            log.signal("/b", {"v": "1"}, [float(start)], [[start]])
    with (tmp_path / "a.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        found = [m.log_time for _, _, m in reader.iter_messages(topics=["/b"], starting_at=3 * 10**9)]
        assert found == [second * 10**9 for second in range(3, 10)]
        summary = reader.get_summary()
        assert summary.statistics.message_count == 20
        assert summary.statistics.message_end_time == 9 * 10**9


def test_nothing_is_left_of_a_run_that_breaks(tmp_path):
    (tmp_path / "run.mcap").write_bytes(b"older")
    with pytest.raises(ZeroDivisionError), write(tmp_path / "run.mcap") as log:
        log.signal("/a", UNITS, [0.0], [[1.0, 2.0]])
        1 / 0  # noqa: B018
    assert [path.name for path in tmp_path.iterdir()] == ["run.mcap"]
    assert (tmp_path / "run.mcap").read_bytes() == b"older"


def test_the_file_appears_only_when_complete(tmp_path):
    with write(tmp_path / "run.mcap") as log:
        log.signal("/a", UNITS, [0.0], [[1.0, 2.0]])
        assert not (tmp_path / "run.mcap").exists()
    assert (tmp_path / "run.mcap").exists()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda log: log.signal("a", UNITS, [0.0], [[1, 2]]), "topic 'a'"),
        (lambda log: log.signal("/a.b", UNITS, [0.0], [[1, 2]]), "topic '/a.b'"),
        (lambda log: log.signal("/a", {"x y": "m"}, [0.0], [[1]]), "'x y'"),
        (lambda log: log.signal("/a", {"time": "s"}, [0.0], [[1]]), "time is there"),
        (lambda log: log.signal("/a", {"x": ""}, [0.0], [[1]]), "1 where there is none"),
        (lambda log: log.signal("/a", UNITS, [0.0], [[1]]), r"\(1, 1\)"),
        (lambda log: log.signal("/a", UNITS, [0.0, 1.0], [[1, 2]]), r"\(1, 2\)"),
        (lambda log: log.signal("/a", UNITS, [-1e-9], [[1, 2]]), "-1e-09"),
        (lambda log: log.signal("/a", UNITS, [float("nan")], [[1, 2]]), "nan"),
        (lambda log: log.signal("/a", UNITS, [1e10], [[1, 2]]), "9.2e9"),
        (lambda log: log.signal("/a", UNITS, [1.0, 0.5], [[1, 2]] * 2), "no decrease"),
        (lambda log: [log.signal("/a", UNITS, [t], [[1, 2]]) for t in (1.0, 0.5)], "no decrease"),
        (lambda log: [log.signal("/a", {n: "m"}, [1.0], [[1]]) for n in "xy"], "as before"),
        (lambda log: [log.extreme("p", 1.0, 2.0, "N") for _ in range(2)], "each once"),
        (lambda log: [log.summary("p", 1.0, "N") for _ in range(2)], "each once"),
        (lambda log: [log.bound("p", "N", upper=1.0) for _ in range(2)], "each once"),
        (lambda log: log.bound("p", "N"), "a finite lower or upper"),
        (lambda log: log.bound("p", "N", upper=float("inf")), "a finite lower or upper"),
        (lambda log: log.event(0.0, "n", "t", level="loud"), "'loud'"),
        (lambda log: log.event(-1.0, "n", "t"), "-1.0"),
        (lambda log: log.transform("a", "b", [0.0], [[1, 2]]), "shapes"),
        (lambda log: log.transform("a", "b", [0.0], [[1, 2, 3]], [[0, 0, 0, 2]]), "unit quaternions"),
        (lambda log: log.transform("a", "b/c", [0.0], [[1, 2, 3]]), "'b/c'"),
        (lambda log: log.line("l", "f", [[1, 2]], "truth"), r"\(1, 2\)"),
        (lambda log: log.line("l", "f", [[1, 2, 3]], "pink"), "'pink'"),
        (lambda log: log.arrows("l", "f", [0.0], [[1, 2]], 1.0, "thrust"), r"\(1, 2\)"),
    ],
)
def test_misuse_is_refused_in_one_line(tmp_path, call, words):
    with pytest.raises(InputError, match=words) as caught, write(tmp_path / "a.mcap") as log:
        call(log)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_missing_topics_and_fields_are_named(tmp_path):
    with write(tmp_path / "a.mcap") as log:
        log.signal("/a", UNITS, [0.0], [[1.0, 2.0]])
    log = read_log(tmp_path / "a.mcap")
    with pytest.raises(LogError, match=r"a\.mcap.*'/b'.*one of /a"):
        log["/b"]
    with pytest.raises(LogError, match=r"'z'.*one of x, y"):
        log["/a"].column("z")


def test_import_is_light():
    """The floor is imported by every step: nothing in it may pull in the viewer, pandas or scipy."""
    code = "import sys, gainsay.logs; print(sorted({'rerun', 'pandas', 'scipy', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
