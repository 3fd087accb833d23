#!/usr/bin/env python3
"""The benchmarks' splits beside those of nonlinear_benchmarks, and PySINDy on the same rows.

    VENV/bin/python experiments/benchmarks/benchmarks.py [--config configs/benchmarks.toml] [--only cascaded-tanks] [--skip pysindy]

The wheel's loaders download their data. Here they get the rows of the configured files instead, written as the files that they
expect, so that their own code splits them: no network is used. PySINDy learns from the training rows alone and chooses its
threshold and smoothing by the validation rows; a test part is opened once, at the end.
"""

import argparse
import sys
import tempfile
import tomllib
from pathlib import Path

import numpy as np

THRESHOLDS = [1e-4, 1e-3, 1e-2, 0.1]
SMOOTHINGS = [0, 5, 21]  # samples; 0 for none
SUBSTEPS = 2


def read(problem, part, base):
    """The input and the observed column of a part, with its rows."""
    folder = (base / problem["folder"]).resolve()
    with open(folder / part["file"]) as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    names = [name.strip() for name in lines[0].split(",")]
    columns = [names.index(part.get(key, problem[key])) for key in ("input", "value")]
    table = np.array([[float(line.split(",")[at]) for at in columns] for line in lines[1:]])
    rows = slice(part.get("from_row", 0), part.get("to_row", len(table)))
    return table[rows, 0], table[rows, 1], table


def silverbox_of_the_wheel(folder, whole):
    import nonlinear_benchmarks
    from scipy.io import savemat

    place = folder / "Silverbox" / "SilverboxFiles"
    place.mkdir(parents=True)
    (place.parent / "SilverboxFiles.zip").touch()
    savemat(place / "SNLS80mV.mat", {"V1": whole[None, :, 0], "V2": whole[None, :, 1]})
    training, tests = nonlinear_benchmarks.Silverbox(dir_placement=folder)
    return training, dict(zip(("multisine", "arrow", "arrow-inside"), tests))


def tanks_of_the_wheel(folder, training, test):
    import nonlinear_benchmarks
    from scipy.io import savemat

    place = folder / "Cascaded_Tanks" / "CascadedTanksFiles"
    place.mkdir(parents=True)
    (place.parent / "CascadedTanksFiles.zip").touch()
    columns = {"uEst": training[:, :1], "yEst": training[:, 1:], "uVal": test[:, :1], "yVal": test[:, 1:]}
    savemat(place / "dataBenchmark.mat", columns | {"Ts": np.array([[4.0]])})
    training, test = nonlinear_benchmarks.Cascaded_Tanks(dir_placement=folder)
    return training, {"test": test}


def compare_splits(name, problem, base):
    """Says for each part whether the wheel has the same rows; returns the number of differences."""
    parts = problem["part"]
    own = {id: read(problem, part, base) for id, part in parts.items()}
    with tempfile.TemporaryDirectory() as folder:
        if name == "silverbox":
            training, tests = silverbox_of_the_wheel(Path(folder), own["training"][2])
        elif name == "cascaded-tanks":
            training, tests = tanks_of_the_wheel(Path(folder), own["training"][2], own["test"][2])
        else:
            print(f"{name}: the wheel has no official split")
            return 0
    learned = [np.concatenate([own[id][at] for id in ("training", "validation")]) for at in (0, 1)]
    differences = 0
    for id, (u, y), theirs in [("training and validation", learned, training)] + [
        (id, own[id][:2], test) for id, test in tests.items()
    ]:
        same = len(u) == len(theirs.u) and np.array_equal(u, theirs.u) and np.array_equal(y, theirs.y)
        init = getattr(theirs, "state_initialization_window_length", None)
        start = "" if init in (None, problem["init"]) else f"; start from {init} samples there, from {problem['init']} here"
        print(f"{name}, {id}: {'the same' if same else 'OTHER'} {len(u)} rows{start}")
        differences += not same
    return differences


class Sindy:
    """A polynomial law of third degree by PySINDy, in units of the training rows' spread; times count in samples."""

    def __init__(self, u, y, smoothing, threshold):
        import pysindy

        self.smoothing, self.scale = smoothing, (y.mean(), y.std(), u.mean(), u.std())
        self.model = pysindy.SINDy(
            optimizer=pysindy.STLSQ(threshold=threshold),
            feature_library=pysindy.PolynomialLibrary(degree=3),
        )
        states, rates, inputs = self.states(u, y)
        self.model.fit(states, t=1.0, x_dot=rates, u=inputs)

    def states(self, u, y):
        """Position and velocity, their rates, and the input, by a polynomial of fifth degree through or near the samples."""
        from scipy.interpolate import make_interp_spline
        from scipy.signal import savgol_filter

        center, spread, level, size = self.scale
        x = (y - center) / spread
        if self.smoothing:
            x, v, a = (savgol_filter(x, self.smoothing, min(5, self.smoothing - 1), deriv=order) for order in (0, 1, 2))
        else:
            spline = make_interp_spline(np.arange(len(x)), x, k=5)
            v, a = (spline(np.arange(len(x)), order) for order in (1, 2))
        return np.column_stack([x, v]), np.column_stack([v, a]), ((u - level) / size)[:, None]

    def run(self, u, y, init, held):
        """Free run from the state that the first samples show."""
        states, _, inputs = self.states(u, y)
        inputs = inputs[:, 0]
        state, found = states[init - 2].copy(), np.full(len(y), np.nan)
        powers = np.array(self.model.feature_library.powers_)
        weights = self.model.coefficients()
        bounded = lambda state, u: np.clip([*state, u], -1e3, 1e3)
        rate = lambda state, u: weights @ np.prod(bounded(state, u) ** powers, axis=1)
        for at in range(init - 2, len(y) - 1):
            a, b = inputs[at], inputs[at] if held else inputs[at + 1]
            for part in range(SUBSTEPS):
                u0, u1, h = a + (b - a) * part / SUBSTEPS, a + (b - a) * (part + 1) / SUBSTEPS, 1 / SUBSTEPS
                k1 = rate(state, u0)
                k2 = rate(state + 0.5 * h * k1, 0.5 * (u0 + u1))
                k3 = rate(state + 0.5 * h * k2, 0.5 * (u0 + u1))
                k4 = rate(state + h * k3, u1)
                state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
                if not np.all(np.abs(state) < 1e3):
                    return np.full(len(y), np.inf)
            found[at + 1] = state[0]
        return self.scale[0] + self.scale[1] * found

    def error(self, u, y, init, held):
        return float(np.sqrt(np.mean((self.run(u, y, init, held)[init:] - y[init:]) ** 2)))


def pysindy_errors(name, problem, base):
    parts = {id: (part["use"], *read(problem, part, base)[:2]) for id, part in problem["part"].items()}
    held, init = problem.get("hold") == "zero", problem["init"]
    of = lambda use: [(id, u, y) for id, (usage, u, y) in parts.items() if usage == use]
    [(_, u, y)], [(_, *validation)] = of("training"), of("validation")
    tried = [Sindy(u, y, smoothing, threshold) for smoothing in SMOOTHINGS for threshold in THRESHOLDS]
    errors = [model.error(*validation, init, held) for model in tried]
    best = tried[int(np.argmin(errors))]
    terms = int(np.count_nonzero(best.model.coefficients()))
    cells = [f"{id} {best.error(u, y, init, held):.3g}" for id, u, y in of("test")]
    print(f"{name}, PySINDy: {', '.join(cells)}, validation {min(errors):.3g} {problem['unit']}, {terms} terms", flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--config", type=Path, default=Path("configs/benchmarks.toml"))
    arguments.add_argument("--only", help="name of one problem")
    arguments.add_argument("--skip", choices=["splits", "pysindy"])
    arguments = arguments.parse_args()
    problems = tomllib.loads(arguments.config.read_text())["problem"]
    differences = 0
    for name, problem in problems.items():
        folder = (arguments.config.parent / problem["folder"]).resolve()
        if arguments.only not in (None, name):
            continue
        if not folder.is_dir():
            print(f"SKIPPED {name}: no folder {folder}", file=sys.stderr)
            continue
        for word, task in [("splits", compare_splits), ("pysindy", pysindy_errors)]:
            if arguments.skip == word:
                continue
            try:
                differences += task(name, problem, arguments.config.parent) or 0
            except ImportError as error:
                print(f"SKIPPED {name}, {word}: {error}; install it with pip", file=sys.stderr)
    sys.exit(1 if differences else 0)


if __name__ == "__main__":
    main()
