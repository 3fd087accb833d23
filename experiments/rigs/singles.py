#!/usr/bin/env python3
"""Records that lack one plain thing each, as a newcomer tries first: coarse rounding, stale readings, scattered stamps, lag, delay.

    VENV/bin/python experiments/rigs/singles.py --out SINGLES --seed 1 --cases 96
    python3 experiments/rigs/singles.py --score ANSWERS --out SINGLES

A linear oscillator, released or driven by a held command, is integrated by Runge-Kutta steps of a tenth of a sampling interval; no
Ringdown code is used. The kinds take turns, and with them a weak, a medium and a strong size (3, 10 and 30 x the noise, a factor of
1.6 either way). Writes OUT/cases/<id>/ as records.py does, and OUT/truths/<id>.json. `--score` prints, by kind, in how many answers
the first name is the right one, and what was said instead.
"""

import argparse
import collections
import json
import math
from pathlib import Path

import numpy

SUB = 10
KINDS = ["sensor_quantization", "dropouts", "timestamp_jitter", "sensor_lag", "input_delay", "constant_torque", "gravity", "hysteresis"]
CLASSES = {"sensor_quantization": "sensor", "sensor_lag": "sensor", "dropouts": "stamps", "timestamp_jitter": "stamps",
           "input_delay": "actuator", "constant_torque": "preload", "gravity": "restoring", "hysteresis": "friction"}
SIZES = {"weak": 3.0, "medium": 10.0, "strong": 30.0}


class Joint:
    """An oscillator per unit of inertia with at most one further law, and how it is moved."""

    def __init__(self, draws, kind):
        self.driven = kind in ("sensor_lag", "input_delay") or draws.random() < 0.1
        self.omega = 2 * math.pi * math.exp(draws.uniform(math.log(0.4), math.log(8.0)))
        self.ratio = math.exp(draws.uniform(math.log(0.004), math.log(0.2 if self.driven else 0.03)))
        per_swing = math.exp(draws.uniform(math.log(15), math.log(150)))
        self.step = 2 * math.pi / self.omega / per_swing
        swings = draws.uniform(15, 40) if self.driven else min(40.0, draws.uniform(3, 5) / (2 * math.pi * self.ratio))
        self.times = numpy.arange(int(min(max(swings * per_swing, 400), 5000))) * self.step
        self.amplitude = math.radians(math.exp(draws.uniform(math.log(5), math.log(60))))
        self.rest = draws.uniform(-0.1, 0.1) * self.amplitude
        self.drive = self.command(draws) if self.driven else None
        self.torque, self.width, self.weight, self.lean, self.delay, self.lag = 0.0, 1.0, 0.0, 0.0, 0.0, 1e-9

    def command(self, draws):
        held = max(2, int(draws.uniform(0.2, 1.2) * 2 * math.pi / self.omega / self.step))
        levels = draws.uniform(-1, 1, len(self.times) // held + 1)
        # A log begins before its command does.
        levels[0] = 0.0
        u = numpy.repeat(levels, held)[: len(self.times)]
        return u * self.omega**2 * self.amplitude * min(1.0, 2 * self.ratio + 0.4)

    def move(self):
        """Angles, velocities and lagging readings at the samples."""
        h = self.step / SUB
        square, damping = self.omega**2, 2 * self.ratio * self.omega

        def rate(q, v, z, u):
            torque = self.torque * z + self.weight * (math.sin(q + self.lean) - math.sin(self.lean))
            slope = v / self.width * (1 - z * (1 if v > 0 else -1)) if self.torque else 0.0
            return v, u - square * (q - self.rest) - damping * v - torque, slope

        state = numpy.array([self.rest + (0.0 if self.driven else self.amplitude), 0.0, 0.0])
        out = numpy.empty((len(self.times), 3))
        level, decay = state[0], math.exp(-h / self.lag)
        for n in range(len(self.times)):
            out[n] = state[0], state[1], level
            for sub in range(SUB):
                t = self.times[n] + (sub + 0.5) * h - self.delay
                u = self.drive[min(int(t / self.step), len(self.drive) - 1)] if self.driven and t >= 0 else 0.0
                k = numpy.array(rate(*state, u))
                k2 = numpy.array(rate(*(state + 0.5 * h * k), u))
                k3 = numpy.array(rate(*(state + 0.5 * h * k2), u))
                k4 = numpy.array(rate(*(state + h * k3), u))
                before, state = state[0], state + h / 6 * (k + 2 * k2 + 2 * k3 + k4)
                # Exact for angles that are straight over a tenth of an interval.
                behind = self.lag * (state[0] - before) / h
                level = state[0] - behind + (level - before + behind) * decay
        return out.T


def rms(values):
    return float(numpy.sqrt(numpy.mean(numpy.square(values))))


def left(values, reference, velocity, rest):
    """The part of a change of the readings that a free fit of angle, velocity and rest leaves."""
    columns = numpy.stack([reference - rest, velocity, numpy.ones_like(velocity)], axis=1)
    return rms(values - columns @ numpy.linalg.lstsq(columns, values, rcond=None)[0])


def make(draws, kind, size):
    """Stamps, readings, the joint, the noise and the parameters of the effect."""
    joint = Joint(draws, kind)
    plain, speed, _ = joint.move()
    step, count = joint.step, len(plain)
    stamps, seen, parameters = joint.times.copy(), plain.copy(), []
    noise = rms(plain - joint.rest) / math.exp(draws.uniform(math.log(100), math.log(1500)))
    match kind:
        case "sensor_quantization":
            width = (plain.max() - plain.min()) / draws.uniform(6, 12)
            noise = width / math.sqrt(12) / size
            parameters = [width]
        case "dropouts":
            share = draws.uniform(0.02, 0.25)
            lost = draws.random(count) < share
            lost[0] = False
            if draws.random() < 0.4:
                stamps, seen, speed = stamps[~lost], seen[~lost], speed[~lost]
            else:
                kept = numpy.maximum.accumulate(numpy.where(lost, 0, numpy.arange(count)))
                noise = max(rms(seen[kept] - seen) / size, 1e-4 * rms(plain))
                seen = seen + noise * draws.standard_normal(count)
                return joint, stamps, seen[kept], noise, [share]
        case "timestamp_jitter":
            deviation = draws.uniform(0.05, 0.4) * step
            noise = deviation * rms(speed) / size
            stamps = numpy.sort(stamps + deviation * draws.standard_normal(count))
            parameters = [deviation]
        case "sensor_lag":
            constant = math.exp(draws.uniform(math.log(0.03), math.log(0.4))) / joint.omega
            joint.lag = constant
            seen = joint.move()[2]
            noise = left(seen, plain, speed, joint.rest) / size
            parameters = [constant]
        case "input_delay":
            joint.delay = math.exp(draws.uniform(math.log(0.03), math.log(0.4))) / joint.omega
            seen, _, _ = joint.move()
            noise = left(seen, plain, speed, joint.rest) / size
            parameters = [joint.delay]
        case "constant_torque":
            torque = draws.choice([-1, 1]) * draws.uniform(0.02, 0.3) * joint.omega**2 * joint.amplitude
            seen = plain + torque / joint.omega**2
            noise = abs(torque) / joint.omega**2 / size / 3
            parameters = [torque]
        case "gravity":
            joint.weight, joint.lean = draws.uniform(0.2, 1.0) * joint.omega**2, draws.uniform(-0.8, 0.8)
            seen, speed, _ = joint.move()
            parameters = [joint.weight, joint.lean]
            noise = None
        case "hysteresis":
            joint.torque = draws.uniform(0.01, 0.1) * joint.omega**2 * joint.amplitude
            joint.width = draws.uniform(0.05, 0.4) * joint.amplitude
            seen, speed, _ = joint.move()
            parameters = [joint.torque, joint.width]
            noise = None
    if noise is None:
        noise = law_left(joint, seen, speed) / size
    return joint, stamps, seen + noise * draws.standard_normal(len(seen)), noise, parameters


def law_left(joint, seen, speed):
    """What the linear oscillator nearest to a motion leaves of it, over windows of three swings."""
    from scipy.optimize import least_squares
    t = joint.times
    if joint.driven:
        return 0.03 * rms(seen - joint.rest)

    def wave(x):
        omega, decay = joint.omega * x[0], joint.ratio * joint.omega * x[1]
        basis = numpy.stack([numpy.cos(omega * t), numpy.sin(omega * t)], axis=1) * numpy.exp(-decay * t)[:, None]
        basis = numpy.column_stack([basis, numpy.ones_like(t)])
        return seen - basis @ numpy.linalg.lstsq(basis, seen, rcond=None)[0]

    start = numpy.fft.rfftfreq(8 * len(t), joint.step)[numpy.argmax(numpy.abs(numpy.fft.rfft(seen - seen.mean(), 8 * len(t))))] * 2 * math.pi / joint.omega
    return rms(least_squares(wave, [start, 2.0]).fun)


def write(out, name, seed, number):
    draws = numpy.random.default_rng([seed, number])
    kind, strength = KINDS[number % len(KINDS)], list(SIZES)[number // len(KINDS) % 3]
    size = SIZES[strength] * 1.6 ** draws.uniform(-1, 1)
    joint, stamps, seen, noise, parameters = make(draws, kind, size)
    inertia = 1.0 if draws.random() < 0.5 else 10 ** draws.uniform(-4, 0)
    folder = out / "cases" / name
    folder.mkdir(parents=True, exist_ok=True)
    if kind == "sensor_quantization":
        seen = numpy.round(seen / parameters[0]) * parameters[0]
    digits = max(6, int(math.ceil(-math.log10(0.02 * noise))))
    decimals = max(6, int(math.ceil(-math.log10(0.001 * joint.step))))
    columns = [[f"{t:.{decimals}f}" for t in stamps], [f"{q:.{digits}f}" for q in seen]]
    if joint.driven:
        # A sample that is lost takes its command along, and the last one stays.
        at = numpy.clip(numpy.round(stamps / joint.step).astype(int), 0, len(joint.drive) - 1) if kind == "dropouts" else numpy.arange(len(seen))
        columns.append([f"{u * inertia:.9g}" for u in joint.drive[at]])
    rows = "\n".join(map(",".join, zip(*columns)))
    (folder / "record-000.csv").write_text(f"# origin: simulated\ntime_s,angle_rad{',torque_nm' if joint.driven else ''}\n{rows}\n")
    off = draws.uniform(-0.2, 0.2, 2) if draws.random() < 0.75 else numpy.zeros(2)
    square, damping = joint.omega**2 * inertia, 2 * joint.ratio * joint.omega * inertia
    (folder / "nominal.toml").write_text(f"inertia = {inertia!r}\ndamping = {float(damping * (1 + off[0]))!r}\n"
                                         f"stiffness = {float(square * (1 + off[1]))!r}\nrest_angle = {joint.rest!r}\n")
    if kind in ("constant_torque", "hysteresis", "gravity"):
        parameters = [parameters[0] * inertia] + parameters[1:]
    truth = {"schema": "ringdown.rig/1", "kind": "single", "unlisted": [], "nuisances": [], "strength": strength,
             "effects": [{"id": kind, "class": CLASSES[kind], "parameters": [float(p) for p in parameters], "floors": size}],
             "chain": {"floor": noise}, "rig": {"driven": joint.driven, "damping_ratio": joint.ratio, "samples": len(seen), "step_s": joint.step},
             "system": {"inertia": inertia, "damping": damping, "stiffness": square, "rest_angle": joint.rest}}
    (out / "truths").mkdir(parents=True, exist_ok=True)
    (out / "truths" / f"{name}.json").write_text(json.dumps(truth, indent=2) + "\n")


def score(out, answers, listed):
    right = collections.defaultdict(list)
    for file in sorted((out / "truths").glob("*.json")):
        truth = json.loads(file.read_text())
        want = truth["effects"][0]["id"]
        answer = answers / file.stem / "diagnosis.json"
        if not answer.exists():
            right[want].append((0, "no answer"))
            continue
        verdict = json.loads(answer.read_text())["verdict"]
        said = verdict["effects"] or [verdict["status"]]
        right[want].append((said[0] == want, f"{truth['strength'][0]} {said[0]}"))
        if listed:
            driven = "driven" if truth["rig"]["driven"] else "free"
            print(file.stem, driven, truth["strength"], want, [f"{p:.3g}" for p in truth["effects"][0]["parameters"]], "->", " ".join(said))
    for kind in KINDS:
        wrong = collections.Counter(said for hit, said in right[kind] if not hit)
        print(f"{kind:20} {sum(hit for hit, _ in right[kind])} of {len(right[kind])}   " + ", ".join(f"{n} x {said}" for said, n in wrong.items()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=96)
    parser.add_argument("--score", type=Path, metavar="ANSWERS")
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    if arguments.score:
        score(arguments.out, arguments.score, arguments.list)
        return
    for number in range(arguments.cases):
        write(arguments.out, f"{number:05d}", arguments.seed, number)


if __name__ == "__main__":
    main()
