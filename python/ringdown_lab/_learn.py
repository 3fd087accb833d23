"""Dynamics learned from records, judged on records never seen."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from os import PathLike
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._nominal import Nominal
from ._record import Record, as_records
from ._worker import Worker, WorkerError

_Array = NDArray[np.float64]
_HEADER = ("method", "kind", "free run", "× noise", "horizon s", "one step", "numbers", "")


class Stretch(NamedTuple):
    """A stretch of a record that a learner sees."""

    time: _Array
    """Times in seconds, strictly increasing."""
    values: _Array
    """Observed positions, one for each time."""
    input: _Array | None
    """The input at each time, where there is one."""


class Ahead(NamedTuple):
    """Times to predict at, all after the past, with the input there."""

    time: _Array
    """Times in seconds."""
    input: _Array | None
    """The input at each time, where there is one."""


class About(NamedTuple):
    """What a learner is told of the data."""

    warm_up_s: float
    """Length of the past that predictions start from, in seconds."""
    period_s: float
    """Typical period of the motion, in seconds."""
    noise: float
    """Standard deviation of the sensor's noise, in ``unit``."""
    unit: str
    """Unit of the positions."""
    max_steps: int | None
    """Cap on the training steps, where there is one."""


class Learner(Protocol):
    """A learner written in Python: ``fit`` on the training part, then ``predict`` from a past.

    ``fit`` returns the model, or None where the learner is the model. The model has ``predict(past, ahead)``, which returns
    positions, one for each time ahead, or a pair of positions and their standard deviations. A model with an attribute
    ``parameters`` states how many numbers were trained.
    """

    def fit(self, train: list[Stretch], validation: list[Stretch], about: About) -> Any:
        """Learns from the training part, choosing by the validation part."""


class Learned:
    """Learners and baselines with their scores on records that none has seen, the best first."""

    def __init__(self, content: dict[str, Any]) -> None:
        self._content = content

    def to_dict(self) -> dict[str, Any]:
        """The content of ``result.json``."""
        return json.loads(json.dumps(self._content))  # type: ignore[no-any-return]

    @property
    def results(self) -> list[dict[str, Any]]:
        """Rows: ``id``, ``kind``, ``test`` with its errors, ``coefficients``, ``equation``, ``failure``."""
        return self._content["results"]  # type: ignore[no-any-return]

    def __getitem__(self, method: str) -> dict[str, Any]:
        for row in self.results:
            if row["id"] == method:
                return row
        raise KeyError(f"{method}; there are {', '.join(row['id'] for row in self.results)}")

    def _rows(self) -> list[tuple[str, ...]]:
        told = []
        for row in self.results:
            test = row["test"] or {}
            numbers = [test.get(key) for key in ("free_run_rmse", "over_noise", "horizon_s", "one_step_rmse")]
            cells = ["–" if number is None else f"{number:.3g}" for number in numbers]
            told.append((row["id"], row["kind"], *cells, str(row["parameters"]), row["failure"] or row["reached"]))
        return told

    def __str__(self) -> str:
        rows = [_HEADER, *self._rows()]
        widths = [max(len(row[at]) for row in rows) for at in range(7)]
        padded = ([cell.ljust(width) for cell, width in zip(row, widths, strict=False)] for row in rows)
        return "\n".join("  ".join([*cells, row[7]]).rstrip() for cells, row in zip(padded, rows, strict=True))

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{name}</th>" for name in _HEADER)
        body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in self._rows())
        unit = escape(self._content["problems"][0]["unit"])
        return f"<table><tr>{head}</tr>{body}</table><p>errors are RMS on records never seen, in {unit}</p>"


def learn(
    records: Iterable[Record | str | PathLike[str]],
    learners: str | Learner | Sequence[str | Learner] | None = None,
    *,
    nominal: Nominal | str | PathLike[str] | None = None,
    baselines: Sequence[str] | None = None,
    seed: int = 0,
    max_steps: int | None = None,
    ablations: bool = True,
    name: str = "records",
    data: Mapping[str, Any] | None = None,
    settings: Mapping[str, Mapping[str, Any]] | None = None,
    threads: int | None = None,
    progress: Callable[[str], object] | None = None,
) -> Learned:
    """Learns the dynamics from records and scores every learner beside the baselines on records that none has seen.

    learners: names of the workspace's own, objects with ``fit`` and ``predict`` (see ``Learner``), or both; left open, all of the
    workspace's. An object works in a process of its own, and is scored as the others are.
    nominal: the simulator, which the baselines ``nominal``, ``recalibrated`` and ``repaired`` need.
    baselines: which ones; left open, all. max_steps: cap on the steps of every fit.
    ablations: judge each learner's model twice more, with everything that it learned at zero, and given noise.
    name: name of the data set, which seeds are drawn by. data: keys of the data set, such as ``{"split": "time"}``.
    settings: sections of the learners, such as ``{"neural-ode": {"hidden": [16]}}``.

    Raises ConfigError for unknown names or settings, RecordError for records that nothing can be learned from. A learner that
    fails is a row with its ``failure``; the others go on.
    """
    system = nominal if nominal is None or isinstance(nominal, Nominal) else Nominal.read(nominal)
    asked = None if learners is None else [learners] if isinstance(learners, str) or hasattr(learners, "fit") else list(learners)
    names = None if asked is None else [one for one in asked if isinstance(one, str)]
    objects = [one for one in asked or [] if not isinstance(one, str)]
    lines = [f"{key} = {json.dumps(value)}" for key, value in (data or {}).items()]
    sections = [
        "\n".join([f"[{section}]", *(f"{key} = {json.dumps(value)}" for key, value in keys.items())])
        for section, keys in (settings or {}).items()
    ]
    wanted = {
        "learners": names,
        "baselines": None if baselines is None else list(baselines),
        "name": name,
        "seed": seed,
        "max_steps": max_steps,
        "ablations": ablations,
        "data": "\n".join(lines),
        "settings": "\n".join(sections),
    }
    own = [(_name(one, objects), _Remote(one)) for one in objects]
    try:
        told = _native.learn(
            [record._native for record in as_records(records)],
            None if system is None else system._native,
            json.dumps(wanted),
            own,
            threads=threads,
            progress=progress,
        )
    finally:
        for _, remote in own:
            remote.close()
    content = json.loads(told)
    failures = {name: remote.failure for name, remote in own}
    for row in content["results"]:
        row["failure"] = row["failure"] or failures.get(row["id"])
    return Learned(content)


def _name(learner: object, beside: list[Any]) -> str:
    """A learner's name in the table: its ``id``, or its class, numbered where several are of one."""
    stated = getattr(learner, "id", None) or type(learner).__name__
    same = [one for one in beside if (getattr(one, "id", None) or type(one).__name__) == stated]
    return str(stated) if len(same) == 1 else f"{stated}-{next(at for at, one in enumerate(same) if one is learner) + 1}"


class _Remote:
    """A learner in its own process, as the extension calls it."""

    def __init__(self, learner: object) -> None:
        self._worker = Worker(learner)
        self.parameters = 0
        self.failure: str | None = None

    def fit(self, train: list[Any], validation: list[Any], about: Any) -> _Remote:
        parts = ([Stretch(*one) for one in part] for part in (train, validation))
        self.parameters = self._worker.call("fit", *parts, About(*about))
        return self

    def predict(self, past: Any, ahead: Any) -> tuple[list[float], list[float] | None]:
        try:
            told = self._worker.call("predict", Stretch(*past), Ahead(*ahead))
            values, std = told if isinstance(told, tuple) else (told, None)
            expected = len(ahead[0])
            return _numbers("values", values, expected), None if std is None else _numbers("deviations", std, expected)
        except (WorkerError, TypeError, ValueError) as error:
            # A prediction that failed counts as one that ran away; the row says why.
            self.failure = self.failure or f"a prediction failed: {error}"
            raise

    def close(self) -> None:
        self._worker.close()


def _numbers(what: str, values: Any, expected: int) -> list[float]:
    numbers = [float(value) for value in np.asarray(values, dtype=np.float64).ravel()]
    if len(numbers) != expected:
        raise WorkerError(f"predict gave {len(numbers)} {what} for {expected} times; expected one for each")
    return numbers
