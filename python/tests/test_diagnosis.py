"""A diagnosis in Python: the parts of diagnosis.json, the page, and what a notebook shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import ringdown_lab as rd


def test_an_arm_with_dry_friction_is_told(answer: rd.Diagnosis) -> None:
    assert answer.verdict["status"] == "effect"
    assert answer.classes[0]["id"] == "friction"
    assert answer.gap["repaired"] < 0.2 * answer.gap["recalibrated"]
    content = answer.to_dict()
    for part in ("verdict", "classes", "effects", "gap"):
        assert getattr(answer, part) == content[part]
    assert str(answer) == content["verdict"]["summary"]


def test_a_notebook_shows_verdict_bars_and_a_plot(answer: rd.Diagnosis) -> None:
    html = answer._repr_html_()
    for words in (">friction<", "<svg", "held-out error", "polyline", "SIMULATED"):
        assert words in html
    # Nothing is loaded.
    assert "http" not in html


def test_the_report_is_one_page(answer: rd.Diagnosis, tmp_path: Path) -> None:
    answer.report(tmp_path / "gap.html")
    page = (tmp_path / "gap.html").read_text()
    assert page.startswith("<!DOCTYPE html>") or page.startswith("<!doctype html>")
    assert "friction" in page


def test_the_repaired_simulator_is_a_nominal_one(answer: rd.Diagnosis) -> None:
    assert "coulomb_friction" in answer.nominal.to_toml() or "stribeck_friction" in answer.nominal.to_toml()


def test_the_series_are_columns(answer: rd.Diagnosis, record: rd.Record) -> None:
    series = answer.series
    assert np.array_equal(series["observed"], record.values[: series["observed"].size])
    residual = series["observed"] - series["repaired"]
    assert np.sqrt(np.nanmean(residual**2)) < 1.0e-3


def test_a_guess_is_near(record: rd.Record) -> None:
    guessed = rd.Nominal.guess(record)
    assert guessed.stiffness**0.5 / (2 * np.pi) == pytest.approx(3.5, rel=0.01)


def test_a_simulated_record_says_so(answer: rd.Diagnosis) -> None:
    assert answer.to_dict()["records"][0]["origin"] == "simulated"


def test_every_effect_and_method_has_a_line() -> None:
    assert rd.effects()["quadratic_drag"]["equation"] == "-β θ′ |θ′|"
    assert {"ols", "pinn", "gaussian-process"} <= set(rd.methods())
