"""Arrays pass without a copy, and what is wrong with them is told as the command line tells it."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

import ringdown_lab as rd
from conftest import ringdown

SAMPLES = 1_000_000


def columns(samples: int = 200) -> tuple[np.ndarray, np.ndarray]:
    time = np.arange(samples) / 100.0
    return time, np.exp(-0.05 * time) * np.cos(9.0 * time)


def test_a_million_samples_are_not_copied() -> None:
    time, values = columns(SAMPLES)
    tracemalloc.start()
    record = rd.Record(time, values)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 100_000
    assert record.time.ctypes.data == time.ctypes.data
    assert record.values.ctypes.data == values.ctypes.data
    assert len(record) == SAMPLES


def test_the_extension_holds_no_copy_either() -> None:
    # What Rust allocates tracemalloc does not see; the high-water mark of a process of its own does.
    program = """
import resource, sys
import numpy as np
import ringdown_lab as rd
time = np.arange(10_000_000) / 1000.0
values = np.cos(time)
most = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
before = most()
record = rd.Record(time, values)
print(most() / before)
"""
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert float(told.stdout) < 1.05


def test_what_was_read_is_one_array_that_nobody_writes_to() -> None:
    time, values = columns()
    record = rd.Record.from_frame({"time_s": time, "angle_rad": values})
    assert record.values is record.values
    with pytest.raises(ValueError, match="read-only"):
        record.values[0] = 1.0


def test_a_series_of_pandas_or_polars_is_a_column() -> None:
    time, values = columns()
    pandas = pytest.importorskip("pandas")
    record = rd.Record(pandas.Series(time), pandas.Series(values))
    assert np.array_equal(record.values, values)


def test_units_are_brought_to_si_when_the_record_is_used() -> None:
    time, values = columns(2000)
    rad, deg = rd.Record(time, values), rd.Record(time, np.degrees(values), unit="deg")
    assert deg.unit == "deg"
    assert rd.estimate(rad).damping_ratio == pytest.approx(rd.estimate(deg).damping_ratio, rel=1e-12)
    assert rd.Record(time, values, unit="deg/s").quantity == "velocity"


@pytest.mark.parametrize(
    ("time", "values", "message"),
    [
        ([0.0, 0.1], [0.0, 0.1], "2 samples"),
        (np.arange(10.0), np.zeros((10, 2)), r"values has shape \(10, 2\); expected one dimension"),
        (np.arange(10.0), np.zeros(9), "9"),
        (np.arange(10.0), np.full(10, np.nan), "values"),
        (np.r_[0:5, 3:8].astype(float), np.zeros(10), "3"),
        (np.arange(10.0), ["a"] * 10, "values are not numbers"),
    ],
)
def test_wrong_arrays_raise_a_record_error(time: object, values: object, message: str) -> None:
    with pytest.raises(rd.RecordError, match=message) as raised:
        rd.Record(time, values, name="log")  # type: ignore[arg-type]
    assert isinstance(raised.value, ValueError)
    assert str(raised.value).startswith("log")


def test_numbers_that_went_wrong_after_the_check_are_found_when_used(nominal: rd.Nominal) -> None:
    time, values = columns(2000)
    record = rd.Record(time, values)
    values[17] = np.nan
    with pytest.raises(rd.RecordError, match="not a number|not finite"):
        rd.diagnose(record, nominal)


def test_a_wrong_unit_names_those_there_are() -> None:
    with pytest.raises(rd.ConfigError, match="`furlong` is no unit; expected one of rad, deg"):
        rd.Record(*columns(), unit="furlong")


@pytest.mark.parametrize(
    ("text", "arguments"),
    [
        ("time_s,angle_rad\n0.0,0.1\n0.1,oops\n", ()),
        ("time_s,angle_rad\n" + "".join(f"{10 - i},0.{i}\n" for i in range(9)), ()),
        ("t,v\n" + "".join(f"{i},0.{i}\n" for i in range(9)), ("--value", "nothing")),
        ("time_s,displacement_m\n" + "".join(f"{i / 10},0.{i}\n" for i in range(10)), ()),
        ("time_s,angle_rad\n" + "".join(f"{i / 10},{'nan' if i == 7 else i}\n" for i in range(10)), ("--missing", "refuse")),
    ],
)
def test_the_message_of_a_file_is_the_command_lines(
    tmp_path: Path, nominal: rd.Nominal, text: str, arguments: tuple[str, ...]
) -> None:
    path, stated = tmp_path / "log.csv", tmp_path / "nominal.toml"
    path.write_text(text)
    stated.write_text(nominal.to_toml())
    told = ringdown("diagnose", str(path), "--nominal", str(stated), *arguments)
    assert told.returncode == 2
    reading = {name.removeprefix("--"): value for name, value in zip(arguments[::2], arguments[1::2], strict=True)}
    with pytest.raises(rd.RingdownError) as raised:
        rd.diagnose(rd.Record.read(path, nominal=nominal, **reading), nominal)
    assert str(raised.value) in told.stderr.replace("\n", " ")


@pytest.mark.parametrize(("unit", "heading", "at"), [("rad", "angle_rad", 50), ("m", "displacement_m", None)])
def test_the_message_of_arrays_is_that_of_their_file(
    tmp_path: Path, nominal: rd.Nominal, unit: str, heading: str, at: int | None
) -> None:
    time, values = columns()
    if at is not None:
        time[at] = time[at - 10]
    rows = "".join(f"{when},{value}\n" for when, value in zip(time.tolist(), values.tolist(), strict=True))
    (tmp_path / "log.csv").write_text(f"time_s,{heading}\n{rows}")
    (tmp_path / "nominal.toml").write_text(nominal.to_toml())
    told = ringdown("diagnose", "log.csv", "--nominal", "nominal.toml", cwd=tmp_path)
    with pytest.raises(rd.RecordError) as raised:
        rd.diagnose(rd.Record(time, values, unit=unit, name="log.csv"), nominal)
    where, message = str(raised.value).split(": ", 1)
    # The heading is the first line of the file.
    assert where == ("log.csv" if at is None else f"log.csv:{at + 1}")
    assert told.returncode == 2
    assert told.stderr.strip() == f"error: log.csv{'' if at is None else f':{at + 2}'}: {message}"


def test_a_nominal_simulators_message_says_where(tmp_path: Path) -> None:
    path = tmp_path / "nominal.toml"
    path.write_text("inertia = 0.02\ndampin = 0.001\n")
    with pytest.raises(rd.ConfigError, match="nominal.toml:2:1: "):
        rd.Nominal.read(path)
    with pytest.raises(rd.ConfigError):
        rd.Nominal(natural_frequency=-1.0, damping_ratio=0.1)


def test_another_system_and_wrong_options_are_told_apart(record: rd.Record, nominal: rd.Nominal) -> None:
    slow = rd.Nominal(natural_frequency=0.4, damping_ratio=0.005)
    with pytest.raises(rd.DiagnosisError):
        rd.diagnose(record, slow)
    with pytest.raises(rd.ConfigError, match="false_alarm"):
        rd.diagnose(record, nominal, false_alarm=2.0)
    with pytest.raises(rd.ConfigError):
        rd.estimate(record, "no-such-method")
