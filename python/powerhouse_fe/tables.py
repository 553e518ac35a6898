"""Tables of time histories as NumPy arrays and pandas frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._lazy import needed

if TYPE_CHECKING:
    import pandas


class Table(Mapping[str, NDArray[np.float64]]):
    """Time histories with common times: a mapping from the names of columns to their values.

    The arrays are the recorded data themselves, not copies, and read-only.

    >>> results.histories["crown.ux"]  # doctest: +SKIP
    """

    def __init__(self, table: _core.Table) -> None:
        self._columns = dict(zip(table.names, table.values))
        #: Times (s), rising.
        self.times: NDArray[np.float64] = table.times
        #: Units of the columns by name, such as ``m/s2``.
        self.units: dict[str, str] = dict(zip(table.names, table.units))

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        try:
            return self._columns[name]
        except KeyError:
            names = ", ".join(self._columns) or "none"
            raise KeyError(f"there is no column '{name}'; available: {names}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        return f"<Table of {len(self)} columns at {len(self.times)} times: {', '.join(self) or 'none'}>"

    def frame(self) -> pandas.DataFrame:
        """The table as a pandas frame with the times (s) as index; ``frame.attrs["units"]`` has the units."""
        pandas = needed("pandas")
        index = pandas.Index(self.times, name="time")
        frame = pandas.DataFrame(self._columns, index=index)
        frame.attrs["units"] = dict(self.units)
        return frame

    def plot(self, *names: str, axes: Any = None) -> Any:
        """Draws columns against time with matplotlib, all of them by default; returns the axes.

        Columns whose names end in ``*`` stand for all that begin so, as in ``plot("crown.u*")``. A column of another
        unit than the first is refused: draw it in axes of its own.
        """
        chosen = self._chosen(names)
        units = {self.units[name] for name in chosen}
        if len(units) > 1:
            raise ValueError(f"columns of the units {', '.join(sorted(units))} do not share an axis: name those of one")
        if axes is None:
            _, axes = needed("matplotlib.pyplot").subplots(layout="constrained")
        for name in chosen:
            axes.plot(self.times, self[name], label=name, linewidth=1.0)
        axes.set_xlabel("time (s)")
        axes.set_ylabel(" ".join(units))
        if chosen:
            axes.legend()
        return axes

    def _chosen(self, names: tuple[str, ...]) -> list[str]:
        if not names:
            return list(self)
        chosen: list[str] = []
        for name in names:
            if name.endswith("*"):
                found = [column for column in self if column.startswith(name[:-1])]
                if not found:
                    raise KeyError(f"no column begins with '{name[:-1]}'; available: {', '.join(self) or 'none'}")
                chosen += found
            else:
                self[name]
                chosen.append(name)
        return chosen


__all__ = ["Table"]
