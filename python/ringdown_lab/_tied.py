"""The command line as a process that ends when its standard input does, which is when the process that started it ends."""

from __future__ import annotations

import os
import threading

from .__main__ import main


def _end_with_the_input() -> None:
    # Not through sys.stdin, whose lock the end of the interpreter would wait for.
    while os.read(0, 4096):
        pass
    os._exit(1)


if __name__ == "__main__":
    threading.Thread(target=_end_with_the_input, daemon=True).start()
    main()
