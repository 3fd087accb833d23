"""The process of a learner or estimator written in Python: see ``_worker``."""

from __future__ import annotations

import os
import pickle
import sys
import traceback
from typing import IO, Any

from ._worker import receive, send


def _count_parameters(model: Any) -> int:
    """Trained numbers of a model: what it states as ``parameters``, or those of a torch module."""
    stated = getattr(model, "parameters", 0)
    if callable(stated):
        return sum(int(tensor.numel()) for tensor in stated())
    return int(stated)


def _serve(reading: IO[bytes], writing: IO[bytes]) -> None:
    own: Any = None
    while True:
        try:
            what, arguments = receive(reading)
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
                told = _count_parameters(own)
            elif what == "estimate":
                told = own.fit(*arguments)
            else:
                told = own.predict(*arguments)
            message = pickle.dumps((True, told))
        except Exception as error:
            traceback.print_exc()
            message = pickle.dumps((False, f"{type(error).__name__}: {error}"))
        send(writing, message)


if __name__ == "__main__":
    # Messages keep the real standard output; everything printed goes to standard error.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    _serve(sys.stdin.buffer, answers)
