"""A robot's model, asked in JSON: MuJoCo's, or any object with ``mass_matrix`` and ``bias``.

The command line starts this file as a program of its own (``python _simulator.py MODEL.xml``) and writes a question a line; the
package asks the same questions in its own process. It needs nothing but NumPy, and MuJoCo for MJCF.
"""

from __future__ import annotations

import importlib
import json
import math
import sys
from os import PathLike, fspath
from typing import Any

import numpy as np

NO_MUJOCO = "MJCF models are read by mujoco, which is not installed: pip install mujoco"


class Refused(ValueError):
    """A model that cannot be used."""


class MuJoCo:
    """An MJCF model of hinges and slides, without actuators and contacts: the torques of its joints are given."""

    def __init__(self, path: str | PathLike[str]) -> None:
        try:
            self._mujoco: Any = importlib.import_module("mujoco")
        except ModuleNotFoundError:
            raise ModuleNotFoundError(NO_MUJOCO, name="mujoco") from None
        self.path = fspath(path)
        try:
            self._model = self._mujoco.MjModel.from_xml_path(self.path)
        except ValueError as error:
            raise Refused(f"{self.path}: cannot be used: {error}; expected an MJCF model") from None
        self._check()
        model = self._model
        self._data = self._mujoco.MjData(model)
        joints = range(model.njnt)
        self._degrees = np.array([int(model.jnt_dofadr[at]) for at in joints])
        self._places = np.array([int(model.jnt_qposadr[at]) for at in joints])
        name = self._mujoco.mj_id2name
        kind = self._mujoco.mjtObj.mjOBJ_JOINT
        self.names = [name(model, kind, at) or f"joint{at}" for at in joints]
        slide = int(self._mujoco.mjtJoint.mjJNT_SLIDE)
        self.slides = [int(model.jnt_type[at]) == slide for at in joints]
        self.damping = [_first(model.dof_damping[at]) for at in self._degrees]
        self.friction = [_first(model.dof_frictionloss[at]) for at in self._degrees]
        self.stiffness = [_first(model.jnt_stiffness[at]) for at in joints]
        self.armature = [_first(model.dof_armature[at]) for at in self._degrees]
        # Torques at the joints are given; what damps and rubs there is stated for each motion.
        off = self._mujoco.mjtDisableBit
        model.opt.disableflags |= int(off.mjDSBL_ACTUATION) | int(off.mjDSBL_CONTACT)
        model.dof_damping[:] = 0.0
        model.dof_frictionloss[:] = 0.0

    def _check(self) -> None:
        model, mujoco = self._model, self._mujoco
        kinds = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
        for at in range(model.njnt):
            if int(model.jnt_type[at]) not in kinds:
                name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, at)
                raise Refused(f"{self.path}: joint {name} has several degrees of freedom; a diagnosis takes hinges and slides: fix the base")
        if model.njnt == 0:
            raise Refused(f"{self.path}: the model has no joint that moves")
        if model.neq:
            raise Refused(f"{self.path}: {model.neq} equality constraints close a loop or tie joints; a diagnosis takes trees: remove <equality>")

    def mass_matrix(self, q: Any) -> Any:
        return self._at(q, np.zeros(len(self.names)))[0]

    def bias(self, q: Any, v: Any) -> Any:
        return self._at(q, v)[1]

    def _at(self, q: Any, v: Any) -> tuple[Any, Any]:
        """Mass matrix, and what gravity, Coriolis forces, springs and fluids do, with the sign of the drive that balances it."""
        model, data = self._model, self._data
        data.qpos[self._places], data.qvel[self._degrees] = q, v
        self._mujoco.mj_forward(model, data)
        matrix = np.zeros((model.nv, model.nv))
        self._mujoco.mj_fullM(model, data, matrix)
        pick = np.ix_(self._degrees, self._degrees)
        return matrix[pick], (data.qfrc_bias - data.qfrc_passive)[self._degrees]

    def rollout(self, parameters: dict[str, Any], start: tuple[Any, Any], inputs: tuple[Any, Any]) -> Any:
        """Positions at the times of ``inputs``: times, and the torques of all joints, which change linearly in between."""
        model, data, mujoco = self._model, self._mujoco.MjData(self._model), self._mujoco
        rows = [parameters[name] for name in self.names]

        def of(key: str) -> Any:
            return np.array([row[key] for row in rows])

        kept = model.dof_armature.copy(), model.opt.timestep
        times, torques = np.asarray(inputs[0]), np.asarray(inputs[1])
        stiffness, torque = of("stiffness"), of("torque")
        try:
            model.dof_damping[self._degrees, ...] = of("damping").reshape(-1, *[1] * (model.dof_damping.ndim - 1))
            model.dof_frictionloss[self._degrees] = of("friction")
            model.dof_armature[self._degrees] = np.maximum(np.array(self.armature) + of("armature"), 0.0)
            mujoco.mj_setConst(model, data)
            data.qpos[self._places], data.qvel[self._degrees] = start
            path = [data.qpos[self._places].copy()]
            for at in range(len(times) - 1):
                lasts = times[at + 1] - times[at]
                count = max(1, math.ceil(lasts / kept[1] - 1e-6))
                model.opt.timestep = lasts / count
                for step in range(count):
                    share = (step + 0.5) / count
                    drive = torques[at] + share * (torques[at + 1] - torques[at])
                    data.qfrc_applied[self._degrees] = drive + torque - stiffness * data.qpos[self._places]
                    mujoco.mj_step(model, data)
                path.append(data.qpos[self._places].copy())
            return np.array(path)
        finally:
            model.dof_armature[:], model.opt.timestep = kept
            model.dof_damping[:] = 0.0
            model.dof_frictionloss[:] = 0.0
            mujoco.mj_setConst(model, data)

    def written(self, parameters: dict[str, dict[str, float | None]]) -> str:
        """The model as one MJCF file with other numbers in its joints."""
        spec = self._mujoco.MjSpec.from_file(self.path)
        names = {"damping": "damping", "friction": "frictionloss", "armature": "armature", "stiffness": "stiffness"}
        for joint in spec.joints:
            for key, value in parameters.get(joint.name, {}).items():
                if value is not None:
                    own = getattr(joint, names[key])
                    setattr(joint, names[key], value if np.ndim(own) == 0 else [value, *np.zeros(len(own) - 1)])
        spec.compile()
        return str(spec.to_xml())


def _first(number: Any) -> float:
    """A number, or the first of several: the linear one of a polynomial."""
    return float(np.ravel(number)[0])


def _list(value: Any, shape: tuple[int, ...], name: str) -> Any:
    array = np.asarray(value, dtype=float)
    if array.shape != shape:
        raise Refused(f"{name} has the shape {array.shape}; expected {shape} for {shape[-1]} joints")
    return array.tolist()


def answer(model: Any, question: str) -> str:
    """What a model answers to a question in JSON."""
    asked = json.loads(question)
    names = list(model.names)
    count = len(names)
    if asked["do"] == "describe":
        keys = ("damping", "friction", "armature", "stiffness")
        columns = [getattr(model, "slides", None) or [False] * count, *(getattr(model, key, None) or [0.0] * count for key in keys)]
        joints = [
            {"name": name, "slides": bool(slides), **{key: float(value) for key, value in zip(keys, values, strict=True)}}
            for name, slides, *values in zip(names, *columns, strict=True)
        ]
        return json.dumps({"joints": joints, "rollout": hasattr(model, "rollout")})
    if asked["do"] == "along":

        def both(q: Any, v: Any) -> tuple[Any, Any]:
            return model._at(q, v) if isinstance(model, MuJoCo) else (model.mass_matrix(q), model.bias(q, v))

        mass, bias = [], []
        for q, v in zip(asked["positions"], asked["velocities"], strict=True):
            own = both(np.array(q), np.array(v))
            mass.append(_list(own[0], (count, count), "mass_matrix(q)"))
            bias.append(_list(own[1], (count,), "bias(q, v)"))
        return json.dumps({"mass": mass, "bias": bias})
    if asked["do"] == "rollout":
        start = np.array(asked["start"]["position"]), np.array(asked["start"]["velocity"])
        inputs = np.array(asked["times"]), np.array(asked["torques"])
        path = np.asarray(model.rollout(asked["parameters"], start, inputs), dtype=float)
        # JSON has no number for what left every bound.
        return json.dumps({"positions": path[np.isfinite(path).all(axis=1)].tolist()})
    if asked["do"] == "write":
        return json.dumps({"text": model.written(asked["parameters"])})
    raise Refused(f"no such question: {asked['do']}")


def main() -> None:
    """Answers the questions of a program that started this one."""
    try:
        model = MuJoCo(sys.argv[1])
    except (ModuleNotFoundError, Refused) as error:
        print(json.dumps({"refused": str(error)}), flush=True)
        return
    print(json.dumps({"ready": True}), flush=True)
    for question in sys.stdin:
        try:
            print(answer(model, question), flush=True)
        except Exception as error:  # noqa: BLE001
            print(json.dumps({"refused": f"{type(error).__name__}: {error}"}), flush=True)


if __name__ == "__main__":
    main()
