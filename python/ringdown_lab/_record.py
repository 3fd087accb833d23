"""Records: one run of an oscillator each."""

from __future__ import annotations

import json
from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import NativeRecord, RecordError

if TYPE_CHECKING:
    from ._nominal import Nominal


class Record:
    """One run of an oscillator: stamps in seconds, observed values and, where it is driven, the input.

    Contiguous float64 arrays are held and not copied: a record looks at the caller's numbers. They are checked when the record is
    made and again when it is used.

    time: stamps in seconds, never decreasing, 8 or more.
    values: observed values in ``unit``, one for each stamp.
    input: the input that drove the system, one number for each stamp.
    unit: unit of the values, such as ``"rad"``, ``"deg"``, ``"m"``, ``"mm"``, ``"deg/s"``.
    quantity: ``"position"``, ``"velocity"`` or ``"acceleration"``; left open, the unit tells it.
    clock: the clock to believe: ``"host"`` (stamps as given), ``"uniform-index"``, or ``"auto"``.
    input_unit: unit of the input; left open, its numbers are taken as they are.
    name: name in messages and results.
    origin: ``"measured"``, ``"simulated"`` or ``"unstated"``.

    Raises RecordError for wrong shapes, fewer than 8 samples, a number that is not finite, or a stamp before its predecessor, and
    ConfigError for an unknown unit or word.
    """

    def __init__(
        self,
        time: ArrayLike,
        values: ArrayLike,
        input: ArrayLike | None = None,
        unit: str = "rad",
        quantity: str | None = None,
        clock: str = "auto",
        *,
        input_unit: str | None = None,
        name: str = "arrays",
        origin: str = "unstated",
    ) -> None:
        self._kept: dict[str, NDArray[np.float64] | None] | None = None
        self._native = NativeRecord(
            _column(name, "time", time),
            _column(name, "values", values),
            None if input is None else _column(name, "input", input),
            name=name,
            unit=unit,
            quantity=quantity,
            input_unit=input_unit,
            clock=clock,
            origin=origin,
        )

    @classmethod
    def _of(cls, native: NativeRecord) -> Record:
        made = cls.__new__(cls)
        made._native = native
        made._kept = {}
        return made

    def _column(self, name: str) -> NDArray[np.float64] | None:
        """The caller's own array, or one made once of what was read, which nobody may write to."""
        if self._kept is None:
            return getattr(self._native, name)  # type: ignore[no-any-return]
        if name not in self._kept:
            column = getattr(self._native, name)
            if column is not None:
                column.flags.writeable = False
            self._kept[name] = column
        return self._kept[name]

    @classmethod
    def read(cls, path: str | PathLike[str], *, nominal: Nominal | None = None, **reading: Any) -> Record:
        """Reads a record file: CSV with any separator, units and dates in its header, or a host log.

        nominal: the simulator that the record is for, whose coordinate says which columns to look for.
        reading: the command line's options: ``time``, ``value``, ``input``, ``unit``, ``input_unit``, ``time_unit``, ``where``,
        ``missing``, ``quantity``, ``sample_rate``, ``clock``, ``format``, ``origin``, ``remove_mean``. What is not given is found,
        and told by ``reading``.

        Raises RecordError with line, what was expected and the option to set.
        """
        return cls._of(NativeRecord.read(path, _options(reading), _native_nominal(nominal)))

    @classmethod
    def parse(cls, text: str | bytes, *, name: str = "text", nominal: Nominal | None = None, **reading: Any) -> Record:
        """Reads a record from the content of a file; options as for ``read``."""
        content = text.encode() if isinstance(text, str) else text
        return cls._of(NativeRecord.parse(name, content, _options(reading), _native_nominal(nominal)))

    @classmethod
    def from_frame(cls, frame: Any, *, name: str = "frame", nominal: Nominal | None = None, **reading: Any) -> Record:
        """Reads a pandas, polars or Arrow frame, or a mapping from names to columns, as the CSV file that it would be written to.

        Columns and units are found by their names (``time_s``, ``angle [deg]``), and every option of ``read`` holds.
        """
        from .logs import csv_of

        return cls.parse(csv_of(frame), name=name, nominal=nominal, **reading)

    @property
    def time(self) -> NDArray[np.float64]:
        """Stamps as given, in seconds; the caller's own array where the record was made from one."""
        column = self._column("time")
        assert column is not None
        return column

    @property
    def values(self) -> NDArray[np.float64]:
        """Observed values, in ``unit``; the caller's own array where the record was made from one."""
        column = self._column("values")
        assert column is not None
        return column

    @property
    def input(self) -> NDArray[np.float64] | None:
        """The input, where there is one."""
        return self._column("input")

    @property
    def unit(self) -> str:
        """Unit of ``values``: as given for arrays, the SI unit of what was read."""
        return self._native.unit

    @property
    def quantity(self) -> str:
        """Observed quantity: ``"position"``, ``"velocity"`` or ``"acceleration"``."""
        return self._native.quantity

    @property
    def name(self) -> str:
        """Name in messages and results: the path of a file."""
        return self._native.name

    @property
    def reading(self) -> str:
        """Account of how the record was read, in one line."""
        return self._native.reading

    def to_csv(self, decimals: int = 9) -> str:
        """The record as CSV text in SI units, with so many decimals, at most 12."""
        return self._native.to_csv(decimals)

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        seconds = float(self.time[-1] - self.time[0])
        return f"<Record {self.name}: {len(self)} samples over {seconds:.4g} s, {self.quantity} in {self.unit}>"


def as_records(records: Any, nominal: Nominal | None = None) -> list[Record]:
    """One record or several, given as records or as paths of files."""
    several = [records] if isinstance(records, (Record, str, PathLike)) else list(records)
    return [one if isinstance(one, Record) else Record.read(one, nominal=nominal) for one in several]


def _column(record: str, name: str, numbers: ArrayLike) -> NDArray[np.float64]:
    try:
        column = np.asarray(numbers, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise RecordError(f"{record}: {name} are not numbers: {error}; expected a column of float64") from None
    if column.ndim != 1:
        raise RecordError(f"{record}: {name} has shape {column.shape}; expected one dimension, a number for each sample")
    return np.ascontiguousarray(column)


def _options(reading: Mapping[str, Any]) -> str:
    return json.dumps({name: value for name, value in reading.items() if value is not None})


def _native_nominal(nominal: Nominal | None) -> Any:
    return None if nominal is None else nominal._native
