"""A joint of a robot model becomes a nominal simulator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import ringdown_lab as rd

ARM = """
<mujoco><option gravity="0 0 -9.81"/><worldbody><body>
<joint name="elbow" axis="0 1 0" damping="0.01" frictionloss="0.02" stiffness="0.5" springref="0"/>
<inertial pos="0.1 0 -0.2" mass="0.3" diaginertia="1e-4 2e-4 1e-4"/>
<geom size="0.01" mass="0"/></body></worldbody></mujoco>
"""
URDF = """
<robot name="arm"><link name="base"/><link name="lower"><inertial><origin xyz="0 0 -0.2"/><mass value="0.3"/>
<inertia ixx="1e-4" iyy="2e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="elbow" type="continuous"><parent link="base"/><child link="lower"/><axis xyz="0 1 0"/>
<dynamics damping="0.01" friction="0.02"/></joint></robot>
"""


@pytest.fixture(autouse=True)
def _mujoco() -> None:
    pytest.importorskip("mujoco")


def test_an_arm_in_mjcf_moves_as_in_mujoco(tmp_path: Path) -> None:
    import mujoco

    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    nominal = rd.Nominal.from_mjcf(path, "elbow")
    # Parallel axes: 2e-4 + 0.3 (0.1² + 0.2²).
    assert nominal.inertia == pytest.approx(0.0152, rel=1e-6)
    assert "coulomb_friction" in nominal.to_toml() and "gravity" in nominal.to_toml()

    model = mujoco.MjModel.from_xml_string(ARM)
    model.opt.timestep, model.opt.integrator = 1e-4, mujoco.mjtIntegrator.mjINT_RK4
    data = mujoco.MjData(model)
    data.qpos[0] = 1.0
    swing = [1.0]
    while data.time < 2.0 - 1e-9:
        mujoco.mj_step(model, data)
        if round(data.time / 1e-4) % 100 == 0:
            swing.append(float(data.qpos[0]))
    own = rd.simulate(nominal, position=1.0, rate_hz=100.0, seconds=2.0)
    # MuJoCo's dry friction is soft; the weight and the spring are the same.
    assert np.abs(own.values[:50] - np.array(swing[:50])).max() < 0.01


def test_an_arm_in_urdf(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF)
    nominal = rd.Nominal.from_urdf(path, "elbow")
    assert nominal.inertia == pytest.approx(2e-4 + 0.3 * 0.2**2, rel=1e-6)
    assert nominal.damping == pytest.approx(0.01)


def test_what_is_no_joint_is_told(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    with pytest.raises(rd.ConfigError, match="no joint wrist; the model has elbow"):
        rd.Nominal.from_mjcf(path, "wrist")
    path.write_text("<mujoco><worldbody><body><freejoint name='free'/><geom size='1'/></body></worldbody></mujoco>")
    with pytest.raises(rd.ConfigError, match="several degrees of freedom"):
        rd.Nominal.from_mjcf(path, "free")
    path.write_text("<nothing/>")
    with pytest.raises(rd.ConfigError, match="cannot be used"):
        rd.Nominal.from_mjcf(path, "elbow")
