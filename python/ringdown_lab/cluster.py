"""Shares of a batch, a sweep or trials as tasks of Dask or Ray: the contract ``--shard I/N`` of the command line.

A task runs the command line on its share, in a process that ends with the worker, even a killed one. The cluster starts the share of a
lost worker again, up to three times unless it is configured otherwise. The second attempt does what the first has left open; a share
that is repeated finds nothing to do. Workers need this package in the same version, and a file system that they share, whose locks
hold between machines.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Sequence
from typing import Any

from ._command import result_of


def share(words: Sequence[str], shard: str, *, threads: int = 1, cwd: str | None = None) -> dict[str, Any]:
    """Works on one share, such as ``"2/8"``, and returns what the command line prints as JSON.

    words: a command line with ``--out``, as ``["diagnose", "--batch", "CASES", "--out", "ANSWERS"]``; ``sweep`` and ``trials`` alike.
    threads: how many. cwd: folder that relative paths start from.

    A run or a case that fails is part of the result. Raises RingdownError with the command line's message where there is none.
    """
    return result_of([*words, "--shard", shard, "--as-task", "--threads", str(threads)], cwd)


def with_dask(client: Any, words: Sequence[str], shares: int, *, threads: int = 1) -> list[dict[str, Any]]:
    """Works on all shares through a ``dask.distributed.Client``; returns the results in their order.

    A worker runs as many shares at a time as it has threads, each on ``threads`` threads. Errors are those of ``share``.
    """
    tasks = [
        client.submit(share, list(words), shard, threads=threads, cwd=os.getcwd(), pure=False) for shard in _shards(shares)
    ]
    return client.gather(tasks)  # type: ignore[no-any-return]


def with_ray(words: Sequence[str], shares: int, *, threads: int = 1) -> list[dict[str, Any]]:
    """Works on all shares through Ray, of ``threads`` CPUs each; returns the results in their order.

    Begins a Ray on this machine where none is connected. Errors are those of ``share``.
    """
    try:
        ray = importlib.import_module("ray")
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError("ray is not installed: pip install ringdown-lab[ray]", name=error.name) from None
    task = ray.remote(num_cpus=threads)(share)
    return ray.get([task.remote(list(words), shard, threads=threads, cwd=os.getcwd()) for shard in _shards(shares)])  # type: ignore[no-any-return]


def _shards(shares: int) -> list[str]:
    if shares < 1:
        raise ValueError(f"{shares} shares; expected 1 or more")
    return [f"{number}/{shares}" for number in range(1, shares + 1)]
