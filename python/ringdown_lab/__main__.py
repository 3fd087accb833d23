"""The command ``ringdown``: the same program as ``trainer``."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from ._native import program


def main() -> None:
    """Runs the command line of this process and exits with its code."""
    beside = Path(sys.executable).with_name("ringdown")
    started_as = str(beside) if beside.exists() else shutil.which("ringdown")
    sys.exit(program(["ringdown", *sys.argv[1:]], started_as))


if __name__ == "__main__":
    main()
