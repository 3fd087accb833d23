"""MuJoCo's own system identification on the arms of make.py, beside the answers of run.py.

    python experiments/arms/sysid.py ARMS ANSWERS          (pip install "mujoco[sysid]" scipy)

For each arm, `mujoco.sysid` fits every joint's armature, damping, friction loss and torque offset to the first 67 % of the log: the
part to which the coefficients behind `closed_loop` were fitted. Its sequences start at measured states, follow the measured torques,
which keep their last sample, and last as long as the runs of the closed loop (`closed_loop.span_s`); the fit starts from one of
sequences of 0.375 s. --longest shortens them. With --all, stiffness and the polynomials of damping and stiffness are fitted
too: all that a joint of MuJoCo has. The fitted model is then run from the held-out starts that joints.json states, and
compared with the positions as the answers were. Fits are kept beside the answers and not computed again.
"""
import argparse
import contextlib
import io
import json
import logging
import time
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np
from mujoco import sysid
from scipy.signal import savgol_filter

logging.disable(logging.WARNING)
SHARE, STEP, EDGE = 0.67, 1e-3, 15
SHORT_S = 0.375
LINEAR = ["armature", "damping", "frictionloss", "offset"]
ALL = LINEAR + ["stiffness", "drag", "drag3", "asymmetry", "cubic"]


class Arm:
    """Log, smoothed states and nominal model of an arm."""

    def __init__(self, folder, found):
        table = np.loadtxt(folder / "log.csv", delimiter=",", skiprows=2)
        self.times, self.position, self.torque = table[:, 0], table[:, 1::2], table[:, 2::2]
        self.every = round((self.times[1] - self.times[0]) / STEP)
        smooth = dict(window_length=2 * EDGE + 1, polyorder=5, axis=0)
        self.smooth = savgol_filter(self.position, **smooth)
        self.speed = savgol_filter(self.position, deriv=1, delta=self.times[1] - self.times[0], **smooth)
        self.loop = found["closed_loop"]
        self.names = [joint["name"] for joint in found["joints"]]
        self.spec = mujoco.MjSpec.from_file(str(folder / "arm.urdf"))
        self.spec.option.timestep, self.spec.option.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        self.spec.option.tolerance = 1e-12
        for name in self.names:
            drive = self.spec.add_actuator(name=f"{name}_drive", target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            drive.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            self.spec.add_sensor(name=f"{name}_position", type=mujoco.mjtSensor.mjSENS_JOINTPOS, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=name)
            # Friction as stiff as the step allows, as in make.py.
            joint = self.spec.joint(name)
            joint.solref_friction, joint.solimp_friction = [2 * STEP, 1], [0.99, 0.999, 0.001, 0.5, 2]
        self.model = self.spec.compile()

    def held(self, first, count):
        """Torques between the samples first … first + count, one for each step of the simulation."""
        return np.repeat(self.torque[first:first + count], self.every, axis=0)

    def parameters(self, kinds):
        data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, data)
        matrix = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, data, matrix)
        found = sysid.ParameterDict()
        for at, name in enumerate(self.names):
            torque, speed, size = (np.std(own[:, at]) for own in (self.torque, self.speed, self.position))
            places = {
                "armature": (lambda own, value: setattr(own, "armature", value), 0, 10 * matrix[at, at]),
                "damping": (lambda own, value: own.damping.__setitem__(0, value), 0, 3 * torque / speed),
                "frictionloss": (lambda own, value: setattr(own, "frictionloss", value), 0, 3 * torque),
                "stiffness": (lambda own, value: own.stiffness.__setitem__(0, value), -3 * torque / size, 3 * torque / size),
                "drag": (lambda own, value: own.damping.__setitem__(1, value), 0, 3 * torque / speed**2),
                "drag3": (lambda own, value: own.damping.__setitem__(2, value), 0, 3 * torque / speed**3),
                "asymmetry": (lambda own, value: own.stiffness.__setitem__(1, value), -3 * torque / size**2, 3 * torque / size**2),
                "cubic": (lambda own, value: own.stiffness.__setitem__(2, value), -3 * torque / size**3, 3 * torque / size**3),
            }
            for kind in kinds:
                if kind == "offset":
                    change, low, high = (lambda spec, own, name=name: spec.actuator(f"{name}_drive").biasprm.__setitem__(0, own.value[0])), -3 * torque, 3 * torque
                else:
                    put, low, high = places[kind]
                    change = lambda spec, own, name=name, put=put: put(spec.joint(name), own.value[0])
                found.add(sysid.Parameter(f"{name}_{kind}", 0.0, low, high, modifier=change))
        return found

    def sequences(self, span, share):
        """Sequences of `span` seconds in a share of the fitted part, evenly spread."""
        samples = round(span / (self.every * STEP))
        fitted = int(SHARE * len(self.times))
        starts = np.linspace(EDGE, fitted - samples - 1, round(share * np.ceil(fitted / samples)), dtype=int)
        states, controls, sensors = [], [], []
        for first in starts:
            at = slice(first, first + samples + 1)
            own = self.held(first, samples)
            own = np.vstack([own, own[-1:]])
            states.append(sysid.create_initial_state(self.model, self.smooth[first], self.speed[first]))
            controls.append(sysid.TimeSeries(np.arange(len(own)) * STEP, own))
            sensors.append(sysid.TimeSeries.from_names(np.arange(samples + 1) * self.every * STEP, self.position[at], self.model))
        return sysid.ModelSequences("arm", self.spec, [f"at{first}" for first in starts], states, controls, sensors)

    def fit(self, kinds, longest):
        parameters = self.parameters(kinds)
        span = min(self.loop["span_s"], longest)
        stages = [(SHORT_S, 0.5), (span, 1.0)] if span > SHORT_S else [(span, 1.0)]
        for own, share in stages:
            residual = sysid.build_residual_fn(models_sequences=[self.sequences(own, share)], n_threads=1)
            with contextlib.redirect_stdout(io.StringIO()):
                parameters, _ = sysid.optimize(parameters, residual, verbose=False, max_iters=15, x_scale="jac", eps=1e-6, xtol=1e-2)
        return parameters

    def errors(self, model):
        """Root mean square of each joint over the held-out runs, which joints.json states."""
        squares, samples = np.zeros(model.nv), 0
        data = mujoco.MjData(model)
        starts = self.loop["recordings"][0]["starts"]
        begins = [int(np.argmin(abs(self.times - own["time_s"]))) for own in starts]
        for own, first, after in zip(starts, begins, begins[1:] + [len(self.times) - EDGE]):
            count = min(after - 1, first + round(self.loop["span_s"] / (self.every * STEP))) - first
            state = sysid.create_initial_state(model, np.array(own["position"]), np.array(own["velocity"]))
            path, _ = mujoco.rollout.rollout(model, data, state, self.held(first, count))
            path = np.vstack([own["position"], path[0, self.every - 1::self.every, 1:1 + model.nq]])
            squares += np.sum((path - self.position[first:first + count + 1]) ** 2, axis=0)
            samples += count + 1
        return np.sqrt(squares / samples)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("arms", type=Path)
    options.add_argument("answers", type=Path)
    options.add_argument("--longest", type=float, default=np.inf, help="seconds that a sequence lasts at most")
    options.add_argument("--all", action="store_true", help="fit all that a joint of MuJoCo has")
    options.add_argument("--only", nargs="*", help="names of arms")
    given = options.parse_args()
    rows, seconds, wins, failed = [], [], 0, 0
    print("arm | effects | joints | span s | as given (MuJoCo, ours) | mujoco.sysid | recalibrated | repaired | s of sysid, ours")
    for folder in sorted(path for path in given.arms.iterdir() if path.is_dir() and (not given.only or path.name in given.only)):
        answer = given.answers / folder.name / "joints.json"
        found = json.loads(answer.read_text()) if answer.exists() else {}
        if not found.get("closed_loop"):
            print(folder.name, "no answer")
            continue
        truth = json.loads((folder / "truth.json").read_text())
        arm = Arm(folder, found)
        ours = [[own[name] if own[name] is not None else np.inf for name in ("nominal", "recalibrated", "repaired")] for own in found["closed_loop"]["recordings"][0]["joints"]]
        fitted, own = answer.parent / f"sysid{'-all' * given.all}{f'-{given.longest:g}' if given.longest < np.inf else ''}.json", {}
        if not fitted.exists():
            begin = time.process_time()
            try:
                parameters = arm.fit(ALL if given.all else LINEAR, given.longest)
                own["rms"] = arm.errors(sysid.apply_param_modifiers(parameters, arm.spec.copy())).tolist()
                own["parameters"] = {name: float(value.value[0]) for name, value in parameters.items()}
            except (ValueError, ArithmeticError, RuntimeError, np.linalg.LinAlgError, mujoco.FatalError) as error:
                own["failed"] = str(error)
            fitted.write_text(json.dumps({**own, "seconds": time.process_time() - begin}, indent=1) + "\n")
        own = json.loads(fitted.read_text())
        theirs = own.get("rms", [np.inf] * len(ours))
        failed += "failed" in own
        note = f"sysid failed: {own['failed']}" if "failed" in own else ""
        seconds.append((own["seconds"], found["seconds"]))
        own = np.column_stack([arm.errors(arm.model), ours, theirs])
        rows.append(own)
        middle = np.median(own, axis=0)
        wins += middle[3] <= 1.05 * middle[4]
        effects = ", ".join(f"{own['effect']} j{own['joint']}" for own in truth["effects"]) or "nothing"
        print(f"{folder.name} | {effects} | {len(ours)} | {arm.loop['span_s']} | {middle[0]:.4f} {middle[1]:.4f} | {middle[4]:.4f} | {middle[2]:.4f} | {middle[3]:.4f} | "
              f"{seconds[-1][0]:.1f} {seconds[-1][1]:.1f} {note}", flush=True)
    table = np.vstack(rows)
    print(f"ours repaired no larger (by 5 %) at {np.sum(table[:, 3] <= 1.05 * table[:, 4])} of {len(table)} joints and {wins} of {len(rows)} arms; "
          f"recalibrated at {np.sum(table[:, 2] <= 1.05 * table[:, 4])} joints; sysid failed on {failed} arms")
    print("median over joints: as given %.4f (MuJoCo) %.4f (ours), recalibrated %.4f, repaired %.4f, mujoco.sysid %.4f rad" % tuple(np.median(table, axis=0)))
    print("seconds an arm: sysid %.1f, ours %.1f" % tuple(np.mean(seconds, axis=0)))


main()
