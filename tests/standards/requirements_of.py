"""A register of checks by conformance class and requirement."""

from __future__ import annotations

from collections.abc import Callable

from api import Api
from schemas import Schemas

Check = Callable[[Api, Schemas], None]
CLASSES: dict[str, list[tuple[str, Check]]] = {}
# Classes without requirements of their own that HTTP can show, and where they are checked instead.
COVERED_BY = {
    "tms/2.0/conf/tilematrixset": "tms/2.0/conf/json-tilematrixset",
    "tms/2.0/conf/tilematrixsetlimits": "tms/2.0/conf/json-tilematrixsetlimits",
    "tms/2.0/conf/tilesetmetadata": "tms/2.0/conf/json-tilesetmetadata",
}


def requirement(standard: str, of_class: str, name: str) -> Callable[[Check], Check]:
    """Registers a check of a requirement, such as `/req/core/http`."""

    def register(check: Check) -> Check:
        CLASSES.setdefault(f"{standard}/conf/{of_class}", []).append((f"/req/{of_class}/{name}", check))
        return check

    return register
