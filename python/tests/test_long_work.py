"""Long work leaves the interpreter free, tells how far it is, and stops on Ctrl-C."""

from __future__ import annotations

import subprocess
import sys
import threading
import time

import pytest

import ringdown_lab as rd

INTERRUPTED = """
import os, signal, threading, time
import ringdown_lab as rd
nominal = rd.Nominal(natural_frequency=3.5, damping_ratio=0.005)
record = rd.simulate(nominal, {"coulomb_friction": {"torque": 1.0}}, rate_hz=400.0, seconds=30.0, noise=2e-4)
threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
start = time.monotonic()
try:
    WORK
except KeyboardInterrupt:
    print("interrupted", time.monotonic() - start)
"""


@pytest.mark.parametrize(
    "work",
    [
        "rd.diagnose(record, nominal)",
        # Wide enough to train for many seconds: a network of the default widths is done before the interruption.
        "rd.estimate(record, 'pinn', settings={'hidden': [64, 64, 64]})",
        "rd.learn([record] * 3, ['neural-ode'])",
    ],
)
def test_ctrl_c_stops_long_work_at_once(work: str) -> None:
    told = subprocess.run(
        [sys.executable, "-c", INTERRUPTED.replace("WORK", work)], capture_output=True, text=True, timeout=60, check=False
    )
    word, seconds = told.stdout.split()
    assert word == "interrupted", told.stderr
    # Asked for after 0.3 s; the rest is for a busy machine.
    assert float(seconds) < 2.3


def test_other_threads_go_on(record: rd.Record, nominal: rd.Nominal) -> None:
    ticks, done = [], threading.Event()

    def tick() -> None:
        while not done.wait(0.01):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    rd.diagnose(record, nominal)
    elapsed = time.monotonic() - start
    done.set()
    thread.join()
    longest = max(b - a for a, b in zip(ticks, ticks[1:], strict=False))
    assert longest < max(0.5, 0.5 * elapsed)


def test_progress_names_the_stages(record: rd.Record, nominal: rd.Nominal) -> None:
    stages: list[str] = []
    answer = rd.diagnose(record, nominal, progress=stages.append)
    assert stages == [stage["name"] for stage in answer.to_dict()["stages"]][:-1]


def test_what_a_callback_raises_ends_the_work(record: rd.Record, nominal: rd.Nominal) -> None:
    def stop(stage: str) -> None:
        raise RuntimeError(f"enough after {stage}")

    with pytest.raises(RuntimeError, match="enough after measurement chain"):
        rd.diagnose(record, nominal, progress=stop)
