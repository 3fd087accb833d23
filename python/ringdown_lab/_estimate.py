"""Estimates of the damping ratio."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._record import Record
from ._worker import Worker


@dataclass(frozen=True)
class Estimate:
    """An estimate of the damping of a free decay, beside least squares on the same peaks."""

    damping_ratio: float
    """Damping ratio ζ."""
    damping_ratio_std_error: float | None
    """Standard error of ζ, where the method states one."""
    decay_rate: float
    """Decay rate of the amplitude, in 1/s."""
    decay_rate_interval_95: tuple[float, float] | None
    """95 % interval of the decay rate, where the method states one."""
    omega_rad_s: float
    """Angular frequency, in rad/s."""
    peaks: int
    """Number of peaks."""
    least_squares: float
    """ζ by closed-form least squares on the same peaks."""
    error_percent: float
    """Distance from that, in percent."""
    reached: str
    """State that the fit reached: ``converged``, ``budget_spent``, ``stalled``, ``diverged``."""
    because: str
    """Reason for stopping there."""
    steps: int
    """Training steps taken."""
    equation: str | None
    """Law that the method found, where it finds laws."""


class Estimator(Protocol):
    """An estimator written in Python: it works in a process of its own, on the same peaks as every other."""

    def fit(self, time: NDArray[np.float64], log_amplitude: NDArray[np.float64]) -> Any:
        """Gives the decay rate in 1/s from the peaks' times and the logarithms of their amplitudes; or a pair of the rate and its
        standard error."""


class _Remote:
    """An estimator in its own process, as the extension calls it."""

    def __init__(self, estimator: object) -> None:
        self._worker = Worker(estimator)

    def fit(self, time: NDArray[np.float64], log_amplitude: NDArray[np.float64]) -> tuple[float, float, float | None]:
        told = self._worker.call("estimate", time, log_amplitude)
        rate, error = told if isinstance(told, tuple) else (told, None)
        # The line through the peaks' center, at time 0.
        start = float(np.mean(log_amplitude) + float(rate) * np.mean(time))
        return float(rate), start, None if error is None else float(error)

    def close(self) -> None:
        self._worker.close()


def estimate(
    record: Record | str | PathLike[str],
    method: str | Estimator = "ols",
    *,
    pipeline: str | None = None,
    seed: int = 0,
    max_steps: int | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Estimate:
    """Estimates the damping ratio of a free decay.

    method: one of ``methods()``, or an object with ``fit`` (see ``Estimator``). pipeline: ``"auto"``, ``"recommended"``, ``"samples"`` or
    ``"paper"``.
    max_steps: cap on the training steps, 0 for the untrained estimate.
    settings: settings of the method, such as ``{"hidden": [16]}``.

    Raises ConfigError for an unknown method or setting, RecordError for a record without enough peaks, FitError where the method
    gives no estimate.
    """
    own = record if isinstance(record, Record) else Record.read(record)
    if not isinstance(method, str):
        remote = _Remote(method)
        try:
            return Estimate(**_native.estimate_own(own._native, type(method).__name__, remote, pipeline=pipeline, seed=seed))
        finally:
            remote.close()
    lines = "".join(f"{name} = {json.dumps(value)}\n" for name, value in (settings or {}).items())
    found = _native.estimate(own._native, method, pipeline=pipeline, seed=seed, max_steps=max_steps, settings=lines)
    return Estimate(**found)


def methods() -> dict[str, str]:
    """Every method by name, with a sentence about it."""
    return {name: summary for name, _, summary in _native.methods()}
