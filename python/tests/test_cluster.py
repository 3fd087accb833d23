"""Shares of a batch on a local cluster of Dask or Ray: a worker that is killed in the middle loses nothing and does nothing twice."""

from __future__ import annotations

import json
import os
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import ringdown_lab as rd
from conftest import FRICTION, timeless
from ringdown_lab import cluster

CASES, SHARES = 8, 4
Work = Callable[[list[str]], list[dict[str, Any]]]


@contextmanager
def dask_cluster() -> Iterator[Work]:
    distributed = pytest.importorskip("distributed", reason="no Dask: pip install 'ringdown-lab[dask]'")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as local,
        distributed.Client(local) as client,
    ):
        yield lambda words: cluster.with_dask(client, words, SHARES)


@contextmanager
def ray_cluster() -> Iterator[Work]:
    ray = pytest.importorskip("ray", reason="no Ray: pip install 'ringdown-lab[ray]'")
    try:
        ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    except Exception as error:  # Ray gives its own daemons 30 s, which a busy machine may not.
        ray.shutdown()
        pytest.skip(f"no Ray: it does not start here: {error}")
    try:
        yield lambda words: cluster.with_ray(words, SHARES)
    finally:
        ray.shutdown()


def fleet(cases: Path, nominal: rd.Nominal) -> None:
    for number in range(CASES):
        record = rd.simulate(nominal, FRICTION, rate_hz=130.0, seconds=4.0, noise=5e-4, seed=number)
        folder = cases / f"case-{number}"
        folder.mkdir(parents=True)
        (folder / "record-000.csv").write_text(record.to_csv(9))
        (folder / "nominal.toml").write_text(nominal.to_toml())


def answers(out: Path) -> dict[Path, tuple[int, int]]:
    """The answers there are: each file with what changes when it is written again."""
    found = ((path, path.stat()) for path in out.glob("*/diagnosis.json"))
    return {path: (stat.st_ino, stat.st_mtime_ns) for path, stat in found}


def working(out: Path) -> list[tuple[int, int, str]]:
    """The processes at work on shares: number, that of the worker, share."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            words = (place / "cmdline").read_text().split("\0")
            parent = (place / "stat").read_text().rpartition(")")[2].split()[1]
        except OSError:
            continue
        if "ringdown_lab._tied" in words and str(out) in words:
            found.append((int(place.name), int(parent), words[words.index("--shard") + 1]))
    return found


def wait(what: str, is_so: Callable[[], bool], seconds: float = 300.0) -> None:
    since = time.monotonic()
    while not is_so():
        assert time.monotonic() - since < seconds, what
        time.sleep(0.01)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are looked for in /proc")
@pytest.mark.parametrize("begin", [dask_cluster, ray_cluster], ids=["dask", "ray"])
def test_a_killed_worker_loses_nothing_and_does_nothing_twice(begin: Any, tmp_path: Path, nominal: rd.Nominal) -> None:
    cases, out = tmp_path / "cases", tmp_path / "answers"
    fleet(cases, nominal)
    results: list[dict[str, Any]] = []
    with begin() as work:
        words = ["diagnose", "--batch", str(cases), "--out", str(out)]
        thread = threading.Thread(target=lambda: results.extend(work(words)))
        thread.start()
        wait("no answer comes", lambda: bool(answers(out)) and bool(working(out)))
        child, worker, shard = working(out)[0]
        os.kill(worker, signal.SIGKILL)
        wait("the share goes on without its worker", lambda: all(one[0] != child for one in working(out)), 30.0)
        before = answers(out)
        assert len(before) < CASES, "killed too late"
        thread.join(timeout=600.0)
    assert len(results) == SHARES, "a share was lost"
    # Nothing is lost, …
    after = answers(out)
    assert len(after) == CASES and all(one["complete"] and not one["failed"] for one in results)
    # … and nothing done twice: what was there has not been written again, and only the share begun again finds answers.
    assert all(after[path] == stat for path, stat in before.items())
    assert sum(one["cases"] for one in results) == CASES
    again = results.pop(int(shard.partition("/")[0]) - 1)
    assert again["diagnosed"] + again["skipped"] == again["cases"]
    assert all(one["diagnosed"] == one["cases"] for one in results)
    # The numbers are those of one process.
    alone = rd.diagnose_batch(cases, tmp_path / "alone")
    assert alone["diagnosed"] == CASES
    for path in after:
        other = tmp_path / "alone" / path.relative_to(out)
        assert timeless(json.loads(path.read_text())) == timeless(json.loads(other.read_text()))


def test_a_share_is_the_command_lines(tmp_path: Path, nominal: rd.Nominal) -> None:
    fleet(tmp_path / "cases", nominal)
    words = ["diagnose", "--batch", "cases", "--out", "answers"]
    parts = [cluster.share(words, f"{number}/3", cwd=str(tmp_path)) for number in (1, 2, 3)]
    assert sum(part["diagnosed"] for part in parts) == CASES
    assert cluster.share(words, "2/3", cwd=str(tmp_path))["skipped"] == parts[1]["cases"]
    with pytest.raises(rd.RingdownError, match="4/3") as raised:
        cluster.share(words, "4/3", cwd=str(tmp_path))
    # As a worker sends it back.
    assert str(pickle.loads(pickle.dumps(raised.value))) == str(raised.value)
    with pytest.raises(ValueError, match="0 shares; expected 1 or more"):
        cluster.with_dask(None, words, 0)
