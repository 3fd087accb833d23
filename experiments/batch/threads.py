"""How much faster a batch is on several threads than on one: simulated logs of a few seconds, through Python.

    python experiments/batch/threads.py FOLDER [LOGS] [THREADS]

Wall times depend on what else the machine does. On Linux they are therefore given without the time in which the busiest thread was
ready and waited for a processor (/proc/PID/task/TID/schedstat), which is the time that an idle machine takes.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from pathlib import Path

import ringdown_lab as rd

EFFECTS: list[dict[str, dict[str, float]]] = [
    {},
    {"coulomb_friction": {"torque": 1.0}},
    {"quadratic_drag": {"coefficient": 0.5}},
    {"cubic_stiffness": {"coefficient": 300.0}},
    {"coulomb_friction": {"torque": 0.5}, "quadratic_drag": {"coefficient": 0.3}},
]


def make(cases: Path, logs: int) -> None:
    """Logs of one kind of arm, each with its own start and noise, and the effects in turn."""
    nominal = rd.Nominal(natural_frequency=3.5, damping_ratio=0.005)
    for number in range(logs):
        start = 0.4 + 0.25 * number / logs
        effects = EFFECTS[number % len(EFFECTS)]
        record = rd.simulate(nominal, effects, rate_hz=130.0, seconds=4.0, noise=5e-4, position=start, seed=number)
        folder = cases / f"case-{number:04}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "record-000.csv").write_text(record.to_csv(9))
        (folder / "nominal.toml").write_text(nominal.to_toml())


def threads_of_children() -> dict[str, tuple[float, float]]:
    """Seconds that each thread of this process's children has run, and has waited for a processor."""
    found = {}
    children = Path(f"/proc/{os.getpid()}/task").glob("*/children")
    for child in (word for file in children for word in file.read_text().split()):
        for place in Path(f"/proc/{child}/task").glob("*"):
            try:
                ran, waited = (place / "schedstat").read_text().split()[:2]
            except OSError:
                continue
            found[place.name] = (int(ran) / 1e9, int(waited) / 1e9)
    return found


def timed(cases: Path, out: Path, threads: int) -> float:
    """Diagnoses all, says how long that took, and gives the time without waiting."""
    seen: dict[str, tuple[float, float]] = {}
    done = threading.Event()

    def look() -> None:
        while not done.wait(0.05):
            seen.update(threads_of_children())

    looking = threading.Thread(target=look)
    looking.start()
    start = time.monotonic()
    told = rd.diagnose_batch(cases, out, threads=threads)
    wall = time.monotonic() - start
    done.set()
    looking.join()
    assert told["diagnosed"] == told["cases"], told
    busiest = max(seen.values(), default=(0.0, 0.0))
    processor = sum(ran for ran, _ in seen.values())
    own = wall - busiest[1]
    print(f"{threads} threads: {own:.1f} s; wall {wall:.1f} s, processor {processor:.1f} s, busiest thread {busiest[0]:.1f} s")
    return own


def main() -> None:
    """Makes the logs and diagnoses them twice."""
    folder = Path(sys.argv[1])
    logs, threads = (int(word) for word in (sys.argv[2:] + ["500", "2"][len(sys.argv) - 2 :]))
    make(folder / "cases", logs)
    one = timed(folder / "cases", folder / "answers-1", 1)
    many = timed(folder / "cases", folder / f"answers-{threads}", threads)
    print(f"{logs} logs on {threads} threads: {one / many:.2f} times as fast as on one")


if __name__ == "__main__":
    main()
