"""Messages on what is left out or approximated, once for each name and text."""

from __future__ import annotations

from collections.abc import Callable


class Report:
    """Collects messages, and hands each new one on: `tell(line)` is called once for it."""

    def __init__(self, tell: Callable[[str], None] | None = None):
        self.lines: list[str] = []
        self._tell = tell or (lambda line: print(f"Steradian: {line}"))

    def __call__(self, name: str, text: str) -> None:
        line = f"{name}: {text}"
        if line not in self.lines:
            self.lines.append(line)
            self._tell(line)
