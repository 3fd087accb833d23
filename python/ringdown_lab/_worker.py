"""Learners and estimators written in Python, each in a process of its own.

A worker is ``python -m ringdown_lab._worker``: it gets an object, fits it and predicts with it, message by message. What the object
prints goes to standard error. Its crash is an exception here and nothing else.
"""

from __future__ import annotations

import importlib.util
import os
import pickle
import subprocess
import sys
import threading
import traceback
from typing import IO, Any

_LENGTH = 8


class WorkerError(RuntimeError):
    """What went wrong in a worker, in the words of its exception."""


def _send(stream: IO[bytes], message: bytes) -> None:
    stream.write(len(message).to_bytes(_LENGTH, "little") + message)
    stream.flush()


def _receive(stream: IO[bytes]) -> Any:
    head = stream.read(_LENGTH)
    if len(head) < _LENGTH:
        raise EOFError
    return pickle.loads(stream.read(int.from_bytes(head, "little")))


def _dumped(own: object) -> bytes:
    """An object as bytes. cloudpickle takes classes of notebooks and scripts along, pickle their names only."""
    if importlib.util.find_spec("cloudpickle") is not None:
        import cloudpickle  # type: ignore[import-not-found, import-untyped, unused-ignore]

        return cloudpickle.dumps(own)  # type: ignore[no-any-return, unused-ignore]
    if type(own).__module__ == "__main__":
        raise WorkerError(
            f"{type(own).__name__} is defined in a notebook or script, which another process cannot import; "
            "pip install cloudpickle, or define it in a module"
        )
    return pickle.dumps(own)


class Worker:
    """A process with an object in it."""

    def __init__(self, own: object) -> None:
        dumped = _dumped(own)
        line = [sys.executable, "-m", "ringdown_lab._worker"]
        # Ctrl-C is for the parent, which ends its workers itself.
        self._process = subprocess.Popen(line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True)
        self._lock = threading.Lock()
        self.call("begin", [path for path in sys.path if path], dumped)

    def call(self, what: str, *arguments: Any) -> Any:
        """Calls a method of the object there and gives what it returns. Raises WorkerError."""
        with self._lock:
            writing, reading = self._process.stdin, self._process.stdout
            assert writing is not None and reading is not None
            try:
                _send(writing, pickle.dumps((what, arguments)))
                done, told = _receive(reading)
            except (EOFError, OSError, ValueError):
                code = self._process.poll()
                raise WorkerError(f"its process ended (exit code {code}) during {what}") from None
        if not done:
            raise WorkerError(told)
        return told

    def close(self) -> None:
        """Ends the process, whatever it does."""
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                try:
                    stream.close()
                except OSError:
                    pass


def count_parameters(model: Any) -> int:
    """Trained numbers of a model: what it states as ``parameters``, or those of a torch module."""
    stated = getattr(model, "parameters", 0)
    if callable(stated):
        return sum(int(tensor.numel()) for tensor in stated())
    return int(stated)


def _serve(reading: IO[bytes], writing: IO[bytes]) -> None:
    own: Any = None
    while True:
        try:
            what, arguments = _receive(reading)
        except EOFError:
            return
        try:
            told: Any = None
            if what == "begin":
                sys.path[:] = arguments[0]
                own = pickle.loads(arguments[1])
            elif what == "fit":
                fitted = own.fit(*arguments)
                own = own if fitted is None else fitted
                told = count_parameters(own)
            elif what == "estimate":
                told = own.fit(*arguments)
            else:
                told = own.predict(*arguments)
            message = pickle.dumps((True, told))
        except Exception as error:
            traceback.print_exc()
            message = pickle.dumps((False, f"{type(error).__name__}: {error}"))
        _send(writing, message)


if __name__ == "__main__":
    # Messages keep the real standard output; everything printed goes to standard error.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    _serve(sys.stdin.buffer, answers)
