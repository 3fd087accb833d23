#!/usr/bin/env python3
"""Regret of answers to rigs with a known truth: was the set that is there found?

    python3 experiments/rigs/regret.py TRAINER RIGS ANSWERS [--keep FOLDER] [--list]

RIGS holds cases/<id> and truths/<id>.json, as records.py writes them, or truth/<id>.json with named parameters. ANSWERS holds
<id>/diagnosis.json. The regret of a case is the held-out error of its answer over that of the best set that contains the truth: the
true effects, by the program's own laws, are written into nominal.toml with their true coefficients, and a diagnosis that may name
nothing recalibrates them from there. So a regret of 1 says that no better fit of what is there was missed, and a large one that the
set was never tried or that its fit was lost. What no simulator predicts (outliers, errors of stamps) and unlisted laws are in both
errors. Where the fit from the truth ends above the answer, the regret is below 1. Standard library only.
"""

import argparse
import json
import math
import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Parameters of the laws that a simulator can hold, in the vocabulary's order.
LAWS = {
    "coulomb_friction": ["torque"], "stribeck_friction": ["torque", "static_torque", "velocity"], "quadratic_drag": ["coefficient"],
    "cubic_stiffness": ["coefficient"], "asymmetric_stiffness": ["coefficient"], "gravity": ["torque", "angle"],
    "constant_torque": ["torque"], "backlash": ["half_width"], "hysteresis": ["torque", "displacement", "softening", "exponent"],
    "end_stop": ["angle", "stiffness", "dissipation"], "stiffness_drift": ["rate"], "damping_drift": ["rate"],
    "periodic_forcing": ["torque", "frequency", "phase"], "flexible_coupling": ["inertia", "stiffness", "damping"],
    "input_delay": ["delay"], "input_saturation": ["torque"], "sensor_lag": ["time_constant"],
    "sensor_nonlinearity": ["amplitude", "phase"], "sensor_drift": ["rate"], "sensor_saturation": ["bound"],
    "clock_drift": ["rate", "change"],
}
OTHERS = ["sensor_quantization", "outliers", "dropouts", "timestamp_jitter", "timestamp_batching"]


def named(effect, own, system):
    """Our law's parameters, from another program's names for them."""
    duration = max(system["durations_s"])
    match effect:
        case "backlash":
            return [own["half_gap_rad"]]
        case "hysteresis":
            return [own["stiffness_nm_rad"] * own["yield_rad"], own["yield_rad"]]
        case "end_stop":
            return [own["angle_rad"], own["stiffness_nm_rad"], 0.0]
        case "stiffness_drift" | "damping_drift":
            return [own["relative"] / duration]
        case "flexible_coupling":
            return [own["inertia_share"] * system["inertia"], own["stiffness_nm_rad"], own["damping_nms_rad"]]
        case "clock_drift":
            return [own.get("rate", 0.0), own.get("change", own.get("change_per_s", 0.0))]
        case _:
            return [value for value in own.values() if isinstance(value, float)][: len(LAWS[effect])]


def truth_of(file):
    """Effects with their parameters, and the true coefficients."""
    truth = json.loads(file.read_text())
    if "sizes" in truth:
        effects = [(name, named(name, truth["parameters"][name], truth["system"])) for name in truth["effects"] if name in LAWS]
        return effects, truth["system"]
    return [(effect["id"], effect["parameters"]) for effect in truth["effects"] if effect["id"] in LAWS], truth.get("system", {})


def with_truth(nominal, effects, coefficients):
    """The text of a nominal.toml with the true effects and coefficients in it."""
    lines = []
    for line in nominal.splitlines():
        key = line.split("=")[0].strip()
        if key in ("inertia", "damping", "stiffness", "rest_angle") and key in coefficients:
            line = f"{key} = {coefficients[key]!r}"
        lines.append(line)
    for name, values in effects:
        lines += ["", "[[effects]]", f'id = "{name}"', "recalibrate = true"]
        lines += [f"parameters.{key} = {float(value)!r}" for key, value in zip(LAWS[name], values)]
    return "\n".join(lines) + "\n"


def reference(trainer, case, effects, coefficients, folder):
    """Held-out error of the fit that starts at the truth; None where it cannot be made."""
    folder.mkdir(parents=True, exist_ok=True)
    answer = folder / "out" / "diagnosis.json"
    if not answer.exists():
        (folder / "nominal.toml").write_text(with_truth((case / "nominal.toml").read_text(), effects, coefficients))
        records = sorted(map(str, case.glob("record-*.csv")))
        without = ",".join([*LAWS, *OTHERS])
        command = [trainer, "diagnose", *records, "--nominal", str(folder / "nominal.toml"), "--without", without, "--out",
                   str(folder / "out"), "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "RAYON_NUM_THREADS": "1"})
        if done.returncode:
            return None, (done.stderr.strip().splitlines() or ["no word"])[-1]
    gap = json.loads(answer.read_text())["gap"]
    return gap["recalibrated"], None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("trainer")
    parser.add_argument("rigs", type=Path)
    parser.add_argument("answers", type=Path)
    parser.add_argument("--keep", type=Path, help="folder for the fits from the truth; those that are there are not made again")
    parser.add_argument("--list", action="store_true", help="print every case too")
    arguments = parser.parse_args()
    truths = next(folder for folder in (arguments.rigs / "truths", arguments.rigs / "truth") if folder.exists())
    keep = arguments.keep or Path(tempfile.mkdtemp())

    def regret(file):
        answer = arguments.answers / file.stem / "diagnosis.json"
        effects, coefficients = truth_of(file)
        if not answer.exists() or not effects:
            return None
        of_truth, why = reference(arguments.trainer, arguments.rigs / "cases" / file.stem, effects, coefficients, keep / file.stem)
        repaired = json.loads(answer.read_text())["gap"]["repaired"]
        return file.stem, effects, repaired, of_truth, why

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        rows = [row for row in pool.map(regret, sorted(truths.glob("*.json"))) if row]
    values = []
    for name, effects, repaired, of_truth, why in rows:
        values.append(repaired / of_truth if of_truth else math.nan)
        if arguments.list:
            said = why or f"answer {repaired:.4g}, from the truth {of_truth:.4g}: {values[-1]:.3f}"
            print(f"{name} {', '.join(effect for effect, _ in effects)}: {said}")
    known = sorted(value for value in values if not math.isnan(value))
    count = len(known)
    shares = "; ".join(f"{bound}: {sum(value > bound for value in known)}" for bound in (1.1, 1.3, 2.0))
    median = known[count // 2] if known else math.nan
    print(f"regret of {count} rigs ({len(values) - count} without a reference): median {median:.3f}; above {shares}")


if __name__ == "__main__":
    main()
