"""Progress of a run on the error stream."""

from __future__ import annotations

import sys
import time
from typing import Any


class Display:
    """Writes one line that is renewed on a terminal, and a line every five seconds elsewhere."""

    def __init__(self, stream: Any = None) -> None:
        self._stream = stream or sys.stderr
        self._begun = self._last = time.monotonic()
        self._on_terminal = bool(getattr(self._stream, "isatty", lambda: False)())
        self._wrote = False

    def __call__(self, stage: str | None, done: int, planned: int, at: float) -> None:
        now = time.monotonic()
        if now - self._last < (0.2 if self._on_terminal else 5.0):
            return
        self._last = now
        if stage is not None:
            text = f"stage '{stage}'"
        elif planned:
            left = (planned - done) * (now - self._begun) / max(done, 1)
            text = f"{100 * done / planned:.0f} %, t = {at:.3f} s, about {left:.0f} s left"
        else:
            text = "preparing"
        self._stream.write(f"\r{text:<60}" if self._on_terminal else f"{text}\n")
        self._stream.flush()
        self._wrote = True

    def end(self) -> None:
        """Ends the line on a terminal."""
        if self._wrote and self._on_terminal:
            self._stream.write("\r" + 60 * " " + "\r")
            self._stream.flush()
