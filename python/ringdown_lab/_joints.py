"""Nominal simulators from the joints of robot models, which MuJoCo reads."""

from __future__ import annotations

import importlib
import math
from os import PathLike, fspath
from typing import Any

import numpy as np

from ._native import ConfigError

_NEGLIGIBLE = 1e-9
"""Share of the inertia times g per meter, below which a weight's torque counts as none."""


def joint(path: str | PathLike[str], name: str) -> dict[str, Any]:
    """A joint of an MJCF or URDF model as the arguments of ``Nominal``, all other joints held where the model has them.

    Inertia, damping, stiffness and rest position are the model's; its dry friction and the weight of what the joint carries are
    effects that the simulator has. Raises ConfigError for a model that cannot be read, or a joint that is absent or of another kind.
    """
    try:
        mujoco: Any = importlib.import_module("mujoco")
    except ModuleNotFoundError:
        message = "robot models are read by mujoco, which is not installed: pip install ringdown-lab[mujoco]"
        raise ModuleNotFoundError(message, name="mujoco") from None
    try:
        model = mujoco.MjModel.from_xml_path(fspath(path))
    except ValueError as error:
        raise ConfigError(f"{fspath(path)}: cannot be used: {error}; expected an MJCF or URDF model") from None
    names = {mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, at): at for at in range(model.njnt)}
    if name not in names:
        raise ConfigError(f"{fspath(path)}: there is no joint {name}; the model has {', '.join(map(str, names)) or 'none'}")
    at = names[name]
    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE): "angle", int(mujoco.mjtJoint.mjJNT_SLIDE): "displacement"}
    coordinate = kinds.get(int(model.jnt_type[at]))
    if coordinate is None:
        raise ConfigError(f"{fspath(path)}: joint {name} has several degrees of freedom; expected a hinge or a slide")
    degree, place = int(model.jnt_dofadr[at]), int(model.jnt_qposadr[at])
    data = mujoco.MjData(model)

    def torque(position: float) -> float:
        """What gravity does to the joint at rest at a position."""
        data.qpos[place] = position
        data.qvel[:] = 0.0
        mujoco.mj_forward(model, data)
        return -float(data.qfrc_bias[degree])

    # The weight of what a hinge carries goes with sine and cosine of its angle, so that two positions tell it.
    sine, cosine = torque(math.pi / 2), torque(0.0)
    column = np.zeros(model.nv)
    column[degree] = 1.0
    product = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, product, column)
    inertia, stiffness = float(product[degree]), _first(model.jnt_stiffness[at])
    rest = _first(model.qpos_spring[place]) if stiffness > 0.0 else 0.0
    effects: dict[str, dict[str, float]] = {}
    friction = _first(model.dof_frictionloss[degree])
    if friction > 0.0:
        effects["coulomb_friction"] = {"torque": friction}
    weight = math.hypot(sine, cosine)
    if coordinate == "displacement":
        # The weight on a slide is constant, and moves where it rests.
        rest += cosine / stiffness if stiffness > 0.0 else 0.0
    elif weight > _NEGLIGIBLE * 9.81 * inertia:
        effects["gravity"] = {"torque": weight, "angle": math.atan2(-cosine, -sine)}
    return {
        "inertia": inertia,
        "damping": _first(model.dof_damping[degree]),
        "stiffness": stiffness,
        "rest_angle": rest,
        "coordinate": coordinate,
        "effects": effects,
    }


def _first(number: Any) -> float:
    """A number, or the first of several: the linear one of a polynomial."""
    return float(np.ravel(number)[0])
