#!/usr/bin/env python3
"""Driven joints of any damping: records whose nominal simulator is exact, or lacks dry friction.

    VENV/bin/python experiments/rigs/joints.py --out JOINTS --seed 1 --cases 40

A joint follows a command, q'' = k (u - q) - c q' - f tanh(q' / v), held or linear between its samples, with white noise on the angle.
Integrated by Runge-Kutta steps of a tenth of a sampling interval; no Ringdown code is used. The damping ratio runs evenly in its
logarithm from 0.04 to 0.9 over the cases; every other input is held, every third case has three records. `--friction SHARE` adds dry
friction of that share of the spring's largest torque. Writes OUT/cases/<id>/ as records.py does, and OUT/truths/<id>.json.
"""

import argparse
import json
import math
from pathlib import Path

import numpy

SUB = 10


def command(draws, times, frequency):
    """Steps, a chirp, a multisine or filtered noise, of about half a radian."""
    match int(draws.integers(0, 4)):
        case 0:
            held = max(2, int(draws.uniform(0.3, 1.5) / frequency / (times[1] - times[0])))
            return numpy.repeat(draws.uniform(-0.7, 0.7, len(times) // held + 1), held)[: len(times)], "steps"
        case 1:
            low, high = 0.2 * frequency, 1.5 * frequency
            return 0.5 * numpy.sin(2 * math.pi * (low * times + 0.5 * (high - low) * times**2 / times[-1])), "chirp"
        case 2:
            lines = frequency * draws.uniform(0.1, 1.5, 5)
            return sum(0.2 * numpy.sin(2 * math.pi * line * times + draws.uniform(0, 6.28)) for line in lines), "multisine"
        case _:
            noise = draws.standard_normal(len(times))
            past = math.exp(-2 * math.pi * frequency * (times[1] - times[0]))
            smooth = numpy.empty_like(noise)
            state = 0.0
            for index, value in enumerate(noise):
                state = past * state + (1 - past) * value
                smooth[index] = state
            return 0.5 * smooth / numpy.std(smooth), "noise"


def motion(square, damping, friction, speed, values, step, held):
    """Angles at the samples."""
    h = step / SUB
    q, v = float(values[0]), 0.0
    angles = [q]

    def rate(q, v, u):
        return square * (u - q) - damping * v - friction * math.tanh(v / speed)

    for before, after in zip(values[:-1], values[1:]):
        for sub in range(SUB):
            at = lambda part: before if held else before + (after - before) * (sub + part) / SUB
            u0, u1, u2 = at(0.0), at(0.5), at(1.0)
            a1 = rate(q, v, u0)
            a2 = rate(q + 0.5 * h * v, v + 0.5 * h * a1, u1)
            a3 = rate(q + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2, u1)
            a4 = rate(q + h * v + 0.5 * h * h * a2, v + h * a3, u2)
            q, v = q + h * v + h * h / 6 * (a1 + a2 + a3), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        angles.append(q)
    return numpy.array(angles)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--friction", type=float, default=0.0)
    arguments = parser.parse_args()
    (arguments.out / "truths").mkdir(parents=True, exist_ok=True)
    for number in range(arguments.cases):
        draws = numpy.random.default_rng([arguments.seed, number])
        ratio = 0.04 * (0.9 / 0.04) ** (number / max(arguments.cases - 1, 1))
        frequency, rate = draws.uniform(0.8, 3.0), float(draws.choice([50.0, 100.0, 250.0]))
        omega = 2 * math.pi * frequency
        square, damping = omega**2, 2 * ratio * omega
        held, records = number % 2 == 0, 3 if number % 3 == 2 else 1
        friction = arguments.friction * square * 0.5
        folder = arguments.out / "cases" / f"{number:05d}"
        folder.mkdir(parents=True, exist_ok=True)
        floor, inputs = 10 ** draws.uniform(-4.0, -2.7), []
        for record in range(records):
            times = numpy.arange(int(rate * draws.uniform(8, 25))) / rate
            values, kind = command(draws, times, frequency)
            inputs.append(kind)
            seen = motion(square, damping, friction, 2e-3, values, 1 / rate, held) + floor * draws.standard_normal(len(times))
            rows = "\n".join(f"{t:.6f},{q:.7f},{u * square:.9g}" for t, q, u in zip(times, seen, values))
            (folder / f"record-{record:03d}.csv").write_text(f"# origin: simulated\ntime_s,angle_rad,torque_nm\n{rows}\n")
        (folder / "nominal.toml").write_text(f"inertia = 1.0\ndamping = {damping!r}\nstiffness = {square!r}\nrest_angle = 0.0\n")
        truth = {"schema": "ringdown.rig/1", "kind": "single" if friction else "none", "unlisted": [], "nuisances": [],
                 "effects": [{"id": "coulomb_friction", "class": "friction", "parameters": [friction], "floors": 99.0}] if friction else [],
                 "chain": {"floor": floor}, "rig": {"damping_ratio": ratio, "held": held, "records": records, "inputs": inputs, "rate_hz": rate},
                 "system": {"inertia": 1.0, "damping": damping, "stiffness": square, "rest_angle": 0.0}}
        (arguments.out / "truths" / f"{number:05d}.json").write_text(json.dumps(truth, indent=2) + "\n")


if __name__ == "__main__":
    main()
