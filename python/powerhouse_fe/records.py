"""Accelerograms from arrays and from ObsPy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

#: Units of acceleration and their values in m/s2.
_UNITS = {"m/s2": 1.0, "cm/s2": 0.01, "g": 9.80665}


#: Acceleration that no accelerogram reaches (m/s2).
_LARGEST = 50.0


class Record:
    """A uniformly sampled accelerogram in memory.

    ``step`` is the time between samples (s), ``values`` are accelerations in ``units``: ``m/s2``, ``cm/s2`` or ``g``. It is
    the ``file`` of a ``record`` table, or of its components, of a scene:

    >>> {"name": "station", "file": Record(0.01, values, "g"), "convention": "outcrop"}  # doctest: +SKIP

    Raises :class:`InputError` for values that are not a row of finite numbers.
    """

    def __init__(self, step: float, values: ArrayLike, units: str = "m/s2") -> None:
        if units not in _UNITS:
            raise InputError(f"'{units}' is no unit of accelerations; available: {', '.join(_UNITS)}")
        samples = np.asarray(values)
        if np.ma.isMaskedArray(values) and np.ma.getmaskarray(values).any():
            raise InputError("the accelerations have gaps (masked values): fill or cut them first")
        if samples.ndim != 1:
            raise InputError(f"the accelerations have {samples.ndim} dimensions, expected 1: one value for a time")
        if not np.issubdtype(samples.dtype, np.number) or np.issubdtype(samples.dtype, np.complexfloating):
            raise InputError(f"the accelerations are {samples.dtype}, expected real numbers")
        #: Time between samples (s).
        self.step: float = float(step)
        #: Accelerations (m/s2).
        self.values: NDArray[np.float64] = samples.astype(np.float64) * _UNITS[units]

    @classmethod
    def from_trace(cls, trace: Any, units: str = "m/s2") -> Record:
        """The record of a trace of ObsPy, or of anything with ``data`` and ``stats.delta`` (s).

        Traces do not know the unit of their data: remove the instrument response first (``output="ACC"``), or read formats
        of counts with ``apply_calib=True``.
        """
        calibration = float(getattr(trace.stats, "calib", 1.0) or 1.0)
        peak = float(np.abs(trace.data).max(initial=0.0)) if np.ma.count(trace.data) else 0.0
        if calibration != 1.0 and peak * _UNITS.get(units, 1.0) > _LARGEST:
            raise InputError(
                f"the trace has a peak of {peak:g} {units} and `stats.calib` = {calibration:g}: these are probably counts; "
                "read it with `obspy.read(FILE, apply_calib=True)`"
            )
        return cls(trace.stats.delta, trace.data, units)

    def __repr__(self) -> str:
        return f"<Record of {len(self.values)} samples at {self.step:g} s>"


def _is_in_memory(value: Any) -> bool:
    is_trace = hasattr(value, "data") and hasattr(getattr(value, "stats", None), "delta")
    return isinstance(value, Record) or is_trace or (isinstance(value, tuple) and len(value) == 2)


def _record_of(value: Any, units: str | None, name: str) -> Record:
    """The record of what a table gives as its file."""
    if isinstance(value, Record):
        if units is not None:
            raise InputError(f"record '{name}': `units` is given by the record itself")
        return value
    if units is None:
        raise InputError(
            f"record '{name}': the unit of the accelerations is missing: `units`, one of {', '.join(_UNITS)}"
        )
    if isinstance(value, tuple):
        step, values = value
        return Record(step, values, units)
    return Record.from_trace(value, units)


def records_of(tables: dict[str, Any]) -> list[tuple[str, float, NDArray[np.float64]]]:
    """Takes the records in memory out of the tables of a scene: path that is then named, step (s), values (m/s2)."""
    given = tables.get("record")
    if not isinstance(given, (list, tuple)):
        return []
    found: list[tuple[str, float, NDArray[np.float64]]] = []
    changed: list[Any] = []
    for table in given:
        if not isinstance(table, Mapping):
            changed.append(table)
            continue
        table = dict(table)
        name = str(table.get("name", ""))
        units = table.get("units")

        def taken(value: Any, path: str, name: str = name, units: str | None = units) -> str:
            record = _record_of(value, units, name)
            found.append((path, record.step, record.values))
            return path

        before = len(found)
        if _is_in_memory(table.get("file")):
            table["file"] = taken(table["file"], f"arrays/{name}")
        components = table.get("components")
        if isinstance(components, Mapping):
            table["components"] = {
                axis: taken(value, f"arrays/{name}.{axis}") if _is_in_memory(value) else value
                for axis, value in components.items()
            }
        if len(found) > before:
            table["units"] = "m/s2"
        changed.append(table)
    tables["record"] = changed
    return found


__all__ = ["Record"]
