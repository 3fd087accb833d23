"""Sizes of effects in noise floors: what no recalibration absorbs, over the noise.

An effect's torque along the motion goes through the linear oscillator nearest to the motion. From that response whatever
inertia (driven), damping, stiffness, rest angle (shared by all records) and the start of each six-period segment absorb to
first order is taken away by least squares. The RMS of what stays, over the RMS of the noise, is the size.
"""

import numpy
from scipy.linalg import expm
from scipy.signal import lfilter

SEGMENT_PERIODS = 6.0


class Tangent:
    """What recalibration moves, about a motion: `positions`, `velocities`, `accelerations` by record on grids of one step."""

    def __init__(self, step, rest, positions, velocities, accelerations, drives, keep, square, damping):
        self.step, self.keep = step, keep
        # The linear oscillator nearest to the motion, by its equation.
        d = numpy.concatenate(positions) - rest
        v = numpy.concatenate(velocities)
        a = numpy.concatenate(accelerations) - numpy.concatenate(drives)
        columns = numpy.stack([-d, -v, numpy.ones_like(d)], axis=1)
        norms = numpy.linalg.norm(columns, axis=0)
        (self.square, self.damping, _) = numpy.linalg.lstsq(columns / norms, a, rcond=None)[0] / norms
        if not self.square > 0.05 * square:
            self.square = square
        self.damping = min(max(self.damping, 0.1 * damping), 0.5 * numpy.sqrt(self.square))
        self.filters()
        driven = any(numpy.any(drive) for drive in drives)
        self.lengths = [len(position) for position in positions]
        shared = [[p - rest for p in positions], velocities, [numpy.ones_like(p) for p in positions]]
        if driven:
            shared.append(accelerations)
        self.shared = [self.response(torque) for torque in shared]
        segment = SEGMENT_PERIODS * 2 * numpy.pi / numpy.sqrt(self.square)
        self.segments = []
        offset = 0
        for length in self.lengths:
            kept = numpy.arange(0, length, keep)
            count = max(1, int(round((length - 1) * step / segment)))
            edges = numpy.linspace(0, len(kept), count + 1).round().astype(int)
            self.segments += [(offset + low, offset + high) for low, high in zip(edges[:-1], edges[1:]) if high - low > 3]
            offset += len(kept)
        self.bases = {high - low: self.basis(high - low) for low, high in self.segments}
        self.columns = numpy.stack([self.within(column) for column in self.shared], axis=1)
        self.columns /= numpy.maximum(numpy.linalg.norm(self.columns, axis=0), 1e-300)

    def filters(self):
        """The response to a torque that is linear between samples (first-order hold), as a filter."""
        h = self.step
        block = numpy.zeros((4, 4))
        block[0, 1] = 1.0
        block[1, 0], block[1, 1], block[1, 2] = -self.square, -self.damping, 1.0
        block[2, 3] = 1.0 / h
        phi = expm(block * h)
        a, g0, g1 = phi[:2, :2], phi[:2, 2], phi[:2, 3]
        # x[n+1] = a x[n] + b0 u[n] + b1 u[n+1], of which the position's row of (zI - a)^-1 (b0 + b1 z).
        b0, b1 = g0 - g1, g1
        self.denominator = numpy.array([1.0, -numpy.trace(a), numpy.linalg.det(a)])
        self.numerator = numpy.array([
            b1[0],
            b0[0] - a[1, 1] * b1[0] + a[0, 1] * b1[1],
            a[0, 1] * b0[1] - a[1, 1] * b0[0],
        ])

    def response(self, torques):
        """Positions at the samples that are kept, of all records in a row."""
        return numpy.concatenate([lfilter(self.numerator, self.denominator, torque)[:: self.keep] for torque in torques])

    def basis(self, length):
        t = numpy.arange(length) * self.step * self.keep
        decay = 0.5 * self.damping
        omega = numpy.sqrt(max(self.square - decay**2, 1e-12))
        columns = numpy.stack([numpy.cos(omega * t), numpy.sin(omega * t)], axis=1) * numpy.exp(-decay * t)[:, None]
        return numpy.linalg.qr(columns)[0]

    def within(self, series):
        """A series without what the starts of the segments absorb."""
        parts = []
        for low, high in self.segments:
            part, basis = series[low:high], self.bases[high - low]
            parts.append(part - basis @ (basis.T @ part))
        return numpy.concatenate(parts)

    def left(self, series, rest_is_absorbed=True):
        """What stays of a series of positions."""
        part = self.within(series)
        columns = self.columns if rest_is_absorbed else numpy.delete(self.columns, 2, axis=1)
        return part - columns @ numpy.linalg.lstsq(columns, part, rcond=1e-10)[0]

    def least(self, series, others):
        """RMS of what stays of a series when others may take from it too."""
        part = self.left(series)
        columns = numpy.stack([self.left(other) for other in others], axis=1)
        columns /= numpy.maximum(numpy.linalg.norm(columns, axis=0), 1e-300)
        return rms(part - columns @ numpy.linalg.lstsq(columns, part, rcond=1e-10)[0])


def rms(values):
    return float(numpy.sqrt(numpy.mean(numpy.square(values))))
