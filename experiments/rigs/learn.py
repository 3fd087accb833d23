#!/usr/bin/env python3
"""Learns the logistic functions of `diagnosis::evidence::probability` from answers to training rigs.

    VENV/bin/python experiments/rigs/learn.py ANSWERS TRUTHS [ANSWERS TRUTHS]... [--unlisted-weight 0.25]

Every class that an answer lists is one observation: its features are what the answer states of it, its outcome is whether the rig has
it. Classes of unlisted laws and of nuisances are left out, since they are neither there nor not. The coefficients maximize the
posterior under independent Gaussian priors of mean 0 and standard deviation 2 (none on the constant). The last one is fitted with the
others held: it concerns records on which no class has evidence, and so it changes no other record's answer.
"""

import argparse
import json
import math
from pathlib import Path

import numpy
import score

PRIOR_DEVIATION = 2.0
FEATURES = ["constant", "replacement", "half_swings", "error", "leads", "none"]


def log1p_positive(nats):
    return math.log1p(max(nats or 0.0, 0.0))


def observations(answers, truths):
    """Features, outcome, probability that something is left, stated probability and kind of rig for every class."""
    rows = []
    for case in score.read(answers, truths):
        if not case.answered:
            continue
        answer = json.loads((answers / case.id / "diagnosis.json").read_text())
        left = answer["verdict"].get("left_over")
        fitted = [row for row in answer["classes"] if row["error_with"] and row["error_without"]]
        most = max((row["evidence"]["replacement"] for row in fitted), default=0.0)
        for row in fitted:
            if row["id"] in case.open:
                continue
            evidence = row["evidence"]
            nats, swings = evidence["replacement"], evidence.get("half_swings")
            support = log1p_positive(nats)
            features = [1.0, support, log1p_positive(swings), math.log(row["error_without"] / row["error_with"]),
                        support if nats >= most else 0.0, float(most <= 0)]
            rows.append((features, float(row["id"] in case.present), 1.0 if left is None else left, row["probability"], case.kind))
    return rows


def fitted(features, outcomes, weights, offset=0.0, precision=None):
    """Coefficients and standard errors by Newton's method; the log odds have an offset."""
    if precision is None:
        precision = numpy.full(features.shape[1], PRIOR_DEVIATION**-2)
        precision[0] = 0.0
    coefficients = numpy.zeros(features.shape[1])
    for _ in range(50):
        found = 1 / (1 + numpy.exp(-offset - features @ coefficients))
        gradient = features.T @ (weights * (outcomes - found)) - precision * coefficients
        curvature = (features.T * (weights * found * (1 - found))) @ features + numpy.diag(precision)
        step = numpy.linalg.solve(curvature, gradient)
        coefficients += step
        if numpy.max(numpy.abs(step)) < 1e-10:
            break
    return coefficients, numpy.sqrt(numpy.diag(numpy.linalg.inv(curvature)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", type=Path, nargs="+", metavar="ANSWERS TRUTHS")
    parser.add_argument("--unlisted-weight", type=float, default=0.25, help="weight of rigs that lack nothing but an unlisted law")
    arguments = parser.parse_args()
    pairs = zip(arguments.folders[::2], arguments.folders[1::2], strict=True)
    rows = [row for answers, truths in pairs for row in observations(answers, truths)]
    features, outcomes, left, stated = (numpy.array(column) for column in list(zip(*rows))[:4])
    unlisted = numpy.array([kind.endswith("unlisted") for *_, kind in rows])
    weights = numpy.where(unlisted, arguments.unlisted_weight, 1.0)
    learned = {}
    for name, share in (("DOUBTED", left), ("CLEAN", 1 - left)):
        first, deviations = fitted(features[:, :-1], outcomes, weights * share)
        last, deviation = fitted(features[:, -1:], outcomes, weights * share, features[:, :-1] @ first, numpy.array([PRIOR_DEVIATION**-2]))
        coefficients, errors = numpy.append(first, last), numpy.append(deviations, deviation)
        learned[name] = 1 / (1 + numpy.exp(-features @ coefficients))
        print(f"{name}: {sum(weights * share):.0f} classes by weight")
        for feature, value, error in zip(FEATURES, coefficients, errors):
            print(f"    {feature:12s} {value:6.2f} ± {error:.2f}")
    probabilities = left * learned["DOUBTED"] + (1 - left) * learned["CLEAN"]
    print("calibration error of classes, as stated and as learned:")
    several = numpy.array([kind in ("composite", "rough", "hard") for *_, kind in rows])
    for label, chosen in (("several effects", several), ("all", numpy.ones(len(rows), bool))):
        of = lambda values: score.calibration(zip(values[chosen], outcomes[chosen]))
        print(f"    {label:16s} {of(stated)}; {of(probabilities)}")


if __name__ == "__main__":
    main()
