"""How Python's values are written for the server. What they mean, and whether they may be, the server decides."""

from __future__ import annotations

import datetime
import json
from collections.abc import Mapping, Sequence
from typing import Any


def query(asked: Mapping[str, Any]) -> dict[str, str]:
    """Parameters of a query; those that are None are left out."""
    return {name: text(value) for name, value in asked.items() if value is not None}


def text(value: Any) -> str:
    """One value as the server's parameters have it.

    True and False are ``on`` and ``off``. A time is RFC 3339; numpy's and astropy's are in UTC, a ``datetime`` needs a
    zone, or the server refuses it. A dictionary is a mix or a spectrum (``hps:0.7,led_4000k:0.3``); pairs are corners
    of a region (``350,10;10,10;0,40``); other sequences are numbers with commas between them.
    """
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, datetime.date):  # which a datetime is too
        return value.isoformat()
    if hasattr(value, "utc") and hasattr(value.utc, "isot"):
        return f"{value.utc.isot}Z"
    if type(value).__name__ == "datetime64":
        return f"{value.astype('datetime64[ms]')}Z"
    if isinstance(value, Mapping):
        return ",".join(f"{name}:{_number(part)}" for name, part in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str):
        if any(isinstance(part, Sequence) and not isinstance(part, str) for part in value):
            return ";".join(",".join(_number(part) for part in corner) for corner in value)
        return ",".join(_number(part) for part in value)
    return _number(value)


def _number(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.12g}" if isinstance(value, float) else str(value)


def body(value: Any) -> Any:
    """A request's body as JSON: whatever has a ``__geo_interface__`` becomes GeoJSON in WGS 84."""
    if hasattr(value, "to_crs") and getattr(value, "crs", None) is not None:
        return json.loads(value.to_crs("EPSG:4326").to_json())
    if hasattr(value, "__geo_interface__"):
        return body(dict(value.__geo_interface__))
    if isinstance(value, Mapping):
        return {str(name): body(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [body(part) for part in value]
    return value.item() if hasattr(value, "item") else value
