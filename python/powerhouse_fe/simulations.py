"""Runs that are taken step by step."""

from __future__ import annotations

from collections.abc import Iterator
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from . import _core
from .errors import InputError
from .results import Results


class Simulation:
    """A run that waits at its steps, from :meth:`Scene.simulation`.

    Iterating takes one step after the other, or every so many; what is read in between belongs to the present step:

    >>> with scene.simulation() as simulation:  # doctest: +SKIP
    ...     for step in simulation:
    ...         if abs(step.displacement).max() > 0.1:
    ...             break
    >>> results = simulation.finish()  # doctest: +SKIP

    The motion is that of :meth:`Scene.run` to the bit. The state at time ``t`` is that which histories record: the
    displacement at ``t``, and the mean of the velocities half a step before and after. The run is on a thread of its own;
    one thread at a time iterates.
    """

    def __init__(self, steps: _core.Steps) -> None:
        self._steps = steps
        self._results: Results | None = None

    def __iter__(self) -> Iterator[Simulation]:
        go_on = self._steps.go_on
        while go_on():
            yield self
        self.finish()

    @property
    def number(self) -> int:
        """Number of the present step, from 0."""
        return self._steps.number

    @property
    def time(self) -> float:
        """Time of the present step (s)."""
        return self._steps.time

    @property
    def step(self) -> float:
        """Length of a time step (s)."""
        return self._steps.step

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacement (m) of the nodes since the start of the run, one row each; a read-only copy."""
        return self._steps.displacement

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Velocity (m/s) of the nodes, one row each; a read-only copy."""
        return self._steps.velocity

    @property
    def acceleration(self) -> NDArray[np.float64]:
        """Acceleration (m/s2) of the nodes, one row each; a read-only copy."""
        return self._steps.acceleration

    @property
    def stress(self) -> NDArray[np.float64]:
        """Mean stress (Pa) of the elements, one row each: xx, yy, zz, xy, yz, zx, tension positive; a read-only copy."""
        return self._steps.stress

    def history(self, name: str) -> NDArray[np.float64]:
        """A history variable of laws, one value for an element, NaN where the law has none of this name."""
        return self._steps.history(name)

    @property
    def finished(self) -> bool:
        """Whether the run has ended and its results are at hand."""
        return self._results is not None

    def finish(self) -> Results:
        """Ends the run after its present step, if it has not ended, and returns its results.

        Files are written if the run has a folder. Raises the exception of a run that failed.
        """
        if self._results is None:
            try:
                found = self._steps.finish()
            except Exception as error:
                results = getattr(error, "results", None)
                if isinstance(results, _core.Results):
                    error.results = Results(results)  # type: ignore[attr-defined]
                raise
            if found is None:
                raise InputError("the run has failed: it has no results")
            self._results = Results(found)
        return self._results

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            self.finish()
        elif not self.finished:
            # The error of the body of `with` is the one to show.
            try:
                self.finish()
            except Exception:
                pass

    def __repr__(self) -> str:
        return f"<Simulation at step {self.number}, t = {self.time:.6g} s>"


__all__ = ["Simulation"]
