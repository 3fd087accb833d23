#!/usr/bin/env python3
"""PINN and LSTM estimators of the decay rate beside JAX and equinox: the same record, the same networks, one thread, compiled beforehand.

    XLA_FLAGS=--xla_cpu_multi_thread_eigen=false OMP_NUM_THREADS=1 taskset -c 0 VENV/bin/python experiments/peers/estimators.py RECORD.CSV TRAINER

What stands in the table: the median of nine trainings after one that compiles (of the program, of nine runs by its own clock), and how
far the decay rate is from least squares on the same peaks. Peers train until they are within 0.1 % of it and their loss stands still.
"""

import csv
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

RUNS, HIDDEN, COLLOCATION, UNITS = 9, 16, 128, 16


def peaks(path):
    """Times in units of the record's length, and logarithms of |peak| by parabolas through three samples."""
    with open(path, newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    t, x = np.array([[float(cell) for cell in row[:2]] for row in rows[1:]]).T
    x = x - x.mean()
    at = [i for i in range(1, len(x) - 1) if x[i] > 0 and x[i] >= x[i - 1] and x[i] > x[i + 1]]
    bend = [x[i - 1] - 2 * x[i] + x[i + 1] for i in at]
    part = [0.5 * (x[i - 1] - x[i + 1]) / b for i, b in zip(at, bend)]
    times = np.array([t[i] + p * (t[1] - t[0]) for i, p in zip(at, part)])
    heights = np.array([x[i] - 0.25 * (x[i - 1] - x[i + 1]) * p for i, p in zip(at, part)])
    rate = -np.polyfit(times, np.log(heights), 1)[0]
    span = times[-1] - times[0]
    y = np.log(heights)
    return (times - times[0]) / span, (y - y.mean()) / y.std(), rate * span / y.std()


def timed(train, rate):
    train()
    seconds, found = [], None
    for _ in range(RUNS):
        begin = time.perf_counter()
        found = float(train())
        seconds.append(time.perf_counter() - begin)
    return statistics.median(seconds), 100 * abs(found / rate - 1)


def jax_pinn(t, y):
    """A network of two hidden layers beside a line, its derivative exact, trained by BFGS, the physics' weight raised in stages: with fewer it
    stops 0.8 to 19 % from least squares."""
    import jax
    import jax.numpy as jnp
    from jax.flatten_util import ravel_pytree
    from jax.scipy.optimize import minimize

    jax.config.update("jax_enable_x64", True)
    keys = jax.random.split(jax.random.PRNGKey(0), 3)
    sizes = [1, HIDDEN, HIDDEN, 1]
    layers = [(0.5 * jax.random.normal(k, (a, b)) / np.sqrt(a), jnp.zeros(b)) for k, a, b in zip(keys, sizes, sizes[1:])]
    begin, unravel = ravel_pytree((layers, jnp.zeros(2), jnp.zeros(())))
    grid = jnp.linspace(0.0, 1.0, COLLOCATION)

    def value(layers, line, time):
        hidden = jnp.array([time])
        for weights, bias in layers[:-1]:
            hidden = jnp.tanh(hidden @ weights + bias)
        weights, bias = layers[-1]
        return (hidden @ weights + bias)[0] + line[0] + line[1] * time

    def loss(flat, weight):
        layers, line, rate = unravel(flat)
        data = jax.vmap(lambda time: value(layers, line, time))(t) - y
        slope = jax.vmap(jax.grad(lambda time: value(layers, line, time)))(grid)
        return jnp.mean(data**2) + weight * jnp.mean((slope + rate) ** 2)

    @jax.jit
    def train(flat):
        for weight in (0.1, 1.0, 10.0, 100.0):
            flat = minimize(loss, flat, args=(weight,), method="BFGS", options={"maxiter": 500, "gtol": 1e-6}).x
        return unravel(flat)[2]

    return lambda: train(begin).block_until_ready()


def equinox_lstm(t, y):
    """The state after the last peak gives a line, trained by optax's L-BFGS."""
    import equinox as eqx
    import jax
    import jax.numpy as jnp
    import optax
    from jax.flatten_util import ravel_pytree

    jax.config.update("jax_enable_x64", True)
    one, two = jax.random.split(jax.random.PRNGKey(0))
    model = (eqx.nn.LSTMCell(2, UNITS, key=one, dtype=jnp.float64), eqx.nn.Linear(UNITS, 2, key=two, dtype=jnp.float64))
    weights, fixed = eqx.partition(model, eqx.is_array)
    begin, unravel = ravel_pytree(weights)
    sequence = jnp.stack([t, y], axis=1)

    def line(flat):
        cell, head = eqx.combine(unravel(flat), fixed)
        state = jax.lax.scan(lambda state, x: (cell(x, state), None), (jnp.zeros(UNITS), jnp.zeros(UNITS)), sequence)[0]
        return head(state[0])

    def loss(flat):
        intercept, slope = line(flat)
        return jnp.mean((intercept + slope * t - y) ** 2)

    solver = optax.lbfgs(memory_size=10)

    @jax.jit
    def train(flat):
        both = optax.value_and_grad_from_state(loss)

        def step(carry):
            flat, state, _, number = carry
            before, slope = both(flat, state=state)
            update, state = solver.update(slope, state, flat, value=before, grad=slope, value_fn=loss)
            return flat + update, state, jnp.linalg.norm(slope), number + 1

        def goes_on(carry):
            return (carry[2] > 1e-8) & (carry[3] < 200)

        flat = jax.lax.while_loop(goes_on, step, (flat, solver.init(flat), jnp.inf, 0))[0]
        return -line(flat)[1]

    return lambda: train(begin).block_until_ready()


def ours(trainer, record, method):
    """Seconds of the fit by the program's own clock, and its distance from least squares in percent."""
    seconds = []
    for _ in range(RUNS):
        with tempfile.TemporaryDirectory() as out:
            call = [trainer, f"configs/{method}.toml", f"data.path={Path(record).resolve()}", "--json", "--quiet", "--out", f"{out}/run"]
            said = subprocess.run(call, capture_output=True, text=True, env={**os.environ, "RAYON_NUM_THREADS": "1"})
        answer = json.loads(said.stdout)
        seconds.append(answer["seconds"])
    return statistics.median(seconds), answer["worst_error_percent"]


def main():
    record, trainer = sys.argv[1:3]
    t, y, rate = peaks(record)
    print("| estimator | peer | its seconds | its distance from least squares, % | ours, seconds | distance, % |\n|---|---|---|---|---|---|")
    for method, name, build in (("pinn", "JAX, BFGS", jax_pinn), ("lstm", "equinox, L-BFGS of optax", equinox_lstm)):
        own = ours(trainer, record, method)
        try:
            peer = timed(build(t, y), rate)
            cells = f"{peer[0]:.4f} | {peer[1]:.2g}"
        except ImportError as error:
            print(f"SKIPPED: {name}: {error}", file=sys.stderr)
            cells = "not installed | "
        print(f"| {method} | {name} | {cells} | {own[0]:.4f} | {own[1]:.2g} |")


if __name__ == "__main__":
    main()
