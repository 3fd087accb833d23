"""Learners written in Python work in processes of their own and are scored like the others."""

from __future__ import annotations

import os

import numpy as np
import pytest

import ringdown_lab as rd
from learners import Crashing, Linear, Wordless


@pytest.fixture(scope="module")
def records() -> list[rd.Record]:
    pendulum = rd.Nominal(natural_frequency=1.0, damping_ratio=0.01)
    made = (
        rd.simulate(pendulum, position=position, noise=1e-3, rate_hz=50.0, seconds=20.0, seed=seed)
        for seed, position in enumerate((0.3, 0.5, 0.4))
    )
    return list(made)


def test_a_learner_in_python_is_scored_beside_the_baselines(records: list[rd.Record]) -> None:
    told = rd.learn(records, ["sindy", Linear()], baselines=["persistence", "arx"])
    # What was learned in Python cannot be put to zero, so that the workspace's own learner alone is judged without it.
    ablated = {"sindy:at-zero", "sindy:on-noise"}
    assert {row["id"] for row in told.results} == {"sindy", "Linear", "persistence", "arx"} | ablated
    assert {row["id"] for row in told.results if row["kind"] == "ablation"} == ablated
    # A linear recursion is the truth of a linear oscillator: far better than persistence.
    own, persistence = told["Linear"]["test"], told["persistence"]["test"]
    assert own["free_run_rmse"] < 0.2 * persistence["free_run_rmse"]
    assert told["Linear"]["kind"] == "learner"
    assert told["Linear"]["parameters"] == 2
    for shown in (str(told), told._repr_html_()):
        assert "Linear" in shown and "persistence" in shown


def test_its_process_is_not_this_one(records: list[rd.Record]) -> None:
    told = rd.learn(records, [Wordless(os.getpid())], baselines=[])
    assert told["Wordless"]["failure"] is None


def test_a_class_of_this_script_needs_cloudpickle_or_comes_along(records: list[rd.Record]) -> None:
    pytest.importorskip("cloudpickle")

    class Here:
        def fit(self, train: list[rd.Stretch], validation: list[rd.Stretch], about: rd.About) -> None:
            self.mean = float(np.mean(np.concatenate([part.values for part in train])))

        def predict(self, past: rd.Stretch, ahead: rd.Ahead) -> tuple[np.ndarray, np.ndarray]:
            return np.full(ahead.time.size, self.mean), np.full(ahead.time.size, 0.2)

    told = rd.learn(records, Here(), baselines=[])
    assert told["Here"]["test"]["coverage_95"] is not None


def test_one_that_fails_is_a_row_with_its_reason(records: list[rd.Record]) -> None:
    told = rd.learn(records, [Crashing("raise"), Crashing("exit"), Crashing("short")], baselines=["persistence"])
    reasons = [told[f"Crashing-{number}"]["failure"] for number in (1, 2, 3)]
    assert "ZeroDivisionError" in reasons[0]
    assert "its process ended (exit code 3) during fit" in reasons[1]
    assert "a prediction failed: predict gave 1 values for" in reasons[2]
    assert told["persistence"]["failure"] is None


def test_wrong_names_and_sets_are_told(records: list[rd.Record]) -> None:
    with pytest.raises(rd.ConfigError, match="no-such"):
        rd.learn(records, ["no-such"])
    with pytest.raises(rd.RecordError, match="only record"):
        rd.learn(records[:1], ["sindy"])


def test_progress_tells_steps(records: list[rd.Record]) -> None:
    lines: list[str] = []
    rd.learn(records, ["neural-ode"], baselines=[], max_steps=200, progress=lines.append)
    assert any(line.startswith("neural-ode: ") and "step 10," in line for line in lines)
