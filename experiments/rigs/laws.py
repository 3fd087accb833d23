"""The vocabulary's effects and laws outside it, each with the numbers that shape it drawn and its strength open."""

import math

import numpy

from motion import (
    COULOMB, CONTACT, CONTACT_LOSS, CUBIC, DAHL, DRAG, EXCESS, FORCING, FREQUENCY, KINDS, LEAN, LIMIT, PHASE, PLAY, PRELOAD,
    PRESLIDING, QUADRATIC, RETURN, SECOND, SECOND_DAMPING, SECOND_SQUARE, SHARPNESS, SIDE, SLIDING, STIFFENING, STOP, STRIBECK, THICKENING, UNLISTED,
    WEIGHT,
)

CLASSES = {
    "coulomb_friction": "friction", "stribeck_friction": "friction", "hysteresis": "friction",
    "cubic_stiffness": "restoring", "asymmetric_stiffness": "restoring", "gravity": "restoring",
    "quadratic_drag": "damping", "damping_drift": "damping",
    "backlash": "play", "end_stop": "play",
    "stiffness_drift": "drift", "clock_drift": "drift",
    "flexible_coupling": "second_body", "periodic_forcing": "forcing", "constant_torque": "preload",
    "input_delay": "actuator", "input_saturation": "actuator",
    "sensor_quantization": "sensor", "sensor_saturation": "sensor", "sensor_lag": "sensor",
    "sensor_nonlinearity": "sensor", "sensor_drift": "sensor", "outliers": "sensor",
    "timestamp_batching": "stamps", "timestamp_jitter": "stamps", "dropouts": "stamps",
}
# How often each comes, relative to the others; those of a driven record only where there is an input.
OFTEN = {
    "coulomb_friction": 3, "stribeck_friction": 2, "hysteresis": 2, "cubic_stiffness": 2, "asymmetric_stiffness": 2, "gravity": 3,
    "quadratic_drag": 3, "damping_drift": 1, "backlash": 1.5, "end_stop": 1, "stiffness_drift": 1, "clock_drift": 0.7,
    "flexible_coupling": 1.5, "periodic_forcing": 1.2, "constant_torque": 1.2, "input_delay": 2, "input_saturation": 2,
    "sensor_nonlinearity": 1, "sensor_drift": 1, "sensor_saturation": 0.5, "outliers": 0.5, "timestamp_jitter": 0.5,
}
# How often each leads a hard rig.
HARD = {"backlash": 3, "end_stop": 3, "hysteresis": 3, "damping_drift": 1, "coulomb_friction": 1, "stribeck_friction": 1, "gravity": 1,
        "quadratic_drag": 1, "flexible_coupling": 1}
CHAIN = {"sensor_nonlinearity", "sensor_drift", "sensor_saturation", "outliers", "timestamp_jitter", "clock_drift"}


class Effect:
    """An effect of the vocabulary: `apply(P, strength)` writes it into parameters per unit of inertia.

    Strength 1 makes it about as large as the spring's torque at the full swing.
    """

    def __init__(self, name, rig, draws):
        self.id, self.rig = name, rig
        self.sign = 1.0 if draws.random() < 0.5 else -1.0
        self.angle = draws.uniform(-0.5, 0.5) if draws.random() < 0.5 else draws.uniform(-math.pi, math.pi)
        self.share = math.exp(draws.uniform(math.log(0.05), math.log(0.6)))
        self.ratio = math.exp(draws.uniform(math.log(1.3), math.log(2.2)))
        self.place = draws.uniform(0, 1)
        self.stiff = math.exp(draws.uniform(math.log(5), math.log(80)))
        self.loss = draws.uniform(0, 0.5)
        self.phase = draws.uniform(-math.pi, math.pi)
        self.form = (1.0, 0.0)
        self.frequency = rig.omega * (draws.uniform(0.15, 0.75) if draws.random() < 0.5 else draws.uniform(1.4, 3.4))
        self.second = rig.omega * draws.uniform(1.6, 5.0)
        self.second_ratio = math.exp(draws.uniform(math.log(0.003), math.log(0.04)))
        swing = rig.amplitude
        self.most = {
            "coulomb_friction": 0.4, "stribeck_friction": 0.3, "hysteresis": 0.4, "cubic_stiffness": 0.6, "asymmetric_stiffness": 0.35,
            "gravity": 3.0 / max(swing, 0.2), "quadratic_drag": 0.5, "damping_drift": 30.0, "backlash": 0.6, "end_stop": 0.6,
            "stiffness_drift": 0.4, "clock_drift": 0.1, "flexible_coupling": 0.4, "periodic_forcing": 1.0, "constant_torque": 0.5,
            "input_delay": 0.25, "input_saturation": 0.8, "sensor_nonlinearity": 0.3, "sensor_drift": 1.0, "sensor_saturation": 0.5,
            "outliers": 1.0, "timestamp_jitter": 0.3,
        }[name]
        self.power = {"end_stop": 1.8, "input_saturation": 1.6, "sensor_saturation": 1.4}.get(name, 1.0)
        # A whole weight in place of the spring.
        self.hanging = name == "gravity" and rig.hanging
        if self.hanging:
            self.angle = draws.uniform(-0.05, 0.05)

    def harden(self, draws):
        """A form and a strength as machines have them, far from those that a linearization sees; returns the strength."""
        match self.id:
            case "backlash":
                return draws.uniform(0.25, 0.5)
            case "end_stop":
                self.stiff, self.loss, self.power = draws.uniform(20, 40), draws.uniform(0.3, 3.0), 1.0
                return draws.uniform(0.15, 0.5) * (1 + self.rig.reach)
            case "hysteresis":
                self.share = draws.uniform(0.2, 0.66)
                self.form = (draws.uniform(0.5, 0.95), float(draws.integers(1, 3)))
                return math.exp(draws.uniform(math.log(0.02), math.log(0.3)))
            case "damping_drift":
                self.sign = -1.0
                return 30.0 * draws.uniform(0.85, 0.95)
            case _:
                return math.exp(draws.uniform(math.log(0.02), math.log(0.25)))

    def apply(self, P, x):
        rig = self.rig
        unit, swing, speed = rig.square * rig.amplitude, rig.amplitude, rig.amplitude * rig.omega
        match self.id:
            case "coulomb_friction":
                P[COULOMB] = x * unit
            case "stribeck_friction":
                P[SLIDING], P[EXCESS], P[STRIBECK] = x * unit, x * unit * (self.ratio - 1), self.share * speed
            case "hysteresis":
                P[DAHL], P[PRESLIDING] = x * unit, 0.5 * self.share * swing
                P[RETURN], P[SHARPNESS] = self.form
            case "cubic_stiffness":
                P[CUBIC] = self.sign * x * unit / swing**3
            case "asymmetric_stiffness":
                P[QUADRATIC] = self.sign * x * unit / swing**2
            case "gravity":
                P[WEIGHT], P[LEAN] = x * rig.square, self.angle
            case "quadratic_drag":
                P[DRAG] = x * unit / speed**2
            case "damping_drift":
                P[THICKENING] = (1 if self.sign > 0 else -0.03) * x / rig.duration
            case "backlash":
                P[PLAY] = x * swing
            case "end_stop":
                side = self.sign if rig.driven else -rig.side
                P[SIDE], P[STOP] = side, rig.rest + side * (rig.reach - x) * swing
                P[CONTACT], P[CONTACT_LOSS] = self.stiff * rig.square, self.loss / speed
            case "stiffness_drift":
                P[STIFFENING] = self.sign * x / rig.duration
            case "periodic_forcing":
                P[FORCING], P[FREQUENCY], P[PHASE] = x * unit, self.frequency, self.phase
            case "flexible_coupling":
                P[SECOND], P[SECOND_SQUARE] = x, self.second**2
                P[SECOND_DAMPING] = 2 * self.second_ratio * self.second
            case "constant_torque":
                P[PRELOAD] = self.sign * x * unit
            case "input_saturation":
                P[LIMIT] = max(1e-9, (1 - x) * rig.input_peak)

    def without(self, P):
        """Parameters in which it does not act; the second body stays, without pulling."""
        Q = P.copy()
        for place in {
            "coulomb_friction": [COULOMB], "stribeck_friction": [SLIDING, EXCESS], "hysteresis": [DAHL], "cubic_stiffness": [CUBIC],
            "asymmetric_stiffness": [QUADRATIC], "gravity": [WEIGHT], "quadratic_drag": [DRAG], "damping_drift": [THICKENING],
            "backlash": [PLAY], "end_stop": [SIDE], "stiffness_drift": [STIFFENING], "periodic_forcing": [FORCING],
            "flexible_coupling": [SECOND], "constant_torque": [PRELOAD], "input_saturation": [LIMIT],
        }.get(self.id, []):
            Q[place] = 0.0
        return Q

    def parameters(self, P, x):
        """By the vocabulary's law, in SI units, in its order."""
        rig, inertia = self.rig, self.rig.inertia
        match self.id:
            case "coulomb_friction":
                return [P[COULOMB] * inertia]
            case "stribeck_friction":
                return [P[SLIDING] * inertia, (P[SLIDING] + P[EXCESS]) * inertia, P[STRIBECK]]
            case "hysteresis":
                if P[SHARPNESS] == 0:
                    return [P[DAHL] * inertia, P[PRESLIDING]]
                # The vocabulary's state is smaller: it ends at (1 + softening)^(-1/exponent), and not at 1.
                larger = P[RETURN] ** (-1 / P[SHARPNESS])
                return [P[DAHL] * inertia * larger, P[PRESLIDING] * larger, 1 / P[RETURN] - 1, P[SHARPNESS]]
            case "cubic_stiffness":
                return [P[CUBIC] * inertia]
            case "asymmetric_stiffness":
                return [P[QUADRATIC] * inertia]
            case "gravity":
                return [P[WEIGHT] * inertia, P[LEAN]]
            case "quadratic_drag":
                return [P[DRAG] * inertia]
            case "damping_drift":
                return [P[THICKENING]]
            case "backlash":
                return [P[PLAY]]
            case "end_stop":
                return [P[STOP], P[CONTACT] * inertia, P[CONTACT_LOSS]]
            case "stiffness_drift":
                return [P[STIFFENING]]
            case "periodic_forcing":
                return [P[FORCING] * inertia, P[FREQUENCY], P[PHASE]]
            case "flexible_coupling":
                return [P[SECOND] * inertia, P[SECOND] * P[SECOND_SQUARE] * inertia, P[SECOND] * P[SECOND_DAMPING] * inertia]
            case "constant_torque":
                return [P[PRELOAD] * inertia]
            case "input_delay":
                return [self.delay(x)]
            case "input_saturation":
                return [P[LIMIT] * inertia]
            case _:
                return self.chain(x)

    def delay(self, x):
        return x / self.rig.omega

    def chain(self, x):
        """Parameters of a step of the measuring chain."""
        rig = self.rig
        match self.id:
            case "sensor_nonlinearity":
                return [x * rig.amplitude, self.phase]
            case "sensor_drift":
                return [self.sign * x * rig.amplitude / rig.duration]
            case "sensor_saturation":
                return [(1 - x) * rig.amplitude]
            case "outliers":
                return [0.002 + 0.02 * self.place**2, x * rig.amplitude]
            case "timestamp_jitter":
                return [x * rig.step]
            case "clock_drift":
                # The rate is a matter of calibration; what counts is its change.
                return [0.0, self.sign * x / rig.duration]

    def read(self, x, times, positions, velocities, draws=None):
        """What a step of the measuring chain adds to the readings; random ones need `draws`."""
        values = self.chain(x)
        match self.id:
            case "sensor_nonlinearity":
                return values[0] * numpy.sin(positions + values[1])
            case "sensor_drift":
                return values[0] * (times - times[0])
            case "sensor_saturation":
                bound = values[0]
                return numpy.clip(positions - self.rig.rest, -bound, bound) + self.rig.rest - positions
            case "clock_drift":
                # Read at the stamps: what was there a moment earlier.
                return -velocities * 0.5 * values[1] * (times - times[0]) ** 2


# Laws outside the vocabulary: two lists without a common member, so that one bank is unlike the other.
FIRST = ["fourier", "cogging", "lugre", "position_damping", "power_drag", "parametric", "settling_spring"]
SECOND_LIST = ["polynomial", "maxwell", "bouc_wen", "exponential_spring", "wandering_forcing", "rough_bearing", "eddy_drag"]
# Classes of which a law is a member by its mechanism: naming one of them is not wrong.
OF_CLASS = {"lugre": "friction", "bouc_wen": "friction", "rough_bearing": "friction", "position_damping": "damping", "power_drag": "damping",
            "eddy_drag": "damping", "exponential_spring": "restoring", "parametric": "drift", "settling_spring": "drift",
            "wandering_forcing": "forcing"}


class Unlisted:
    """A smooth law outside the vocabulary, in one of the two places for such laws."""

    most, power = 0.5, 1.0

    def __init__(self, name, rig, place, draws):
        self.id, self.rig, self.place = name, rig, place
        low, high = draws.uniform(0, 1, 2)
        q = numpy.zeros(14)
        q[12], q[13] = rig.amplitude, rig.amplitude * rig.omega
        match name:
            case "fourier":
                for i in range(3):
                    weights = draws.normal(size=2)
                    q[4 * i : 4 * i + 4] = [draws.normal() / 1.7, 2.5 * weights[0], 2.5 * weights[1], draws.uniform(-math.pi, math.pi)]
            case "cogging":
                q[0], q[1] = draws.uniform(4, 25), draws.uniform(-math.pi, math.pi)
            case "lugre":
                q[0], q[1], q[2] = 0.01 + 0.15 * low, 0.2 + high, draws.uniform(0.05, 0.5)
            case "power_drag":
                q[0] = draws.uniform(0.3, 0.7) if low < 0.4 else draws.uniform(1.4, 1.7) if low < 0.7 else draws.uniform(2.4, 3.5)
            case "polynomial":
                q[:7] = draws.normal(size=7) * [1, 1, 0.6, 1, 0.7, 0.7, 0.4]
            case "maxwell":
                q[0] = 10 ** draws.uniform(-0.7, 0.5) / rig.omega if low < 0.5 else draws.uniform(0.08, 0.4) * rig.duration
            case "bouc_wen":
                q[0], q[1] = 0.02 + 0.3 * low, draws.uniform(1.3, 4.0)
            case "parametric":
                q[0] = rig.omega * (draws.uniform(0.02, 0.5) if low < 0.5 else draws.uniform(0.6, 1.4))
                q[1] = draws.uniform(-math.pi, math.pi)
            case "exponential_spring":
                q[0] = draws.uniform(1.0, 2.5) * (1 if low < 0.5 else -1)
            case "wandering_forcing":
                q[0] = rig.omega * (draws.uniform(0.2, 0.7) if low < 0.5 else draws.uniform(1.4, 2.8))
                q[1], q[2], q[3] = draws.uniform(-math.pi, math.pi), draws.uniform(1, 4), q[0] * draws.uniform(0.01, 0.05)
            case "rough_bearing":
                q[0], q[1], q[2], q[3] = draws.uniform(0.3, 0.9), draws.uniform(2, 9), draws.uniform(-3, 3), draws.uniform(0.05, 0.3)
            case "eddy_drag":
                q[0] = draws.uniform(0.15, 0.7)
            case "settling_spring":
                q[0] = rig.duration * draws.uniform(0.08, 0.3)
        self.shape = q

    def apply(self, P, x):
        at = UNLISTED[self.place]
        P[at], P[at + 1] = KINDS.index(self.id), x * self.rig.square * self.rig.amplitude
        P[at + 2 : at + 16] = self.shape

    def without(self, P):
        Q = P.copy()
        Q[UNLISTED[self.place] + 1] = 0.0
        return Q

    def hidden(self, deflection):
        """The hidden state at the start."""
        return deflection if self.id == "maxwell" else 0.0
