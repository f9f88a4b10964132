"""Where a map's files lie: a folder, or a bucket of object storage by its address.

Needs ``zarr`` 3, and ``obstore`` for buckets.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

try:
    from zarr.abc.store import Store
    from zarr.core.buffer import default_buffer_prototype
    from zarr.core.sync import sync
    from zarr.storage import LocalStore, MemoryStore, ObjectStore
except ModuleNotFoundError as error:
    raise ImportError("maps in shards need zarr 3: pip install 'skyglow[distributed]'") from error

Where: TypeAlias = str | os.PathLike[str]
Options: TypeAlias = Mapping[str, Any]


def text(where: Where) -> str:
    """The same in every process: an address as it is, a folder from the root on."""
    return str(where) if is_address(where) else str(Path(where).absolute())


def is_address(where: Where) -> bool:
    """Whether it is one of object storage, such as ``s3://bucket/world.zarr``."""
    return "://" in str(where)


def open_store(where: Where, options: Options | None = None) -> Store:
    """A store of zarr; ``options`` are those of ``obstore.store.from_url``, beside what the environment says."""
    if not is_address(where):
        if options:
            raise ValueError("store= is for object storage alone, not for a folder")
        return LocalStore(Path(where))
    try:
        import obstore.store
    except ModuleNotFoundError as error:
        raise ImportError("object storage needs obstore: pip install 'skyglow[objects]'") from error
    return ObjectStore(obstore.store.from_url(str(where), **(options or {})))


def size_of(store: Store, key: str) -> int | None:
    """Bytes of a file; None where it is not there."""
    try:
        return int(sync(store.getsize(key)))
    except FileNotFoundError:
        return None


def delete(store: Store, key: str) -> None:
    """Deletes a file, if it is there."""
    sync(store.delete(key))


def is_empty(store: Store) -> bool:
    """Whether nothing is there."""
    return bool(sync(store.is_empty("")))


def clear(store: Store) -> None:
    """Deletes everything."""
    sync(store.clear())


def copy(source: MemoryStore, target: Store, *, first: str, last: str) -> None:
    """Copies what was made in memory: with the first file something is begun, with the last all is there."""

    async def copied() -> None:
        keys = [key async for key in source.list() if key not in (first, last)]
        for key in [first, *keys, last]:
            content = await source.get(key, default_buffer_prototype())
            if content is not None:
                await target.set(key, content)

    sync(copied())
