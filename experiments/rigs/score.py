#!/usr/bin/env python3
"""Scores of answers against the truths of a bank of rigs, per effect and per class. Standard library only.

    python3 experiments/rigs/score.py ANSWERS TRUTHS [--cases]

ANSWERS holds <id>/diagnosis.json, TRUTHS <id>.json. A class's probability is that of `classes` in the answer; where an answer has
none, the sum of its effects' probabilities, at most 1. What a record's logger does to its stamps and readings alike in every
kind of case (`nuisances`) counts neither for nor against. A case without an answer is wrong. Shares come with n and
Wilson's interval of 95 %.
"""

import argparse
import json
import math
from pathlib import Path

CLASSES = {
    "coulomb_friction": "friction", "stribeck_friction": "friction", "hysteresis": "friction",
    "cubic_stiffness": "restoring", "asymmetric_stiffness": "restoring", "gravity": "restoring",
    "quadratic_drag": "damping", "damping_drift": "damping",
    "backlash": "play", "end_stop": "play",
    "stiffness_drift": "drift", "clock_drift": "drift",
    "flexible_coupling": "second_body", "periodic_forcing": "forcing", "constant_torque": "preload",
    "input_delay": "actuator", "input_saturation": "actuator",
    "sensor_quantization": "sensor", "sensor_saturation": "sensor", "sensor_lag": "sensor", "sensor_nonlinearity": "sensor",
    "sensor_drift": "sensor", "outliers": "sensor",
    "timestamp_batching": "stamps", "timestamp_jitter": "stamps", "dropouts": "stamps",
    # No rig lacks these; an answer may name them.
    "load_friction": "friction", "friction_drift": "friction", "directional_friction": "friction", "drive_dead_band": "play",
    "torque_limit": "actuator", "speed_torque_limit": "actuator", "command_derivative": "actuator",
    "unlisted_damping": "damping", "unlisted_stiffness": "restoring",
}
VERDICTS = {"none", "calibration", "unknown"}
# A class may be named for a law outside the vocabulary if its best member leaves so much of it, in floors or of its size.
LEFT_FLOORS, LEFT_SHARE = 0.5, 0.15
LISTED = 0.01


class Case:
    """A truth with its answer, nuisances struck."""

    def __init__(self, name, truth, answer, least=0.0):
        self.id, self.truth, self.kind, self.answered = name, truth, truth["kind"], answer is not None
        answer = answer or {"verdict": {"status": "no answer", "effects": []}, "effects": []}
        nuisances = set(truth["nuisances"]) - {effect["id"] for effect in truth["effects"]}
        self.effects = truth["effects"]
        self.status = answer["verdict"]["status"]
        self.named = [name for name in answer["verdict"]["effects"] if name not in nuisances]
        if not self.named and self.status == "effect":
            self.status = "none"
        self.probability = {row["id"]: row["probability"] for row in answer["effects"]
                            if row["id"] not in nuisances and row["id"] not in VERDICTS}
        self.present = {effect["class"] for effect in self.effects}
        # The class of a law outside the vocabulary, or of a nuisance, is neither there nor not.
        self.open = {law["class"] for law in truth["unlisted"] if law["class"]} | {CLASSES[name] for name in nuisances}
        size = max((law["floors"] for law in truth["unlisted"]), default=0.0)
        alike = {key for key, left in truth.get("resembles", {}).items() if left <= max(LEFT_FLOORS, LEFT_SHARE * size)}
        self.allowed = self.present | self.open | alike
        if "classes" in answer:
            self.classes = {row["id"]: row["probability"] for row in answer["classes"]}
        else:
            self.classes = {}
            for name, value in self.probability.items():
                key = CLASSES.get(name, name)
                self.classes[key] = min(1.0, self.classes.get(key, 0.0) + value)
        likely = [name for name in self.named if self.classes.get(CLASSES.get(name, name), 0.0) >= least]
        if self.named and not likely:
            self.status = "unknown"
        self.named = likely
        self.named_classes = {CLASSES.get(name, name) for name in self.named}


def wilson(hits, count):
    if count == 0:
        return float("nan"), float("nan")
    z, p = 1.959964, hits / count
    center = (p + z * z / (2 * count)) / (1 + z * z / count)
    half = z * math.sqrt(p * (1 - p) / count + z * z / (4 * count * count)) / (1 + z * z / count)
    return center - half, center + half


def share(hits):
    hits = list(hits)
    low, high = wilson(sum(hits), len(hits))
    if not hits:
        return "-"
    return f"{100 * sum(hits) / len(hits):5.1f} %  [{100 * low:.0f}, {100 * high:.0f}]  n = {len(hits)}"


def calibration(pairs):
    """Expected calibration error over ten bins, with how many there are."""
    pairs = list(pairs)
    if not pairs:
        return "-"
    total = 0.0
    for at in range(10):
        part = [(p, hit) for p, hit in pairs if min(int(10 * p), 9) == at]
        if part:
            total += abs(sum(p for p, _ in part) - sum(hit for _, hit in part))
    return f"{total / len(pairs):.3f}  n = {len(pairs)}"


def median(values):
    values = sorted(values)
    return values[len(values) // 2] if values else float("nan")


def marginals(cases, listed):
    """Probabilities of classes and of effects, with whether they act."""
    classes, effects = [], []
    for case in cases:
        if not case.answered:
            continue
        for key in set(CLASSES.values()) - case.open:
            p = case.classes.get(key, 0.0)
            if p > LISTED or not listed:
                classes.append((p, key in case.present))
        ids = {effect["id"] for effect in case.effects}
        for key, of in CLASSES.items():
            p = case.probability.get(key, 0.0)
            if of not in case.open and (p > LISTED or not listed):
                effects.append((p, key in ids))
    return classes, effects


def table(cases):
    """Rows of name and value."""
    of = lambda *kinds: [case for case in cases if case.kind in kinds]
    composite, apart = of("composite", "rough", "hard"), of("single", "pair")
    lead = [case.classes.get(case.effects[0]["class"], 0.0) for case in composite]
    rows = [("cases; without an answer", f"{len(cases)}; {sum(not case.answered for case in cases)}")]
    rows.append(("composite: leading class at 0.9 or more", share(p >= 0.9 for p in lead)))
    # A constant torque moves the rest position, and so does a rest angle that is off: one record cannot tell.
    told = [p for case, p in zip(composite, lead) if case.effects[0]["id"] != "constant_torque"]
    rows.append(("composite: the same, where it is no constant torque", share(p >= 0.9 for p in told)))
    rows.append(("composite: leading class's median probability", f"{median(lead):.3f}"))
    rows.append(("composite: leading class named", share(case.effects[0]["class"] in case.named_classes for case in composite)))
    rows.append(("composite: set of classes right", share(case.present == case.named_classes - case.open for case in composite)))
    rows.append(("composite: `unknown`", share(case.status == "unknown" for case in composite)))
    for label, some in (("composite", composite), ("single and pair", apart), ("all", cases)):
        classes, effects = marginals(some, True)
        rows.append((f"{label}: calibration error of classes, listed", calibration(classes)))
        rows.append((f"{label}: calibration error of effects, listed", calibration(effects)))
        rows.append((f"{label}: of classes, every one", calibration(marginals(some, False)[0])))
    recall = lambda pairs: share(effect["class"] in case.named_classes for case, effect in pairs)
    for label, some in (("composite", composite), ("single and pair", apart)):
        for low, high in ((1, 4), (4, 10), (10, 30), (30, math.inf)):
            within = [(case, effect) for case in some for effect in case.effects if low <= effect["floors"] < high]
            rows.append((f"{label}: class recall at {low}–{high} floors", recall(within)))
            rows.append((f"{label}: the same, without constant torques",
                         recall(pair for pair in within if pair[1]["id"] != "constant_torque")))
        hits = [CLASSES.get(name, name) in case.present | case.open for case in some for name in case.named]
        rows.append((f"{label}: precision of names, by class", share(hits)))
    first = lambda case: bool(case.named) and case.named[0] == case.effects[0]["id"]
    kind = lambda case: bool(case.named) and CLASSES.get(case.named[0]) == case.effects[0]["class"]
    rows.append(("single: first name right", share(map(first, of("single")))))
    rows.append(("single: class of the first name right", share(map(kind, of("single")))))
    ids = lambda case: {effect["id"] for effect in case.effects}
    rows.append(("pair: first name is one of them", share(bool(c.named) and c.named[0] in ids(c) for c in of("pair"))))
    rows.append(("pair: both named", share(ids(c) <= set(c.named) for c in of("pair"))))
    rows.append(("pair: both by class", share(c.present <= c.named_classes for c in of("pair"))))
    rows.append(("unlisted alone: `unknown` or a class that is allowed",
                 share(c.status == "unknown" or bool(c.named_classes) and c.named_classes <= c.allowed for c in of("unlisted"))))
    rows.append(("nothing missing: false alarms", share(bool(c.named) or c.status == "unknown" for c in of("none"))))
    rows.append(("small unlisted law alone: a class that is not allowed", share(bool(c.named_classes - c.allowed) for c in of("none-unlisted"))))
    return rows


def read(answers, truths, least=0.0):
    cases = []
    for file in sorted(truths.glob("*.json")):
        answer = answers / file.stem / "diagnosis.json"
        cases.append(Case(file.stem, json.loads(file.read_text()), json.loads(answer.read_text()) if answer.exists() else None, least))
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("answers", type=Path)
    parser.add_argument("truths", type=Path)
    parser.add_argument("--cases", action="store_true", help="print every case too")
    parser.add_argument("--least", type=float, default=0.0, help="strike names whose class has a smaller probability")
    parser.add_argument("--only-answered", action="store_true", help="leave out cases without an answer, as while a batch runs")
    arguments = parser.parse_args()
    cases = read(arguments.answers, arguments.truths, arguments.least)
    if arguments.only_answered:
        cases = [case for case in cases if case.answered]
    if arguments.cases:
        for case in cases:
            hidden = ", ".join(f"{effect['id']} {effect['floors']:.0f} ({case.classes.get(effect['class'], 0):.2f})" for effect in case.effects)
            print(f"{case.id} {case.kind:13s} {hidden or '-'} -> {case.status}: {', '.join(case.named) or '-'}")
    for name, value in table(cases):
        print(f"{name:58s} {value}")


if __name__ == "__main__":
    main()
