"""Executes notebooks: python execute.py [NOTEBOOK…], all beside this file where none is named. Nothing is written.

Needs nbclient and ipykernel.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient


def main() -> None:
    """Executes each notebook and says how long it took; an error in a cell ends the program with exit code 1."""
    here = Path(__file__).parent
    for path in [Path(name) for name in sys.argv[1:]] or sorted(here.glob("*.ipynb")):
        start = time.monotonic()
        NotebookClient(nbformat.read(path, as_version=4), timeout=600, kernel_name="python3").execute()
        print(f"{path.name}: {time.monotonic() - start:.1f} s")


if __name__ == "__main__":
    main()
