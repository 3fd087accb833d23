"""Results of Python and of the command line are equal to the bit."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import ringdown_lab as rd
from conftest import ringdown, timeless


def test_a_diagnosis_equals_the_programs(case: Path) -> None:
    path, nominal = str(case / "record-000.csv"), str(case / "nominal.toml")
    told = ringdown("diagnose", path, "--nominal", nominal, "--out", str(case / "run"), "--json")
    assert told.returncode == 0, told.stderr
    own = rd.diagnose(path, nominal, threads=1)
    assert timeless(own.to_dict()) == timeless(json.loads(told.stdout))
    assert own.files["repaired.py"] == (case / "run" / "repaired.py").read_text()
    assert own.to_mjcf() == (case / "run" / "repaired.mjcf.xml").read_text()


def test_arrays_are_diagnosed_as_their_file_is(case: Path, nominal: rd.Nominal) -> None:
    read = rd.Record.read(case / "record-000.csv", nominal=nominal)
    arrays = rd.Record(read.time, read.values)

    def numbers(answer: rd.Diagnosis) -> object:
        content = timeless(answer.to_dict())
        return [content[key] for key in ("verdict", "effects", "classes", "gap", "calibration")]

    assert numbers(rd.diagnose(arrays, nominal)) == numbers(rd.diagnose(read, nominal))


def test_an_estimate_equals_the_programs(case: Path) -> None:
    config = case / "config.toml"
    config.write_text('[data]\npath = "record-000.csv"\n[estimator]\nname = "sindy"\n')
    told = ringdown(str(config), "--out", str(case / "run"), "--json")
    assert told.returncode in (0, 1), told.stderr
    result = json.loads(told.stdout)
    own = rd.estimate(case / "record-000.csv", "sindy")
    assert own.damping_ratio == result["estimate"]["zeta"]
    assert own.least_squares == result["oracle"]["zeta"]


def test_learning_equals_the_programs(tmp_path: Path) -> None:
    pendulum = rd.Nominal(natural_frequency=1.0, damping_ratio=0.01)
    for number, position in enumerate((0.3, 0.5, 0.4)):
        made = rd.simulate(pendulum, position=position, noise=1e-3, rate_hz=50.0, seconds=20.0, seed=number)
        (tmp_path / f"record-{number:03}.csv").write_text(made.to_csv(9))
    (tmp_path / "learn.toml").write_text(
        'task = "learn"\n[learn]\nlearners = ["sindy", "gaussian-process"]\nbaselines = ["persistence", "arx"]\n'
        '[problem.records]\nfolder = "."\nrecords = ["record-*.csv"]\n'
    )
    told = ringdown(str(tmp_path / "learn.toml"), "--out", str(tmp_path / "run"), "--json")
    assert told.returncode == 0, told.stderr
    records = [rd.Record.read(path) for path in sorted(tmp_path.glob("record-*.csv"))]
    own = rd.learn(records, ["sindy", "gaussian-process"], baselines=["persistence", "arx"])

    def rows(result: dict) -> list:
        return [{key: value for key, value in row.items() if key != "model"} for row in timeless(result)["results"]]

    assert rows(own.to_dict()) == rows(json.loads(told.stdout))


def test_a_batch_is_the_programs(case: Path, tmp_path: Path, nominal: rd.Nominal) -> None:
    cases = tmp_path / "cases"
    for name in ("a", "b"):
        (cases / name).mkdir(parents=True)
        for file in ("record-000.csv", "nominal.toml"):
            (cases / name / file).write_text((case / file).read_text())
    (cases / "bad").mkdir()
    (cases / "bad" / "nominal.toml").write_text(nominal.to_toml())
    told = rd.diagnose_batch(cases, tmp_path / "answers", threads=2)
    assert (told["cases"], told["diagnosed"], [one["id"] for one in told["failed"]]) == (3, 2, ["bad"])
    own = rd.diagnose(cases / "a" / "record-000.csv", cases / "a" / "nominal.toml")
    stored = json.loads((tmp_path / "answers" / "a" / "diagnosis.json").read_text())
    assert timeless(own.to_dict()) == timeless(stored)
    # What is there is left alone.
    assert rd.diagnose_batch(cases, tmp_path / "answers")["skipped"] == 2


def test_a_batch_that_cannot_begin_says_why(tmp_path: Path) -> None:
    with pytest.raises(rd.RingdownError, match="no case|cannot be"):
        rd.diagnose_batch(tmp_path / "nothing", tmp_path / "answers")


def test_the_repaired_simulator_moves_as_the_record_does(answer: rd.Diagnosis) -> None:
    from math import isclose

    position, velocity = answer.start[:2]
    rates = answer.repaired(0.0, answer.start)
    assert rates[0] == velocity
    # Released from 0.5 rad: a spring of 3.5 Hz pulls it back, less the friction.
    stiffness = (2 * np.pi * 3.5) ** 2
    assert isclose(rates[1], -stiffness * position, rel_tol=0.05)


def test_the_command_has_the_programs_help_and_exit_codes(tmp_path: Path) -> None:
    assert "Exit codes" in ringdown("--help").stdout
    wrong = ringdown("diagnose", "nothing.csv", "--nominal", "nothing.toml", cwd=tmp_path)
    assert wrong.returncode == 2
    assert "nothing.toml: cannot be used" in wrong.stderr
    assert ringdown("diagnos").returncode == 2


def test_trials_start_the_installed_command_again(tmp_path: Path) -> None:
    # The diagnosis of a trial is another process of the program, which is not the interpreter.
    config = tmp_path / "trials.toml"
    few = ["none=1", "single=1"] + [
        f"{kind}=0"
        for kind in ("calibration", "pair", "left_out", "foreign", "releases", "driven", "stressed", "measured_cases")
        + ("engine_cases", "composite", "rigs_cases")
    ]
    config.write_text('task = "trials"\n')
    overrides = [f"trials.{one}" for one in few] + ["record.seconds=8", "record.rate_hz=130"]
    told = ringdown("trials", str(config), *overrides, "--out", str(tmp_path / "run"), "--quiet", cwd=tmp_path)
    assert told.returncode in (0, 1), told.stderr
    assert len(list((tmp_path / "run").rglob("diagnosis.json"))) == 2
