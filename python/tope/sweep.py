"""`tope sweep`: the runs of a campaign on Dask, kept as they are done."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import pyarrow as pa
from distributed import Client, KilledWorker, LocalCluster, as_completed

from tope import _core
from tope.campaign import Campaign
from tope.campaign_file import load_campaign
from tope.runs import Run
from tope.simulation import Progress, simulate
from tope.sweep_folder import SweepFolder
from tope.sweep_rows import Chunk, run_chunk
from tope.sweep_summary import write_sweep_summary

AHEAD = (
    4  # chunks a thread of a worker has waiting, so that it never idles and none waits long for its memory
)
CONNECT = "10 s"
JOIN = 60.0  # s; that the first worker may take


@dataclass(frozen=True)
class Sweep:
    """A finished sweep."""

    campaign: Campaign
    table: pa.Table
    out: Path


def sweep(
    campaign: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    runs: int | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Do those runs of a campaign that `out` (runs/<campaign> by default) does not hold yet.

    `runs` replaces the campaign's number of runs. `workers`: local processes, one a core by default, 0 for
    none beside this one; `scheduler`: the address of a Dask cluster instead. Writes runs.parquet, the same
    bytes for the same campaign however it was computed, and summary.html.
    """
    loaded = load_campaign(campaign, runs)
    folder = SweepFolder(Path(out or Path("runs") / Path(campaign).stem), loaded)
    missing = folder.missing()
    total = len(list(folder.chunks()))
    tell = progress or (lambda done: None)
    tell(1 - len(missing) / total)
    with chunk_source(loaded, missing, workers, scheduler) as done:
        for left, chunk in zip(range(len(missing) - 1, -1, -1), done, strict=True):
            folder.keep(chunk)
            tell(1 - left / total)
    result = Sweep(loaded, folder.table(), folder.path)
    write_sweep_summary(loaded, result.table, folder.path / "summary.html", shown(campaign, runs))
    return result


def shown(campaign: str | os.PathLike[str], runs: int | None) -> str:
    """The command that made a sweep, for its page."""
    return f"tope sweep {os.fspath(campaign)}" + (f" --runs {runs}" if runs is not None else "")


def replay(
    campaign: str | os.PathLike[str],
    run: int,
    *,
    out: str | os.PathLike[str],
    progress: Progress | None = None,
) -> Run:
    """Simulate one run of a campaign as `tope run` does."""
    loaded = load_campaign(campaign)
    if run < 0:
        raise _core.ConfigError(f"--replay {run}: runs are numbered from 0")
    keys = loaded.overrides(loaded.draw(run))
    return simulate(loaded.scenario, out=out, overrides=keys, progress=progress)


@contextmanager
def chunk_source(
    campaign: Campaign, missing: list[tuple[int, int]], workers: int | None, scheduler: str | None
) -> Iterator[Iterator[Chunk]]:
    """The missing chunks in the order in which they get done."""
    if not missing or (workers == 0 and scheduler is None):
        yield (run_chunk(campaign, *each) for each in missing)
        return
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what matters of it is told below
    with connected(workers, scheduler) as client:
        yield computed(client, campaign, missing)


@contextmanager
def connected(workers: int | None, scheduler: str | None) -> Iterator[Client]:
    """A cluster of local processes, or the one at an address."""
    if scheduler is not None:
        with answering(scheduler) as client:
            yield client
        return
    count = len(os.sched_getaffinity(0)) if workers is None else workers
    with (
        LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            processes=True,
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        yield client


@contextmanager
def answering(scheduler: str) -> Iterator[Client]:
    """The cluster at an address, once it has a worker."""
    try:
        client = Client(scheduler, timeout=CONNECT, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise _core.Error(f"--scheduler {scheduler}: no Dask scheduler answers there: {error}") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=JOIN)
        except TimeoutError as error:
            raise _core.Error(
                f"--scheduler {scheduler}: it has no worker, and none came in {JOIN:g} s"
            ) from error
        yield client


def computed(client: Client, campaign: Campaign, missing: list[tuple[int, int]]) -> Iterator[Chunk]:
    """Chunks as they get done; a worker that dies has its chunks done by another."""
    threads = sum(client.nthreads().values())
    waiting = iter(missing)

    def submit(chunk: tuple[int, int]) -> object:
        return client.submit(run_chunk, campaign, *chunk, pure=False)

    active = as_completed(
        [submit(each) for each in islice(waiting, AHEAD * max(threads, 1))], loop=client.loop
    )
    for future in active:
        yield result_of(future.result)
        future.release()
        if (more := next(waiting, None)) is not None:
            active.add(submit(more))


def result_of(result: Callable[[], Chunk]) -> Chunk:
    """What a worker sent; raises Error if its runs killed one worker after another."""
    try:
        return result()
    except KilledWorker as error:
        raise _core.Error(f"workers died again and again over the same runs: {error}") from error
