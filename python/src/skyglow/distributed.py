"""Maps of brightness by several machines: ``atlas`` bakes one into a Zarr array, a task of Dask for each shard.

    from dask.distributed import Client
    report = skyglow.distributed.atlas("world", "/shared/world.zarr", Client("scheduler:8786"), data="/shared/scenes")
    report.open().luminance.sel(latitude=46.2, longitude=8.8, method="nearest")

Needs ``pip install 'skyglow[distributed]'`` and ``skyglow-engine`` on every worker.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import os
import sys
import threading
import time
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import xarray

from . import stores
from .engine import Engine
from .errors import SkyglowError
from .maps import PLACES, Bounds, BrightnessMap, Frame
from .shards import Shards, Tile, open_shards
from .stores import Options, Where

Progress = Callable[[int, int], None]


@dataclasses.dataclass(frozen=True)
class Report:
    """What became of a map: ``shards`` were asked for, of which ``found`` were there already, in ``seconds``."""

    path: Path | str
    shards: int
    found: int
    seconds: float
    store: Options | None = dataclasses.field(default=None, repr=False)

    def open(self) -> xarray.Dataset:
        """The map; shards that are not made yet are NaN."""
        opened: xarray.Dataset = xarray.open_zarr(
            stores.open_store(self.path, self.store), consolidated=False, chunks=None
        )
        return opened


@dataclasses.dataclass(frozen=True)
class _Job:
    """Which map, and where an engine finds what it takes: what is sent to workers."""

    scene: str
    places: int
    packs: str | None
    data: str | None
    parameters: tuple[tuple[str, Any], ...]

    def map(self) -> BrightnessMap:
        engine = _engine(self.packs, self.data)
        return BrightnessMap(engine, self.scene, places=self.places, **dict(self.parameters))


def atlas(
    scene: str,
    out: Where,
    client: Any = None,
    *,
    packs: str | os.PathLike[str] | None = None,
    data: str | os.PathLike[str] | None = None,
    places: int = PLACES,
    tile: Tile | None = None,
    bounds: Bounds | None = None,
    resume: bool = True,
    progress: Progress | None = None,
    store: Options | None = None,
    **parameters: Any,
) -> Report:
    """Bakes a map of brightness of a scene into a Zarr v3 array, with the numbers of one bake by one process.

    ``client`` is a ``dask.distributed.Client``. Each of its worker processes opens an engine with its first task and
    keeps it. A bake takes all cores of its machine, so one worker process a machine is enough; tasks of one process
    wait for each other. A worker that dies is replaced by Dask, and its tasks are done again. Without a client this
    process bakes, on all its cores, with the same engine kept.

    ``out`` is a folder that this process and all workers reach, or an address of object storage, such as
    ``s3://bucket/world.zarr``: ``store`` are then options of ``obstore.store.from_url``, such as ``endpoint``, beside
    what the environment of each process says (``AWS_...``). ``packs`` and ``data`` (see :class:`skyglow.Engine`) are
    folders. A worker with another scene, other packs or another build of the engine is refused. Shards are whole or
    not there, and one that is made twice is the same. With ``resume`` those that are whole are kept.

    ``places`` are as many as the map has at most, as of ``skyglow atlas``. ``tile`` are rows and columns of a shard; by
    default whole patches, which are found together, so other sizes cost more. ``bounds`` (west, south, east, north)
    name a part: the array is that of the whole map, and shards with a place within the bounds are made.
    ``progress(done, shards)`` is called after each; by default a terminal shows it. ``parameters`` are those of
    ``engine.layer("brightness")``.
    """
    begun = time.monotonic()
    job = _Job(scene, places, _text(packs), _text(data), tuple(sorted(parameters.items())))
    frame = _frame(job, bounds) if client is None else client.submit(_frame, job, bounds, pure=False).result()
    shards = open_shards(out, frame, tile, resume=resume, options=store)
    wanted = shards.over(frame.window)
    missing = [shard for shard in wanted if not shards.has(shard)]
    found = len(wanted) - len(missing)
    tell = progress or _shown
    tell(found, len(wanted))
    bake = (stores.text(out), shards.name, job, frame.key, store)
    done = _here(bake, missing) if client is None else _by_workers(client, bake, missing)
    with contextlib.closing(done):
        for count, _ in enumerate(done, found + 1):
            tell(count, len(wanted))
    shards.clear_unfinished()
    path = str(out) if stores.is_address(out) else Path(out)
    return Report(path, len(wanted), found, time.monotonic() - begun, store)


def _text(path: str | os.PathLike[str] | None) -> str | None:
    return None if path is None else str(Path(path).absolute())


def _shown(done: int, shards: int) -> None:
    if sys.stderr.isatty():
        end = "\n" if done == shards else ""
        print(f"\r{done} of {shards} shards", end=end, file=sys.stderr, flush=True)


_Bake = tuple[str, str, _Job, str, Options | None]


def _here(bake: _Bake, missing: list[Tile]) -> Generator[Tile, None, None]:
    for shard in missing:
        yield _made(bake, shard)


def _by_workers(client: Any, bake: _Bake, missing: list[Tile]) -> Generator[Tile, None, None]:
    from dask import distributed

    futures = client.map(functools.partial(_made, bake), missing, pure=False, key="skyglow-shard")
    try:
        for future in distributed.as_completed(futures):  # type: ignore[no-untyped-call]
            yield future.result()
    finally:
        # Where one failed, or the caller ended it, the others are not wanted.
        client.cancel([future for future in futures if not future.done()])


# What runs in workers.


@functools.lru_cache(maxsize=1)
def _engine(packs: str | None, data: str | None) -> Engine:
    """One for the life of a process: it takes seconds to open and a gigabyte. Maps are made by the processor alone."""
    return Engine(packs, data, device="cpu")


_TURN = threading.Lock()


def _frame(job: _Job, bounds: Bounds | None) -> Frame:
    with _TURN:
        return job.map().frame(bounds)


def _made(bake: _Bake, shard: Tile) -> Tile:
    """Makes a shard, and writes it."""
    out, name, job, key, options = bake
    with _TURN:
        whole = job.map()
        if whole.frame().key != key:
            raise SkyglowError("this worker has another scene, other packs or another build of the engine than the map")
        shards = Shards(stores.open_store(out, options), name)
        shards.write(shard, whole.part(shards.at(shard)))
    return shard
