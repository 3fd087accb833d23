#!/usr/bin/env python3
"""Other people's libraries on the records of a learning study: the same files, the same split, the same free runs.

    python3 experiments/peers/peers.py RECORDS NOMINAL_STIFFNESS NOMINAL_DAMPING --period 1.57 --noise 1e-3 [--ours RESULT.JSON]

RECORDS is the folder of `trainer simulate` (records/record-000.csv, ...). The first twelve records are learned from, three choose,
the last five are tested on; every prediction starts from a period of the past and sees no later observation. A peer that is
not installed, or fails, is said on standard error and stands in the table as such. Every training ends after --minutes of
processor time, which the table's seconds are too; what was cut short is said with the steps that it took.
"""

import argparse
import csv
import json
import sys
import time
from pathlib import Path

import numpy as np

TRAIN, VALIDATION, TEST = slice(0, 12), slice(12, 15), slice(15, 20)


class Record:
    def __init__(self, path):
        with open(path, newline="") as file:
            rows = list(csv.reader(line for line in file if not line.startswith("#")))
        columns = np.array([[float(cell) for cell in row] for row in rows[1:]]).T
        self.t, self.x = columns[0] - columns[0][0], columns[1]
        self.u = columns[2] if len(columns) > 2 else np.zeros_like(self.t)


class Data:
    def __init__(self, arguments):
        paths = sorted(Path(arguments.records).glob("record-*.csv")) or sorted(
            Path(arguments.records).glob("records/record-*.csv"))
        records = [Record(path) for path in paths]
        if len(records) != 20:
            sys.exit(f"{len(records)} records in {arguments.records}, expected 20")
        self.train, self.validation, self.test = records[TRAIN], records[VALIDATION], records[TEST]
        self.driven = bool(np.any(records[0].u))
        self.dt = float(np.mean(np.diff(records[0].t)))
        self.past = int(round(arguments.period / self.dt)) + 1
        self.k, self.c = arguments.stiffness, arguments.damping
        self.noise, self.seconds, self.period = arguments.noise, 60.0 * arguments.minutes, arguments.period


def smoothed(record, data):
    """Position, velocity, acceleration by cubic Savitzky-Golay over a quarter of a period."""
    from scipy.signal import savgol_filter

    width = max(7, 2 * int(data.period / data.dt / 8) + 1)
    return [savgol_filter(record.x, width, 4, deriv=order, delta=data.dt, mode="interp") for order in range(3)]


def start_state(record, data):
    """State at the end of the past, from the past alone: a cubic over its last quarter of a period."""
    width = max(7, int(data.period / data.dt / 4))
    past = slice(data.past - width, data.past)
    t = record.t[past] - record.t[data.past - 1]
    fit = np.polynomial.polynomial.polyfit(t, record.x[past], 3)
    return fit[0], fit[1]


def march(acceleration, record, data):
    """Free run of x'' = acceleration(x, v, u) by Runge-Kutta of fourth order, two steps a sample, the input held."""
    x, v = start_state(record, data)
    h, found = data.dt / 2, []
    for at in range(data.past - 1, len(record.t) - 1):
        u = record.u[at]
        for _ in range(2):
            def slope(x, v, u=u):
                return v, acceleration(x, v, u)
            a = slope(x, v)
            b = slope(x + h / 2 * a[0], v + h / 2 * a[1])
            c = slope(x + h / 2 * b[0], v + h / 2 * b[1])
            d = slope(x + h * c[0], v + h * c[1])
            x += h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
            v += h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
        if not abs(x) < 1e3:
            return None
        found.append(x)
    return np.array(found)


def error(predict, data, records=None):
    squares, count = 0.0, 0
    for record in records or data.test:
        found = predict(record)
        if found is None:
            return float("inf")
        squares += float(np.sum((found - record.x[data.past:]) ** 2))
        count += len(found)
    return (squares / count) ** 0.5


def nominal(data):
    return lambda record: march(lambda x, v, u: u - data.k * x - data.c * v, record, data)


def pysindy(data):
    import pysindy as ps

    names = ["x", "v", "sign v", "v|v|", "x^3", "sin x", "u"]
    library = [lambda x, v, u: x, lambda x, v, u: v, lambda x, v, u: np.sign(v), lambda x, v, u: v * np.abs(v),
               lambda x, v, u: x ** 3, lambda x, v, u: np.sin(x), lambda x, v, u: u]
    if not data.driven:
        names, library = names[:-1], library[:-1]
    states = [smoothed(record, data) for record in data.train]
    inner = slice(10, -10)
    rows = np.vstack([np.column_stack([f(s[0], s[1], r.u) for f in library])[inner] for s, r in zip(states, data.train)])
    right = np.concatenate([s[2][inner] for s in states])
    best = None
    for threshold in [0.003, 0.01, 0.03, 0.1, 0.3]:
        # PySINDy's thresholded least squares on the columns scaled to unit size.
        scale = np.sqrt(np.mean(rows ** 2, axis=0))
        optimizer = ps.STLSQ(threshold=threshold * np.std(right), alpha=1e-10)
        optimizer.fit(rows / scale, right.reshape(-1, 1))
        weights = np.ravel(optimizer.coef_) / scale
        def predict(record, weights=weights):
            return march(lambda x, v, u: float(sum(w * f(x, v, u) for w, f in zip(weights, library))), record, data)
        found = error(predict, data, data.validation)
        if best is None or found < best[0]:
            best = (found, predict, {n: round(float(w), 4) for n, w in zip(names, weights) if w})
    return best[1], f"{best[2]}"


def gpytorch_torque(data):
    import gpytorch
    import torch

    torch.set_default_dtype(torch.float64)
    torch.manual_seed(0)
    torch.set_num_threads(1)
    states = [smoothed(record, data) for record in data.train]
    rows = np.vstack([np.column_stack([s[0], s[1]])[10:-10:6] for s in states])
    right = np.concatenate([(s[2] + data.k * s[0] + data.c * s[1] - r.u)[10:-10:6] for s, r in zip(states, data.train)])
    center, spread, size = rows.mean(0), rows.std(0), right.std()
    inputs, targets = torch.tensor((rows - center) / spread), torch.tensor(right / size)

    class Process(gpytorch.models.ExactGP):
        def __init__(self, likelihood):
            super().__init__(inputs, targets, likelihood)
            self.mean_module = gpytorch.means.ConstantMean()
            self.covar_module = gpytorch.kernels.ScaleKernel(gpytorch.kernels.RBFKernel(ard_num_dims=2))

        def forward(self, x):
            return gpytorch.distributions.MultivariateNormal(self.mean_module(x), self.covar_module(x))

    likelihood = gpytorch.likelihoods.GaussianLikelihood()
    model = Process(likelihood)
    model.train(), likelihood.train()
    optimizer = torch.optim.Adam(model.parameters(), lr=0.1)
    marginal = gpytorch.mlls.ExactMarginalLogLikelihood(likelihood, model)
    begun = time.process_time()
    for _ in range(60):
        optimizer.zero_grad()
        (-marginal(model(inputs), targets)).backward()
        optimizer.step()
        if time.process_time() - begun > data.seconds:
            break
    model.eval(), likelihood.eval()
    with torch.no_grad():
        kernel = model.covar_module(inputs).to_dense() + likelihood.noise * torch.eye(len(targets))
        weights = torch.linalg.solve(kernel, targets - model.mean_module.constant).numpy()
        lengths = model.covar_module.base_kernel.lengthscale.numpy().ravel()
        amplitude, mean = float(model.covar_module.outputscale), float(model.mean_module.constant)
    scaled = inputs.numpy() / lengths

    def torque(x, v):
        place = ((np.array([x, v]) - center) / spread) / lengths
        return size * (mean + amplitude * float(np.exp(-0.5 * np.sum((scaled - place) ** 2, axis=1)) @ weights))

    return lambda record: march(lambda x, v, u: u - data.k * x - data.c * v + torque(x, v), record, data), ""


def diffrax_neural_ode(data):
    import diffrax
    import equinox as eqx
    import jax
    import jax.numpy as jnp
    import optax

    jax.config.update("jax_enable_x64", True)
    scale = [np.std(np.concatenate([smoothed(r, data)[order] for r in data.train])) for order in range(3)]
    network = eqx.nn.MLP(2, "scalar", 16, 2, activation=jnp.tanh, key=jax.random.PRNGKey(0))
    network = jax.tree_util.tree_map(lambda p: p.astype(jnp.float64) if eqx.is_inexact_array(p) else p, network)
    length = int(2 * data.period / data.dt)
    pieces = [(r, at) for r in data.train for at in range(0, len(r.x) - length, length // 2)]
    states = {id(r): smoothed(r, data) for r in data.train}
    x = jnp.array([r.x[at:at + length] for r, at in pieces])
    u = jnp.array([r.u[at:at + length] for r, at in pieces])
    begin = jnp.array([[states[id(r)][0][at], states[id(r)][1][at]] for r, at in pieces])
    times = jnp.arange(length) * data.dt

    def torque(network, x, v):
        return scale[2] * network(jnp.array([x / scale[0], v / scale[1]]))

    def run(network, start, u):
        def field(t, y, _):
            drive = u[jnp.clip((t / data.dt + 1e-9).astype(int), 0, length - 1)]
            return jnp.array([y[1], drive - data.k * y[0] - data.c * y[1] + torque(network, y[0], y[1])])
        found = diffrax.diffeqsolve(diffrax.ODETerm(field), diffrax.Tsit5(), 0.0, times[-1], data.dt / 2, start,
                                    saveat=diffrax.SaveAt(ts=times), max_steps=4 * length)
        return found.ys[:, 0]

    def loss(both, x, u, begin):
        network, shift = both
        found = jax.vmap(lambda start, u: run(network, start, u))(begin + shift, u)
        return jnp.mean((found - x) ** 2) / scale[0] ** 2

    steps = 600
    optimizer = optax.adam(optax.cosine_decay_schedule(5e-3, steps))
    both = (network, jnp.zeros_like(begin))
    state = optimizer.init(eqx.filter(both, eqx.is_inexact_array))

    @eqx.filter_jit
    def step(both, state):
        value, gradient = eqx.filter_value_and_grad(loss)(both, x, u, begin)
        change, state = optimizer.update(gradient, state)
        return eqx.apply_updates(both, change), state, value

    begun, taken = time.process_time(), 0
    for taken in range(1, steps + 1):
        both, state, value = step(both, state)
        if time.process_time() - begun > data.seconds:
            break
    layers = [(np.array(l.weight), np.array(l.bias)) for l in both[0].layers]

    def learned(x, v):
        z = np.array([x / scale[0], v / scale[1]])
        for number, (weight, bias) in enumerate(layers):
            z = weight @ z + bias
            z = np.tanh(z) if number + 1 < len(layers) else z
        return scale[2] * float(np.ravel(z)[0])

    return (lambda record: march(lambda x, v, u: u - data.k * x - data.c * v + learned(x, v), record, data),
            f"{taken} steps of Adam")


def pytorch_lstm(data):
    import torch

    torch.manual_seed(0)
    torch.set_num_threads(1)
    torch.set_default_dtype(torch.float64)
    size = np.std(np.concatenate([r.x for r in data.train]))
    drive = np.std(np.concatenate([r.u for r in data.train])) or 1.0
    horizon = 3 * data.past

    class Model(torch.nn.Module):
        """Reads the past; then follows the input, fed with its own last prediction."""

        def __init__(self):
            super().__init__()
            self.cell, self.head = torch.nn.LSTMCell(2, 24), torch.nn.Linear(24, 1)

        def forward(self, past, u):
            h = c = torch.zeros(past.shape[0], 24)
            for at in range(past.shape[1]):
                h, c = self.cell(torch.stack([past[:, at], u[:, at]], 1), (h, c))
            now, found = past[:, -1], []
            for at in range(past.shape[1], u.shape[1]):
                now = now + self.head(h)[:, 0]
                found.append(now)
                h, c = self.cell(torch.stack([now, u[:, at]], 1), (h, c))
            return torch.stack(found, 1)

    windows = [(r, at) for r in data.train for at in range(0, len(r.x) - data.past - horizon, 8)]
    x = torch.tensor(np.array([r.x[at:at + data.past + horizon] for r, at in windows]) / size)
    u = torch.tensor(np.array([r.u[at:at + data.past + horizon] for r, at in windows]) / drive)
    model = Model()
    optimizer = torch.optim.Adam(model.parameters(), lr=5e-3)

    def predict(record):
        with torch.no_grad():
            past = torch.tensor(record.x[:data.past] / size)[None]
            return size * model(past, torch.tensor(record.u / drive)[None])[0].numpy()

    begun, best, epochs = time.process_time(), (float("inf"), None), 0
    while time.process_time() - begun < data.seconds:
        epochs += 1
        for batch in torch.randperm(len(windows)).split(32):
            optimizer.zero_grad()
            loss = ((model(x[batch][:, :data.past], u[batch]) - x[batch][:, data.past:]) ** 2).mean()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
            optimizer.step()
            if time.process_time() - begun > data.seconds:
                break
        found = error(predict, data, data.validation)
        if found < best[0]:
            best = (found, {name: value.clone() for name, value in model.state_dict().items()})
    if best[1]:
        model.load_state_dict(best[1])
    return predict, f"{epochs} epochs"


def deepxde_pinn(data):
    import os

    os.environ.setdefault("DDE_BACKEND", "pytorch")
    import deepxde as dde
    import torch

    torch.set_num_threads(1)
    dde.config.set_random_seed(0)
    dde.config.set_default_float("float64")
    record = data.train[0]
    names = ["x", "v", "sign v", "v|v|", "x^3", "u"]
    start = [-data.k, -data.c, 0.0, 0.0, 0.0, 1.0]
    weights = [dde.Variable(value) for value in (start if data.driven else start[:-1])]
    t = torch.tensor(record.t)
    drive = torch.tensor(record.u)

    def residual(time_, y):
        v = dde.grad.jacobian(y, time_)
        a = dde.grad.hessian(y, time_)
        terms = [y, v, torch.sign(v), v * torch.abs(v), y ** 3]
        if data.driven:
            place = torch.clamp(torch.searchsorted(t, time_[:, 0].detach().contiguous()), 0, len(t) - 1)
            terms.append(drive[place][:, None])
        return (a - sum(w * term for w, term in zip(weights, terms))) / abs(data.k)

    observed = dde.icbc.PointSetBC(record.t[:, None], record.x[:, None])
    problem = dde.data.PDE(dde.geometry.TimeDomain(0, record.t[-1]), residual, [observed], num_domain=600,
                           anchors=record.t[:, None])
    network = dde.nn.FNN([1] + [32] * 3 + [1], "tanh", "Glorot uniform")
    rate = 2 * np.pi / data.period
    network.apply_feature_transform(lambda t: torch.cat(
        [t / float(record.t[-1])] + [f(n * rate * t) for n in (1, 2, 3) for f in (torch.sin, torch.cos)], 1))
    network.linears[0] = torch.nn.Linear(7, 32, dtype=torch.float64)
    model = dde.Model(problem, network)
    model.compile("adam", lr=2e-3, loss_weights=[1, 100], external_trainable_variables=weights)
    class Budget(dde.callbacks.Callback):
        begun = time.process_time()

        def on_epoch_end(self):
            if time.process_time() - self.begun > data.seconds:
                self.model.stop_training = True

    model.train(iterations=20000, callbacks=[Budget()], display_every=5000, verbose=0)
    found = [float(w.detach()) for w in weights]

    def acceleration(x, v, u):
        terms = [x, v, np.sign(v), v * abs(v), x ** 3, u]
        return sum(w * term for w, term in zip(found, terms))

    return (lambda record: march(acceleration, record, data),
            f"{ {n: round(w, 4) for n, w in zip(names, found)} }, from one record, {model.train_state.epoch} steps of Adam")


def operon_acceleration(data):
    from pyoperon.sklearn import SymbolicRegressor

    states = [smoothed(record, data) for record in data.train]
    rows = np.vstack([np.column_stack([s[0], s[1], r.u])[10:-10:4] for s, r in zip(states, data.train)])
    right = np.concatenate([s[2][10:-10:4] for s in states])
    inputs = 3 if data.driven else 2
    best = None
    for length in [10, 20, 40]:
        # sign v is v/|v| here: Operon has no sign.
        model = SymbolicRegressor(allowed_symbols="add,sub,mul,div,sin,abs,constant,variable", max_length=length,
                                  optimizer_iterations=5, max_time=int(data.seconds / 3), max_evaluations=10**9,
                                  generations=10**6, n_threads=1, random_state=0)
        model.fit(rows[:, :inputs], right)

        def acceleration(x, v, u, model=model):
            return float(model.predict(np.array([[x, v, u][:inputs]]))[0])

        def predict(record, acceleration=acceleration):
            return march(acceleration, record, data)
        found = error(predict, data, data.validation)
        if best is None or found < best[0]:
            best = (found, predict, model.get_model_string(model.model_, 4))
    return best[1], best[2]


PEERS = [
    ("PySINDy, thresholded least squares", "sindy", pysindy),
    ("GPyTorch, torque on smoothed derivatives", "gaussian-process", gpytorch_torque),
    ("diffrax, neural ODE by multiple shooting", "neural-ode", diffrax_neural_ode),
    ("PyTorch, LSTM fed with its own prediction", "lstm", pytorch_lstm),
    ("DeepXDE, inverse PINN on one record", "pinn", deepxde_pinn),
    ("Operon, acceleration from smoothed derivatives", "symbolic", operon_acceleration),
]


def ours(path, problem):
    rows = json.loads(Path(path).read_text())["results"] if path else []
    return {row["id"]: row for row in rows if row["problem"] == problem and row["test"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("records")
    parser.add_argument("stiffness", type=float)
    parser.add_argument("damping", type=float)
    parser.add_argument("--period", type=float, required=True, help="typical period in seconds: the past is as long")
    parser.add_argument("--noise", type=float, required=True, help="standard deviation of the sensor")
    parser.add_argument("--minutes", type=float, default=2.0, help="most minutes of processor time for each training")
    parser.add_argument("--ours", help="result.json of a learning study on the same records")
    parser.add_argument("--problem", default="", help="its name there")
    parser.add_argument("--only", default="", help="peers whose name holds this")
    arguments = parser.parse_args()
    data = Data(arguments)
    own = ours(arguments.ours, arguments.problem)
    print("| peer | free run over noise | seconds | ours | free run over noise | seconds |")
    print("|---|---|---|---|---|---|")
    for title, learner, make in PEERS:
        if arguments.only and arguments.only.lower() not in title.lower():
            continue
        begun, note = time.process_time(), ""
        try:
            predict, note = make(data)
            seconds = f"{time.process_time() - begun:.1f}"
            found = f"{error(predict, data) / data.noise:.3g}"
        except ImportError as problem:
            print(f"SKIPPED: {title}: {problem}", file=sys.stderr)
            found, seconds = "not installed", "–"
        except Exception as problem:  # a peer's failure is a row, not the end of the table
            print(f"FAILED: {title}: {type(problem).__name__}: {problem}", file=sys.stderr)
            found, seconds = "failed", f"{time.process_time() - begun:.1f}"
        row = own.get(learner)
        mine = [learner, f"{row['test']['over_noise']:.3g}", f"{row['seconds']:.1f}"] if row and row["test"]["over_noise"] else [learner, "–", "–"]
        print(f"| {title} | {found} | {seconds} | {' | '.join(mine)} |", flush=True)
        if note:
            print(f"{title}: {note}", file=sys.stderr)
    print(f"nominal simulator: {error(nominal(data), data) / data.noise:.3g} times the noise", file=sys.stderr)


if __name__ == "__main__":
    main()
