"""The command line in a process of its own, whose result is the JSON that it prints."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

from ._native import RingdownError


def result_of(words: Sequence[str], cwd: str | None = None) -> dict[str, Any]:
    """The result of a command. Its process ends with this one, even where this one is killed.

    Raises RingdownError with the command line's message where there is no result, KeyboardInterrupt where it was interrupted.
    """
    line = [sys.executable, "-m", "ringdown_lab._tied", *words, "--json"]
    # The other end of the child's standard input closes with this process, however it ends.
    reading, writing = os.pipe()
    try:
        done = subprocess.run(line, stdin=reading, capture_output=True, text=True, cwd=cwd, check=False)
    finally:
        os.close(reading)
        os.close(writing)
    if done.returncode == 130:
        raise KeyboardInterrupt
    try:
        return json.loads(done.stdout)  # type: ignore[no-any-return]
    except json.JSONDecodeError:
        message = done.stderr.strip().removeprefix("error: ")
        raise RingdownError(message or f"the command line ended without a result (exit code {done.returncode})") from None
