"""Learners and estimators written in Python, each in a process of its own.

A worker is ``python -m ringdown_lab._serve``: it gets an object, fits it and predicts with it, message by message. What the object
prints goes to standard error. Its crash is an exception here and nothing else.
"""

from __future__ import annotations

import importlib.util
import pickle
import subprocess
import sys
import threading
from typing import IO, Any

_LENGTH = 8


class WorkerError(RuntimeError):
    """What went wrong in a worker, in the words of its exception."""


def send(stream: IO[bytes], message: bytes) -> None:
    """Writes a message after its length."""
    stream.write(len(message).to_bytes(_LENGTH, "little") + message)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """Reads a message. Raises EOFError where the stream ends."""
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
        line = [sys.executable, "-m", "ringdown_lab._serve"]
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
                send(writing, pickle.dumps((what, arguments)))
                done, told = receive(reading)
            except (EOFError, OSError, ValueError):
                raise WorkerError(f"its process ended (exit code {self._ended()}) during {what}") from None
        if not done:
            raise WorkerError(told)
        return told

    def _ended(self) -> int:
        try:
            return self._process.wait(timeout=1.0)
        except subprocess.TimeoutExpired:
            # It has closed its end and goes on.
            self._process.kill()
            return self._process.wait()

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
