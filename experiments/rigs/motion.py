"""Motions of an oscillator with many laws at once, by adaptive Dormand–Prince steps that land on events.

Everything is per unit of inertia, in a flat vector of parameters (`P`, places below), so that numba compiles one right-hand side.
Dry friction is exact: the direction of sliding is a mode, a step that passes rest is cut there by bisection on its
length, and the body stays at rest while what pulls is weaker than the static torque. Inputs are held from sample to sample, and
steps end at samples and where a delayed input jumps. The other kinks (a stop, a dead zone) are continuous torques: the
control of the step's error sees them.

Dormand, Prince, Journal of Computational and Applied Mathematics 6 (1980) 19.
"""

import numpy
from numba import njit

# Places in the vector of parameters, per unit of inertia.
(SQUARE, DAMPING, REST, COULOMB, SLIDING, EXCESS, STRIBECK, DAHL, PRESLIDING, DRAG, CUBIC, QUADRATIC, WEIGHT, LEAN, PRELOAD,
 PLAY, STOP, CONTACT, CONTACT_LOSS, SIDE, STIFFENING, THICKENING, FORCING, FREQUENCY, PHASE, SECOND, SECOND_SQUARE, SECOND_DAMPING,
 GAIN, LIMIT, RETURN, SHARPNESS) = range(32)
UNLISTED = (32, 48)
LENGTH = 64
# Kinds of laws outside the vocabulary: at UNLISTED kind, size, then 14 numbers of shape.
KINDS = ["fourier", "cogging", "lugre", "position_damping", "power_drag", "polynomial", "maxwell", "bouc_wen", "parametric",
         "exponential_spring", "wandering_forcing", "rough_bearing", "eddy_drag", "settling_spring"]
# State: position, velocity, Dahl's z, the second body's position and velocity, one hidden state of each unlisted law.
STATES = 7


@njit(cache=True, fastmath=False)
def unlisted(P, at, d, v, z, t):
    """Acceleration by an unlisted law and the rate of its hidden state."""
    kind, size = int(P[at]), P[at + 1]
    q = P[at + 2 : at + 16]
    if kind == 0:
        total = 0.0
        for i in range(3):
            total += q[4 * i] * numpy.sin(q[4 * i + 1] * d / q[12] + q[4 * i + 2] * v / q[13] + q[4 * i + 3])
        return size * total, 0.0
    if kind == 1:
        return -size * numpy.sin(q[0] * d / q[12] + q[1]), 0.0
    if kind == 2:
        g = 1.0 + q[1] * numpy.exp(-((v / (q[2] * q[13])) ** 2))
        return -size * z, (v - abs(v) * z / g) / (q[0] * q[12])
    if kind == 3:
        return -size * (d / q[12]) ** 2 * v / q[13], 0.0
    if kind == 4:
        return -size * abs(v / q[13]) ** q[0] * numpy.sign(v), 0.0
    if kind == 5:
        x, y = d / q[12], v / q[13]
        total = q[0] * x * x * y + q[1] * x * y + q[2] * (4 * x**3 - 3 * x) + q[3] * x * y * y + q[4] * x**4
        total += q[5] * y**3 + q[6] * (16 * x**5 - 20 * x**3 + 5 * x)
        return size * total, 0.0
    if kind == 6:
        return -size * (d - z) / q[12], (d - z) / q[0]
    if kind == 7:
        loss = abs(z) ** q[1] * (0.5 + 0.5 * numpy.sign(v * z))
        return -size * z, v * (1.0 - loss) / (q[0] * q[12])
    if kind == 8:
        return -size * numpy.sin(q[0] * t + q[1]) * d / q[12], 0.0
    if kind == 9:
        x = q[0] * d / q[12]
        return -size * (numpy.exp(x) - 1.0 - x), 0.0
    if kind == 10:
        return size * numpy.sin(q[0] * t + q[1] + q[2] * numpy.sin(q[3] * t)), 0.0
    if kind == 11:
        return -size * (1.0 + q[0] * numpy.sin(q[1] * d / q[12] + q[2])) * numpy.tanh(v / (q[3] * q[13])), 0.0
    if kind == 12:
        y = v / (q[0] * q[13])
        return -size * y / (1.0 + y * y), 0.0
    return -size * (1.0 - numpy.exp(-t / q[0])) * d / q[12], 0.0


@njit(cache=True)
def smooth(P, y, t, u, out):
    """Acceleration by everything but dry friction; fills the rates of the hidden states."""
    d, v = y[0] - P[REST], y[1]
    drive = P[GAIN] * u
    if P[LIMIT] > 0.0:
        drive = min(max(drive, -P[LIMIT]), P[LIMIT])
    a = drive - P[SQUARE] * (1.0 + P[STIFFENING] * t) * d - P[DAMPING] * (1.0 + P[THICKENING] * t) * v
    a += P[PRELOAD] - P[DRAG] * v * abs(v) - P[CUBIC] * d * d * d - P[QUADRATIC] * d * d
    if P[WEIGHT] != 0.0:
        a -= P[WEIGHT] * numpy.sin(y[0] + P[LEAN])
    if P[PLAY] > 0.0:
        a += P[SQUARE] * min(max(d, -P[PLAY]), P[PLAY])
    if P[SIDE] != 0.0:
        depth = (y[0] - P[STOP]) * P[SIDE]
        if depth > 0.0:
            a -= P[SIDE] * P[CONTACT] * depth * max(0.0, 1.0 + P[CONTACT_LOSS] * v * P[SIDE])
    if P[FORCING] != 0.0:
        a += P[FORCING] * numpy.sin(P[FREQUENCY] * t + P[PHASE])
    for i in range(2, 7):
        out[i] = 0.0
    if P[DAHL] != 0.0:
        a -= P[DAHL] * y[2]
        if P[SHARPNESS] > 0.0:
            # Bouc and Wen's law: a part of the loss acts on the way back as well, and an exponent sharpens the knee.
            loss = abs(y[2]) ** P[SHARPNESS] * (1.0 - P[RETURN] + P[RETURN] * numpy.sign(v * y[2]))
            out[2] = v * (1.0 - loss) / P[PRESLIDING]
        else:
            out[2] = (v - abs(v) * y[2]) / P[PRESLIDING]
    if P[SECOND] != 0.0:
        pull = P[SECOND_SQUARE] * (y[3] - y[0]) + P[SECOND_DAMPING] * (y[4] - v)
        a += P[SECOND] * pull
        out[3] = y[4]
        out[4] = -pull
    for i in range(2):
        at = 32 + 16 * i
        if P[at + 1] != 0.0:
            more, rate = unlisted(P, at, d, v, y[5 + i], t)
            a += more
            out[5 + i] = rate
    return a


@njit(cache=True)
def dry(P, speed):
    """Dry friction's size at a speed."""
    size = P[COULOMB]
    if P[SLIDING] != 0.0 or P[EXCESS] != 0.0:
        size += P[SLIDING] + P[EXCESS] * numpy.exp(-((speed / P[STRIBECK]) ** 2))
    return size


@njit(cache=True)
def rate(P, y, t, u, mode, out):
    a = smooth(P, y, t, u, out)
    if mode == 0:
        out[0] = 0.0
        out[1] = 0.0
    else:
        out[0] = y[1]
        out[1] = a - mode * dry(P, y[1])


@njit(cache=True)
def attempt(P, y, t, h, u, mode, k, end):
    """One Dormand–Prince step; k[0] holds the rate at its start. Returns the error in units of the tolerance's scale."""
    tmp = numpy.empty(STATES)
    for i in range(STATES):
        tmp[i] = y[i] + h * 0.2 * k[0, i]
    rate(P, tmp, t + 0.2 * h, u, mode, k[1])
    for i in range(STATES):
        tmp[i] = y[i] + h * (3 / 40 * k[0, i] + 9 / 40 * k[1, i])
    rate(P, tmp, t + 0.3 * h, u, mode, k[2])
    for i in range(STATES):
        tmp[i] = y[i] + h * (44 / 45 * k[0, i] - 56 / 15 * k[1, i] + 32 / 9 * k[2, i])
    rate(P, tmp, t + 0.8 * h, u, mode, k[3])
    for i in range(STATES):
        tmp[i] = y[i] + h * (19372 / 6561 * k[0, i] - 25360 / 2187 * k[1, i] + 64448 / 6561 * k[2, i] - 212 / 729 * k[3, i])
    rate(P, tmp, t + 8 / 9 * h, u, mode, k[4])
    for i in range(STATES):
        tmp[i] = y[i] + h * (9017 / 3168 * k[0, i] - 355 / 33 * k[1, i] + 46732 / 5247 * k[2, i] + 49 / 176 * k[3, i]
                             - 5103 / 18656 * k[4, i])
    rate(P, tmp, t + h, u, mode, k[5])
    for i in range(STATES):
        end[i] = y[i] + h * (35 / 384 * k[0, i] + 500 / 1113 * k[2, i] + 125 / 192 * k[3, i] - 2187 / 6784 * k[4, i]
                             + 11 / 84 * k[5, i])
    rate(P, end, t + h, u, mode, k[6])


@njit(cache=True)
def error(h, k, scale):
    worst = 0.0
    for i in range(STATES):
        e = h * abs(71 / 57600 * k[0, i] - 71 / 16695 * k[2, i] + 71 / 1920 * k[3, i] - 17253 / 339200 * k[4, i]
                    + 22 / 525 * k[5, i] - 1 / 40 * k[6, i])
        worst = max(worst, e / scale[i])
    return worst


@njit(cache=True)
def integrate(P, start, times, knots, values, tolerance, scale, most, budget):
    """States and modes at `times`; the input is values[i] from knots[i] on. Returns False where the budget of steps ends."""
    count = len(times)
    states = numpy.zeros((count, STATES))
    modes = numpy.zeros(count)
    y = start.copy()
    k = numpy.zeros((7, STATES))
    end = numpy.empty(STATES)
    rates = numpy.empty(STATES)
    t = times[0]
    knot = 0
    while knot + 1 < len(knots) and knots[knot + 1] <= t:
        knot += 1
    u = values[knot] if len(values) else 0.0
    static = dry(P, 0.0)
    mode = numpy.sign(y[1])
    if mode == 0.0:
        pull = smooth(P, y, t, u, rates)
        mode = numpy.sign(pull) if abs(pull) > static else 0.0
    states[0] = y
    modes[0] = mode
    h = most
    steps = 0
    for n in range(1, count):
        while t < times[n]:
            steps += 1
            if steps > budget:
                return False, states, modes
            target = times[n]
            if knot + 1 < len(knots) and knots[knot + 1] < target:
                target = knots[knot + 1]
            left = target - t
            step = min(h, left)
            if left - step < 1e-3 * step:
                step = left
            rate(P, y, t, u, mode, k[0])
            attempt(P, y, t, step, u, mode, k, end)
            e = error(step, k, scale) / tolerance
            if e > 1.0 and step > 1e-9 * most:
                h = step * max(0.2, 0.9 * e**-0.2)
                continue
            taken = step
            event = False
            if mode != 0.0 and end[1] * mode < 0.0:
                # The end of sliding, by bisection with secants on the step's length.
                low, high, vlow, vhigh = 0.0, step, y[1] * mode, end[1] * mode
                for turn in range(60):
                    middle = 0.5 * (low + high)
                    if turn % 3 and vlow > vhigh:
                        middle = low + (high - low) * vlow / (vlow - vhigh)
                        middle = min(max(middle, low + 1e-3 * (high - low)), high - 1e-3 * (high - low))
                    attempt(P, y, t, middle, u, mode, k, end)
                    if end[1] * mode < 0.0:
                        high, vhigh = middle, end[1] * mode
                    else:
                        low, vlow = middle, end[1] * mode
                    if high - low < 1e-13 * max(abs(t), step) + 1e-12 * step or abs(end[1]) < 1e-13 * scale[1]:
                        break
                taken = middle
                event = True
            elif mode == 0.0:
                pull = smooth(P, end, t + step, u, rates)
                if abs(pull) > static:
                    low, high = 0.0, step
                    for turn in range(50):
                        middle = 0.5 * (low + high)
                        attempt(P, y, t, middle, u, mode, k, end)
                        if abs(smooth(P, end, t + middle, u, rates)) > static:
                            high = middle
                        else:
                            low = middle
                    taken = high
                    attempt(P, y, t, taken, u, mode, k, end)
                    event = True
            for i in range(STATES):
                y[i] = end[i]
            t = target if taken == left else t + taken
            if event:
                y[1] = 0.0
                pull = smooth(P, y, t, u, rates)
                mode = numpy.sign(pull) if abs(pull) > static else 0.0
            else:
                h = min(most, step * min(4.0, 0.9 * max(e, 1e-10) ** -0.2)) if step >= h else h
            if knot + 1 < len(knots) and knots[knot + 1] <= t:
                knot += 1
                u = values[knot]
                if mode == 0.0:
                    pull = smooth(P, y, t, u, rates)
                    mode = numpy.sign(pull) if abs(pull) > static else 0.0
            if not abs(y[0]) < 1e9:
                return False, states, modes
        states[n] = y
        modes[n] = mode
    return True, states, modes


@njit(cache=True)
def accelerations(P, states, modes, times, inputs):
    """Acceleration by all but dry friction, and dry friction's, at the samples."""
    count = len(times)
    others, friction = numpy.empty(count), numpy.empty(count)
    out = numpy.empty(STATES)
    for n in range(count):
        others[n] = smooth(P, states[n], times[n], inputs[n], out)
        friction[n] = -modes[n] * dry(P, states[n, 1]) if modes[n] != 0.0 else -others[n]
    return others, friction
