#!/usr/bin/env python3
"""Records of hinged bodies from MuJoCo, each with one effect hidden, for the bank `engine` of the trials.

    python3 -m venv VENV && VENV/bin/pip install mujoco numpy
    VENV/bin/python experiments/physics-engine/records.py --out reports/physics-engine --cases 200

Writes OUT/<id>/record-000.csv and OUT/<id>/nominal.toml, and apart from them OUT/hidden/<id>.json. Nothing of Ringdown's own
code is used: MuJoCo integrates (Runge-Kutta of fourth order, eight steps a sample), with its own soft dry friction, soft
stops, dead bands and second bodies. Systems, sensors and stamps are drawn from the same ranges as in configs/trials.toml.

An effect is as large as makes it as detectable as wanted: the noise-free record is fitted by the damped oscillation in
closed form (damping, stiffness, rest angle, start), and the norm of what is left, over the standard deviation of all that is
white in the record, is the detectability.
"""

import argparse
import json
import math
from pathlib import Path

import mujoco
import numpy
from mujoco import rollout

SECONDS, RATE, SUBSTEPS = 25.0, 260.0, 8
DETECTABILITIES = [3.0, 6.0, 12.0, 25.0, 50.0, 100.0]
EFFECTS = [
    "coulomb_friction", "quadratic_drag", "cubic_stiffness", "asymmetric_stiffness", "gravity",
    "constant_torque", "backlash", "end_stop", "flexible_coupling",
]
ATTEMPTS = 30


class System:
    """A hinged body on a spring, per unit of inertia or small."""

    def __init__(self, draws):
        self.omega = 2 * math.pi * math.exp(draws.uniform(math.log(1), math.log(8)))
        self.ratio = math.exp(draws.uniform(math.log(0.002), math.log(0.03)))
        # MuJoCo refuses inertias below 1e-15 only; small ones are as good as large ones.
        self.inertia = 1.0 if draws.random() < 0.5 else math.exp(draws.uniform(math.log(2e-4), math.log(1e-3)))
        self.stiffness = self.inertia * self.omega**2
        self.damping = 2 * self.ratio * self.omega * self.inertia
        self.rest = draws.uniform(-0.05, 0.05)
        self.swing = math.radians(draws.uniform(20, 60))
        self.side = 1 if draws.random() < 0.5 else -1
        self.start = self.rest + self.side * self.swing
        self.noise = math.exp(draws.uniform(math.log(2e-4), math.log(1e-3)))


class Shape:
    """An effect whose size is open: what it changes in the model, and its parameters by the vocabulary's law."""

    def __init__(self, effect, system, draws):
        self.effect, self.system = effect, system
        self.sign = 1 if draws.random() < 0.5 else -1
        self.angle = draws.uniform(0, math.pi / 2)
        stiff = math.exp(draws.uniform(math.log(100), math.log(1000))) * system.omega**2
        self.contact = min(stiff, 0.05 * (RATE * SUBSTEPS) ** 2)
        self.second = draws.uniform(1.8, 5.0) * system.omega
        self.second_ratio = math.exp(draws.uniform(math.log(0.002), math.log(0.03)))
        self.guess = {"end_stop": 1e-2, "gravity": 1e-2, "flexible_coupling": 1e-2}.get(effect, 1e-3)
        self.most = {"end_stop": 0.5, "gravity": 0.8, "flexible_coupling": 1.0, "quadratic_drag": 1.0}.get(effect, 0.3)

    def model(self, size):
        """The model as MuJoCo's XML, and the effect's parameters."""
        s = self.system
        stiffness, damping, spring, extra, tendon, child = f"{s.stiffness!r}", f"{s.damping!r}", s.rest, "", "", ""
        gravity, center, own = "0 0 0", "0 0 0", s.inertia
        torque = s.stiffness * s.swing
        match self.effect:
            case "coulomb_friction":
                extra, law, values = f'frictionloss="{size * torque!r}"', "joint frictionloss", [size * torque]
            case "quadratic_drag":
                damping += f" {size * s.inertia!r}"
                law, values = "polynomial joint damping", [size * s.inertia]
            case "cubic_stiffness":
                values = [self.sign * size * s.stiffness / s.swing**2]
                stiffness += f" 0 {values[0]!r}"
                law = "polynomial joint stiffness"
            case "asymmetric_stiffness":
                values = [self.sign * size * s.stiffness / s.swing]
                stiffness += f" {values[0]!r}"
                law = "polynomial joint stiffness"
            case "gravity":
                # A mass of which the lever is a hundredth of the radius of gyration: what it adds to the inertia is taken off.
                lever = 0.01 * math.sqrt(s.inertia)
                pull = size * s.stiffness / lever
                gravity = f"0 {-pull!r} 0"
                center = f"{lever * math.sin(self.angle)!r} {-lever * math.cos(self.angle)!r} 0"
                own = s.inertia - lever**2
                law, values = "weight", [size * s.stiffness, self.angle]
            case "constant_torque":
                spring += self.sign * size * s.swing
                law, values = "springref", [self.sign * size * torque]
            case "backlash":
                half = size * s.swing
                tendon = (f'<tendon><fixed stiffness="{s.stiffness!r}" springlength="{s.rest - half!r} {s.rest + half!r}">'
                          '<joint joint="hinge" coef="1"/></fixed></tendon>')
                stiffness, law, values = "0", "tendon dead band", [half]
            case "end_stop":
                # MuJoCo's contact prescribes an acceleration, and is felt where that exceeds the spring's own: what is solved for is
                # how deep the first swing would go. Direct stiffness and damping, per unit of inertia; a constant impedance.
                reach = math.exp(-math.pi * s.ratio) - size
                place = s.rest - s.side * reach * s.swing
                loss = 0.1 * math.sqrt(self.contact)
                edges = f"-9 {place!r}" if place > s.rest else f"{place!r} 9"
                extra = (f'limited="true" range="{edges}" solreflimit="{-self.contact!r} {-loss!r}" '
                         'solimplimit="0.9 0.9 0.001 0.5 2"')
                law, values = "joint range", [place, 0.9 * self.contact * s.inertia, loss / self.contact]
            case "flexible_coupling":
                inertia = size * s.inertia
                values = [inertia, inertia * self.second**2, 2 * self.second_ratio * self.second * inertia]
                child = (f'<body><joint name="second" type="hinge" axis="0 0 1" stiffness="{values[1]!r}" '
                         f'damping="{values[2]!r}"/>{inertial("0 0 0", inertia)}</body>')
                law = "second body"
        xml = (f'<mujoco><compiler angle="radian" autolimits="false"/>'
               f'<option timestep="{1 / (RATE * SUBSTEPS)!r}" integrator="RK4" gravity="{gravity}"/><worldbody><body>'
               f'<joint name="hinge" type="hinge" axis="0 0 1" stiffness="{stiffness}" damping="{damping}" '
               f'springref="{spring!r}" {extra}/>{inertial(center, own)}{child}</body></worldbody>{tendon}</mujoco>')
        return xml, law, values


def inertial(center, inertia):
    """A unit mass whose inertia does not bound what the triangle inequality admits."""
    return f'<inertial pos="{center}" mass="1" diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>'


def motion(xml, start):
    """Angle and velocity at the samples."""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    data.qpos[0] = start
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = numpy.zeros(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, state, kind)
    count = int(round(SECONDS * RATE))
    states, _ = rollout.rollout(model, data, state[None], nstep=(count - 1) * SUBSTEPS)
    samples = numpy.vstack([state, states[0][SUBSTEPS - 1 :: SUBSTEPS]])
    # The state is time, positions, velocities.
    return samples[:, 1], samples[:, 1 + model.nq]


def closed_form(times, decay, square, rest, position, velocity):
    omega = numpy.sqrt(max(square - decay**2, 1e-12))
    shape = (position - rest) * numpy.cos(omega * times)
    shape += (velocity + decay * (position - rest)) / omega * numpy.sin(omega * times)
    return rest + numpy.exp(-decay * times) * shape


def left_over(system, angle, rest_is_known):
    """Root of the sum of squares that the best damped oscillation leaves."""
    times = numpy.arange(len(angle)) / RATE
    unknowns = numpy.array([system.ratio * system.omega, system.omega**2, system.rest, system.start, 0.0])
    scales = numpy.array([system.omega, system.omega**2, 1.0, 1.0, system.omega])
    free = [0, 1, 3, 4] if rest_is_known else [0, 1, 2, 3, 4]
    expected = math.inf
    # Over ever longer parts of the record, so that no turn is lost.
    for part in [1 / 16, 1 / 8, 1 / 4, 1 / 2, 1]:
        used = times[: int(len(angle) * part)]
        seen = angle[: len(used)]
        norm = numpy.linalg.norm(seen - closed_form(used, *unknowns))
        for _ in range(8):
            columns = []
            for index in free:
                by = numpy.zeros(5)
                by[index] = 1e-6 * scales[index]
                columns.append((closed_form(used, *(unknowns + by)) - closed_form(used, *(unknowns - by))) / 2e-6)
            columns = numpy.array(columns).T
            residual = seen - closed_form(used, *unknowns)
            step, *_ = numpy.linalg.lstsq(columns, residual, rcond=None)
            expected = numpy.linalg.norm(residual - columns @ step)
            share = 1.0
            while share > 0.01:
                tried = unknowns.copy()
                tried[free] += share * step * scales[free]
                with numpy.errstate(over="ignore", invalid="ignore"):
                    left = numpy.linalg.norm(seen - closed_form(used, *tried))
                if left <= norm:
                    unknowns = tried
                    break
                share *= 0.25
            settled = share <= 0.01 or abs(left - expected) <= 1e-3 * left
            norm = min(norm, left)
            if settled:
                break
    return expected


def solve(shape, wanted, white):
    """The size as detectable as wanted, by the secant rule on logarithms; None where there is none."""
    system = shape.system

    def detectability(size):
        xml, *_ = shape.model(size)
        angle, _ = motion(xml, system.start)
        if not numpy.all(numpy.abs(angle) < 10):
            return math.inf
        return left_over(system, angle, shape.effect == "constant_torque") / white

    top, place, before = math.log(shape.most), math.log(shape.guess), None
    below, above = None, None
    for _ in range(24):
        found = detectability(math.exp(place))
        if abs(found / wanted - 1) <= 0.01:
            return math.exp(place), found
        if not math.isfinite(found):
            return None
        miss = math.log(max(found, 1e-9) / wanted)
        if miss < 0:
            below = place if below is None else max(below, place)
        else:
            above = place if above is None else min(above, place)
        if miss < 0 and place >= top:
            return None
        slope = 1.0
        if before is not None and before[0] != place:
            slope = min(max((miss - before[1]) / (place - before[0]), 0.4), 4.0)
        before = (place, miss)
        place = min(place - min(max(miss / slope, -5), 5), top)
        if below is not None and above is not None:
            margin = 0.02 * abs(above - below)
            if not min(below, above) + margin <= place <= max(below, above) - margin:
                place = 0.5 * (below + above)
    return None


def stamped(draws, velocity, noise):
    """What a logger does to the stamps, with the probabilities of the other banks; the ids of it, and its variance."""
    times = numpy.arange(len(velocity)) / RATE
    square = float(numpy.mean(velocity**2))
    interval, scatter, part, share = draws.uniform(0.01, 0.08), draws.uniform(0, 0.1), draws.uniform(0.3, 1), draws.random()
    if share < 0.25:
        ends = [interval * draws.random()]
        while ends[-1] < times[-1]:
            ends.append(ends[-1] + interval * (1 + scatter * min(max(draws.standard_normal(), -3.9), 3.9)))
        return numpy.array(ends)[numpy.searchsorted(ends, times)], ["timestamp_batching"], 0.0
    if share < 0.5:
        deviation = min(part * noise / math.sqrt(square), 0.3 / RATE)
        scattered = numpy.sort(times + deviation * draws.standard_normal(len(times)))
        return scattered, ["timestamp_jitter"], deviation**2 * square
    return times, [], 0.0


def write(out, number, seed):
    """One case."""
    draws = numpy.random.default_rng([seed, number])
    effect = EFFECTS[number % len(EFFECTS)]
    wanted = DETECTABILITIES[number // len(EFFECTS) % len(DETECTABILITIES)]
    for _ in range(ATTEMPTS):
        system = System(draws)
        decay, omega = system.ratio * system.omega, system.omega
        times = numpy.arange(int(round(SECONDS * RATE))) / RATE
        speed = -system.swing * omega * numpy.exp(-decay * times) * numpy.sin(omega * times)
        stamps, nuisances, scattered = stamped(draws, speed, system.noise)
        step = 2 * math.pi / (4096 if draws.random() < 0.5 else 8192) if draws.random() < 0.5 else None
        white = math.sqrt(system.noise**2 + (step**2 / 12 if step else 0.0) + scattered)
        shape = Shape(effect, system, draws)
        if sized := solve(shape, wanted, white):
            break
    else:
        raise SystemExit(f"case {number}: no {effect} is as detectable as {wanted}")
    xml, law, values = shape.model(sized[0])
    angle, _ = motion(xml, system.start)
    seen = angle + system.noise * draws.standard_normal(len(angle))
    if step:
        seen = numpy.round(seen / step) * step
        nuisances = ["sensor_quantization", *nuisances]
    off = draws.random() < 0.5
    factors = 1 + draws.uniform(-0.1, 0.1, 2) if off else numpy.ones(2)

    name = f"{number:05d}"
    folder = out / name
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"{stamp:.6f},{value:.9f}" for stamp, value in zip(stamps, seen)]
    text = "# origin: simulated\ntime_s,angle_rad\n" + "\n".join(lines) + "\n"
    (folder / "record-000.csv").write_text(text)
    nominal = {"inertia": system.inertia, "damping": system.damping * float(factors[0]),
               "stiffness": system.stiffness * float(factors[1]), "rest_angle": system.rest}
    if step:
        nominal["sensor_resolution"] = step
    (folder / "nominal.toml").write_text("".join(f"{key} = {value!r}\n" for key, value in nominal.items()))
    hidden = {
        "schema": "ringdown.trial/1",
        "bank": "engine",
        "effects": [{"id": effect, "parameters": [float(value) for value in values], "law": f"MuJoCo {law}",
                     "detectability": float(sized[1])}],
        "nuisances": nuisances,
        "miscalibrated": off,
        "noise": system.noise,
        "made": f"experiments/physics-engine/records.py, MuJoCo {mujoco.__version__}, seed {seed}, case {number}",
    }
    (out / "hidden").mkdir(exist_ok=True)
    (out / "hidden" / f"{name}.json").write_text(json.dumps(hidden, indent=2) + "\n")
    return f"{name} {effect} {sized[1]:.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder to write to")
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="number of the first case, to make them in parts")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    for number in range(arguments.first, arguments.first + arguments.cases):
        print(write(arguments.out, number, arguments.seed), flush=True)


if __name__ == "__main__":
    main()
