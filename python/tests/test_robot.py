"""Robots of several joints: a model written by hand, a URDF and an MJCF give the same answer."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ringdown_lab as rd
from ringdown_lab import _simulator

PAGE = Path(__file__).parents[2] / "book" / "src" / "robots.md"
FRICTION = 0.12
LINK = '<link name="{0}"><inertial><origin xyz="0 0 -{1}"/><mass value="{2}"/><inertia ixx="{3}" iyy="{3}" izz="0.001"/></inertial></link>'
URDF = f"""<robot name="arm"><link name="base"/>{LINK.format("upper", 0.25, 0.8, 0.006)}{LINK.format("lower", 0.2, 0.5, 0.004)}
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/></joint></robot>"""
MJCF = """<mujoco><!-- mine --><option timestep="0.0005" integrator="RK4"/><worldbody>
<body><joint name="shoulder" axis="0 1 0"/><inertial pos="0 0 -0.25" mass="0.8" diaginertia="0.006 0.006 0.001"/>
<body pos="0 0 -0.3"><joint name="elbow" axis="0 1 0"/><inertial pos="0 0 -0.2" mass="0.5" diaginertia="0.004 0.004 0.001"/></body></body>
</worldbody><actuator><position joint="elbow" kp="50"/></actuator></mujoco>"""


def snippet() -> str:
    found = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    assert len(found) == 1
    assert len(found[0].strip().splitlines()) <= 25
    return str(found[0])


def model() -> Any:
    """The model of the book's page."""
    made: dict[str, Any] = {"__name__": "page"}
    exec(compile(snippet().split("\nanswer =")[0], "robots.md", "exec"), made)
    return made["TwoLinks"]()


def recorded(path: Path) -> None:
    """Ten seconds of the page's arm with dry friction in its elbow."""
    arm, step = model(), 5e-4
    noise = np.random.default_rng(5)
    q, v = np.array([0.3, -0.2]), np.zeros(2)
    rows = []
    for at in range(20000):
        t = at * step
        tau = np.array([0.9 * np.sin(3.0 * t) + 0.8 * np.sin(7.3 * t), 0.35 * np.sin(5.5 * t + 1.0) + 0.25 * np.cos(2.1 * t)])
        if at % 10 == 0:
            rows.append([t, *(np.round((q + noise.normal(0, 2e-4, 2)) / 7.7e-4) * 7.7e-4), *(tau + noise.normal(0, [0.03, 0.015]))])
        left = tau - arm.bias(q, v) - np.array([0.2, 0.2]) * v - np.array([0.0, FRICTION]) * np.tanh(v / 2e-3)
        v = v + step * np.linalg.solve(arm.mass_matrix(q), left)
        q = q + step * v
    np.savetxt(path, rows, delimiter=",", header="time_s,shoulder_position,elbow_position,shoulder_torque,elbow_torque", comments="", fmt="%.7g")


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("robot") / "log.csv"
    recorded(path)
    return path


def friction(answer: rd.Joints) -> float:
    effects = {own["id"]: own for own in answer["elbow"]["diagnosis"]["effects"]}
    assert effects["coulomb_friction"]["probability"] > 0.5
    return float(effects["coulomb_friction"]["parameters"]["torque"]["value"])


def test_the_pages_model_is_diagnosed(log: Path) -> None:
    told = subprocess.run([sys.executable, "-c", snippet()], cwd=log.parent, capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stderr
    assert "elbow: " in told.stdout
    assert "dry friction" in told.stdout


def test_every_kind_of_model_gives_the_same_answer(log: Path, tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(URDF)
    by_urdf = rd.diagnose(log, rd.Robot.from_urdf(tmp_path / "arm.urdf"), joints=["elbow"])
    assert friction(by_urdf) == pytest.approx(FRICTION, rel=0.1)
    assert by_urdf.repaired is not None
    assert "<dynamics" in by_urdf.repaired
    columns = np.genfromtxt(log, delimiter=",", names=True)
    frame = {name: columns[name] for name in columns.dtype.names or ()}
    by_hand = rd.Robot(model()).diagnose(frame, joints=["elbow"])
    assert friction(by_hand) == pytest.approx(friction(by_urdf), rel=1e-3)
    assert by_hand.repaired is None
    assert by_hand.closed_loop is not None
    first, second = (own["elbow"]["closed_loop"]["repaired"] for own in (by_hand, by_urdf))
    # 0.0396 and 0.0392 rad were measured.
    assert first == pytest.approx(second, rel=2e-2)


def test_the_repaired_mjcf_moves_as_stated(log: Path, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    (tmp_path / "arm.xml").write_text(MJCF)
    answer = rd.Robot.from_mjcf(tmp_path / "arm.xml").diagnose(log)
    assert friction(answer) == pytest.approx(FRICTION, rel=0.1)
    assert answer.repaired is not None
    assert "<!-- mine -->" in answer.repaired
    assert 'frictionloss="0.1' in answer.repaired
    (tmp_path / "repaired.xml").write_text(answer.repaired)
    columns = np.genfromtxt(log, delimiter=",", names=True)
    times = columns["time_s"][1340:1900]
    torques = np.stack([columns["shoulder_torque"], columns["elbow_torque"]], 1)[1340:1900]
    start = np.array([columns["shoulder_position"][1340], columns["elbow_position"][1340]])
    offsets = [answer[name]["repair"]["torque_offset"]["value"] for name in ("shoulder", "elbow")]

    # What the stated figures were computed with.
    parameters = {}
    for name in ("shoulder", "elbow"):
        own = answer[name]["repair"]
        parameters[name] = {key: own[key]["value"] for key in ("armature", "stiffness")} | {"torque": own["torque_offset"]["value"]}
        parameters[name]["damping"] = max(own["damping"]["value"], 0.0)
        parameters[name]["friction"] = friction(answer) if name == "elbow" else 0.0
    stated = _simulator.MuJoCo(tmp_path / "arm.xml").rollout(parameters, (start, np.zeros(2)), (times, torques))

    loaded = mujoco.MjModel.from_xml_path(str(tmp_path / "repaired.xml"))
    loaded.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    data = mujoco.MjData(loaded)
    data.qpos[:] = start
    path = [start]
    for before, after in zip(torques[:-1], torques[1:], strict=True):
        for step in range(10):
            share = (step + 0.5) / 10
            data.qfrc_applied[:] = before + share * (after - before) + offsets
            mujoco.mj_step(loaded, data)
        path.append(data.qpos.copy())
    measured = np.stack([columns["shoulder_position"], columns["elbow_position"]], 1)[1340:1900]
    errors = [np.sqrt(np.mean((np.array(own) - measured) ** 2, axis=0)) for own in (stated, path)]
    assert errors[1] == pytest.approx(errors[0], rel=0.01)


def test_models_that_cannot_be_used_are_told(tmp_path: Path) -> None:
    class Sideways:
        def mass_matrix(self, q: Any) -> Any:
            return np.eye(3)

        def bias(self, q: Any, v: Any) -> Any:
            return np.zeros(2)

    with pytest.raises(rd.ConfigError, match="names of the joints are needed"):
        rd.Robot(Sideways())
    with pytest.raises(rd.ConfigError, match="no method mass_matrix"):
        rd.Robot(object(), ["a"])
    log = {"time_s": np.arange(400) * 0.005, "q1": np.sin(np.arange(400) * 0.05), "q2": np.sin(np.arange(400) * 0.07)}
    log |= {"tau1": log["q1"], "tau2": log["q2"]}
    with pytest.raises(rd.ConfigError, match=r"mass_matrix\(q\) has the shape \(3, 3\); expected \(2, 2\)"):
        rd.Robot(Sideways(), ["a", "b"]).diagnose(log)
    with pytest.raises(rd.ConfigError, match="joints are those of a Robot"):
        rd.diagnose(tmp_path / "log.csv", rd.Nominal(natural_frequency=1.0, damping_ratio=0.1), joints=["a"])  # type: ignore[call-overload]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<nothing/>", "cannot be used"),
        ("<mujoco><worldbody><body><freejoint name='free'/><geom size='1'/></body></worldbody></mujoco>", "joint free has several degrees"),
        ("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>", "no joint that moves"),
        (
            "<mujoco><worldbody><body name='a'><joint/><geom size='1'/></body><body name='b'><joint/><geom size='1'/></body></worldbody>"
            "<equality><connect body1='a' body2='b' anchor='0 0 0'/></equality></mujoco>",
            "close a loop",
        ),
    ],
)
def test_mjcf_that_is_no_tree_of_hinges_and_slides_is_refused(tmp_path: Path, text: str, message: str) -> None:
    pytest.importorskip("mujoco")
    (tmp_path / "arm.xml").write_text(text)
    with pytest.raises(rd.ConfigError, match=message):
        rd.Robot.from_mjcf(tmp_path / "arm.xml")


def test_the_command_line_says_that_mujoco_is_absent(tmp_path: Path) -> None:
    """A module of that name that cannot be found: an interpreter without it, whatever is installed."""
    (tmp_path / "arm.xml").write_text(MJCF)
    program = f"""
import runpy, sys
sys.modules["mujoco"] = None
sys.argv = ["-c", {str(tmp_path / "arm.xml")!r}]
runpy.run_path({_simulator.__file__!r}, run_name="__main__")
"""
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert json.loads(told.stdout) == {"refused": _simulator.NO_MUJOCO}
