"""Logs in other formats give the record that their CSV would give; each test needs the library of its format."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ringdown_lab as rd
from ringdown_lab import logs

TIME = np.arange(300) / 100.0
ANGLE = 0.4 * np.exp(-0.1 * TIME) * np.cos(9.0 * TIME)


def holds(record: rd.Record, time: np.ndarray = TIME) -> None:
    assert np.array_equal(record.values, ANGLE)
    assert np.allclose(record.time, time, rtol=0, atol=1e-12)


def test_a_mapping_is_read_by_its_names() -> None:
    record = rd.Record.from_frame({"time_ms": np.arange(300) * 10, "angle_rad": ANGLE, "note": ["x"] * 300})
    holds(record)
    assert "angle_rad" in record.reading
    with pytest.raises(rd.RecordError, match="different lengths"):
        rd.Record.from_frame({"time_s": TIME, "angle_rad": ANGLE[1:]})
    with pytest.raises(rd.RecordError, match="int is not a data frame"):
        rd.Record.from_frame(3)


def test_pandas() -> None:
    pandas = pytest.importorskip("pandas")
    holds(rd.Record.from_frame(pandas.DataFrame({"time_s": TIME, "angle [rad]": ANGLE})))
    holds(rd.Record.from_frame(pandas.DataFrame({"angle_rad": ANGLE}, index=pandas.Index(TIME, name="time_s"))))


def test_polars() -> None:
    polars = pytest.importorskip("polars")
    holds(rd.Record.from_frame(polars.DataFrame({"time_s": TIME, "angle_rad": ANGLE})))


def test_parquet(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    states = np.c_[np.zeros(300), ANGLE].tolist()
    parquet.write_table(pyarrow.table({"time_s": TIME, "state": states}), tmp_path / "log.parquet")
    holds(logs.read_parquet(tmp_path / "log.parquet", value="state[1]"))


def test_lerobot(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    (tmp_path / "data/chunk-000").mkdir(parents=True)
    (tmp_path / "meta").mkdir()
    names = {"observation.state": {"names": ["shoulder", "elbow"]}}
    (tmp_path / "meta/info.json").write_text(json.dumps({"features": names}))
    for episode, scale in ((0, 2.0), (1, 1.0)):
        table = pyarrow.table(
            {
                "timestamp": TIME,
                "episode_index": [episode] * 300,
                "observation.state": np.c_[np.zeros(300), scale * ANGLE].tolist(),
                "action": np.c_[ANGLE, ANGLE].tolist(),
            }
        )
        parquet.write_table(table, tmp_path / f"data/chunk-000/episode_{episode:06}.parquet")
    record = logs.read_lerobot(tmp_path, "observation.state[elbow]", episode=1, input="action[0]")
    holds(record)
    assert record.input is not None and np.array_equal(record.input, ANGLE)
    with pytest.raises(rd.RecordError, match="no joint wrist; it has shoulder, elbow"):
        logs.read_lerobot(tmp_path, "observation.state[wrist]")
    with pytest.raises(rd.RecordError, match="no episode 7"):
        logs.read_lerobot(tmp_path, "observation.state[elbow]", episode=7)


def test_mcap(tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    from mcap.writer import Writer

    with open(tmp_path / "log.mcap", "wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("joint", "jsonschema", b"{}")
        channel = writer.register_channel("/joint", "json", schema)
        for time, angle in zip(TIME, ANGLE, strict=True):
            stamp = 1_700_000_000_000_000_000 + round(1e9 * time)
            data = json.dumps({"position": [0.0, angle]}).encode()
            writer.add_message(channel, stamp, data, stamp)
        writer.finish()
    holds(logs.read_mcap(tmp_path / "log.mcap", "/joint", "position[1]"))
    with pytest.raises(rd.RecordError, match="no topic /arm; the file has /joint"):
        logs.read_mcap(tmp_path / "log.mcap", "/arm", "position[1]")
    with pytest.raises(rd.RecordError, match="no `speed` of `speed`; it has position"):
        logs.read_mcap(tmp_path / "log.mcap", "/joint", "speed")


def write_joints(writer: Any, store: Any, encode: Any, **header: Any) -> None:
    """The record as joint states, by a writer of rosbags."""
    joint, head, stamp = (
        store.types[name] for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    with writer:
        connection = writer.add_connection("/joints", joint.__msgtype__, typestore=store)
        for time, angle in zip(TIME, ANGLE, strict=True):
            message = joint(
                header=head(stamp=stamp(sec=0, nanosec=0), frame_id="", **header),
                name=["elbow"],
                position=np.array([angle]),
                velocity=np.array([]),
                effort=np.array([]),
            )
            nanoseconds = 1_700_000_000_000_000_000 + round(1e9 * time)
            writer.write(connection, nanoseconds, encode(message, joint.__msgtype__))


def test_ros_1_bags(tmp_path: Path) -> None:
    pytest.importorskip("rosbags")
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    write_joints(Writer(tmp_path / "log.bag"), store, store.serialize_ros1, seq=0)
    assert (tmp_path / "log.bag").read_bytes().startswith(b"#ROSBAG V2.0")
    holds(logs.read_rosbag(tmp_path / "log.bag", "/joints", "position[0]"))
    with pytest.raises(rd.RecordError, match="no topic /arm; the bag has /joints"):
        logs.read_rosbag(tmp_path / "log.bag", "/arm", "position[0]")


@pytest.mark.parametrize("storage", ["SQLITE3", "MCAP"])
def test_ros_2_bags(tmp_path: Path, storage: str) -> None:
    pytest.importorskip("rosbags")
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    writer = Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin[storage])
    write_joints(writer, store, store.serialize_cdr)
    holds(logs.read_rosbag(tmp_path / "bag", "/joints", "position[0]"))
    with pytest.raises(rd.RecordError, match="no topic /arm; the bag has /joints"):
        logs.read_rosbag(tmp_path / "bag", "/arm", "position[0]")
    if storage == "MCAP":
        pytest.importorskip("mcap")
        (file,) = (tmp_path / "bag").glob("*.mcap")
        holds(logs.read_mcap(file, "/joints", "position[0]"))
        with pytest.raises(rd.RecordError, match="no `speed` of `speed`; it has .*position"):
            logs.read_mcap(file, "/joints", "speed")


def test_matlab(tmp_path: Path) -> None:
    io = pytest.importorskip("scipy.io")
    io.savemat(tmp_path / "log.mat", {"t": TIME, "theta": ANGLE, "rate": 100.0})
    holds(logs.read_mat(tmp_path / "log.mat", time="t", value="theta"))


@pytest.mark.parametrize(
    ("module", "extra", "call"),
    [
        ("pyarrow", "parquet", lambda: logs.read_parquet("log.parquet")),
        ("mcap", "mcap", lambda: logs.read_mcap("log.mcap", "/joint", "position")),
        ("rosbags", "rosbags", lambda: logs.read_rosbag("bag", "/joint", "position")),
        ("scipy", "mat", lambda: logs.read_mat("log.mat")),
    ],
)
def test_without_its_library_a_reader_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, module: str, extra: str, call: Any
) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == module]:
        monkeypatch.delitem(sys.modules, name)

    class Absent:
        def find_spec(self, name: str, *_: Any) -> None:
            if name.partition(".")[0] == module:
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(sys, "meta_path", [Absent(), *sys.meta_path])
    with pytest.raises(ModuleNotFoundError, match=rf"which is not installed: pip install ringdown-lab\[{extra}\]"):
        call()
