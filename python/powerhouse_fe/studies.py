"""Results of studies: sweeps over the cases of a scene file, and trades of error against cost."""

from __future__ import annotations

import csv
import json
import math
import sys
import time
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _core
from ._lazy import needed
from .results import write_report

if TYPE_CHECKING:
    from collections.abc import Iterator

    import pandas

#: Called with new lines, and with steps done and planned and the time (s) of the runs that go on, by name.
StudyProgress = Callable[[list[str], dict[str, tuple[int, int, float]]], object]


class Sweep:
    """Outcomes of the cases of a sweep, whose results are files."""

    def __init__(self, folder: str, cases: list[str]) -> None:
        #: Folder of the results, in which each case has a folder with its name.
        self.folder = Path(folder)
        #: Names of the cases.
        self.cases: list[str] = cases
        #: Content of ``outcome.json`` by case: peaks, damage, joints, steps, wall time (SI units).
        self.outcomes: dict[str, dict[str, Any]] = {
            case: json.loads((self.folder / case / "outcome.json").read_text(encoding="utf-8")) for case in cases
        }

    def frame(self) -> pandas.DataFrame:
        """The table ``sweep.csv`` as a pandas frame: a row for each case of this sweep, units in the names of columns."""
        pandas = needed("pandas")
        with open(self.folder / "sweep.csv", encoding="utf-8", newline="") as file:
            rows = [{name: _cell(name, text) for name, text in row.items()} for row in csv.DictReader(file)]
        return pandas.DataFrame(rows).set_index("case").loc[self.cases]

    def histories(self, case: str) -> pandas.DataFrame:
        """The histories of a case as a pandas frame with the times (s) as index, units in the names of columns."""
        pandas = needed("pandas")
        with open(self.folder / case / "histories.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.reader(line for line in file if not line.startswith("#")))
        values = [[float(text) for text in row] for row in rows[1:]]
        return pandas.DataFrame(values, columns=rows[0]).set_index(rows[0][0])

    def report(self) -> Path:
        """Writes ``report.html`` into the folder, as ``powerhouse report`` does, and returns its path."""
        return write_report(self.folder)

    def __repr__(self) -> str:
        return f"<Sweep of {len(self.cases)} cases: {', '.join(self.cases)}; results in {self.folder}>"


def _cell(name: str, text: str) -> str | float:
    """The value of a cell of ``sweep.csv``; a number to all its digits, NaN where a case has none."""
    if name == "case":
        return text
    return float(text) if text else math.nan


@dataclass(frozen=True)
class TradeCase:
    """Cost and error of one run of a trade study."""

    #: Name: the levels in which it differs from the most accurate ones, or ``reference``.
    name: str
    #: Name of the level of each factor, by the name of the factor.
    levels: dict[str, str]
    #: Length of the time step (s).
    step: float
    #: Mean wall time of a step (s).
    step_time: float
    #: Wall time before the first step (s).
    before: float
    #: Number of steps of the whole run.
    steps: int
    #: Predicted memory of the whole run (bytes).
    memory: int
    #: Predicted wall time of the whole run (s).
    wall_time: float
    #: Largest relative L2 error over the window (1), without that of the reference.
    error: float
    #: Name of the history with this error.
    worst: str


class Trade:
    """Results of a trade study."""

    def __init__(self, trade: _core.Trade) -> None:
        #: Folder of the results.
        self.folder = Path(trade.folder)
        #: Names of the factors, the most important first.
        self.factors: list[str] = trade.factors
        #: Finished runs, the reference first.
        self.cases: list[TradeCase] = [
            TradeCase(row[0], dict(zip(trade.factors, row[1])), *row[2:]) for row in trade.cases
        ]
        #: Runs on the Pareto front of cost and error, the cheapest first.
        self.front: list[TradeCase] = [self.cases[index] for index in trade.front]
        #: The best run that meets the goal; ``None`` without a goal or if none does.
        self.chosen: TradeCase | None = None if trade.chosen is None else self.cases[trade.chosen]
        #: Histories that depend sensitively on the input and are left out, with their changes (1).
        self.sensitive: dict[str, float] = dict(trade.sensitive)
        #: Runs that failed, with the messages.
        self.failed: dict[str, str] = dict(trade.failed)
        #: Estimated relative error of the reference without that of the mesh; ``None`` if no other time step was run.
        self.reference_error: float | None = trade.reference_error
        #: Estimated relative error of the mesh, if it was requested.
        self.mesh_error: float | None = trade.mesh_error[0] if trade.mesh_error else None
        #: Duration of the runs (s), if later yielding, cracking or slip may increase the errors.
        self.partial_window: float | None = trade.partial_window
        #: Paths of the written files, the scene of the chosen run first if there is one.
        self.files: list[Path] = [Path(file) for file in trade.files]

    def frame(self) -> pandas.DataFrame:
        """The runs as a pandas frame with their names as index: levels, wall time (s), error (1), memory (bytes) ..."""
        pandas = needed("pandas")
        front = {case.name for case in self.front}
        rows = [
            {
                "name": case.name,
                **case.levels,
                "error": case.error,
                "worst": case.worst,
                "wall_time": case.wall_time,
                "steps": case.steps,
                "step": case.step,
                "memory": case.memory,
                "on_front": case.name in front,
            }
            for case in self.cases
        ]
        return pandas.DataFrame(rows).set_index("name")

    def plot(self, axes: Any = None) -> Any:
        """Draws the errors of all runs against their wall times with matplotlib; returns the axes."""
        if axes is None:
            _, axes = needed("matplotlib.pyplot").subplots(layout="constrained")
        axes.plot([case.wall_time for case in self.cases], [case.error for case in self.cases], "o")
        axes.plot([case.wall_time for case in self.front], [case.error for case in self.front], "-")
        for case in self.front:
            axes.annotate(case.name, (case.wall_time, case.error), fontsize="small")
        axes.set_xlabel("wall time of a whole run (s)")
        axes.set_ylabel("relative error")
        return axes

    def __repr__(self) -> str:
        return f"<Trade of {len(self.cases)} runs, {len(self.front)} on the front; results in {self.folder}>"


class StudyDisplay:
    """Writes the lines of a study, and how far its runs are: on a terminal in a line that is renewed."""

    def __init__(self, stream: Any = None) -> None:
        self._stream = stream or sys.stderr
        self._on_terminal = bool(getattr(self._stream, "isatty", lambda: False)())
        self._last = 0.0
        self._status = False

    def __call__(self, lines: list[str], running: dict[str, tuple[int, int, float]]) -> None:
        if lines:
            self.clear()
            self._stream.write("".join(f"{line}\n" for line in lines))
        now = time.monotonic()
        if running and self._on_terminal and now - self._last > 0.2:
            self._last, self._status = now, True
            shares = [f"{name} {100 * done / max(planned, 1):.0f} %" for name, (done, planned, _) in running.items()]
            self._stream.write(f"\r{'  '.join(shares)[:79]:<79}")
        self._stream.flush()

    def clear(self) -> None:
        """Empties the line on a terminal."""
        if self._status:
            self._stream.write("\r" + 79 * " " + "\r")
            self._status = False

    @staticmethod
    @contextmanager
    def of(progress: bool | StudyProgress) -> Iterator[StudyProgress | None]:
        """A function for the progress that is asked for, while a study goes on."""
        if not isinstance(progress, bool):
            yield progress
            return
        display = StudyDisplay() if progress else None
        try:
            yield display
        finally:
            if display:
                display.clear()


__all__ = ["StudyDisplay", "StudyProgress", "Sweep", "Trade", "TradeCase"]
