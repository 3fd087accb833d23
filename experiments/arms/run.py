"""Diagnoses the arms of make.py and scores the answers.

    python experiments/arms/run.py ARMS ANSWERS [--trainer target/debug/trainer]

A joint's answer is right if it names the class of the effect that acts there as certain or likely, and wrong if it names a
class of the motion that does not act. Answers that are there are scored again and not computed again.
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
    errors = []
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
        for index, joint in enumerate(found["joints"]):
            named = {row["id"]: row["probability"] for row in joint["diagnosis"]["classes"]
                     if row["id"] not in ("sensor", "stamps", "drift") and row["probability"] >= 0.5}
            expected = CLASSES.get(truth["effect"]) if truth["joint"] == index else None
            if expected:
                acting += 1
                right += expected in named
                wrong += bool(set(named) - {expected})
                for row in joint["diagnosis"]["effects"]:
                    if row["id"] == truth["effect"] and row["probability"] > 0.5 and "torque" in (row.get("parameters") or {}):
                        low, high = row["parameters"]["torque"]["interval_95"]
                        measured += 1
                        inside += low <= truth["values"]["torque"] <= high
            else:
                quiet += 1
                alarms += bool(named)
            if expected or named:
                print(arm.name, joint["name"], truth["effect"] if expected else "nothing", "->", named or "nothing",
                      {row["id"]: {name: round(own["value"], 4) for name, own in row["parameters"].items()} for row in joint["diagnosis"]["effects"]
                       if row["probability"] > 0.5 and row.get("parameters") and not row["id"].startswith("sensor")}, truth["values"] if expected else "")
            if joint["closed_loop"]:
                errors.append([joint["closed_loop"][name] for name in ("nominal", "recalibrated", "repaired")])
    print(f"class of the effect named: {right} of {acting}; a wrong class beside it: {wrong}; alarms on joints that lack nothing: {alarms} of {quiet}; "
          f"friction within its interval: {inside} of {measured}")
    middle = lambda at: sorted(row[at] if row[at] is not None else float("inf") for row in errors)[len(errors) // 2]
    if errors:
        print("closed loop, median over joints (rad): as given %.4f, recalibrated %.4f, repaired %.4f" % tuple(middle(at) for at in range(3)))


main()
