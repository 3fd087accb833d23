"""Diagnoses the arms of make.py and scores the answers.

    python experiments/arms/run.py ARMS ANSWERS [--trainer target/debug/trainer]

A joint's answer is right if it names the class of the effect that acts there as certain or likely, and wrong if it names a
class of the motion that does not act. Coefficients are those of the effect and, where viscous damping with an armature acts, of
these. Answers that are there are scored again and not computed again.
"""
import argparse
import json
import subprocess
from pathlib import Path

CLASSES = {"coulomb_friction": "friction", "stribeck_friction": "friction", "quadratic_drag": "damping", "cubic_stiffness": "restoring"}


def main():
    options = argparse.ArgumentParser()
    options.add_argument("arms", type=Path)
    options.add_argument("answers", type=Path)
    options.add_argument("--trainer", default="target/debug/trainer")
    given = options.parse_args()
    right = wrong = acting = quiet = alarms = inside = measured = 0
    errors, seconds = [], []
    for arm in sorted(path for path in given.arms.iterdir() if path.is_dir()):
        out = given.answers / arm.name
        if not out.exists():
            subprocess.run([given.trainer, "diagnose", arm / "log.csv", "--nominal", arm / "arm.urdf", "--out", out, "--quiet"], check=False,
                           stdout=subprocess.DEVNULL)
        if not (out / "joints.json").exists():
            print(arm.name, "no answer")
            continue
        truth = json.loads((arm / "truth.json").read_text())
        found = json.loads((out / "joints.json").read_text())
        acts = {own["joint"]: own for own in truth["effects"]}
        seconds.append(found["seconds"])
        for index, joint in enumerate(found["joints"]):
            named = {row["id"]: row["probability"] for row in joint["diagnosis"]["classes"]
                     if row["id"] not in ("sensor", "stamps", "drift") and row["probability"] >= 0.5}
            own = acts.get(index, {"effect": "nothing", "values": {}})
            expected = CLASSES.get(own["effect"])
            intervals = {}
            if expected:
                acting += 1
                right += expected in named
                wrong += bool(set(named) - {expected})
                for row in joint["diagnosis"]["effects"]:
                    if row["id"] == own["effect"] and row["probability"] > 0.5:
                        intervals = {name: value["interval_95"] for name, value in (row.get("parameters") or {}).items()}
            else:
                quiet += 1
                alarms += bool(named)
                intervals = {name: joint["repair"][name]["interval_95"] for name in own["values"] if joint["repair"][name]}
            for name, truth_value in own["values"].items():
                if name in intervals:
                    measured += 1
                    low, high = intervals[name]
                    inside += low <= truth_value <= high
                    if not low <= truth_value <= high:
                        print(arm.name, joint["name"], own["effect"], name, truth_value, "is outside of", intervals[name])
            if expected or named:
                print(arm.name, joint["name"], own["effect"], "->", named or "nothing",
                      {row["id"]: {name: round(value["value"], 4) for name, value in row["parameters"].items()} for row in joint["diagnosis"]["effects"]
                       if row["probability"] > 0.5 and row.get("parameters") and not row["id"].startswith("sensor")}, own["values"])
            if joint["closed_loop"]:
                errors.append([joint["closed_loop"][name] for name in ("nominal", "recalibrated", "repaired")])
    print(f"class of the effect named: {right} of {acting}; a wrong class beside it: {wrong}; alarms on joints that lack nothing: {alarms} of {quiet}; "
          f"coefficients within their intervals: {inside} of {measured}; {sum(seconds) / max(1, len(seconds)):.1f} s an arm")
    middle = lambda at: sorted(row[at] if row[at] is not None else float("inf") for row in errors)[len(errors) // 2]
    if errors:
        told = [row for row in errors if row[1] is not None and row[2] is not None]
        print(f"repaired no worse than recalibrated at {sum(row[2] <= 1.05 * row[1] for row in told)} of {len(told)} joints")
        print("closed loop, median over joints (rad): as given %.4f, recalibrated %.4f, repaired %.4f" % tuple(middle(at) for at in range(3)))


main()
