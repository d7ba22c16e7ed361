"""What there is to say about a scene."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Diagnostic"]


@dataclass(frozen=True)
class Diagnostic:
    """One message about a scene; ``place`` is (file, line, column) where the scene was read from a file."""

    severity: str
    code: str
    message: str
    place: tuple[str, int, int] | None
    help: str | None

    def __str__(self) -> str:
        where = f"{self.place[0]}:{self.place[1]}:{self.place[2]}: " if self.place else ""
        return f"{where}{self.severity}[{self.code}]: {self.message}"
