"""Learners for the tests: in a module, so that another process can import them."""

from __future__ import annotations

import os
import sys

import numpy as np

import ringdown_lab as rd


class Linear:
    """The next position from the last two, by least squares: the exact recursion of a linear oscillator."""

    parameters = 2

    def fit(self, train: list[rd.Stretch], validation: list[rd.Stretch], about: rd.About) -> None:
        print("what a learner prints goes to standard error")
        # Every fifth sample: noise then weighs less in what is learned.
        rows = [np.c_[part.values[5:-5], part.values[:-10], part.values[10:]] for part in train]
        table = np.concatenate(rows)
        self.weights, *_ = np.linalg.lstsq(table[:, :2], table[:, 2], rcond=None)
        self.seconds = 5 * float(np.median(np.diff(train[0].time)))

    def predict(self, past: rd.Stretch, ahead: rd.Ahead) -> np.ndarray:
        # The recursion's own frequency and decay, fitted to the past.
        roots = np.log(np.roots([1.0, *(-self.weights)]).astype(complex)) / self.seconds
        rate, frequency = roots[0].real, abs(roots[0].imag)

        def waves(time: np.ndarray) -> np.ndarray:
            since = time - past.time[0]
            return np.exp(rate * since)[:, None] * np.c_[np.cos(frequency * since), np.sin(frequency * since)]

        amplitudes, *_ = np.linalg.lstsq(waves(past.time), past.values, rcond=None)
        return waves(ahead.time) @ amplitudes


class Wordless:
    """Knows that it is not in the process that it was made in."""

    def __init__(self, parent: int) -> None:
        self.parent = parent

    def fit(self, train: list[rd.Stretch], validation: list[rd.Stretch], about: rd.About) -> Wordless:
        assert os.getpid() != self.parent
        return self

    def predict(self, past: rd.Stretch, ahead: rd.Ahead) -> list[float]:
        return [past.values[-1]] * len(ahead.time)


class Crashing:
    """Fails in the way that it is told."""

    def __init__(self, how: str) -> None:
        self.how = how

    def fit(self, train: list[rd.Stretch], validation: list[rd.Stretch], about: rd.About) -> None:
        if self.how == "raise":
            raise ZeroDivisionError("by nothing")
        if self.how == "exit":
            sys.stderr.flush()
            os._exit(3)

    def predict(self, past: rd.Stretch, ahead: rd.Ahead) -> list[float]:
        return [0.0]


class EndToEnd:
    """The decay from the first to the last peak."""

    def fit(self, time: np.ndarray, log_amplitude: np.ndarray) -> tuple[float, float]:
        return (log_amplitude[0] - log_amplitude[-1]) / (time[-1] - time[0]), 1e-3


class Helpless:
    """Gives nothing."""

    def fit(self, time: np.ndarray, log_amplitude: np.ndarray) -> float:
        raise RuntimeError("no idea")
