"""What was checked, and what came out."""

from __future__ import annotations

import traceback
from collections.abc import Callable


class Report:
    """Counts checks by part, and keeps the faults."""

    def __init__(self) -> None:
        self.parts: dict[str, list[str]] = {}
        self.faults: list[str] = []

    def run(self, part: str, what: str, check: Callable[[], object]) -> None:
        """One check: it has a fault if it raises."""
        self.parts.setdefault(part, []).append(what)
        try:
            check()
        except AssertionError as error:
            self.faults.append(f"{part} {what}: {error}")
        except Exception:
            self.faults.append(f"{part} {what}: {traceback.format_exc(limit=-3)}")

    def finds(self, part: str, what: str, check: Callable[[], object]) -> None:
        """A negative control: a planted fault, which the check must find."""

        def must_find() -> None:
            try:
                check()
            except AssertionError:
                return
            raise AssertionError("a planted fault was not found")

        self.run(part, f"{what} (planted fault)", must_find)

    def print(self) -> None:
        """A line for each part, and each fault."""
        for part, checks in self.parts.items():
            bad = sum(fault.startswith(f"{part} ") for fault in self.faults)
            print(f"{len(checks) - bad:4} of {len(checks):3}  {part}")
        for fault in self.faults:
            print(f"FAULT {fault}")
