"""Many logs, or several rigs, at once, in a process of its own: the command line's batch."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike, fspath
from typing import Any

from ._command import result_of


def diagnose_batch(
    cases: str | PathLike[str],
    out: str | PathLike[str],
    *,
    threads: int | None = None,
    options: Sequence[str] = (),
) -> dict[str, Any]:
    """Diagnoses every folder ``cases/<id>/`` with ``record-*.csv`` and ``nominal.toml``: ``ringdown diagnose --batch``.

    Answers go to ``out/<id>/diagnosis.json``; those that are there already are left alone, so that an interrupted batch goes on.
    One bad case is one reported failure, the others go on.

    threads: how many; left open, one for each core. options: further options of the command line, such as ``["--seed", "3"]``.

    Returns the batch's result: ``cases``, ``diagnosed``, ``skipped``, ``failed``, ``complete``, ``seconds``.
    Raises RingdownError with the command line's message where the batch cannot begin.
    """
    return _diagnosed(["--batch", fspath(cases), "--out", fspath(out)], threads, options)


def diagnose_rigs(
    rigs: Sequence[str | PathLike[str]],
    out: str | PathLike[str],
    *,
    threads: int | None = None,
    options: Sequence[str] = (),
) -> dict[str, Any]:
    """Diagnoses several rigs of one build, each a folder with ``record-*.csv`` and ``nominal.toml``: ``ringdown diagnose --rigs``.

    The answer says which classes of effects the rigs share, and where their coefficients agree; the folder ``out`` holds the
    report. Arguments and errors as for ``diagnose_batch``.
    """
    return _diagnosed(["--rigs", *(fspath(rig) for rig in rigs), "--out", fspath(out)], threads, options)


def _diagnosed(asked: list[str], threads: int | None, options: Sequence[str]) -> dict[str, Any]:
    return result_of(["diagnose", *asked, *options, *([] if threads is None else ["--threads", str(threads)])])
