"""Diagnoses of the gap between a simulator and records."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._html import diagnosis_html
from ._native import ConfigError
from ._nominal import Nominal
from ._record import Record, as_records
from ._robot import Joints, Robot


class Diagnosis:
    """Where the gap between a simulator and records lies, which effects cause it, and how far it closes.

    Shown by a notebook with its verdict, its classes of effects and a plot; ``report`` writes the whole page.
    """

    def __init__(self, native: _native.NativeDiagnosis) -> None:
        self._native = native
        self._content: dict[str, Any] = json.loads(native.to_json())
        self._equations: dict[str, Any] | None = None

    def to_dict(self) -> dict[str, Any]:
        """The content of ``diagnosis.json``."""
        return json.loads(self._native.to_json())  # type: ignore[no-any-return]

    def to_json(self) -> str:
        """The text of ``diagnosis.json``."""
        return self._native.to_json()

    @property
    def verdict(self) -> dict[str, Any]:
        """Status (``none``, ``calibration``, ``effect``, ``unknown``), names, confidence, and a summary in a sentence."""
        return self._content["verdict"]  # type: ignore[no-any-return]

    @property
    def classes(self) -> list[dict[str, Any]]:
        """Classes of effects that explain alike, the most probable first."""
        return self._content["classes"]  # type: ignore[no-any-return]

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Effects with their probabilities, coefficients and shares of the gap, best first."""
        return self._content["effects"]  # type: ignore[no-any-return]

    @property
    def gap(self) -> dict[str, Any]:
        """Errors on parts that were not fitted: of the simulator as given, recalibrated and repaired, beside the noise floor."""
        return self._content["gap"]  # type: ignore[no-any-return]

    @property
    def series(self) -> dict[str, NDArray[np.float64]]:
        """Observed values beside those of the simulator as given, recalibrated and repaired: columns of ``series.csv``."""
        return self._native.series()

    @property
    def files(self) -> dict[str, str]:
        """The repaired simulator by file name: a configuration, equations, and programs for SciPy, Modelica, MuJoCo and URDF."""
        return self._native.files()

    @property
    def nominal(self) -> Nominal:
        """The repaired simulator as a nominal one, to diagnose further records with."""
        return Nominal._of(self._native.repaired_nominal())

    def _program(self) -> dict[str, Any]:
        if self._equations is None:
            made: dict[str, Any] = {"__name__": "repaired"}
            exec(compile(self.files["repaired.py"], "repaired.py", "exec"), made)
            self._equations = made
        return self._equations

    @property
    def start(self) -> list[float]:
        """State of the repaired simulator where the first record starts: position, velocity, then hidden states."""
        return list(self._program()["start"])

    def repaired(self, t: float, state: Sequence[float], u: Callable[[float], float] | None = None) -> list[float]:
        """Time derivative of the repaired simulator's state, for ``scipy.integrate.solve_ivp``.

        t: time in seconds. state: position, velocity, then hidden states, as ``start``. u: the input as a function of time.
        """
        rhs = self._program()["rhs"]
        return list(rhs(t, state) if u is None else rhs(t, state, u))

    def to_mjcf(self) -> str:
        """The repaired simulator as a MuJoCo model."""
        return self.files["repaired.mjcf.xml"]

    def to_urdf(self) -> str:
        """The repaired simulator as a robot description."""
        return self.files["repaired.urdf.xml"]

    def report_html(self) -> str:
        """The report as one HTML page that loads nothing."""
        return self._native.report_html()

    def report(self, path: str | PathLike[str]) -> None:
        """Writes the report to a file, in place of one that is there."""
        Path(path).write_text(self.report_html(), encoding="utf-8")

    def _repr_html_(self) -> str:
        return diagnosis_html(self._content, self.series)

    def __str__(self) -> str:
        return str(self.verdict["summary"])

    def __repr__(self) -> str:
        return f"<Diagnosis {self.verdict['status']}: {', '.join(self.verdict['effects']) or 'no effect'}>"


@overload
def diagnose(
    records: Any,
    nominal: Robot,
    *,
    joints: Sequence[str] = ...,
    false_alarm: float | None = ...,
    most_effects: int | None = ...,
    without: Sequence[str] = ...,
    seed: int = ...,
    threads: int | None = ...,
    progress: Callable[[str], object] | None = ...,
) -> Joints: ...
@overload
def diagnose(
    records: Record | str | PathLike[str] | Iterable[Record | str | PathLike[str]],
    nominal: Nominal | str | PathLike[str],
    *,
    false_alarm: float | None = ...,
    most_effects: int | None = ...,
    without: Sequence[str] = ...,
    seed: int = ...,
    threads: int | None = ...,
    progress: Callable[[str], object] | None = ...,
) -> Diagnosis: ...
def diagnose(
    records: Any,
    nominal: Nominal | Robot | str | PathLike[str],
    *,
    joints: Sequence[str] = (),
    false_alarm: float | None = None,
    most_effects: int | None = None,
    without: Sequence[str] = (),
    seed: int = 0,
    threads: int | None = None,
    progress: Callable[[str], object] | None = None,
) -> Diagnosis | Joints:
    """Diagnoses the gap between a nominal simulator and records of one system.

    records: one record or several, as records or as paths. nominal: the simulator, or the path of its ``nominal.toml``; or a
    Robot, whose records are logs of all its joints (``Robot.diagnose``). joints: names of the robot's joints to diagnose.
    false_alarm: false-alarm probability of the search for effects, 0.001 to 0.2.
    most_effects: largest number of effects in one fitted set, 1 to 5. without: effects that are not considered.
    seed: root of the random draws. threads: how many; the answer does not depend on it.
    progress: called with the name of each stage once that is done; ``print`` will do.

    Other Python threads go on meanwhile, and Ctrl-C interrupts.

    Raises RecordError for records that cannot be of this system, DiagnosisError for records that say nothing of it, ConfigError
    for options out of range.
    """
    if isinstance(nominal, Robot):
        return nominal.diagnose(
            records,
            joints=joints,
            false_alarm=false_alarm,
            most_effects=most_effects,
            without=without,
            seed=seed,
            threads=threads,
            progress=progress,
        )
    if joints:
        raise ConfigError("joints are those of a Robot; the nominal simulator given is that of one oscillator")
    system = nominal if isinstance(nominal, Nominal) else Nominal.read(nominal)
    return Diagnosis(
        _native.diagnose(
            [record._native for record in as_records(records, system)],
            system._native,
            false_alarm=false_alarm,
            most_effects=most_effects,
            without=list(without),
            seed=seed,
            threads=threads,
            progress=progress,
        )
    )
