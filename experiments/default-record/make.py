"""Makes record.csv, the simulated record that the default configurations run on.

A free decay of an oscillator with viscous damping, dry friction and air drag, seen through a measuring
chain like that of a cheap pendulum rig: a 12-bit encoder read at 259.6 Hz, whose samples reach the
logger in bursts about 62 ms apart and get the logger's time, rounded to a millisecond.

Run it with any Python 3, no packages needed:

    python3 experiments/default-record/make.py > experiments/default-record/record.csv
"""

import math
import random

# The oscillator, per unit of inertia.
OMEGA = 21.75  # rad/s
VISCOUS = 0.22  # 1/s: the torque per speed
FRICTION = 0.0004  # rad: dry friction's torque over the stiffness
DRAG = 0.010  # 1/rad: the torque per speed squared
RELEASE = 0.60  # rad from the rest angle
REST = 0.03  # rad

# The measuring chain.
RATE = 259.6  # Hz
DURATION = 29.3  # s
STEP = 2 * math.pi / 4096  # rad
NOISE = 3e-4  # rad
BURST = 0.062  # s

SUBSTEPS = 16


def acceleration(angle, speed):
    spring = -OMEGA**2 * angle
    loss = -VISCOUS * speed - DRAG * speed * abs(speed)
    friction = FRICTION * OMEGA**2
    if speed == 0.0:
        # At rest friction holds against any smaller torque.
        return math.copysign(max(abs(spring) - friction, 0.0), spring)
    return spring + loss - math.copysign(friction, speed)


def advance(angle, speed, step):
    """One step of the classical Runge-Kutta method; friction stops the motion, it never reverses it."""
    a1 = acceleration(angle, speed)
    a2 = acceleration(angle + step / 2 * speed, speed + step / 2 * a1)
    a3 = acceleration(angle + step / 2 * (speed + step / 2 * a1), speed + step / 2 * a2)
    a4 = acceleration(angle + step * (speed + step / 2 * a2), speed + step * a3)
    new_angle = angle + step * speed + step**2 / 6 * (a1 + a2 + a3)
    new_speed = speed + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    if speed * new_speed < 0 and abs(OMEGA**2 * new_angle) < FRICTION * OMEGA**2:
        new_speed = 0.0
    return new_angle, new_speed


def main():
    draw = random.Random(20251)
    count = int(DURATION * RATE)
    angle, speed = RELEASE, 0.0
    print("# origin: simulated (experiments/default-record/make.py)")
    print("# A free decay, made by a program: no sensor was involved.")
    print("time_s,angle_rad")
    arrival = BURST
    for sample in range(count):
        time = sample / RATE
        while time > arrival:
            arrival += BURST + draw.uniform(-0.004, 0.004)
        seen = STEP * round((angle + REST + draw.gauss(0.0, NOISE)) / STEP)
        print(f"{100 + arrival:.3f},{seen:.6f}")
        for _ in range(SUBSTEPS):
            angle, speed = advance(angle, speed, 1 / (RATE * SUBSTEPS))


if __name__ == "__main__":
    main()
