"""Estimates by the workspace's methods and by estimators written in Python."""

from __future__ import annotations

import pytest

import ringdown_lab as rd
from learners import EndToEnd, Helpless


@pytest.fixture(scope="module")
def decay() -> rd.Record:
    return rd.simulate(rd.Nominal(natural_frequency=2.0, damping_ratio=0.01), noise=1e-5)


def test_methods_agree_on_a_linear_decay(decay: rd.Record) -> None:
    for method in ("ols", "sindy", "gaussian-process"):
        assert rd.estimate(decay, method).damping_ratio == pytest.approx(0.01, rel=0.01), method


def test_untrained_networks_are_wrong_and_say_so(decay: rd.Record) -> None:
    found = rd.estimate(decay, "pinn", max_steps=0)
    assert found.error_percent > 1.0
    assert found.reached == "budget_spent"


def test_an_estimator_in_python_stands_beside_least_squares(decay: rd.Record) -> None:
    found = rd.estimate(decay, EndToEnd())
    assert found.damping_ratio == pytest.approx(found.least_squares, rel=0.01)
    assert found.decay_rate_interval_95 is not None


def test_one_that_fails_says_why(decay: rd.Record) -> None:
    with pytest.raises(rd.FitError, match="Helpless, seed 0: RuntimeError: no idea"):
        rd.estimate(decay, Helpless())


def test_settings_are_the_methods_own(decay: rd.Record) -> None:
    with pytest.raises(rd.ConfigError, match="no-such-key|no_such_key"):
        rd.estimate(decay, "pinn", settings={"no_such_key": 1})
