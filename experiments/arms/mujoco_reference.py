"""Ten random trees as URDF, with MuJoCo's mass matrices and bias forces: the fixtures of crates/robot/tests/mujoco.rs.

    python experiments/arms/mujoco_reference.py crates/robot/tests/models      (pip install mujoco numpy)

Trees of two to six joints that move, branched or not: revolute, continuous and prismatic joints along any axis, frames
turned about all three axes, fixed joints between, tilted inertias, armatures. MuJoCo reads the same URDF.
"""
import json
import sys
from pathlib import Path

import mujoco
import numpy as np


def text(numbers):
    return " ".join(f"{number:.6f}" for number in numbers)


def inertia(draw):
    """A mass whose principal moments obey the triangle inequality, turned at random."""
    size = draw.uniform(0.05, 0.3, 3)
    mass = draw.uniform(0.2, 3.0)
    moments = mass / 12 * (np.sum(size**2) - size**2)
    return (f'<inertial><origin xyz="{text(draw.uniform(-0.2, 0.2, 3))}" rpy="{text(draw.uniform(-3, 3, 3))}"/>'
            f'<mass value="{mass:.6f}"/><inertia ixx="{moments[0]:.8f}" iyy="{moments[1]:.8f}" izz="{moments[2]:.8f}" '
            f'ixy="0" ixz="0" iyz="0"/></inertial>')


def tree(number):
    draw = np.random.default_rng(530 + number)
    moving, names, parts = 2 + number % 5, ["base"], ['<link name="base"/>']
    joints = ["moves"] * moving + ["fixed"] * (number % 3)
    draw.shuffle(joints)
    for index, kind in enumerate(joints):
        parent = names[-1] if number % 2 == 0 else names[draw.integers(max(0, len(names) - 3), len(names))]
        name = f"link{index}"
        kind = "fixed" if kind == "fixed" else draw.choice(["revolute", "continuous", "prismatic"], p=[0.4, 0.3, 0.3])
        axis = draw.normal(size=3)
        axis /= np.linalg.norm(axis)
        limit = '<limit lower="-3" upper="3" effort="100" velocity="100"/>' if kind in ("revolute", "prismatic") else ""
        axis = "" if kind == "fixed" else f'<axis xyz="{" ".join(repr(float(own)) for own in axis)}"/>'
        parts.append(f'<link name="{name}">{inertia(draw)}</link>')
        parts.append(f'<joint name="joint{index}" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
                     f'<origin xyz="{text(draw.uniform(-0.4, 0.4, 3))}" rpy="{text(draw.uniform(-3, 3, 3))}"/>{axis}{limit}</joint>')
        names.append(name)
    return draw, f'<robot name="tree{number}">\n' + "\n".join(parts) + "\n</robot>\n"


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    cases = []
    for number in range(10):
        draw, urdf = tree(number)
        (folder / f"tree{number}.urdf").write_text(urdf)
        model = mujoco.MjModel.from_xml_string(urdf)
        data = mujoco.MjData(model)
        joints = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, index) for index in range(model.njnt)]
        armature = draw.uniform(0.0, 0.1, model.nv).round(6)
        model.dof_armature[:] = armature
        states = []
        for _ in range(3):
            data.qpos[:] = draw.uniform(-2, 2, model.nv).round(6)
            data.qvel[:] = draw.uniform(-3, 3, model.nv).round(6)
            mujoco.mj_forward(model, data)
            matrix = np.zeros((model.nv, model.nv))
            mujoco.mj_fullM(model, data, matrix)
            states.append({"position": data.qpos.tolist(), "velocity": data.qvel.tolist(),
                           "mass_matrix": matrix.tolist(), "bias": data.qfrc_bias.tolist()})
        cases.append({"urdf": f"tree{number}.urdf", "joints": joints, "armature": armature.tolist(), "states": states})
    (folder / "mujoco.json").write_text(json.dumps({"mujoco": mujoco.__version__, "cases": cases}, indent=1) + "\n")


main()
