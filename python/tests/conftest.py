"""What the tests share: an arm with dry friction that its simulator lacks, on disk and in memory."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import ringdown_lab as rd

FRICTION = {"coulomb_friction": {"torque": 1.0}}


@pytest.fixture(scope="session")
def nominal() -> rd.Nominal:
    return rd.Nominal(natural_frequency=3.5, damping_ratio=0.005)


@pytest.fixture(scope="session")
def record(nominal: rd.Nominal) -> rd.Record:
    return rd.simulate(nominal, FRICTION, rate_hz=100.0, seconds=8.0, noise=2e-4)


@pytest.fixture(scope="session")
def answer(record: rd.Record, nominal: rd.Nominal) -> rd.Diagnosis:
    return rd.diagnose(record, nominal)


@pytest.fixture
def case(tmp_path: Path, record: rd.Record, nominal: rd.Nominal) -> Path:
    """A folder with the record and the nominal simulator as files."""
    (tmp_path / "record-000.csv").write_text(record.to_csv(9))
    (tmp_path / "nominal.toml").write_text(nominal.to_toml())
    return tmp_path


def ringdown(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """The command line, as it is installed."""
    line = [str(Path(sys.executable).with_name("ringdown")), *arguments]
    return subprocess.run(line, capture_output=True, text=True, check=False, cwd=cwd)


def timeless(content: Any) -> Any:
    """The same without durations, which differ from run to run."""
    if isinstance(content, dict):
        return {key: timeless(value) for key, value in content.items() if key != "seconds"}
    return [timeless(value) for value in content] if isinstance(content, list) else content
