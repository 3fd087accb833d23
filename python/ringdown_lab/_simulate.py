"""Simulated records."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from . import _native
from ._nominal import Nominal
from ._record import Record


def simulate(
    nominal: Nominal,
    effects: Mapping[str, Mapping[str, float]] | None = None,
    *,
    position: float = 0.5,
    velocity: float = 0.0,
    rate_hz: float = 200.0,
    seconds: float = 20.0,
    noise: float = 0.0,
    quantity: str = "position",
    input: Mapping[str, Any] | None = None,
    seed: int = 0,
) -> Record:
    """Simulates one record of a nominal simulator with further effects; it says that it is simulated.

    effects: from identifiers to parameters, in the system or in the measurement chain; ``effects()`` lists them.
    position, velocity: where the motion starts, in rad or m and per second. rate_hz, seconds: sampling.
    noise: standard deviation of white sensor noise, in the observed unit. quantity: what the sensor observes.
    input: ``{"waveform": "sine" | "chirp" | "square", "amplitude": …, "frequency_hz": …, "end_frequency_hz": …}``.
    seed: root of the random draws; the same gives the same bits.

    Raises ConfigError for unknown effects or parameters and for an impossible motion or sampling.
    """
    driven = None if input is None else {"end_frequency_hz": input.get("frequency_hz"), **input}
    wanted = {
        "effects": [[name, dict(parameters)] for name, parameters in (effects or {}).items()],
        "position": position,
        "velocity": velocity,
        "rate_hz": rate_hz,
        "seconds": seconds,
        "noise": noise,
        "seed": seed,
        "quantity": quantity,
        "input": driven,
    }
    return Record._of(_native.simulate(nominal._native, json.dumps(wanted)))


def effects() -> dict[str, dict[str, Any]]:
    """Every effect that a simulator may lack, by identifier: its equation, and its parameters with their meaning."""
    return {name: {"equation": equation, "parameters": parameters} for name, equation, parameters in _native.effects()}
