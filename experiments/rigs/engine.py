"""The same motions by MuJoCo, where it has what a case needs: dry friction by its soft constraint, springs, drag, weight and second
body by its own joints and bodies, and every further law without a hidden state by its passive force."""

import math

import mujoco
import numpy

from laws import Unlisted
from motion import (
    CONTACT, COULOMB, CUBIC, DAMPING, DRAG, GAIN, LEAN, LIMIT, QUADRATIC, REST, SECOND, SECOND_DAMPING, SECOND_SQUARE,
    SQUARE, STATES, WEIGHT, smooth,
)

VERSION = mujoco.__version__
HIDDEN = {"stribeck_friction", "hysteresis", "lugre", "maxwell", "bouc_wen", "input_delay"}
# Largest steps to try, in units of 1/ω, and most steps of a case, of which those with a passive force
# written in Python cost the more.
PHASES, STEPS, PASSIVE_STEPS = (0.03, 0.01), 200_000, 40_000
LEVER = 0.01


def motions(case, phase):
    """Positions of every record at the samples, or None where MuJoCo has not what the case needs."""
    rig, P = case.rig, case.P
    if any(law.id in HIDDEN for law in case.laws):
        return None
    fastest = max(rig.omega, math.sqrt(P[SECOND_SQUARE]), math.sqrt(P[CONTACT]) / 6)
    sub = max(2, math.ceil(rig.step * fastest / phase))
    more = any(isinstance(law, Unlisted) or law.id in ("damping_drift", "stiffness_drift", "backlash", "end_stop", "periodic_forcing", "constant_torque")
               for law in case.laws)
    if sub * rig.count * rig.records > (PASSIVE_STEPS if more else STEPS):
        return None
    xml = model_of(rig, P, rig.step / sub)
    model = mujoco.MjModel.from_xml_string(xml)
    rest = P.copy()
    # What MuJoCo has by itself is not asked of the passive force.
    for place in (DRAG, CUBIC, QUADRATIC, WEIGHT, SECOND, COULOMB, GAIN):
        rest[place] = 0.0
    if more:
        state, out = numpy.zeros(STATES), numpy.zeros(STATES)

        def passive(_, data):
            state[0], state[1] = data.qpos[0], data.qvel[0]
            a = smooth(rest, state, data.time, 0.0, out)
            data.qfrc_passive[0] += a + rest[SQUARE] * (state[0] - rest[REST]) + rest[DAMPING] * state[1]

        mujoco.set_mjcb_passive(passive)
    try:
        return [one(model, rig, P, start, u, sub) for start, u in zip(rig.starts, rig.inputs)]
    finally:
        mujoco.set_mjcb_passive(None)


def one(model, rig, P, start, u, sub):
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = start
    positions = numpy.empty(rig.count)
    for n in range(rig.count):
        positions[n] = data.qpos[0]
        if u is not None:
            drive = u[n]
            data.qfrc_applied[0] = min(max(drive, -P[LIMIT]), P[LIMIT]) if P[LIMIT] > 0 else drive
        mujoco.mj_step(model, data, nstep=sub)
    return positions


def inertial(center, inertia):
    return f'<inertial pos="{center}" mass="1" diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>'


def model_of(rig, P, step):
    """A hinge, or a slide for displacements, per unit of inertia."""
    P = [float(value) for value in P]
    slide = rig.displacement
    kind, axis = ("slide", "1 0 0") if slide else ("hinge", "0 0 1")
    gravity, center, own = "0 0 0", "0 0 0", 1.0
    if P[WEIGHT] != 0.0:
        # A mass of which the lever is a hundredth of the radius of gyration: what it adds to the inertia is taken off.
        gravity = f"0 {-P[WEIGHT] / LEVER!r} 0"
        center = f"{LEVER * math.sin(P[LEAN])!r} {-LEVER * math.cos(P[LEAN])!r} 0"
        own = 1.0 - LEVER**2
    spring = f"{P[SQUARE]!r} {P[QUADRATIC]!r} {P[CUBIC]!r}"
    damper = f"{P[DAMPING]!r} {P[DRAG]!r}"
    dry = ""
    if P[COULOMB] != 0.0:
        dry = f'frictionloss="{P[COULOMB]!r}" solreffriction="0 {-300 * rig.omega!r}" solimpfriction="0.99 0.99 0.001 0.5 2"'
    child = ""
    if P[SECOND] != 0.0:
        inertia = P[SECOND]
        body = f'<inertial pos="0 0 0" mass="{inertia!r}" diaginertia="1 1 1"/>' if slide else inertial("0 0 0", inertia)
        child = (f'<body><joint name="second" type="{kind}" axis="{axis}" stiffness="{inertia * P[SECOND_SQUARE]!r}" '
                 f'damping="{inertia * P[SECOND_DAMPING]!r}"/>{body}</body>')
    return (f'<mujoco><compiler angle="radian" autolimits="false"/>'
           f'<option timestep="{step!r}" integrator="RK4" gravity="{gravity}"/><worldbody><body>'
           f'<joint name="joint" type="{kind}" axis="{axis}" stiffness="{spring}" damping="{damper}" springref="{P[REST]!r}" {dry}/>'
           f'{inertial(center, own)}{child}</body></worldbody></mujoco>')
