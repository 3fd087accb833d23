#!/usr/bin/env python3
"""Records of rigs that lack several things at once, by programs that share no code with Ringdown.

    python3 -m venv VENV && VENV/bin/pip install numpy scipy numba mujoco
    VENV/bin/python experiments/rigs/records.py --out reports/rigs/score --bank score --seed 2

Writes OUT/cases/<id>/record-000.csv and so on and OUT/cases/<id>/nominal.toml, with what a user would have, and apart from them
OUT/truths/<id>.json. README.md in this folder says what is drawn and what a truth holds.
"""

import argparse
import json
import math
import os
import time
from pathlib import Path

import numpy

import motion
from laws import CHAIN, CLASSES, FIRST, HARD, OF_CLASS, OFTEN, SECOND_LIST, Effect, Unlisted
from motion import COULOMB, DAMPING, GAIN, LENGTH, REST, SQUARE
from sizes import Tangent, rms

SCHEMA = "ringdown.rig/1"
ATTEMPTS = 40
# In 21 cases.
KINDS = ["composite"] * 10 + ["single"] * 4 + ["pair"] * 2 + ["unlisted"] * 2 + ["none", "none", "none-unlisted"]


class Bank:
    """What is drawn from where: two that are unlike in their ranges and in their unlisted laws, and short records beside the first."""

    def __init__(self, name):
        first = name != "score"
        self.unlisted = FIRST if first else SECOND_LIST
        self.rates = (30.0, 2500.0) if first else (15.0, 5000.0)
        self.swings = (8.0, 800.0) if first else (5.0, 2000.0)
        self.ratios = (0.001, 0.1) if first else (0.0005, 0.2)
        self.samples = (1500, 14000) if first else (1000, 20000)
        self.off = 0.2 if first else 0.3
        self.colors = ["white", "white", "ar"] if first else ["white", "pink", "ar", "mains"]
        self.displacement = 0.25 if first else 0.4
        self.wide = 0.15 if first else 0.2
        self.driven = 0.15 if first else 0.25
        self.least = 400
        if name == "short":
            self.rates, self.swings, self.samples, self.least = (15.0, 500.0), (4.0, 40.0), (150, 900), 150


def log_uniform(draws, low, high):
    return math.exp(draws.uniform(math.log(low), math.log(high)))


class Rig:
    """A nominal oscillator, how it is moved and how it is measured."""

    def __init__(self, bank, draws, driven_only=False):
        self.ratio = log_uniform(draws, *bank.ratios)
        self.driven = draws.random() < bank.driven or driven_only
        self.records = 1 if draws.random() < 0.6 else int(draws.integers(2, 5))
        total = log_uniform(draws, *bank.samples)
        count = max(int(total / self.records), bank.least)
        self.swings = log_uniform(draws, *bank.swings)
        if not self.driven:
            # A free decay is recorded while there is something to see.
            self.swings = min(self.swings, max(5.0, draws.uniform(3, 7) / (2 * math.pi * self.ratio)))
        per_swing = min(max(count / self.swings, 8.0), 400.0)
        self.swings = min(self.swings, count / per_swing)
        self.swings = max(self.swings, 5.0)
        self.count = int(min(self.swings * per_swing, 20000 / max(1, self.records - 1)))
        self.rate = log_uniform(draws, *bank.rates)
        self.step = 1 / self.rate
        self.frequency = self.rate / per_swing
        self.omega = 2 * math.pi * self.frequency
        self.square = self.omega**2
        self.damping = 2 * self.ratio * self.omega
        self.duration = self.count * self.step
        self.inertia = 1.0 if draws.random() < 0.5 else log_uniform(draws, 1e-5, 10.0)
        self.displacement = draws.random() < bank.displacement
        if self.displacement:
            self.amplitude = log_uniform(draws, 2e-4, 0.2)
            self.rest = draws.uniform(-0.3, 0.3) * self.amplitude
        else:
            wide = draws.random() < bank.wide
            self.amplitude = math.radians(draws.uniform(70, 168) if wide else log_uniform(draws, 2, 60))
            self.rest = draws.uniform(-0.05, 0.05) * min(1.0, self.amplitude)
        self.hanging = not self.displacement and draws.random() < 0.5
        self.side = 1.0 if draws.random() < 0.5 else -1.0
        # Where the far side of the first swing ends.
        self.reach = 1.0 if self.driven else math.exp(-math.pi * self.ratio)
        self.sub = max(1, math.ceil(28 / per_swing))
        self.starts, self.inputs = [], []
        for record in range(self.records):
            size = self.amplitude * (1.0 if record == 0 else draws.uniform(0.2, 1.0))
            self.starts.append(self.start(draws, size))
            self.inputs.append(self.input(draws, size) if self.driven else None)
        self.input_peak = max((float(numpy.max(numpy.abs(u))) for u in self.inputs if u is not None), default=0.0)

    def start(self, draws, size):
        if self.driven:
            return [self.rest, 0.0]
        if draws.random() < 0.75:
            return [self.rest + self.side * size, 0.0]
        turn = draws.uniform(-0.5, 0.5) * math.pi
        return [self.rest + self.side * size * math.cos(turn), size * self.omega * math.sin(turn)]

    def input(self, draws, size):
        """A torque per unit of inertia that swings it about as far as wanted."""
        t = numpy.arange(self.count) * self.step
        match draws.integers(0, 3):
            case 0:
                low, high = self.frequency * draws.uniform(0.2, 0.6), self.frequency * draws.uniform(1.3, 3)
                high = min(high, 0.4 * self.rate)
                u = numpy.sin(2 * math.pi * (low * t + 0.5 * (high - low) * t**2 / t[-1]))
            case 1:
                held = max(2, int(draws.uniform(0.6, 4) * self.rate / self.frequency))
                levels = draws.uniform(-1, 1, self.count // held + 2)
                u = numpy.repeat(levels, held)[: self.count]
            case _:
                held = max(1, int(draws.uniform(0.1, 0.4) * self.rate / self.frequency))
                levels = draws.normal(size=self.count // held + 2)
                u = numpy.repeat(levels, held)[: self.count]
        P = self.parameters()
        run = Motion(self, P, [[self.rest, 0.0]], [u], [])
        moved = float(numpy.max(numpy.abs(run.positions[0] - self.rest))) if run.ok else 1.0
        return u * size / moved

    def parameters(self):
        P = numpy.zeros(LENGTH)
        P[SQUARE], P[DAMPING], P[REST], P[GAIN] = self.square, self.damping, self.rest, 1.0
        return P


class Motion:
    """Motion of every record on a grid `sub` times as fine as the samples."""

    def __init__(self, rig, P, starts, inputs, laws, tolerance=1e-7, delay=0.0):
        self.step = rig.step / rig.sub
        times = numpy.arange((rig.count - 1) * rig.sub + 1) * self.step
        speed = rig.amplitude * rig.omega
        scale = numpy.array([rig.amplitude, speed, 1.0, rig.amplitude, speed, rig.amplitude, rig.amplitude])
        for law in laws:
            if isinstance(law, Unlisted) and law.id in ("lugre", "bouc_wen"):
                scale[5 + law.place] = 1.0
        self.times, self.states, self.modes, self.drives, self.ok = times, [], [], [], True
        for start, u in zip(starts, inputs):
            state = numpy.zeros(motion.STATES)
            state[:2] = start
            state[3:5] = start
            for law in laws:
                if isinstance(law, Unlisted):
                    state[5 + law.place] = law.hidden(start[0] - rig.rest)
            if u is None:
                knots, values = numpy.array([-1.0]), numpy.zeros(1)
            else:
                # Before a delayed command arrives there is none.
                knots = numpy.concatenate([[-1.0], numpy.arange(len(u)) * rig.step + delay])
                values = numpy.concatenate([[0.0], u])
            ok, states, modes = motion.integrate(P, state, times, knots, values, tolerance, scale, 0.5 / rig.omega, 4_000_000)
            at = numpy.searchsorted(knots, times + 1e-9 * rig.step, side="right") - 1
            self.ok &= bool(ok)
            self.states.append(states)
            self.modes.append(modes)
            self.drives.append(values[at])
            if not self.ok:
                return
        self.positions = [states[:, 0] for states in self.states]
        self.velocities = [states[:, 1] for states in self.states]

    def torques(self, P, Q):
        """What acts by P and not by Q along the motion, and dry friction's part in it."""
        parts = []
        for states, modes, drive in zip(self.states, self.modes, self.drives):
            with_it, dry = motion.accelerations(P, states, modes, self.times, drive)
            without, other = motion.accelerations(Q, states, modes, self.times, drive)
            if P[COULOMB] != Q[COULOMB] or P[motion.SLIDING] != Q[motion.SLIDING]:
                # At rest friction holds whatever pulls; where there are two kinds, each its share.
                share = 1.0 - motion.dry(Q, 0.0) / motion.dry(P, 0.0)
                parts.append(numpy.where(modes == 0, share * dry, dry - other))
            else:
                parts.append(with_it - without)
        return parts


class Case:
    """A rig with its effects, each with a target in noise floors, solved for their strengths."""

    def __init__(self, bank, draws, kind):
        self.bank, self.draws, self.kind = bank, draws, kind
        wants_input = kind == "single" and draws.random() < 0.08
        self.rig = rig = Rig(bank, draws, wants_input)
        self.laws, self.targets, self.strengths = [], [], []
        self.pick()
        motions = self.move()
        if not motions.ok:
            raise ValueError("the nominal motion cannot be integrated")
        moved = rms(numpy.concatenate(motions.positions) - rig.rest)
        if kind == "hard":
            # The leading effect is as large as a machine's; the noise follows from its size.
            self.floor = 1.0
            self.strengths = [self.laws[0].harden(draws)] + [1e-4] * (len(self.laws) - 1)
            run = self.move()
            if not run.ok or not self.sensible(run):
                raise ValueError("the leading effect leaves no motion")
            self.floor = self.sizes(run)[0] / self.targets[0]
            if not 3e-4 * moved < self.floor < 0.03 * moved:
                raise ValueError("the noise would be out of range")
        elif self.targets:
            share = log_uniform(draws, 0.01, 0.12)
            self.floor = moved * share / max(*self.targets, 12.0)
        else:
            self.floor = moved / log_uniform(draws, 100, 5000)
        self.noise_kinds()

    def pick(self):
        """The effects and their sizes, by the kind of case."""
        draws, rig = self.draws, self.rig
        targets, unlisted = [], []
        match self.kind:
            case "composite":
                targets = [log_uniform(draws, 30, 150)]
                for _ in range(int(draws.integers(1, 6))):
                    targets.append(log_uniform(draws, 1, 4) if draws.random() < 0.3 else log_uniform(draws, 4, 30))
                unlisted = [log_uniform(draws, 0.3, 3) for _ in range(1 if draws.random() < 0.6 else 2)]
            case "single":
                targets = [log_uniform(draws, 6, 100)]
            case "pair":
                targets = [log_uniform(draws, 6, 100) for _ in range(2)]
            case "hard":
                targets = [log_uniform(draws, 30, 150)]
                targets += [log_uniform(draws, 30, 150) if draws.random() < 0.4 else log_uniform(draws, 4, 30)
                            for _ in range(int(draws.integers(0, 4)))]
                unlisted = [log_uniform(draws, 0.7, 2)] if draws.random() < 0.75 else []
            case "rough":
                # As on machines: what no law explains is far above the noise, and the cause is larger still.
                targets = [log_uniform(draws, 60, 300)]
                targets += [log_uniform(draws, 6, 60) for _ in range(int(draws.integers(0, 3)))]
                unlisted = [log_uniform(draws, 4, 30)]
            case "unlisted":
                unlisted = [log_uniform(draws, 6, 100)]
            case "none-unlisted":
                unlisted = [log_uniform(draws, 0.3, 3)]
        allowed = [name for name in OFTEN if self.fits(name)]
        weights = numpy.array([OFTEN[name] for name in allowed])
        for target in targets:
            weights = weights / weights.sum()
            leading = numpy.array([HARD.get(name, 0.0) for name in allowed])
            first = self.kind == "hard" and not self.laws
            at = int(draws.choice(len(allowed), p=leading / leading.sum() if first else weights))
            # A record's stamps and outliers are no leading cause of a composite rig.
            while self.kind in ("composite", "rough") and not self.laws and allowed[at] in ("outliers", "timestamp_jitter"):
                at = int(draws.choice(len(allowed), p=weights))
            self.laws.append(Effect(allowed[at], rig, draws))
            self.targets.append(target)
            weights[at] = 0.0
            for apart in ({"coulomb_friction", "stribeck_friction"}, {"sensor_drift", "constant_torque"}):
                if allowed[at] in apart:
                    weights[[index for index, name in enumerate(allowed) if name in apart]] = 0.0
        names = list(draws.permutation(self.bank.unlisted))
        for place, target in enumerate(unlisted):
            self.laws.append(Unlisted(str(names[place]), rig, place, draws))
            self.targets.append(target)

    def fits(self, name):
        if name in ("gravity", "sensor_nonlinearity"):
            return not self.rig.displacement
        if name in ("input_delay", "input_saturation"):
            return self.rig.driven
        return True

    def noise_kinds(self):
        """How the floor is shared out among noise, rounding and scatter of the stamps."""
        draws, rig = self.draws, self.rig
        self.color = str(draws.choice(self.bank.colors))
        rounded = draws.random() < 0.45
        # A step of up to the floor's √12; the rest is noise.
        share = draws.uniform(0.05, 0.95) if rounded else 0.0
        self.resolution = self.floor * math.sqrt(12 * share) if rounded else None
        self.stated = rounded and draws.random() < 0.5
        self.noise = self.floor * math.sqrt(1 - share)
        self.clock = str(draws.choice(["uniform", "uniform", "jitter", "bursts", "rate"]))
        if any(law.id in ("timestamp_jitter", "clock_drift") for law in self.laws):
            self.clock = "uniform"

    def fill(self):
        P = self.rig.parameters()
        for law, x in zip(self.laws, self.strengths):
            if law.id not in CHAIN and law.id != "input_delay":
                law.apply(P, x)
            if getattr(law, "hanging", False):
                # A pendulum: what the weight pulls, a spring does not.
                P[SQUARE] = max(1e-3 * self.rig.square, self.rig.square - P[motion.WEIGHT] * math.cos(law.angle))
        return P

    def move(self, tolerance=1e-7):
        delay = 0.0
        for law, x in zip(self.laws, self.strengths):
            if law.id == "input_delay":
                delay = law.delay(x)
        self.P = self.fill()
        return Motion(self.rig, self.P, self.rig.starts, self.rig.inputs, self.laws, tolerance, delay)

    def responses(self, run):
        """What each effect changes in the records beyond what recalibration absorbs; None for what is random."""
        rig = self.rig
        everything = [a + b for a, b in (motion.accelerations(self.P, s, m, run.times, d)
                                         for s, m, d in zip(run.states, run.modes, run.drives))]
        tangent = Tangent(run.step, rig.rest, run.positions, run.velocities, everything, run.drives, rig.sub, rig.square, rig.damping)
        self.tangent = tangent
        series = []
        for law, x in zip(self.laws, self.strengths):
            if law.id in ("outliers", "timestamp_jitter"):
                series.append(None)
                continue
            if law.id in CHAIN:
                parts = [law.read(x, run.times[:: rig.sub], p[:: rig.sub], v[:: rig.sub])
                         for p, v in zip(run.positions, run.velocities)]
                raw = numpy.concatenate(parts)
            elif law.id == "input_delay":
                late = []
                for drive, u in zip(run.drives, rig.inputs):
                    prompt = u[numpy.minimum(((run.times + 1e-9) / rig.step).astype(int), len(u) - 1)]
                    late.append(drive - prompt)
                raw = tangent.response(late)
            else:
                raw = tangent.response(run.torques(self.P, law.without(self.P)))
            series.append((raw, law.id != "constant_torque"))
        return series

    def sizes(self, run):
        rig = self.rig
        found = []
        for (law, x), item in zip(zip(self.laws, self.strengths), self.responses(run)):
            if item is None:
                values = law.chain(x)
                if law.id == "outliers":
                    found.append(values[1] * math.sqrt(values[0]) / self.floor)
                else:
                    found.append(values[0] * rms(numpy.concatenate(run.velocities)) / self.floor)
                continue
            found.append(rms(tangent_left(self.tangent, item)) / self.floor)
        return found

    def solve(self):
        """Strengths by repeated proportion; raises where the sizes are out of reach."""
        leading = self.strengths[:1]
        self.strengths = [min(0.3 * law.most, max(1e-4, 0.02 * target * self.floor / self.rig.amplitude * 10))
                          for law, target in zip(self.laws, self.targets)]
        for turn in range(14):
            self.strengths[: len(leading)] = leading
            run = self.move()
            if not run.ok or not self.sensible(run):
                self.strengths = [0.4 * x for x in self.strengths]
                continue
            found = self.sizes(run)
            ratios = [target / max(size, 1e-9) for target, size in zip(self.targets, found)]
            others = ratios[len(leading) :]
            if all(0.87 < ratio < 1.15 for ratio in others):
                return run
            if turn > 8 and all(0.6 < ratio < 1.67 for ratio in others):
                return run
            limit = 6.0 if turn < 5 else 2.0
            self.strengths = [
                min(law.most, x * min(max(ratio ** (1 / law.power), 1 / limit), limit))
                for law, x, ratio in zip(self.laws, self.strengths, ratios)
            ]
        raise ValueError("sizes out of reach")

    def sensible(self, run):
        """Whether there is still a motion about the nominal place to look at."""
        rig = self.rig
        for positions, velocities, modes in zip(run.positions, run.velocities, run.modes):
            if not numpy.all(numpy.isfinite(positions)):
                return False
            if numpy.max(numpy.abs(positions - rig.rest)) > 3 * rig.amplitude:
                return False
            if not rig.displacement and numpy.max(numpy.abs(positions)) > math.radians(178):
                return False
            if numpy.sum(velocities[1:] * velocities[:-1] < 0) + numpy.sum((modes[1:] != modes[:-1])) < 8:
                return False
            if numpy.mean(modes == 0) > 0.5 and not rig.driven:
                return False
        return True

    def resembles(self, run):
        """For a law outside the vocabulary alone: floors that the best member of each class leaves of it."""
        rig, P = self.rig, self.rig.parameters()
        (series,) = [item[0] for item in self.responses(run)]
        left = {}
        probe = numpy.random.default_rng(0)
        for names in (["coulomb_friction", "stribeck_friction", "hysteresis"], ["cubic_stiffness", "asymmetric_stiffness"],
                      ["quadratic_drag", "damping_drift"], ["backlash"], ["stiffness_drift"]):
            columns = []
            for name in names:
                effect = Effect(name, rig, probe)
                for share in (0.1, 0.3) if name in ("stribeck_friction", "backlash") else (0.1,):
                    effect.share = share
                    Q = P.copy()
                    effect.apply(Q, share if name == "backlash" else 0.01)
                    columns.append(self.tangent.response(run.torques(Q, effect.without(Q))))
            if names[0] == "cubic_stiffness" and not rig.displacement:
                for angle in (0.0, math.pi / 2):
                    columns.append(self.tangent.response([-numpy.sin(p + angle) for p in run.positions]))
            left[CLASSES[names[0]]] = self.tangent.least(series, columns) / self.floor
        return left


def tangent_left(tangent, item):
    series, rest_is_absorbed = item
    return tangent.left(series, rest_is_absorbed)


def colored(draws, count, color, rate):
    """Unit noise of a color."""
    white = draws.standard_normal(count)
    if color == "white":
        return white
    if color == "ar":
        from scipy.signal import lfilter
        past = draws.uniform(0.2, 0.85)
        return lfilter([math.sqrt(1 - past**2)], [1, -past], white)
    if color == "mains":
        hum = math.sqrt(2) * numpy.sin(2 * math.pi * (50.0 % (0.5 * rate)) * numpy.arange(count) / rate + draws.uniform(0, 6.28))
        return math.sqrt(0.8) * white + math.sqrt(0.2) * hum
    spectrum = numpy.fft.rfft(white)
    lines = numpy.arange(len(spectrum))
    pink = numpy.fft.irfft(spectrum / numpy.sqrt(numpy.maximum(lines, 1)), count)
    return math.sqrt(0.7) * white + math.sqrt(0.3) * pink / rms(pink)


def stamps_of(case, record, draws, count, velocity):
    """What the logger writes as times, and ids of what it did."""
    rig = case.rig
    times = numpy.arange(count) * rig.step
    if case.clock == "jitter":
        # On a hard rig by up to a third of the interval.
        deviation = 0.33 * rig.step if case.kind == "hard" else min(0.5 * case.floor / max(rms(velocity), 1e-300), 0.3 * rig.step)
        return numpy.sort(times + deviation * draws.standard_normal(count)), ["timestamp_jitter"]
    if case.clock == "bursts":
        interval = max(3 * rig.step, 0.03 * draws.uniform(0.3, 2))
        interval = min(interval, 0.25 * 2 * math.pi / rig.omega)
        if interval > 1.5 * rig.step:
            ends = numpy.cumsum(interval * (1 + 0.05 * draws.standard_normal(int(times[-1] / interval) + 9)))
            return ends[numpy.minimum(numpy.searchsorted(ends, times), len(ends) - 1)], ["timestamp_batching"]
    if case.clock == "rate":
        return times * (1 + 10 ** draws.uniform(-4.5, -2.5)), ["clock_drift"]
    return times, []


def write(out, name, case, run, seed, number, engine):
    """The files of a case."""
    rig, draws = case.rig, case.draws
    folder = out / "cases" / name
    folder.mkdir(parents=True, exist_ok=True)
    nuisances = ["sensor_quantization"] if case.resolution else []
    # Hum in the readings is a line that does not decay: calling it a forcing is not wrong.
    if case.color == "mains" and not any(law.id == "periodic_forcing" for law in case.laws):
        nuisances.append("periodic_forcing")
    sensed = [(law, x) for law, x in zip(case.laws, case.strengths) if law.id in CHAIN]
    unit = "displacement_m" if rig.displacement else "angle_rad"
    decimals = max(6, int(math.ceil(-math.log10(0.02 * case.floor))))
    # The rounding of stamps moves the body by less than the noise.
    fine = min(0.01 * rig.step, 0.05 * case.floor / (rig.amplitude * rig.omega))
    stamp_decimals = max(6, int(math.ceil(-math.log10(fine))))
    for record in range(rig.records):
        times = run.times[:: rig.sub]
        positions, velocities = run.positions[record][:: rig.sub], run.velocities[record][:: rig.sub]
        if engine is not None:
            positions = engine[record]
        seen = positions.copy()
        for law, x in sensed:
            if law.id in ("sensor_nonlinearity", "sensor_drift", "sensor_saturation"):
                seen = seen + law.read(x, times, seen, velocities)
        seen = seen + case.noise * colored(draws, len(seen), case.color, rig.rate)
        stamps, marks = stamps_of(case, record, draws, len(seen), velocities)
        nuisances += [mark for mark in marks if mark not in nuisances]
        for law, x in sensed:
            values = law.chain(x)
            if law.id == "outliers":
                wrong = draws.random(len(seen)) < values[0]
                seen = seen + numpy.where(wrong, values[1] * draws.standard_normal(len(seen)), 0.0)
            elif law.id == "timestamp_jitter":
                stamps = numpy.sort(stamps + values[0] * draws.standard_normal(len(seen)))
            elif law.id == "clock_drift":
                stamps = stamps + 0.5 * values[1] * times**2
            elif law.id == "sensor_saturation":
                seen = numpy.clip(seen - rig.rest, -values[0], values[0]) + rig.rest
        if case.resolution:
            seen = numpy.round(seen / case.resolution) * case.resolution
        header = f"time_s,{unit}"
        columns = [[f"{value:.{stamp_decimals}f}" for value in stamps], [f"{value:.{decimals}f}" for value in seen]]
        if rig.driven:
            header += ",force_n" if rig.displacement else ",torque_nm"
            columns.append([f"{value:.9g}" for value in rig.inputs[record] * rig.inertia])
        rows = "\n".join(map(",".join, zip(*columns)))
        (folder / f"record-{record:03d}.csv").write_text(f"# origin: simulated\n{header}\n{rows}\n")
    return nuisances, nominal_of(case, folder)


def nominal_of(case, folder):
    """What a user would believe; returns the relative offsets."""
    rig, draws = case.rig, case.draws
    exact = draws.random() < (0.5 if case.kind == "none" else 0.25)
    reach = 0.0 if exact else case.bank.off
    stiffness, damping = draws.uniform(-reach, reach, 2)
    rest = 0.0 if exact or any(law.id == "constant_torque" for law in case.laws) else draws.uniform(-0.1, 0.1) * rig.amplitude
    lines = {"inertia": rig.inertia, "damping": rig.damping * rig.inertia * (1 + damping),
             "stiffness": rig.square * rig.inertia * (1 + stiffness), "rest_angle": rig.rest + rest}
    if case.stated:
        lines["sensor_resolution"] = case.resolution
    text = "".join(f"{key} = {float(value)!r}\n" for key, value in lines.items())
    if rig.displacement:
        text = 'coordinate = "displacement"\n' + text
    (folder / "nominal.toml").write_text(text)
    return {"stiffness": float(stiffness), "damping": float(damping), "rest": float(rest)}


def by_engine(case, run):
    """Positions by MuJoCo and their difference in words; None where it cannot, or is coarse beside the noise.

    Soft friction creeps; where there is none, both ways to integrate must agree.
    """
    import engine

    for phase in engine.PHASES:
        positions = engine.motions(case, phase)
        if positions is None:
            return None
        difference = rms(numpy.concatenate(positions) - numpy.concatenate([p[:: case.rig.sub] for p in run.positions])) / case.floor
        if case.P[COULOMB] != 0.0 or difference < 0.3:
            return positions, f"MuJoCo {engine.VERSION}, {difference:.3f} floors from the event integrator"
    return None


def make(out, bank, seed, number, use_engine, kind=None):
    """One case: drawn until its sizes are within reach."""
    kind = kind or KINDS[(8 * number) % len(KINDS)]
    began = time.time()
    for attempt in range(ATTEMPTS):
        draws = numpy.random.default_rng([seed, number, attempt])
        try:
            case = Case(bank, draws, kind)
            run = case.solve() if case.laws else case.move()
        except (ValueError, numpy.linalg.LinAlgError):
            continue
        break
    else:
        raise SystemExit(f"case {number}: nothing of kind {kind} is within reach")
    run = case.move(1e-10)
    if not run.ok:
        raise SystemExit(f"case {number}: the motion cannot be integrated finely")
    found = case.sizes(run) if case.laws else []
    engine, integrator = None, "Dormand-Prince with events"
    if use_engine and (number + number // len(KINDS)) % 3 == 0:
        engine, integrator = by_engine(case, run) or (engine, integrator)
    name = f"{number:05d}"
    nuisances, offsets = write(out, name, case, run, seed, number, engine)
    rig = case.rig
    effects = [
        {"id": law.id, "class": CLASSES[law.id], "parameters": [float(v) for v in law.parameters(case.P, x)], "floors": round(size, 3)}
        for law, x, size in zip(case.laws, case.strengths, found) if isinstance(law, Effect)
    ]
    truth = {
        "schema": SCHEMA,
        "kind": kind,
        "effects": sorted(effects, key=lambda effect: -effect["floors"]),
        "unlisted": [
            {"law": law.id, "floors": round(size, 3), "class": OF_CLASS.get(law.id), "shape": [float(v) for v in law.shape]}
            for law, size in zip(case.laws, found) if isinstance(law, Unlisted)
        ],
        "nuisances": nuisances,
        "nominal_off": offsets,
        "chain": {"floor": case.floor, "noise": case.noise, "color": case.color, "resolution": case.resolution,
                  "resolution_stated": bool(case.stated), "clock": case.clock},
        "rig": {"rate_hz": rig.rate, "swings": rig.swings, "records": rig.records, "samples": rig.count, "damping_ratio": rig.ratio,
                "amplitude": rig.amplitude, "coordinate": "displacement" if rig.displacement else "angle", "driven": bool(rig.driven),
                "hanging": any(getattr(law, "hanging", False) for law in case.laws)},
        "integrator": integrator,
        "system": {"inertia": rig.inertia, "damping": rig.damping * rig.inertia, "stiffness": float(case.P[SQUARE]) * rig.inertia,
                   "rest_angle": rig.rest},
        "made": f"experiments/rigs/records.py, seed {seed}, case {number}",
    }
    if kind == "unlisted":
        truth["resembles"] = {key: round(value, 3) for key, value in case.resembles(run).items()}
    (out / "truths").mkdir(exist_ok=True)
    (out / "truths" / f"{name}.json").write_text(json.dumps(truth, indent=2) + "\n")
    what = ", ".join(f"{e['id']} {e['floors']:.1f}" for e in truth["effects"] + [{"id": u["law"] + "*", "floors": u["floors"]} for u in truth["unlisted"]])
    return f"{name} {kind}: {what or '-'} ({attempt + 1} tries, {time.time() - began:.1f} s, {integrator[:6]})"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder to write to")
    parser.add_argument("--bank", choices=["train", "score", "short"], default="score", help="ranges and unlisted laws to draw from")
    parser.add_argument("--cases", type=int, default=240)
    parser.add_argument("--first", type=int, default=0, help="number of the first case, to make them in parts")
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--kind", choices=sorted({*KINDS, "rough", "hard"}),
                        help="rigs of one kind only; `rough`: a cause far above the noise, and an unlisted law that is as well; `hard`: large play, "
                        "stops and other forms of hysteresis, two large effects at once")
    parser.add_argument("--no-engine", action="store_true", help="leave MuJoCo out")
    arguments = parser.parse_args()
    for number in range(arguments.first, arguments.first + arguments.cases):
        print(make(arguments.out, Bank(arguments.bank), arguments.seed, number, not arguments.no_engine, arguments.kind), flush=True)


if __name__ == "__main__":
    main()
