#!/usr/bin/env python3
"""Made logs of ringdowns in the layouts that people have, each with its true frequency and damping ratio.

    VENV/bin/python experiments/logs/make.py OUT --count 300 --seed 1

Every motion is that of a linear oscillator in closed form, so the truth is exact. Writes OUT/logs/NNNN.<ending> (a folder where the
kind is a folder) and OUT/truth/NNNN.json. The draws of a log depend only on the seed and its number.
"""

import argparse
import io
import json
import math
import wave
from pathlib import Path

import numpy

# Thirty-five slots that repeat: how many of them each kind has.
SHARES = {"columns": 4, "runs": 4, "command": 2, "handled": 4, "codings": 4, "headers": 7, "modes": 2, "dampings": 3, "strikes": 3, "beside": 2}
# Time, angle, position, deflection, temperature.
WORDS = {
    "en": ("Time", "Angle", "Position", "Displacement", "Temperature"), "de": ("Zeit", "Winkel", "Position", "Auslenkung", "Temperatur"),
    "fr": ("Temps", "Angle", "Position", "Déplacement", "Température"), "es": ("Tiempo", "Ángulo", "Posición", "Desplazamiento", "Temperatura"),
    "it": ("Tempo", "Angolo", "Posizione", "Spostamento", "Temperatura"), "pt": ("Tempo", "Ângulo", "Posição", "Deslocamento", "Temperatura"),
    "nl": ("Tijd", "Hoek", "Positie", "Uitwijking", "Temperatuur"), "sv": ("Tid", "Vinkel", "Läge", "Förskjutning", "Temperatur"),
    "pl": ("Czas", "Kąt", "Położenie", "Przemieszczenie", "Temperatura"), "cs": ("Čas", "Úhel", "Poloha", "Výchylka", "Teplota"),
    "tr": ("Zaman", "Açı", "Konum", "Yer değiştirme", "Sıcaklık"), "ja": ("時間", "角度", "位置", "変位", "温度"),
}
# The size of a swing in each unit.
SIZES = {"rad": (0.03, 1.0), "deg": (2, 60), "°": (2, 60), "m": (0.005, 0.5), "cm": (0.5, 50), "mm": (0.5, 200), "V": (0.05, 5), "mV": (5, 900)}


def spread(rng, low, high):
    """A number whose logarithm is evenly spread."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def pick(rng, items):
    return items[int(rng.integers(len(items)))]


def free(t, f, z, x, v):
    """Value and slope of a free decay after a start with value x and slope v, at any damping."""
    w = 2 * math.pi * f
    if abs(z - 1) < 1e-9:
        e = numpy.exp(-w * t)
        return e * (x + (v + w * x) * t), e * (v - w * (v + w * x) * t)
    root = numpy.sqrt(complex(z * z - 1))
    p, q = w * (-z + root), w * (-z - root)
    a, b = (v - q * x) / (p - q), (p * x - v) / (p - q)
    ep, eq = numpy.exp(p * t), numpy.exp(q * t)
    return (a * ep + b * eq).real, (a * p * ep + b * q * eq).real


class Swing:
    """The numbers of one oscillator and of its logger."""

    def __init__(self, rng, f=(0.05, 40), z=(0.001, 0.1), per=(12, 500), cycles=(8, 60), snr=(8, 1000), size=(0.03, 1.0), rows=9000):
        self.rng = rng
        self.f, self.z = spread(rng, *f), spread(rng, *z)
        self.cycles = rng.uniform(*cycles)
        self.per = min(spread(rng, *per), max(12.0, rows / self.cycles))
        self.snr, self.size = spread(rng, *snr), spread(rng, *size)
        # Rates are round numbers.
        self.rate = float(f"{self.per * self.f:.3g}")
        self.noise = self.size / self.snr

    def times(self, cycles=None, uneven=None):
        n = max(20, int((cycles or self.cycles) / self.f * self.rate))
        t = numpy.arange(n) / self.rate
        if uneven is None:
            uneven = self.rng.random() < 0.25
        return t + uneven * self.rng.uniform(0, 0.2 / self.rate, n)

    def start(self, size=None):
        """Value and slope of a release, a stroke, or anything between."""
        phase = pick(self.rng, [0.0, math.pi, math.pi / 2, self.rng.uniform(0, 2 * math.pi)])
        size = size or self.size
        return size * math.cos(phase), size * math.sin(phase) * 2 * math.pi * self.f

    def free(self, t, x, v):
        return free(t, self.f, self.z, x, v)

    def decay(self, t, size=None):
        return self.free(t - t[0], *self.start(size))[0]

    def hiss(self, n):
        return self.noise * self.rng.standard_normal(n)

    def log(self, offset=True, cycles=None):
        """Times and readings of one plain log."""
        t = self.times(cycles)
        rest = self.rng.uniform(-1, 1) * self.size if offset and self.rng.random() < 0.6 else 0.0
        return t, self.decay(t) + rest + self.hiss(len(t))


def digits(step):
    """Decimals that show a step of this size."""
    return int(min(9, max(0, math.ceil(-math.log10(step) + 0.3))))


def fixed(values, step, decimal="."):
    """Cells with as many decimals as a step needs; blank where there is no number."""
    n = digits(step)
    return ["" if v is None or v != v else f"{v:.{n}f}".replace(".", decimal) for v in values]


def exponents(values, decimal=".", places=6):
    return ["" if v != v else f"{v:.{places}E}".replace(".", decimal) for v in values]


def rows(columns, separator):
    return [separator.join(cells) for cells in zip(*columns)]


def encode(rng, lines, plain=False):
    """Bytes of a text with the line ends and marks that loggers write."""
    end = "\n" if plain or rng.random() < 0.75 else "\r\n"
    text = end.join(lines) + end
    mark = not plain and rng.random() < 0.1
    return text.encode("utf-8-sig" if mark else "utf-8")


def style(rng, comma=None):
    """Separator and decimal sign, as spreadsheets in many countries write them."""
    if comma is None:
        comma = rng.random() < 0.3
    return (pick(rng, [";", "\t"]), ",") if comma else (pick(rng, [",", ",", ";", "\t"]), ".")


def titled(rng, name, unit):
    """A title with its unit in one of the common ways."""
    if not unit:
        return name
    plain = {"°": "deg", "m/s²": "m/s^2"}.get(unit, unit)
    forms = [f"{name} ({unit})", f"{name} [{unit}]", f"{name} / {unit}"]
    if name.isascii() and "/" not in plain and "^" not in plain and " " not in name:
        forms.append(f"{name.lower()}_{plain}")
    return pick(rng, forms)


def quantity(rng, words, units=("rad", "deg", "°", "m", "cm", "mm")):
    """A name of the swinging quantity, its unit and the size of its swing."""
    unit = pick(rng, list(units))
    name = words[1] if unit in ("rad", "deg", "°") else "U" if unit in ("V", "mV") else words[int(rng.integers(2, 4))]
    return name, unit, SIZES[unit]


def time_cells(swing, t, decimal=".", unit="s"):
    scale = {"s": 1, "ms": 1e3}[unit]
    return fixed(t * scale, scale * 1e-3 / swing.rate, decimal)


def attainable(swing):
    """Standard errors of frequency and damping ratio that least squares on the samples of one such decay would reach."""
    t = numpy.arange(max(20, int(swing.cycles / swing.f * swing.rate))) / swing.rate
    w, h = 2 * math.pi * swing.f, 1e-4
    bend = [(free(t, swing.f * (1 + h * i), swing.z * (1 + h * j), swing.size, 0.0)[0] - free(t, swing.f * (1 - h * i), swing.z * (1 - h * j), swing.size, 0.0)[0])
            / (2 * h) for i, j in ((1, 0), (0, 1))]
    slopes = numpy.stack([*bend, free(t, swing.f, swing.z, 1.0, 0.0)[0] * swing.size, free(t, swing.f, swing.z, 0.0, w)[0] * swing.size, numpy.full(len(t), swing.size)])
    errors = swing.noise * numpy.sqrt(numpy.diag(numpy.linalg.pinv(slopes @ slopes.T)))
    return {"frequency_hz": float(errors[0] * swing.f), "damping_ratio": float(errors[1] * swing.z)}


def given(swing, **more):
    """The truth of a log."""
    return {"attainable_se": attainable(swing), "frequency_hz": swing.f, "damping_ratio": swing.z, "options": [], "accept": "number",
            "snr": swing.snr, "rate_hz": swing.rate, "cycles": swing.cycles, **more}


def table(rng, swing, titles, columns, steps, separator=None, decimal=None, top=()):
    """A text table; the first column is time."""
    if separator is None:
        separator, decimal = style(rng)
    cells = [time_cells(swing, columns[0], decimal)]
    cells += [fixed(c, s, decimal) for c, s in zip(columns[1:], steps)]
    quote = rng.random() < 0.2 and separator != "\t"
    head = separator.join(f'"{title}"' if quote else title for title in titles)
    return encode(rng, [*top, head, *rows(cells, separator)])


# 1. The observed column is the one that swings.

def axis(rng):
    u = rng.standard_normal(3)
    return u / numpy.linalg.norm(u)


def columns_tracker(rng):
    swing = Swing(rng, f=(0.2, 3), size=(0.02, 0.8), per=(12, 200))
    t = swing.times(uneven=False)
    x = swing.decay(t)
    length = 9.81 / (2 * math.pi * swing.f) ** 2
    length = max(length, 3 * swing.size)
    # The bob rises by x^2 / 2 L: the height swings a little at twice the frequency.
    y = -length + x**2 / (2 * length) + swing.hiss(len(t))
    x = x + swing.hiss(len(t)) + rng.uniform(-1, 1) * swing.size
    mass = {"de": "Masse A", "en": "mass A", "fr": "masse A"}[pick(rng, ["de", "en", "fr"])]
    separator, decimal = pick(rng, [("\t", "."), ("\t", ","), (",", "."), (";", ",")])
    top = [mass + 2 * separator] if rng.random() < 0.5 else []
    return ".txt", table(rng, swing, ["t", "x", "y"], [t, x, y], [swing.noise] * 2, separator, decimal, top), given(swing)


def columns_gyroscope(rng):
    swing = Swing(rng, f=(0.3, 10), size=(0.2, 6), per=(12, 200))
    t = swing.times(uneven=True) + rng.uniform(0, 0.1)
    v = swing.decay(t)
    about, wobble = axis(rng)[:, None], 0.0
    if rng.random() < 0.5:
        # Nearly about one axis; the other two see how the phone shakes.
        about = rng.permutation([1.0, *rng.uniform(-0.04, 0.04, 2)])[:, None]
        shake = rng.uniform(0.05, 0.25, (3, 1)) * (abs(about) < 0.5)
        wobble = shake * swing.size * numpy.sin(2 * math.pi * swing.f * rng.uniform(2.3, 6, (3, 1)) * t + rng.uniform(0, 6, (3, 1)))
    three = about * v + wobble + rng.uniform(-0.02, 0.02, (3, 1)) * swing.size + swing.hiss((3, len(t)))
    word = pick(rng, ["Gyroscope", "Rotation"])
    columns, names = list(three), [f"{word} {a} (rad/s)" for a in "xyz"]
    if rng.random() < 0.5:
        columns.append(numpy.linalg.norm(three, axis=0))
        names.append("Absolute (rad/s)")
    separator, decimal = pick(rng, [(",", "."), ("\t", "."), (";", "."), ("\t", ","), (";", ",")])
    head = separator.join(f'"{n}"' for n in ["Time (s)"] + names)
    return ".csv", encode(rng, [head, *rows([exponents(c, decimal, 9) for c in [t] + columns], separator)]), given(swing)


def columns_accelerometer(rng):
    swing = Swing(rng, f=(0.5, 40), size=(0.5, 8), per=(12, 100))
    t = swing.times(uneven=True)
    a = swing.decay(t)
    three = axis(rng)[:, None] * a + swing.hiss((3, len(t)))
    held = rng.random() < 0.5
    if held:
        three = three + 9.81 * axis(rng)[:, None]
    word = "Acceleration" if held else "Linear Acceleration"
    unit = pick(rng, ["m/s^2", "m/s²"])
    names = [f"{word} {x} ({unit})" for x in "xyz"]
    columns = list(three)
    if rng.random() < 0.5:
        columns.append(numpy.linalg.norm(three, axis=0))
        names.append(f"Absolute acceleration ({unit})")
    return ".csv", table(rng, swing, ["Time (s)"] + names, [t] + columns, [swing.noise] * len(columns)), given(swing)


def columns_attitude(rng):
    swing = Swing(rng, f=(0.2, 8), size=(3, 50), per=(12, 120))
    t, value = swing.log()
    names = ["roll", "pitch", "yaw"]
    place = int(rng.integers(3))
    columns = [swing.decay(t, swing.size * rng.uniform(0.005, 0.05)) + rng.uniform(-5, 5) + swing.hiss(len(t)) for _ in names]
    # The heading drifts.
    columns[2] = columns[2] + rng.uniform(-1, 1) * swing.size * t / t[-1]
    columns[place] = value
    names = [pick(rng, ["{}", "{}_deg", "{} (deg)", "{} [°]"]).format(n) for n in names]
    return ".csv", table(rng, swing, [pick(rng, ["time", "timestamp", "t_s"])] + names, [t] + columns, [swing.noise] * 3), given(swing)


def columns_decoy(rng):
    """A column with the right name that stands still or drifts, beside the one that swings."""
    name, unit, size = pick(rng, [("ch1", "V", (0.05, 5)), ("laser", "mm", (0.5, 50)), ("sensor", "", (0.1, 10)), ("encoder", "deg", (2, 60)),
                                  ("U_A1", "V", (0.05, 5)), ("signal", "", (0.1, 10)), ("AI0", "V", (0.05, 5))])
    swing = Swing(rng, size=size)
    t, value = swing.log()
    level = spread(rng, 0.1, 100)
    drift = pick(rng, [0.0, rng.uniform(-1, 1) * level])
    other = level + drift * t / t[-1] + pick(rng, [0.0, 0.002 * level]) * rng.standard_normal(len(t))
    titles, columns, steps = [titled(rng, name, unit)], [value], [swing.noise]
    at = int(rng.integers(2))
    titles.insert(at, pick(rng, ["angle", "position", "angle_deg", "position (mm)", "Position", "Angle (deg)"]))
    columns.insert(at, other)
    steps.insert(at, 0.001 * level)
    return ".csv", table(rng, swing, ["time_s"] + titles, [t] + columns, steps), given(swing)


def columns_temperature(rng):
    words = WORDS[pick(rng, list(WORDS))]
    name, unit, size = quantity(rng, words)
    if rng.random() < 0.4:
        name = pick(rng, ["ch2", "value", "signal", "sensor 1"])
    swing = Swing(rng, size=size)
    t, value = swing.log()
    warm = rng.uniform(18, 30) + rng.uniform(-3, 3) * t / t[-1] + 0.02 * rng.standard_normal(len(t))
    titles, columns, steps = [titled(rng, name, unit)], [value], [swing.noise]
    at = int(rng.integers(2))
    titles.insert(at, titled(rng, words[4], pick(rng, ["°C", "C", "degC"])))
    columns.insert(at, warm)
    steps.insert(at, 0.01)
    return ".csv", table(rng, swing, [titled(rng, words[0], "s")] + titles, [t] + columns, steps), given(swing)


# 2. Several runs in one file, each with its own time.

def runs(rng, names):
    """The runs of one system with rates and lengths of their own, side by side; `names` gives the two titles of a run."""
    swing = Swing(rng, size=(0.01, 0.5), f=(0.1, 20), cycles=(10, 50), rows=3000)
    count = int(rng.integers(2, 5))
    cells, head, rate = [], [], swing.rate
    separator, decimal = style(rng)
    for n in range(count):
        swing.rate = float(f"{max(12 * swing.f, rate * rng.uniform(0.4, 2.2)):.3g}")
        t, x = swing.log(cycles=max(8, swing.cycles * rng.uniform(0.5, 1.2)))
        cells += [time_cells(swing, t, decimal), fixed(x, swing.noise, decimal)]
        head += names(n, count)
    longest = max(map(len, cells))
    cells = [c + [""] * (longest - len(c)) for c in cells]
    options = ["--run", "2"] if rng.random() < 0.25 else []
    return ".csv", encode(rng, [separator.join(head), *rows(cells, separator)]), given(swing, options=options, runs=count)


def runs_pasco(rng):
    what = pick(rng, ["Position (m)", "Angle (rad)", "Displacement (m)"])
    return runs(rng, lambda n, count: [f"Time (s) Run #{n + 1}", f"{what} Run #{n + 1}"])


def runs_vernier(rng):
    what = pick(rng, ["Position (m)", "Angle (rad)", "Distance (m)"])

    def names(n, count):
        run = "Latest" if n == count - 1 else f"Run {n + 1}"
        return [f"{run}: Time (s)", f"{run}: {what}"]

    return runs(rng, names)


def runs_sheet(rng):
    t, x = pick(rng, [("t{}", "x{}"), ("t{} (s)", "x{} (m)"), ("t_{}", "phi_{}"), ("time {}", "angle {}")])
    return runs(rng, lambda n, count: [t.format(n + 1), x.format(n + 1)])


def runs_same(rng):
    pair = pick(rng, [["time_s", "x_m"], ["Time (s)", "Angle (rad)"], ["Zeit (s)", "Position (m)"], ["t", "x"]])
    return runs(rng, lambda n, count: list(pair))


# 3. A command at a lower rate than the position.

def follow(swing, t, when, command):
    """Position of a joint at t; command[k] holds from when[k] on. Closed form over each hold."""
    x, v, out = 0.0, 0.0, numpy.zeros(len(t))
    for k, level in enumerate(command):
        end = when[k + 1] if k + 1 < len(when) else numpy.inf
        inside = (t >= when[k]) & (t < end)
        out[inside] = swing.free(t[inside] - when[k], x - level, v)[0] + level
        if end < numpy.inf:
            x, v = swing.free(end - when[k], x - level, v)
            x += level
    return out


def command(rng, joined):
    swing = Swing(rng, f=(0.3, 8), z=(0.02, 0.4), per=(15, 150), cycles=(15, 60), size=(0.05, 1.0), snr=(30, 1000), rows=6000)
    t = swing.times(uneven=False)
    every = int(rng.integers(3, 16))
    if joined:
        # Stamps of a second topic: near an even rate, never on those of the position.
        when = (numpy.arange(len(t) // every) * every + rng.uniform(0.1, 0.9, len(t) // every)) / swing.rate
    else:
        when = t[::every].copy()
    hold = max(1, round(rng.uniform(0.5, 4) * swing.rate / swing.f / every))
    levels = numpy.repeat(rng.uniform(-1, 1, len(when) // hold + 1) * swing.size, hold)[: len(when)]
    if rng.random() < 0.7:
        levels[: min(hold, 3)] = 0.0
    levels = numpy.round(levels, 5)
    position = follow(swing, t, when, levels) + swing.hiss(len(t))
    names = pick(rng, [("cmd_pos (rad)", "joint_pos (rad)"), ("command_rad", "position_rad"), ("setpoint (rad)", "measured (rad)"),
                       ("/joint_cmd/position", "/joint_states/position"), ("target_pos", "present_pos"), ("Soll (rad)", "Ist (rad)")])
    blank = pick(rng, ["", "", "nan", "NaN"])
    if joined:
        stamps = numpy.concatenate([t, when])
        order = numpy.argsort(stamps, kind="stable")
        stamps = stamps[order]
        columns = [numpy.concatenate([numpy.full(len(t), numpy.nan), levels])[order],
                   numpy.concatenate([position, numpy.full(len(when), numpy.nan)])[order]]
    else:
        stamps = t
        wide = numpy.full(len(t), numpy.nan)
        wide[::every] = levels
        columns = [wide, position]
    at = slice(None) if rng.random() < 0.6 else slice(None, None, -1)
    cells = [time_cells(swing, stamps)] + [[c or blank for c in fixed(x, s)] for x, s in list(zip(columns, (1e-5, swing.noise)))[at]]
    head = ",".join([pick(rng, ["timestamp", "time_s", "__time"]), *names[at]])
    return ".csv", encode(rng, [head, *rows(cells, ",")]), given(swing, driven=True)


def command_blanks(rng):
    return command(rng, False)


def command_join(rng):
    return command(rng, True)


# 4. Records that a hand has touched.

def hermite(u, x, v):
    """From (x, v) at u = 0 to rest at u = 1."""
    return x * (2 * u**3 - 3 * u**2 + 1) + v * (u**3 - 2 * u**2 + u)


def handled_table(rng, swing, t, x, speed=False):
    words = WORDS[pick(rng, list(WORDS))]
    x = x + swing.hiss(len(t))
    if speed:
        return ".csv", table(rng, swing, ["Time (s)", f"Gyroscope {pick(rng, list('xyz'))} (rad/s)"], [t, x], [swing.noise]), given(swing)
    name, unit = pick(rng, [(words[1], "rad"), (words[3], "cm"), (words[2], "m")])
    return ".csv", table(rng, swing, [titled(rng, words[0], "s"), titled(rng, name, unit)], [t, x], [swing.noise]), given(swing)


def touched(rng, **more):
    return Swing(rng, f=(0.2, 10), per=(20, 200), cycles=(8, 40), snr=(20, 1000), z=(0.002, 0.05), **more)


def handled_lift(rng):
    swing = touched(rng)
    rest, lift, hold = (rng.uniform(a, b) / swing.f for a, b in ((1, 8), (0.3, 3), (0.5, 8)))
    t = numpy.arange(int((rest + lift + hold + swing.cycles / swing.f) * swing.rate)) / swing.rate
    up = swing.size * (0.5 - 0.5 * numpy.cos(math.pi * numpy.clip((t - rest) / lift, 0, 1)))
    let_go = rest + lift + hold
    x = numpy.where(t < let_go, up, swing.free(numpy.maximum(t - let_go, 0), swing.size, 0.0)[0])
    return handled_table(rng, swing, t, x)


def handled_hand(rng):
    """A hand moves the body, lets it go, and stops it."""
    swing = touched(rng)
    begin, end = rng.uniform(1, 8) / swing.f, rng.uniform(1, 8) / swing.f
    stop = rng.uniform(0.1, 0.5) / swing.f
    rates = rng.uniform(0.3, 1.5, 3) * 2 * math.pi * swing.f
    sizes = rng.uniform(-1, 1, 3)

    def hand(t):
        return numpy.sin(numpy.outer(t, rates)) @ sizes

    edge, h = numpy.array([begin]), 1e-6 / swing.f
    x0, v0 = hand(edge)[0], (hand(edge + h)[0] - hand(edge - h)[0]) / (2 * h)
    scale = swing.size / math.hypot(x0, v0 / (2 * math.pi * swing.f))
    # A hand that moves the body no further than twice the swing.
    peak = abs(hand(numpy.linspace(0, begin, 200))).max() * scale
    if peak > 2 * swing.size:
        scale *= 2 * swing.size / peak
    caught = begin + swing.cycles / swing.f
    t = numpy.arange(int((caught + end) * swing.rate)) / swing.rate
    loose = swing.free(numpy.maximum(t - begin, 0), x0 * scale, v0 * scale)[0]
    xe, ve = swing.free(caught - begin, x0 * scale, v0 * scale)
    held = hermite(numpy.clip((t - caught) / stop, 0, 1), xe, ve * stop)
    x = numpy.where(t < begin, hand(t) * scale, numpy.where(t < caught, loose, held))
    return handled_table(rng, swing, t, x, rng.random() < 0.4)


def handled_again(rng):
    """Struck again in the middle: the second swing is the larger one."""
    swing = touched(rng)
    first = swing.cycles * rng.uniform(0.35, 0.6) / swing.f
    t = swing.times(max(16, swing.cycles), uneven=False)
    x0, v0 = swing.start()
    xe, ve = swing.free(first, x0, v0)
    blow = swing.size * rng.uniform(1.2, 2.5) * 2 * math.pi * swing.f * pick(rng, [-1, 1])
    x = numpy.where(t < first, swing.free(t, x0, v0)[0], swing.free(numpy.maximum(t - first, 0), xe, blow)[0])
    return handled_table(rng, swing, t, x)


def handled_stop(rng):
    """A full stop by a brake, or by the damping, and a long rest after it."""
    swing = touched(rng)
    brake = rng.random() < 0.5
    free_part = swing.cycles / swing.f
    if not brake:
        swing.z = spread(rng, 0.015, 0.05)
        free_part = 6 / (2 * math.pi * swing.f * swing.z)
    t = numpy.arange(int(free_part * rng.uniform(1.3, 2.0) * swing.rate)) / swing.rate
    x0, v0 = swing.start()
    x = swing.free(t, x0, v0)[0]
    if brake:
        stop = rng.uniform(0.1, 0.4) / swing.f
        xe, ve = swing.free(free_part, x0, v0)
        x = numpy.where(t < free_part, x, hermite(numpy.clip((t - free_part) / stop, 0, 1), xe, ve * stop))
    return handled_table(rng, swing, t, x)


# 5. Codings of an angle.

def coded(rng, swing, t, values, title, step, **more):
    stamp = pick(rng, ["time_s", "timestamp", "Time (s)", "t"])
    return ".csv", table(rng, swing, [stamp, title], [t, values], [step]), given(swing, **more)


def wrapped(rng, turn, low, title, step_of_turn=None):
    """An angle of which only the part within one turn is written."""
    far = rng.random() < 0.25
    swing = Swing(rng, f=(0.1, 8), per=(60 if far else 20, 200), size=(1.0, 3.0) if far else (0.08, 0.45), snr=(50, 1000))
    t = swing.times()
    # Near the edge, so that it is crossed.
    rest = 0.5 + rng.uniform(-0.6, 0.6) * min(swing.size, 0.4)
    turns = rest + swing.decay(t) + swing.hiss(len(t))
    values = numpy.mod(turns * turn - low, turn) + low
    if step_of_turn:
        values = numpy.floor(values)
    step = 1 if step_of_turn else swing.noise * turn
    return coded(rng, swing, t, values, title, step, accept="number or message")


def codings_180(rng):
    # The edge lies half a turn from zero.
    return wrapped(rng, 360.0, -180.0, pick(rng, ["angle_deg", "yaw (deg)", "Winkel (°)", "heading_deg"]))


def codings_360(rng):
    swing = Swing(rng, f=(0.1, 8), per=(20, 200), size=(0.05, 0.4), snr=(50, 1000))
    t = swing.times()
    turns = rng.uniform(-0.6, 0.6) * swing.size + swing.decay(t) + swing.hiss(len(t))
    return coded(rng, swing, t, numpy.mod(turns * 360, 360), pick(rng, ["angle_deg", "azimuth (deg)", "Angle [°]"]), swing.noise * 360,
                 accept="number or message")


def codings_pi(rng):
    return wrapped(rng, 2 * math.pi, -math.pi, pick(rng, ["angle_rad", "theta (rad)", "yaw_rad", "theta"]))


def codings_modulo(rng):
    """Counts of an encoder with 2^10 to 2^16 a turn, whose zero is crossed."""
    bits = int(rng.integers(10, 17))
    counts = 2**bits
    swing = Swing(rng, f=(0.1, 8), per=(20, 200), size=(0.05, 0.4), snr=(50, 1000))
    t = swing.times()
    turns = rng.uniform(-0.6, 0.6) * swing.size + swing.decay(t) + swing.hiss(len(t))
    values = numpy.mod(numpy.floor(turns * counts), counts)
    return coded(rng, swing, t, values, pick(rng, ["counts", "encoder", "shoulder_lift.pos", "ticks", "present_position"]), 1,
                 accept="number or message", bits=bits)


def sixteen(rng, code):
    swing = Swing(rng, f=(0.1, 8), per=(15, 200), size=(200, 9000), snr=(50, 1000))
    t = swing.times()
    values = numpy.round(rng.uniform(-0.5, 0.5) * swing.size + swing.decay(t) + swing.hiss(len(t)))
    return coded(rng, swing, t, code(values), pick(rng, ["counts", "raw", "position", "shoulder_lift.pos", "adc"]), 1, accept="number or message")


def codings_sign(rng):
    return sixteen(rng, lambda v: numpy.where(v < 0, 32768 - v, v))


def codings_unsigned(rng):
    return sixteen(rng, lambda v: numpy.mod(v, 65536))


def codings_per_turn(rng):
    swing = Swing(rng, f=(0.1, 8), per=(15, 200), size=(0.02, 0.4), snr=(50, 1000))
    t, turns = swing.log()
    return coded(rng, swing, t, numpy.round((turns + 0.5) * 4096), pick(rng, ["counts", "encoder", "ticks", "shoulder_lift.pos"]), 1,
                 options=["--counts-per-turn", "4096"])


def codings_turns(rng):
    swing = Swing(rng, f=(0.05, 8), size=(0.02, 3))
    t, turns = swing.log()
    title = pick(rng, ["angle (turn)", "turns", "angle_turn", "rotation [turns]", "position (rev)", "revolutions"])
    return coded(rng, swing, t, turns, title, swing.noise)


def codings_torsion(rng):
    swing = Swing(rng, f=(0.05, 1), size=(400, 2500), snr=(50, 1000))
    t, angle = swing.log()
    return coded(rng, swing, t, angle, pick(rng, ["angle (deg)", "Winkel (°)", "angle_deg", "phi / °", "Angle [deg]"]), swing.noise)


# 6. Headers and containers.

def plain(rng, units=("rad", "deg", "m", "mm", "V"), **more):
    unit = pick(rng, list(units))
    swing = Swing(rng, size=SIZES[unit], rows=5000, **more)
    return swing, unit


def name_of(unit):
    return {"rad": "Angle", "deg": "Angle", "°": "Angle", "V": "Voltage", "mV": "Voltage"}.get(unit, "Position")


def even(swing):
    t = swing.times(uneven=False)
    return t, swing.decay(t) + swing.rng.uniform(-0.5, 0.5) * swing.size + swing.hiss(len(t))


def lvm(rng, stamped):
    swing, unit = plain(rng)
    t, x = even(swing)
    decimal = pick(rng, [".", ","])
    number = lambda v: f"{v:.16E}".replace(".", decimal)
    lines = ["LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", f"Decimal_Separator\t{decimal}",
             "Multi_Headings\tNo", f"X_Columns\t{'One' if stamped else 'No'}", "Time_Pref\tRelative", "Operator\tlab", "Date\t2021/05/11",
             f"Time\t10:12:31{decimal}5", "***End_of_Header***\t", "\t", "Channels\t1\t", f"Samples\t{len(t)}\t", "Date\t2021/05/11\t",
             f"Time\t10:12:31{decimal}5\t", f"Y_Unit_Label\t{unit}\t", "X_Dimension\tTime\t", f"X0\t{number(0.0)}\t",
             f"Delta_X\t{1 / swing.rate:.10E}\t".replace(".", decimal), "***End_of_Header***\t\t", "X_Value\tUntitled\tComment"]
    cells = fixed(x, swing.noise / 10, decimal)
    stamps = fixed(t, 1e-6, decimal) if stamped else [""] * len(t)
    return ".lvm", encode(rng, lines + [f"{a}\t{b}" for a, b in zip(stamps, cells)]), given(swing)


def headers_lvm_stamps(rng):
    return lvm(rng, True)


def headers_lvm_no_stamps(rng):
    return lvm(rng, False)


def headers_cassy_def(rng):
    swing, unit = plain(rng, ("°", "m", "V"))
    t, x = even(swing)
    symbol = {"°": "&a_A1", "m": "s_A1", "V": "U_A1"}[unit]
    decimal = pick(rng, [".", ","])
    far = f"{2 * swing.size:.3g}".replace(".", decimal)
    long = f"{t[-1]:.3g}".replace(".", decimal)
    if rng.random() < 0.5:
        top = [f"MIN\t0\t-{far}", f"MAX\t{long}\t{far}", "SCALE\t1\t1", "DEC\t3\t3", f"DEF\tt / s\t{symbol} / {unit}"]
    else:
        top = ["MIN=0", f"MAX={long}", "SCALE=1", "DEC=3", 'DEF="t / s"', f"MIN=-{far}", f"MAX={far}", "SCALE=1", "DEC=3",
               f'DEF="{symbol} / {unit}"', f"t / s\t{symbol} / {unit}"]
    return ".txt", encode(rng, top + rows([time_cells(swing, t, decimal), fixed(x, swing.noise, decimal)], "\t")), given(swing)


def headers_cassy_lines(rng):
    swing, unit = plain(rng, ("°", "m", "V"))
    t, x = even(swing)
    symbol = {"°": "α_A1", "m": "s_A1", "V": "U_A1"}[unit]
    decimal = pick(rng, [".", ","])
    columns = [fixed(numpy.arange(1, len(t) + 1), 1)] if rng.random() < 0.3 else []
    head = (["n"] if columns else []) + ["t / s", f"{symbol} / {unit}"]
    return ".txt", encode(rng, ["\t".join(head), *rows(columns + [time_cells(swing, t, decimal), fixed(x, swing.noise, decimal)], "\t")]), given(swing)


def headers_picoscope(rng):
    swing, unit = plain(rng, ("V", "mV"))
    t, x = even(swing)
    fine = rng.random() < 0.5
    separator, decimal, names = pick(rng, [(",", ".", "Time,Channel A"), (";", ",", "Zeit;Kanal A"), ("\t", ".", "Time\tChannel A")])
    scale = 1e3 if fine else 1.0
    lines = [names, f"({'ms' if fine else 's'}){separator}({unit})", ""]
    return ".csv", encode(rng, lines + rows([fixed(t * scale, scale * 1e-4 / swing.rate, decimal), fixed(x, swing.noise, decimal)], separator)), given(swing)


def headers_rigol(rng):
    swing, _ = plain(rng, ("V",))
    t, x = even(swing)
    head = ["X,CH1,Start,Increment,", f"Sequence,Volt,{-t[-1] / 2:.6e},{1 / swing.rate:.6e}"]
    cells = exponents(x, places=max(2, digits(swing.noise / swing.size)))
    return ".csv", encode(rng, head + [f"{n},{c.lower()}," for n, c in enumerate(cells)]), given(swing)


def headers_tektronix(rng):
    """The columns on the left of the first lines hold what the scope was set to."""
    swing, _ = plain(rng, ("V",))
    t, x = even(swing)
    t = t - t[len(t) // 10]
    data = rows([[f"{v:+.9f}" for v in t], [f"{v:.6f}" for v in x]], ",")
    facts = [("Record Length", f"{len(t):.6e}"), ("Sample Interval", f"{1 / swing.rate:.6e}"), ("Trigger Point", f"{len(t) // 10:.6e}"),
             ("", ""), ("", ""), ("", ""), ("Source", "CH1"), ("Vertical Units", "V"), ("Vertical Scale", f"{swing.size / 2:.6e}"),
             ("Vertical Offset", "0.000000e+00"), ("Horizontal Units", "s"), ("Horizontal Scale", f"{t[-1] / 10:.6e}"), ("Pt Fmt", "Y"),
             ("Yzero", "0.000000e+00"), ("Probe Atten", "1.000000e+00"), ("Model Number", "TDS2014B"), ("Serial Number", "C030455"),
             ("Firmware Version", "FV:v22.01")]
    facts += [("", "")] * (len(data) - len(facts))
    lines = [f"{name},{value},,{line}," for (name, value), line in zip(facts, data)]
    return ".csv", encode(rng, lines), given(swing)


def headers_scope_block(rng):
    """A newer scope: its settings in lines of their own, then TIME,CH1."""
    swing, _ = plain(rng, ("V",))
    t, x = even(swing)
    top = ["Model,TBS1052B", "Firmware Version,v4.06", "", "Point Format,Y,", "Horizontal Units,S,", f"Horizontal Scale,{t[-1] / 10:.6g},",
           f"Sample Interval,{1 / swing.rate:.6g},", f"Record Length,{len(t)},", "Vertical Units,V,", "Label,,", "TIME,CH1"]
    return ".csv", encode(rng, top + rows([[f"{v:.8f}" for v in t], [f"{v:.6f}" for v in x]], ",")), given(swing)


def headers_lecroy(rng):
    """Facts with more cells than the samples, above the names."""
    swing, _ = plain(rng, ("V",))
    t, x = even(swing)
    lines = ["LECROYWS434,54321,Waveform", f"Segments,1,SegmentSize,{len(t)}", "Segment,TrigTime,TimeSinceSegment1",
             "#1,12-Oct-2026 10:11:12,0", "Time,Ampl"]
    return ".csv", encode(rng, lines + rows([exponents(t - t[len(t) // 20], places=9), fixed(x, swing.noise)], ",")), given(swing)


def headers_counted(rng):
    """Numbers of the samples in place of their times; a few samples are missing."""
    swing, unit = plain(rng)
    t, x = even(swing)
    kept = rng.random(len(t)) > rng.uniform(0.005, 0.03)
    kept[0] = True
    name = pick(rng, ["frame", "sample", "Index", "n", "Frame no."])
    cells = [[str(n) for n in numpy.flatnonzero(kept) + int(rng.integers(200))], fixed(x[kept], swing.noise)]
    return ".csv", encode(rng, [f"{name},{name_of(unit)} ({unit})", *rows(cells, ",")]), given(swing, options=["--sample-rate", f"{swing.rate:g}"])


def headers_daq(rng):
    """Title, date, names, units."""
    swing, unit = plain(rng)
    t, x = even(swing)
    separator, decimal = style(rng)
    title, day, names = pick(rng, [("Pendulum test 3", "2023-06-14 09:41:07", ["Time", name_of(unit)]),
                                   ("Messung Drehpendel 2", "14.06.2023 09:41:07", ["Zeit", {"Angle": "Winkel", "Voltage": "Spannung"}.get(name_of(unit), "Weg")]),
                                   ("Essai de balancier", "14/06/2023 09:41", ["Temps", {"Angle": "Angle", "Voltage": "Tension"}.get(name_of(unit), "Position")])])
    mark = pick(rng, ["{}", "({})", "[{}]"])
    lines = [title, day, separator.join(names), separator.join(mark.format(u) for u in ("s", unit))]
    return ".csv", encode(rng, lines + rows([time_cells(swing, t, decimal), fixed(x, swing.noise, decimal)], separator)), given(swing)


def headers_units_row(rng):
    """Names and units in rows of their own, with blanks between."""
    swing, unit = plain(rng)
    t, x = even(swing)
    other = 0.01 * swing.size * rng.standard_normal(len(t))
    top = pick(rng, [[], ["", "These results were made by a simulation of a floating platform", ""]])
    width = 14
    lines = ["".join(c.rjust(width) for c in cells) for cells in (["Time", name_of(unit), "Wave"], ["(s)", f"({unit})", "(m)"])]
    body = ["".join(c.rjust(width) for c in cells) for cells in zip(time_cells(swing, t), exponents(x), exponents(other))]
    return pick(rng, [".out", ".txt"]), encode(rng, top + lines + body), given(swing)


def headers_tabs(rng):
    swing, unit = plain(rng)
    t, x = even(swing)
    words = WORDS[pick(rng, list(WORDS))]
    name = words[1] if unit in ("rad", "deg") else words[2]
    titles = [titled(rng, words[0], "s"), titled(rng, name, unit)]
    return ".txt", table(rng, swing, titles, [t, x], [swing.noise], "\t", "."), given(swing)


def headers_semicolons(rng):
    swing, unit = plain(rng)
    t, x = even(swing)
    words = WORDS[pick(rng, list(WORDS))]
    name = words[1] if unit in ("rad", "deg") else words[2]
    titles = [titled(rng, words[0], "s"), titled(rng, name, unit)]
    return ".csv", table(rng, swing, titles, [t, x], [swing.noise], ";", pick(rng, [".", ","])), given(swing)


def headers_none_two(rng):
    swing, _ = plain(rng)
    t, x = even(swing)
    separator = pick(rng, [" ", "\t", ",", ";"])
    return ".txt", encode(rng, rows([time_cells(swing, t), fixed(x, swing.noise)], separator)), given(swing)


def headers_none_three(rng):
    """Three columns without names; the third is a velocity or a setting that stays."""
    swing, _ = plain(rng)
    t = swing.times(uneven=False)
    x, v = swing.free(t, *swing.start())
    w = 2 * math.pi * swing.f
    third = v + w * swing.hiss(len(t)) if rng.random() < 0.5 else numpy.full(len(t), 1.5)
    cells = [time_cells(swing, t), fixed(x + swing.hiss(len(t)), swing.noise), fixed(third, swing.noise * min(w, 1))]
    return ".txt", encode(rng, rows(cells, pick(rng, [" ", "\t", ","]))), given(swing)


def headers_none_one(rng):
    swing, _ = plain(rng)
    t, x = even(swing)
    return ".txt", encode(rng, fixed(x, swing.noise)), given(swing, options=["--sample-rate", f"{swing.rate:g}"])


def headers_serial(rng):
    """Arduino's serial monitor: wall clock, arrow, milliseconds and volts."""
    swing = Swing(rng, f=(0.2, 8), size=(0.1, 2), rows=4000, per=(12, 100))
    swing.rate = max(1.0, 1000 / max(1, round(1000 / swing.rate)))
    t, x = even(swing)
    stamps = []
    for v in t:
        second = 43200.5 + v + 0.002
        stamps.append(f"{int(second // 3600):02d}:{int(second // 60) % 60:02d}:{second % 60:06.3f}")
    lines = [f"{s} -> {round(v * 1000)}, {c}" for s, v, c in zip(stamps, t, fixed(x + 2.0, swing.noise))]
    return ".txt", encode(rng, lines), given(swing)


def headers_comma(rng):
    swing, unit = plain(rng)
    t, x = even(swing)
    return ".csv", table(rng, swing, ["Zeit in s", f"{pick(rng, ['Messwert', {'rad': 'Winkel', 'deg': 'Winkel', 'V': 'Spannung'}.get(unit, 'Weg')])} in {unit}"], [t, x], [swing.noise],
                         pick(rng, [";", "\t"]), ","), given(swing)


def packed(array):
    out = io.BytesIO()
    numpy.save(out, array)
    return out.getvalue()


def headers_npy(rng):
    swing, _ = plain(rng)
    t, x = even(swing)
    form = pick(rng, ["pairs", "long", "named", "one"])
    options = []
    if form == "pairs":
        array = numpy.stack([t, x], axis=1)
    elif form == "long":
        array = numpy.stack([t, x]).astype(pick(rng, [numpy.float64, numpy.float32]) if t[-1] * swing.rate < 2000 else numpy.float64)
    elif form == "named":
        array = numpy.zeros(len(t), dtype=[("time_s", "f8"), ("angle_rad", "f4")])
        array["time_s"], array["angle_rad"] = t, x
    else:
        array, options = x.astype(pick(rng, [numpy.float64, numpy.float32])), ["--sample-rate", f"{swing.rate:g}"]
    return ".npy", packed(array), given(swing, options=options, form=form)


def headers_npz(rng):
    swing, _ = plain(rng)
    t, x = even(swing)
    names = pick(rng, [("t", "x"), ("time", "angle"), ("time_s", "angle_rad"), ("t", "theta")])
    out = io.BytesIO()
    pick(rng, [numpy.savez, numpy.savez_compressed])(out, **dict(zip(names, (t, x))))
    return ".npz", out.getvalue(), given(swing)


def headers_wav(rng):
    swing = Swing(rng, f=(2, 40), per=(20, 400), snr=(20, 1000), size=(0.1, 0.75))
    swing.rate = float(max(16, round(swing.rate)))
    t = swing.times(uneven=False)
    x = swing.decay(t) + swing.hiss(len(t))
    out = io.BytesIO()
    with wave.open(out, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(int(swing.rate))
        file.writeframes(numpy.clip(numpy.round(x * 32767), -32768, 32767).astype("<i2").tobytes())
    return ".wav", out.getvalue(), given(swing)


def headers_json_records(rng):
    swing, _ = plain(rng)
    t, x = even(swing)
    names = pick(rng, [("t", "x"), ("time", "angle"), ("time_s", "angle_rad"), ("timestamp", "value")])
    n = digits(swing.noise)
    records = [{names[0]: round(float(a), 7), names[1]: round(float(b), n)} for a, b in zip(t, x)]
    if rng.random() < 0.3:
        return ".jsonl", encode(rng, [json.dumps(r) for r in records], plain=True), given(swing)
    return ".json", json.dumps(records).encode(), given(swing)


def headers_json_columns(rng):
    swing, _ = plain(rng)
    t, x = even(swing)
    names = pick(rng, [("t", "x"), ("time", "angle"), ("time_s", "angle_rad")])
    n = digits(swing.noise)
    columns = {names[0]: [round(float(v), 7) for v in t], names[1]: [round(float(v), n) for v in x]}
    if rng.random() < 0.3:
        columns = {"device": "pendulum 2", "data": columns}
    return ".json", json.dumps(columns).encode(), given(swing)


def headers_phyphox_folder(rng):
    ending, log, truth = columns_gyroscope(rng)
    files = {"Raw Data.csv": log,
             "meta/device.csv": b'"property","value"\n"version","1.1.11"\n"deviceModel","Pixel 6"\n',
             "meta/time.csv": b'"event","experiment time","system time","system time text"\n"START",0.000000000E0,1686728467.123,"2023-06-14 09:41:07.123 UTC+02:00"\n'}
    if rng.random() < 0.5:
        lag = numpy.arange(200) * 0.05
        curve = numpy.cos(2 * math.pi * truth["frequency_hz"] * lag) * (1 - lag / 12)
        files["Autocorrelation.csv"] = encode(rng, ['"Time (s)","Autocorrelation ()"', *rows([exponents(lag), exponents(curve)], ",")])
    return "", files, truth


# 7. Several modes.

def modal(rng, far, third=False):
    """Two or three modes: the record is their sum. The first is the largest one."""
    swing = Swing(rng, f=(0.2, 15), z=(0.001, 0.02), per=(25, 200), cycles=(25, 60), snr=(50, 1000), size=(0.03, 1.0))
    if far:
        ratio = pick(rng, [spread(rng, 1.6, 5), 1 / spread(rng, 1.6, 3)])
        second_size, z = rng.uniform(0.15, 0.7), spread(rng, 0.001, 0.02)
    else:
        # At least two beats in the record.
        ratio = 1 + rng.uniform(max(0.03, 2 / swing.cycles), 0.15)
        second_size, z = rng.uniform(0.5, 1.0), swing.z * rng.uniform(0.6, 1.6)
    f = swing.f * ratio
    modes = [(swing.f, swing.z, swing.size), (f, z, second_size * swing.size)]
    if third:
        modes.append((max(f, swing.f) * rng.uniform(1.5, 2.5), spread(rng, 0.001, 0.02), rng.uniform(0.15, 0.5) * swing.size))
    swing.rate = float(f"{max(swing.rate, 14 * max(g for g, _, _ in modes)):.3g}")
    t = swing.times(uneven=False)
    start = pick(rng, [(1, 0), (0, 1)])
    parts = [free(t, g, d, size * start[0], size * start[1] * 2 * math.pi * g)[0] for g, d, size in modes]
    columns, titles = [sum(parts) + swing.hiss(len(t))], ["angle_rad"]
    if not far and rng.random() < 0.5:
        columns.append(parts[0] - parts[1] + swing.hiss(len(t)))
        titles = ["angle 1 (rad)", "angle 2 (rad)"]
    modes = [{"frequency_hz": g, "damping_ratio": d} for g, d, _ in modes]
    return ".csv", table(rng, swing, ["time_s"] + titles, [t] + columns, [swing.noise] * len(columns)), given(swing, modes=modes, accept="number or message" if len(columns) == 2 else "number")


def modes_beating(rng):
    return modal(rng, False)


def modes_apart(rng):
    return modal(rng, True)


def modes_three(rng):
    return modal(rng, True, True)


# 8. Dampings and thin data.

def slow(rng, z, step):
    """A return or a step that hardly oscillates: a few of its slow time constants."""
    swing = Swing(rng, z=z, snr=(50, 1000), size=SIZES["deg"])
    w = 2 * math.pi * swing.f
    decay = w * (swing.z - math.sqrt(swing.z**2 - 1)) if swing.z > 1 else w * swing.z
    length = rng.uniform(5, 9) / decay
    n = int(spread(rng, 120, 2000))
    swing.rate = float(f"{n / length:.3g}")
    t = numpy.arange(n) / swing.rate
    swing.cycles = t[-1] * swing.f
    lead = rng.uniform(0.05, 0.2) * length if step and rng.random() < 0.3 else 0.0
    x = swing.free(numpy.maximum(t - lead, 0), -swing.size if step else swing.size, 0.0)[0]
    if step:
        x = x + swing.size * rng.uniform(1.0, 1.5)
    words = WORDS[pick(rng, list(WORDS))]
    titles = [titled(rng, words[0], "s"), titled(rng, words[1], pick(rng, ["deg", "°"]))]
    return ".csv", table(rng, swing, titles, [t, x + swing.hiss(n)], [swing.noise]), given(swing, accept="number or message")


def dampings_over(rng):
    return slow(rng, (1.1, 2.0), rng.random() < 0.3)


def dampings_critical(rng):
    return slow(rng, pick(rng, [(1.0, 1.0), (0.5, 1.1)]), rng.random() < 0.3)


def dampings_step(rng):
    ending, log, truth = slow(rng, (0.1, 0.8), True)
    return ending, log, {**truth, "accept": "number"}


def simple(rng, **more):
    words = WORDS[pick(rng, list(WORDS))]
    name, unit, size = quantity(rng, words)
    swing = Swing(rng, size=size, **more)
    t, x = swing.log()
    return ".csv", table(rng, swing, [titled(rng, words[0], "s"), titled(rng, name, unit)], [t, x], [swing.noise]), given(swing)


def dampings_dozen(rng):
    return simple(rng, per=(11, 13))


def dampings_three(rng):
    """Three turning points and no more: half a swing between two of them."""
    return simple(rng, cycles=(1.5, 1.75), z=(0.01, 0.2), per=(30, 300), snr=(30, 1000))


def dampings_noisy(rng):
    return simple(rng, snr=(7.9, 8.1))


# 9. Strikes of a hammer.

def strike(rng, count, strikes):
    """A rest, then strikes of a hammer with one to three modes, each of which decays into the noise."""
    swing = Swing(rng, f=(2, 60), z=(0.004, 0.03), per=(12, 60), snr=(30, 300), size=(0.05, 5))
    modes = [(swing.f, swing.z, 1.0)]
    for _ in range(count - 1):
        modes.append((max(f for f, _, _ in modes) * rng.uniform(1.35, 2.5), spread(rng, 0.004, 0.03), rng.uniform(0.25, 0.8)))
    swing.rate = float(f"{max(swing.rate, 12 * max(f for f, _, _ in modes)):.3g}")
    longest = max(1 / (2 * math.pi * f * z) for f, z, _ in modes)
    length = min(math.log(swing.snr) * rng.uniform(0.8, 1.3) * longest, 20000 / strikes / swing.rate)
    rest = rng.uniform(0.05, 0.3) * length
    swing.cycles = length * swing.f
    times = rest + numpy.concatenate([[0.0], numpy.cumsum(length * rng.uniform(0.7, 1.2, strikes - 1))])
    t = numpy.arange(int((times[-1] + length) * swing.rate)) / swing.rate
    acceleration = rng.random() < 0.5
    x = numpy.zeros(len(t))
    for at in times:
        blow = rng.uniform(0.6, 1.0) if at > rest else 1.0
        for f, z, size in modes:
            w = 2 * math.pi * f
            # An impulse starts every mode at its rest with a velocity.
            own, speed = free(numpy.maximum(t - at, 0), f, z, 0.0, blow * size * swing.size * w)
            x += numpy.where(t >= at, (-w * w * own - 2 * z * w * speed) / w**2 if acceleration else own, 0.0)
    unit = pick(rng, ["m/s^2", "g"]) if acceleration else pick(rng, ["mm", "V"])
    name = {"mm": "Displacement", "V": "Ch1"}.get(unit, "Acceleration")
    all_modes = [{"frequency_hz": f, "damping_ratio": z} for f, z, _ in modes]
    more = {"modes": all_modes} if count > 1 else {}
    log = table(rng, swing, ["Time (s)", f"{name} ({unit})"], [t, x + swing.hiss(len(t))], [swing.noise])
    return ".csv", log, given(swing, strikes=strikes, **more)


def strikes_one(rng):
    return strike(rng, 1, int(rng.integers(1, 4)))


def strikes_two(rng):
    return strike(rng, 2, int(rng.integers(1, 4)))


def strikes_three(rng):
    return strike(rng, 3, int(rng.integers(1, 4)))


# 10. Something beside a swing, or only its size.

def beside_hum(rng):
    """The mains hum at a constant amplitude."""
    swing = Swing(rng, f=(1, 25), z=(0.003, 0.05), cycles=(15, 60), snr=(30, 1000), size=SIZES["V"])
    swing.rate = float(f"{max(swing.rate, rng.uniform(220, 900)):.3g}")
    t = swing.times(uneven=False)
    line = pick(rng, [50.0, 60.0]) * (1 + rng.uniform(-1e-3, 1e-3))
    x = swing.decay(t) + rng.uniform(0.03, 0.4) * swing.size * numpy.sin(2 * math.pi * line * t + rng.uniform(0, 6)) + swing.hiss(len(t))
    return ".csv", table(rng, swing, ["Time (s)", "CH1 (V)"], [t, x], [swing.noise]), given(swing, hum_hz=line)


def beside_motor(rng):
    """A motor that runs beside the swing, at 1.15 to 3 times its frequency."""
    swing = Swing(rng, f=(1, 25), z=(0.003, 0.03), per=(25, 200), cycles=(25, 60), snr=(50, 1000), size=SIZES["mm"])
    t = swing.times(uneven=False)
    line = swing.f * rng.uniform(1.15, 3)
    x = swing.decay(t) + rng.uniform(0.03, 0.3) * swing.size * numpy.sin(2 * math.pi * line * t + rng.uniform(0, 6)) + swing.hiss(len(t))
    return ".csv", table(rng, swing, ["time_s", "disp_mm"], [t, x], [swing.noise]), given(swing, motor_hz=line)


def beside_magnitude(rng):
    """Only the absolute value of a vector was exported: its own noise is positive too."""
    swing = Swing(rng, f=(0.3, 5), z=(0.002, 0.05), per=(40, 200), cycles=(12, 60), snr=(30, 1000), size=(0.2, 6))
    t = swing.times(uneven=False)
    three = axis(rng)[:, None] * swing.decay(t) + swing.hiss((3, len(t)))
    title = pick(rng, ["Absolute velocity (rad/s)", "Absolute (rad/s)", "gyro_abs_rad_s"])
    return ".csv", table(rng, swing, ["Time (s)", title], [t, numpy.linalg.norm(three, axis=0)], [swing.noise]), given(swing, accept="number or message")


def beside_rectified(rng):
    """A sensor that writes the absolute value of its signal."""
    swing = Swing(rng, f=(0.3, 20), z=(0.002, 0.05), per=(40, 200), cycles=(12, 60), snr=(30, 1000), size=SIZES["V"])
    t = swing.times(uneven=False)
    return ".csv", table(rng, swing, ["t_s", "signal (V)"], [t, numpy.abs(swing.decay(t)) + swing.hiss(len(t))], [swing.noise]), given(swing, accept="number or message")


def variants(kind):
    """The functions of a kind, in the order of this file."""
    return [(name[len(kind) + 1:], work) for name, work in globals().items() if name.startswith(kind + "_")
            and callable(work) and name != "handled_table"]


def slots():
    """The kinds in turn, spread evenly over the slots."""
    places = [((i + 0.5) / share, kind) for kind, share in SHARES.items() for i in range(share)]
    return [kind for _, kind in sorted(places)]


def write(path, content):
    if isinstance(content, dict):
        for name, part in content.items():
            write(path / name, part)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def make(out, seed, number):
    order = slots()
    kind = order[number % len(order)]
    turn = order[: number % len(order)].count(kind) + number // len(order) * SHARES[kind]
    works = variants(kind)
    variant, work = works[turn % len(works)]
    ending, content, truth = work(numpy.random.default_rng([seed, number]))
    name = f"{number:04d}"
    write(out / "logs" / (name + ending), content)
    truth = {"kind": kind, "variant": variant, "log": name + ending, **truth}
    (out / "truth" / f"{name}.json").write_text(json.dumps(truth, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    (chosen.out / "truth").mkdir(parents=True, exist_ok=True)
    for number in range(chosen.count):
        make(chosen.out, chosen.seed, number)


if __name__ == "__main__":
    main()
