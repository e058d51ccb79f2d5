"""Who does the work: processes of this machine, or the workers of a Dask scheduler."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Generator, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import NDArray

from sculler.runs.campaign.flights import fly
from sculler.runs.campaign.plan import Campaign, Tables
from sculler_model.errors import InputError

Rows = Mapping[str, NDArray[Any]]


MOST_TOGETHER = 50
"""Runs of a batch."""


def runs_together(runs: int, workers: int) -> int:
    """Runs of a batch, so that each worker gets as many batches as any other, and two or more."""
    each = max(2, -(-runs // (MOST_TOGETHER * workers)))
    return -(-runs // (each * workers))


class Batch(NamedTuple):
    """Runs that one worker does together.

    Attributes:
        design: number of the design, from 0.
        seeds: the first one, and how many.
    """

    design: int
    first_seed: int
    many: int


class Job(NamedTuple):
    """What a worker must know: a campaign's tables as JSON, and their folder."""

    tables: str
    folder: str
    batch: Batch


@lru_cache(maxsize=2)
def _campaign(tables: str, folder: str) -> Campaign:
    return Campaign(Tables.model_validate_json(tables), Path(folder))


def work(job: Job) -> dict[str, NDArray[Any]]:
    """A batch, in whatever process."""
    batch = job.batch
    seeds = range(batch.first_seed, batch.first_seed + batch.many)
    return fly(_campaign(job.tables, job.folder), batch.design, seeds)


def in_this_process(jobs: Iterable[Job]) -> Generator[tuple[Batch, Rows], None, None]:
    """One batch after another."""
    for job in jobs:
        yield job.batch, work(job)


@contextmanager
def _pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that end with the work, where it is broken off at once, and when this one does."""
    others = set(multiprocessing.active_children())
    # new processes begin empty: a copy of this one might hold locks that nobody gives back
    spawn = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, spawn, initializer=_end_with_the_campaign)
    try:
        yield pool
    except BaseException:
        for process in set(multiprocessing.active_children()) - others:
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _end_with_the_campaign() -> None:
    """In a worker: end when the campaign's process has ended, of whatever; it says when to stop."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def in_processes(jobs: Iterable[Job], workers: int) -> Generator[tuple[Batch, Rows], None, None]:
    """Batches as they are done by processes of this machine."""
    with _pool(workers) as pool:
        waiting: dict[Future[dict[str, NDArray[Any]]], Batch] = {}
        for job in jobs:
            waiting[pool.submit(work, job)] = job.batch
        while waiting:
            done, _ = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield waiting.pop(future), future.result()


def by_scheduler(jobs: Iterable[Job], address: str) -> Generator[tuple[Batch, Rows], None, None]:
    """Batches as they are done by the workers of a Dask scheduler; a lost worker's are done again.

    The workers must have the same sculler, and see the campaign file's folder.

    Raises:
        InputError: Dask is absent, or nobody answers at the address.
    """
    try:
        import distributed

        dask: Any = distributed
    except ImportError as error:
        raise InputError("--scheduler needs Dask, run: pip install 'sculler[campaign]'") from error
    try:
        client = dask.Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler: nobody answers at {address}, start one there") from error
    with client:
        futures = {client.submit(work, job, pure=False, retries=3): job.batch for job in jobs}
        for future in dask.as_completed(list(futures)):
            yield futures[future], future.result()
