"""Simulated arms with an effect in one joint or two, or in none, for a blind test of the diagnosis of robots.

    python experiments/arms/make.py ARMS --count 20 --seed 1      makes ARMS/000, … (pip install mujoco numpy)
    python experiments/arms/run.py ARMS ANSWERS                   diagnoses and scores them

Each folder holds arm.urdf (the nominal model), log.csv (positions and measured torques) and, sealed from the diagnosis,
truth.json. Arms have two to six revolute joints, which a computed-torque controller moves along sums of sines. The encoder has
noise and steps, the torque sensor noise and an offset. Effects: dry friction, Stribeck friction, quadratic drag, a cubic
spring, viscous damping with an armature (which a recalibration explains), and nothing. With --two, every third arm has an effect
in a second joint.
"""
import argparse
import json
from pathlib import Path

import mujoco
import numpy as np

EFFECTS = ["coulomb_friction", "stribeck_friction", "quadratic_drag", "cubic_stiffness", "calibration", "nothing"]
STEP, RATE, SECONDS = 2.5e-4, 250, 12.0


def urdf(draw, joints):
    parts = ['<robot name="arm">', '<link name="base"/>']
    for index in range(joints):
        length, mass = draw.uniform(0.15, 0.35), draw.uniform(0.3, 2.0) * 0.8**index
        moment = max(mass * length**2 / 12, 6e-4)
        axis = ["0 1 0", "1 0 0", "0 0 1"][draw.choice(3, p=[0.6, 0.2, 0.2])]
        parts.append(f'<link name="l{index}"><inertial><origin xyz="{draw.uniform(-.02, .02):.4f} {draw.uniform(-.02, .02):.4f} {-length / 2:.4f}"/>'
                     f'<mass value="{mass:.4f}"/><inertia ixx="{moment:.6f}" iyy="{moment:.6f}" izz="{max(moment / 4, 1e-3):.6f}" ixy="0" ixz="0" iyz="0"/></inertial></link>')
        origin = "" if index == 0 else f'<origin xyz="0 0 {-before:.4f}"/>'
        parts.append(f'<joint name="j{index}" type="continuous"><parent link="{"base" if index == 0 else f"l{index - 1}"}"/><child link="l{index}"/>{origin}<axis xyz="{axis}"/></joint>')
        before = length
    return "\n".join(parts + ["</robot>\n"])


def references(draw, joints, times):
    """Position and speed: three sines for each joint."""
    position, speed = np.zeros((joints, len(times))), np.zeros((joints, len(times)))
    for joint in range(joints):
        for _ in range(3):
            omega, size, phase = 2 * np.pi * draw.uniform(0.15, 1.5), draw.uniform(0.1, 0.5), draw.uniform(0, 2 * np.pi)
            position[joint] += size * np.sin(omega * times + phase)
            speed[joint] += size * omega * np.cos(omega * times + phase)
    return position, speed


def added(effect, values, position, speed):
    """Torque of an effect that MuJoCo does not have."""
    if effect == "quadratic_drag":
        return -values["coefficient"] * speed * abs(speed)
    if effect == "cubic_stiffness":
        return -values["coefficient"] * position**3
    if effect == "stribeck_friction":
        size = values["torque"] + (values["static_torque"] - values["torque"]) * np.exp(-((speed / values["velocity"]) ** 2))
        return -size * np.tanh(speed / 2e-3)
    return 0.0


def simulate(model, truth, controller, reference, count):
    data = mujoco.MjData(model)
    position, speed = reference
    data.qpos[:], data.qvel[:] = position[:, 0], speed[:, 0]
    gains = controller
    rows, every = [], round(1 / RATE / STEP)
    torque, matrix = np.zeros(model.nv), np.zeros((model.nv, model.nv))
    for step in range(count * every):
        at = step // every
        if step % every == 0:
            mujoco.mj_forward(model, data)
            mujoco.mj_fullM(model, data, matrix)
            wanted = gains[0] * (position[:, at] - data.qpos) + gains[1] * (speed[:, at] - data.qvel)
            torque = matrix @ wanted + data.qfrc_bias
            rows.append((data.time, data.qpos.copy(), data.qvel.copy(), torque.copy()))
        data.qfrc_applied[:] = torque
        for own in truth["effects"]:
            joint = own["joint"]
            data.qfrc_applied[joint] += added(own["effect"], own["values"], data.qpos[joint], data.qvel[joint])
        mujoco.mj_step(model, data)
    return rows


def drawn(draw, model, effect, joint, sizes, speeds, position, inertia):
    """An effect in a joint, about a tenth to a third of its torque."""
    size, speed = draw.uniform(0.08, 0.3) * sizes[joint], speeds[joint]
    values = {}
    if effect == "coulomb_friction":
        values = {"torque": size}
        model.dof_frictionloss[joint] = size
        model.dof_solref[joint] = [2 * STEP, 1]
        model.dof_solimp[joint] = [0.99, 0.999, 0.001, 0.5, 2]
    elif effect == "stribeck_friction":
        values = {"torque": size, "static_torque": 2 * size, "velocity": 0.3 * speed}
    elif effect == "quadratic_drag":
        values = {"coefficient": size / speed**2}
    elif effect == "cubic_stiffness":
        values = {"coefficient": 2 * size / position**3}
    else:
        values = {"damping": size / speed, "armature": 0.2 * inertia}
        model.dof_damping[joint], model.dof_armature[joint] = values["damping"], values["armature"]
    return {"effect": effect, "joint": joint, "values": values}


def make(folder, seed, noise, two):
    draw = np.random.default_rng(seed)
    joints = int(draw.integers(2, 5 if draw.random() < 0.8 else 7))
    text = urdf(draw, joints)
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep, model.opt.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    count = int(SECONDS * RATE)
    times = np.arange(count) / RATE
    reference = references(draw, joints, times)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    matrix = np.zeros((joints, joints))
    mujoco.mj_fullM(model, data, matrix)
    omega = 2 * np.pi * 3
    gains = (omega**2, 1.4 * omega)
    effect = EFFECTS[draw.integers(len(EFFECTS))]
    truth = {"effects": []}
    rows = simulate(model, truth, gains, reference, count)
    sizes = np.std([row[3] for row in rows], axis=0)
    speeds = np.std([row[2] for row in rows], axis=0)
    positions = np.std([row[1] for row in rows], axis=0)
    if effect != "nothing":
        places = [int(draw.integers(joints))]
        chosen = [effect]
        if two and seed % 3 == 0:
            places.append(int((places[0] + 1 + draw.integers(joints - 1)) % joints))
            chosen.append(EFFECTS[draw.integers(len(EFFECTS) - 1)])
        for own, joint in zip(chosen, places):
            truth["effects"].append(drawn(draw, model, own, joint, sizes, speeds, positions[joint], matrix[joint, joint]))
        rows = simulate(model, truth, gains, reference, count)
    step = 2 * np.pi / 2**14 * noise
    positions = np.array([row[1] for row in rows]) + draw.normal(0, 0.5 * step, (count, joints))
    positions = np.round(positions / step) * step
    torques = np.array([row[3] for row in rows])
    torques += draw.normal(0, 0.03, torques.shape) * sizes + draw.normal(0, 0.02, joints) * sizes
    folder.mkdir(parents=True)
    (folder / "arm.urdf").write_text(text)
    (folder / "truth.json").write_text(json.dumps({**truth, "joints": joints, "torques": sizes.tolist()}, indent=1) + "\n")
    header = "# origin: simulated\ntime_s," + ",".join(f"j{at}_position,j{at}_torque" for at in range(joints))
    table = np.column_stack([times] + [column for at in range(joints) for column in (positions[:, at], torques[:, at])])
    np.savetxt(folder / "log.csv", table, delimiter=",", header=header, comments="", fmt="%.7g")


def main():
    options = argparse.ArgumentParser()
    options.add_argument("folder", type=Path)
    options.add_argument("--count", type=int, default=20)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--noise", type=float, default=1.0, help="factor of the encoder's noise and steps")
    options.add_argument("--two", action="store_true", help="an effect in a second joint of every third arm")
    given = options.parse_args()
    for index in range(given.count):
        make(given.folder / f"{index:03}", 1000 * given.seed + index, given.noise, given.two)


main()
