"""Nominal simulators: what is believed of a system."""

from __future__ import annotations

import json
from collections.abc import Mapping
from os import PathLike

from ._native import NativeNominal
from ._record import Record


class Nominal:
    """The simulator as it is: a linear oscillator, with the effects that it has already.

    I·θ̈ + c·θ̇ + k·(θ − θ_rest) = g·u(t), in SI units, or with everything divided by the inertia.

    Give ``natural_frequency`` [Hz] or ``period`` [s] with ``damping_ratio``, or ``damping`` and ``stiffness``; ``inertia`` left out
    means that everything is per unit of inertia.

    coordinate: ``"angle"`` (rad) or ``"displacement"`` (m).
    input_gain: torque or force per unit of the input; with it the system is driven.
    sensor_resolution: step of the sensor.
    effects: what the simulator has already, from identifiers to parameters: ``{"coulomb_friction": {"torque": 0.8}}``.

    Raises ConfigError for a number out of range or an unknown effect.
    """

    def __init__(
        self,
        *,
        natural_frequency: float | None = None,
        damping_ratio: float | None = None,
        period: float | None = None,
        inertia: float | None = None,
        damping: float | None = None,
        stiffness: float | None = None,
        rest_angle: float = 0.0,
        coordinate: str | None = None,
        input_gain: float | None = None,
        sensor_resolution: float | None = None,
        effects: Mapping[str, Mapping[str, float]] | None = None,
    ) -> None:
        numbers = {
            "natural_frequency": natural_frequency,
            "damping_ratio": damping_ratio,
            "period": period,
            "inertia": inertia,
            "damping": damping,
            "stiffness": stiffness,
            "rest_angle": rest_angle,
            "input_gain": input_gain,
            "sensor_resolution": sensor_resolution,
        }
        lines = [f"{key} = {_number(value)}" for key, value in numbers.items() if value is not None]
        if coordinate is not None:
            lines.append(f"coordinate = {json.dumps(coordinate)}")
        for effect, parameters in (effects or {}).items():
            inside = ", ".join(f"{json.dumps(name)} = {_number(value)}" for name, value in parameters.items())
            lines.append(f"[[effects]]\nid = {json.dumps(effect)}\nparameters = {{ {inside} }}")
        self._native = NativeNominal.parse("nominal", "\n".join(lines) + "\n")

    @classmethod
    def _of(cls, native: NativeNominal) -> Nominal:
        made = cls.__new__(cls)
        made._native = native
        return made

    @classmethod
    def guess(cls, record: Record | str | PathLike[str]) -> Nominal:
        """The linear oscillator nearest to a record, as ``ringdown init`` writes it.

        Raises RecordError where nothing moves or the record is shorter than a few swings.
        """
        own = record if isinstance(record, Record) else Record.read(record)
        return cls._of(NativeNominal.guess(own._native))

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Nominal:
        """Reads a ``nominal.toml``. Raises ConfigError with file, line and column."""
        return cls._of(NativeNominal.read(path))

    @classmethod
    def parse(cls, text: str, name: str = "nominal.toml") -> Nominal:
        """Reads the text of a ``nominal.toml``; ``name`` is what messages call it."""
        return cls._of(NativeNominal.parse(name, text))

    @classmethod
    def from_mjcf(cls, path: str | PathLike[str], joint: str) -> Nominal:
        """The simulator of one joint of a MuJoCo model, all others held; friction and weight are effects that it has.

        Needs mujoco (``pip install ringdown-lab[mujoco]``). Raises ConfigError for a model that cannot be read, or a joint that is
        absent or neither hinge nor slide.
        """
        from ._joints import joint as of_joint

        return cls(**of_joint(path, joint))

    @classmethod
    def from_urdf(cls, path: str | PathLike[str], joint: str) -> Nominal:
        """The same for a joint of a robot description, read by MuJoCo."""
        return cls.from_mjcf(path, joint)

    @property
    def inertia(self) -> float:
        """Inertia in kg m² or kg; 1 where everything is per unit of it."""
        return self._native.coefficients[0]

    @property
    def damping(self) -> float:
        """Damping coefficient."""
        return self._native.coefficients[1]

    @property
    def stiffness(self) -> float:
        """Stiffness."""
        return self._native.coefficients[2]

    @property
    def rest_angle(self) -> float:
        """Position at rest, in rad or m."""
        return self._native.coefficients[3]

    @property
    def input_gain(self) -> float:
        """Torque or force per unit of the input."""
        return self._native.coefficients[4]

    def to_toml(self) -> str:
        """The simulator as the text of a ``nominal.toml``."""
        return self._native.to_toml()

    def __repr__(self) -> str:
        return f"<Nominal inertia={self.inertia:.6g} damping={self.damping:.6g} stiffness={self.stiffness:.6g}>"


def _number(value: float) -> str:
    text = repr(float(value))
    return text if any(sign in text for sign in ".en") else f"{text}.0"
