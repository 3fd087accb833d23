"""Robots of several joints: their models, and what these lack."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from . import _native, _simulator
from ._native import ConfigError
from .logs import csv_of


class _Named:
    """A model of the caller's with the names of its joints."""

    def __init__(self, model: Any, joints: Sequence[str], slides: Sequence[str]) -> None:
        self.names = list(joints)
        self.slides = [name in slides for name in joints]
        self.mass_matrix, self.bias = model.mass_matrix, model.bias
        for key in ("damping", "friction", "armature", "stiffness"):
            own = getattr(model, key, None)
            setattr(self, key, None if own is None else list(own))
        if hasattr(model, "rollout"):
            self.rollout = model.rollout


class Robot:
    """The model of a robot: a URDF, an MJCF, or any object that gives a mass matrix and bias forces.

    model: an object with ``mass_matrix(q)``, an array of n by n in kg m² (armatures included), and ``bias(q, v)``, the n torques of
    gravity, Coriolis and centrifugal forces in N m, for positions q in rad and speeds v in rad/s (m and N for slides). Where it has
    ``rollout(parameters, start, inputs)``, that runs the whole model in the check: ``parameters`` holds for each joint
    ``damping``, ``friction``, ``armature``, ``stiffness`` and ``torque``, beyond what the model has; ``start`` is (q, v), ``inputs``
    are times and torques, a row for each time; it returns the positions, a row for each time. joints: their names in the
    order of q. slides: names of those that slide.
    """

    def __init__(self, model: Any, joints: Sequence[str] | None = None, *, slides: Sequence[str] = ()) -> None:
        names = getattr(model, "names", None) if joints is None else joints
        if not names:
            raise ConfigError("the names of the joints are needed, in the order of q: Robot(model, ['shoulder', 'elbow'])")
        for method in ("mass_matrix", "bias"):
            if not callable(getattr(model, method, None)):
                raise ConfigError(f"the model has no method {method}; expected mass_matrix(q) and bias(q, v)")
        self._native = self._asked(type(model).__name__, _Named(model, names, slides), None)

    @staticmethod
    def _asked(name: str, model: Any, text: str | None) -> _native.NativeRobot:
        return _native.NativeRobot.of(name, lambda question: _simulator.answer(model, question), text)

    @classmethod
    def _of(cls, native: _native.NativeRobot) -> Robot:
        made = cls.__new__(cls)
        made._native = native
        return made

    @classmethod
    def from_urdf(cls, path: str | PathLike[str]) -> Robot:
        """Reads a URDF: revolute, continuous, prismatic and fixed joints that form a tree."""
        return cls._of(_native.NativeRobot.from_urdf(path))

    @classmethod
    def from_mjcf(cls, path: str | PathLike[str]) -> Robot:
        """Reads an MJCF through MuJoCo, which must be installed: hinges and slides that form a tree.

        Damping, ``frictionloss``, armatures and springs are the model's; its actuators do not act, since the torques are measured.
        """
        try:
            model = _simulator.MuJoCo(path)
        except _simulator.Refused as error:
            raise ConfigError(str(error)) from None
        return cls._of(cls._asked(fspath(path), model, Path(path).read_text(encoding="utf-8")))

    @property
    def joints(self) -> list[str]:
        """Names of the joints, in the order of all vectors."""
        return self._native.joints

    def diagnose(
        self,
        records: Any,
        *,
        joints: Sequence[str] = (),
        columns: Mapping[str, tuple[str, str]] | None = None,
        check: Any = (),
        false_alarm: float | None = None,
        most_effects: int | None = None,
        without: Sequence[str] = (),
        seed: int = 0,
        threads: int | None = None,
        progress: Callable[[str], object] | None = None,
        **reading: Any,
    ) -> Joints:
        """Says for each joint which effects the model lacks, and runs the whole model over recordings that were not fitted.

        records: a log of all joints or several: paths, data frames, or mappings from names to columns. joints: names of those to
        diagnose; all, if empty. columns: position and torque of a joint where the header does not tell, ``{"elbow": ("q2", "tau2")}``.
        check: recordings that are not fitted. reading: the options of ``Record.read``, such as ``unit="deg"``.
        The other options are those of ``ringdown_lab.diagnose``, which takes a robot too.

        Raises RecordError for logs that cannot be used, ConfigError for models and options.
        """
        stated = [f"{joint}={position},{torque}" for joint, (position, torque) in (columns or {}).items()]
        with tempfile.TemporaryDirectory() as folder:
            return Joints(
                _native.diagnose_joints(
                    _paths(records, Path(folder), "recording"),
                    self._native,
                    joints=list(joints),
                    columns=stated,
                    check=_paths(check, Path(folder), "check"),
                    reading=json.dumps({name: value for name, value in reading.items() if value is not None}),
                    false_alarm=false_alarm,
                    most_effects=most_effects,
                    without=list(without),
                    seed=seed,
                    threads=threads,
                    progress=progress,
                )
            )

    def __repr__(self) -> str:
        return f"<Robot of {len(self.joints)} joints: {', '.join(self.joints)}>"


def _paths(records: Any, folder: Path, kind: str) -> list[str]:
    """Paths of logs; a frame becomes a file."""
    several = list(records) if isinstance(records, (list, tuple)) else [records]
    paths = []
    for at, one in enumerate(several):
        if isinstance(one, (str, PathLike)):
            paths.append(fspath(one))
        else:
            path = folder / f"{kind}-{at + 1}.csv"
            path.write_bytes(csv_of(one))
            paths.append(str(path))
    return paths


class Joints:
    """The diagnosis of a robot, joint by joint, with a check of the whole model."""

    def __init__(self, native: _native.NativeJoints) -> None:
        self._native = native
        self._content: dict[str, Any] = json.loads(native.to_json())

    def to_dict(self) -> dict[str, Any]:
        """The content of ``joints.json``."""
        return json.loads(self._native.to_json())  # type: ignore[no-any-return]

    def to_json(self) -> str:
        """The text of ``joints.json``."""
        return self._native.to_json()

    def __getitem__(self, joint: str) -> dict[str, Any]:
        """A joint by its name: its ``diagnosis``, its ``repair``, and the errors of the whole model there."""
        for own in self._content["joints"]:
            if own["name"] == joint:
                return own  # type: ignore[no-any-return]
        raise KeyError(joint)

    @property
    def repaired(self) -> str | None:
        """The text of the repaired URDF or MJCF; None for a model that is no file."""
        return self._native.repaired

    @property
    def closed_loop(self) -> dict[str, Any] | None:
        """Errors of the whole model on recordings that were not fitted; None where it could not be run."""
        return self._content["closed_loop"]  # type: ignore[no-any-return]

    def __str__(self) -> str:
        lines = [f"{own['name']}: {own['diagnosis']['verdict']['summary']}" for own in self._content["joints"]]
        lines += [f"{own['id']}: no answer: {own['message']}" for own in self._content["failed"]]
        return "\n".join(lines + self._content["notes"])

    def __repr__(self) -> str:
        return f"<Joints {', '.join(own['name'] for own in self._content['joints'])}>"
