"""Logs in other formats than text: frames, Parquet and LeRobot folders, MCAP, ROS bags, MATLAB files.

Each reader needs a library that the extra of the same name installs, ``pip install ringdown-lab[mcap]``, and says so where that is
absent. What it reads becomes columns with names, which are read as the CSV file that they would be written to: columns and units
are found by their names, and every option of ``Record.read`` holds.
"""

from __future__ import annotations

import importlib
import io
import json
from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._native import RecordError

if TYPE_CHECKING:
    from ._nominal import Nominal
    from ._record import Record


def _library(module: str, extra: str, what: str) -> Any:
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != module.partition(".")[0]:
            raise
        message = f"{what} are read by {module.partition('.')[0]}, which is not installed: pip install ringdown-lab[{extra}]"
        raise ModuleNotFoundError(message, name=error.name) from None


def csv_of(frame: Any) -> bytes:
    """A pandas, polars or Arrow frame, or a mapping from names to columns, as the content of a CSV file, to the bit."""
    if hasattr(frame, "write_csv"):  # polars
        return frame.write_csv().encode()  # type: ignore[no-any-return]
    if hasattr(frame, "to_csv") and hasattr(frame, "columns"):  # pandas
        named = frame.index.name is not None
        return frame.to_csv(index=named).encode()  # type: ignore[no-any-return]
    if hasattr(frame, "to_pydict"):  # Arrow
        frame = frame.to_pydict()
    if not isinstance(frame, Mapping):
        kind = type(frame).__name__
        raise RecordError(f"{kind} is not a data frame of pandas, polars or Arrow, or a mapping from names to columns")
    columns = {str(name): np.asarray(column).ravel() for name, column in frame.items()}
    lengths = {name: column.size for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise RecordError(f"columns have different lengths: {lengths}; expected a number for each sample in each")
    text = io.StringIO()
    text.write(",".join(json.dumps(name) if "," in name else name for name in columns) + "\n")
    for row in zip(*(column.tolist() for column in columns.values()), strict=True):
        text.write(",".join("" if cell is None else str(cell) for cell in row) + "\n")
    return text.getvalue().encode()


def _record(columns: Any, name: str | PathLike[str], nominal: Nominal | None, reading: dict[str, Any]) -> Record:
    from ._record import Record

    return Record.from_frame(columns, name=str(name), nominal=nominal, **reading)


def _elements(name: str, column: Any) -> dict[str, Any]:
    """A column; where each cell is a list, one column for each place in it, named ``name[0]``, ``name[1]``, …"""
    cells = column.to_pylist()
    if cells and isinstance(cells[0], (list, tuple)):
        return {f"{name}[{at}]": [cell[at] for cell in cells] for at in range(len(cells[0]))}
    return {name: cells}


def read_parquet(path: str | PathLike[str], *, nominal: Nominal | None = None, **reading: Any) -> Record:
    """Reads a Parquet file. A column of lists becomes columns ``name[0]``, ``name[1]``, …: ``value="state[2]"``."""
    parquet = _library("pyarrow.parquet", "parquet", "Parquet files")
    table = parquet.read_table(path)
    columns: dict[str, Any] = {}
    for name in table.column_names:
        columns.update(_elements(name, table[name]))
    return _record(columns, path, nominal, reading)


def read_lerobot(
    folder: str | PathLike[str],
    value: str,
    *,
    episode: int = 0,
    input: str | None = None,
    nominal: Nominal | None = None,
    **reading: Any,
) -> Record:
    """Reads one episode of a LeRobot data set: Parquet files below ``data/``, names of joints in ``meta/info.json``.

    value, input: a feature with the joint's name or place, such as ``"observation.state[elbow.pos]"`` or ``"action[2]"``.
    """
    parquet = _library("pyarrow.parquet", "parquet", "LeRobot folders")
    files = sorted(Path(folder).glob("data/**/*.parquet"))
    if not files:
        raise RecordError(f"{folder}: there is no Parquet file below data/; expected the folder of a LeRobot data set")
    info = Path(folder) / "meta" / "info.json"
    features = json.loads(info.read_text(encoding="utf-8")).get("features", {}) if info.exists() else {}
    wanted = {"value": _place(value, features), "input": None if input is None else _place(input, features)}
    names = ["timestamp", "episode_index", *{place[0] for place in wanted.values() if place}]
    columns: dict[str, list[float]] = {"time_s": [], "value": []}
    if input is not None:
        columns["input"] = []
    for file in files:
        there = parquet.read_schema(file).names
        missing = [name for name in names if name not in there]
        if missing:
            raise RecordError(f"{file}: there is no column {missing[0]}; the file has {', '.join(there)}")
        table = parquet.read_table(file, columns=names, filters=[("episode_index", "==", episode)])
        columns["time_s"] += table["timestamp"].to_pylist()
        for key, place in wanted.items():
            if place is not None:
                feature, at = place
                columns[key] += [cell if at is None else cell[at] for cell in table[feature].to_pylist()]
    if not columns["time_s"]:
        raise RecordError(f"{folder}: there is no episode {episode}")
    reading = {"time": "time_s", "value": "value", "input": None if input is None else "input", **reading}
    return _record(columns, f"{folder} episode {episode}", nominal, reading)


def _place(text: str, features: Mapping[str, Any]) -> tuple[str, int | None]:
    feature, bracket, joint = text.rstrip("]").partition("[")
    if not bracket:
        return feature, None
    if joint.isdigit():
        return feature, int(joint)
    names = features.get(feature, {}).get("names") or []
    names = names.get("motors", []) if isinstance(names, dict) else names
    if joint not in names:
        raise RecordError(f"{feature} has no joint {joint}; it has {', '.join(map(str, names)) or 'no names, use a place: [0]'}")
    return feature, list(names).index(joint)


def _field(message: Any, path: str) -> float:
    """A number in a message by its path: ``position[1]``, ``pose.orientation.z``."""
    for part in path.replace("]", "").replace("[", ".").split("."):
        try:
            if part.isdigit():
                message = message[int(part)]
            else:
                message = message[part] if isinstance(message, Mapping) else getattr(message, part)
        except (KeyError, IndexError, AttributeError):
            there = sorted(message) if isinstance(message, Mapping) else [one for one in dir(message) if one[0] != "_"]
            raise RecordError(f"a message has no `{part}` of `{path}`; it has {', '.join(there)}") from None
    return float(message)


def _of_messages(
    messages: Iterable[tuple[float, Any]], name: str, value: str, input: str | None, nominal: Nominal | None, reading: dict[str, Any]
) -> Record:
    columns: dict[str, list[float]] = {"time_s": [], "value": []}
    if input is not None:
        columns["input"] = []
    for seconds, message in messages:
        columns["time_s"].append(seconds)
        columns["value"].append(_field(message, value))
        if input is not None:
            columns["input"].append(_field(message, input))
    if columns["time_s"]:
        # Nanoseconds since 1970 in a double end at a quarter of a microsecond; counted from the first they do not.
        columns["time_s"] = [seconds - columns["time_s"][0] for seconds in columns["time_s"]]
    reading = {"time": "time_s", "value": "value", "input": None if input is None else "input", **reading}
    return _record(columns, name, nominal, reading)


def read_mcap(
    path: str | PathLike[str], topic: str, value: str, *, input: str | None = None, nominal: Nominal | None = None, **reading: Any
) -> Record:
    """Reads a topic of an MCAP file with messages in JSON or in ROS 2's encoding (the latter by rosbags).

    value, input: paths into a message, such as ``"position[1]"``. Times are the log's, in seconds from the first message.
    """
    _library("mcap", "mcap", "MCAP files")
    reader = _library("mcap.reader", "mcap", "MCAP files")

    def messages() -> Iterator[tuple[float, Any]]:
        with open(path, "rb") as file:
            stream = reader.make_reader(file)
            topics: set[str] = set()
            summary = stream.get_summary()
            if summary is not None:
                topics = {channel.topic for channel in summary.channels.values()}
                if topic not in topics:
                    raise RecordError(f"{path}: there is no topic {topic}; the file has {', '.join(sorted(topics))}")
            first = None
            decoders: dict[int, Any] = {}
            for schema, channel, message in stream.iter_messages(topics=[topic]):
                first = message.log_time if first is None else first
                if channel.id not in decoders:
                    decoders[channel.id] = _decoder(channel.message_encoding, schema, path)
                yield (message.log_time - first) / 1e9, decoders[channel.id](message.data)

    return _of_messages(messages(), f"{path} {topic}", value, input, nominal, reading)


def _decoder(encoding: str, schema: Any, path: str | PathLike[str]) -> Any:
    if encoding == "json":
        return json.loads
    if encoding == "cdr" and schema is not None:
        typesys = _library("rosbags.typesys", "rosbags", "ROS 2 messages")
        store = typesys.get_typestore(typesys.Stores.EMPTY)
        name = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/")
        store.register(typesys.get_types_from_msg(schema.data.decode(), name))
        return lambda data: store.deserialize_cdr(data, name)
    raise RecordError(f"{path}: messages are encoded as {encoding}; expected json or cdr")


def read_rosbag(
    path: str | PathLike[str], topic: str, value: str, *, input: str | None = None, nominal: Nominal | None = None, **reading: Any
) -> Record:
    """Reads a topic of a ROS 1 or ROS 2 bag.

    value, input: paths into a message, such as ``"position[1]"`` of ``sensor_msgs/msg/JointState``.
    """
    highlevel = _library("rosbags.highlevel", "rosbags", "ROS bags")
    typesys = _library("rosbags.typesys", "rosbags", "ROS bags")

    def messages() -> Iterator[tuple[float, Any]]:
        store = typesys.get_typestore(typesys.Stores.LATEST)
        with highlevel.AnyReader([Path(path)], default_typestore=store) as reader:
            chosen = [connection for connection in reader.connections if connection.topic == topic]
            if not chosen:
                there = sorted({connection.topic for connection in reader.connections})
                raise RecordError(f"{path}: there is no topic {topic}; the bag has {', '.join(there)}")
            first = None
            for connection, stamp, data in reader.messages(connections=chosen):
                first = stamp if first is None else first
                yield (stamp - first) / 1e9, reader.deserialize(data, connection.msgtype)

    return _of_messages(messages(), f"{path} {topic}", value, input, nominal, reading)


def read_mat(path: str | PathLike[str], *, nominal: Nominal | None = None, **reading: Any) -> Record:
    """Reads the vectors of a MATLAB file (version 7.2 or earlier) as columns by their names."""
    scipy = _library("scipy.io", "mat", "MATLAB files")
    try:
        content = scipy.loadmat(path)
    except NotImplementedError:
        raise RecordError(f"{path}: is a MATLAB file of version 7.3; save it again with -v7") from None
    vectors = {name: array.ravel() for name, array in content.items() if not name.startswith("__") and _is_vector(array)}
    if not vectors:
        raise RecordError(f"{path}: holds no vector of numbers")
    longest = max(array.size for array in vectors.values())
    return _record({name: array for name, array in vectors.items() if array.size == longest}, path, nominal, reading)


def _is_vector(array: Any) -> bool:
    is_numbers = isinstance(array, np.ndarray) and array.dtype.kind in "fiu"
    return is_numbers and array.ndim <= 2 and array.size == max(array.shape, default=0) > 1
