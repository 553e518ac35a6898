"""Constitutive laws that are functions of arrays."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Mapping

from ._core import LawPoints
from .errors import InputError

#: Called with integration points; returns the change of stress (Pa) against the initial stress, one row for a point, and,
#: of a law with history variables, a tuple of it and a mapping from their names to values, one for each point.
LawFunction = Callable[[LawPoints], object]


class Law:
    """A constitutive law in NumPy, evaluated for all integration points of some thousand elements at once.

    ``function(points)`` returns the change of stress (Pa) against the initial stress, one row for a point: xx, yy, zz, xy,
    yz, zx, tension positive. ``points`` has, as read-only arrays,

    - ``strain`` (1), one row for a point in this order, with engineering shears, since the reference configuration;
    - ``initial_stress`` (Pa), likewise;
    - ``history``, a dictionary of the committed history variables, one value for each point, zero at the start;
    - ``widths`` (m) of the element along x, y and z, one row for a point, for softening by fracture energy;
    - ``positions`` (m), one row for a point, if ``positions`` is true, else ``None``;
    - ``parameters``, a dictionary of those of the material.

    ``history`` has the names of the history variables with their units (``{"damage": "1"}``); a law with any returns a
    tuple of stress and a dictionary of their new values. Their element values and envelopes are in the results.

    The law is a pure function of each point, whatever the others are: it keeps nothing, since it is evaluated more than
    once for a step, with trial strains, from threads of the run and with several numbers of points. Time step, mass and
    stiffness damping follow from the elastic medium of the material, which is the stiffest state of the law. An exception,
    or a stress that is not finite, ends the run and is raised with the ``results`` until then.

    This is slow: the interpreter evaluates one block of elements at a time, whatever the number of threads, and arrays are
    made for each. Static solutions iterate with the elastic stiffness. In elements with one integration point
    (``hex8-natural``, the default of bricks, and ``hex8-one-point``) bending stays elastic: name ``kernel = "hex8-full"``.

    ``version`` is a text that changes with the function: studies take finished cases of earlier studies only where it is
    the same. Without it they run all cases anew.

    >>> def no_tension(points):
    ...     la, mu = points.parameters["lambda"], points.parameters["mu"]
    ...     stress = 2 * mu * points.strain * [1, 1, 1, 0.5, 0.5, 0.5]
    ...     stress[:, :3] += la * points.strain[:, :3].sum(axis=1, keepdims=True)
    ...     stress[stress[:, :3].sum(axis=1) > 0] = 0.0
    ...     return stress
    >>> scene = Scene.from_file("scene.toml", laws={"no-tension": Law(no_tension)})  # doctest: +SKIP

    A material names it as ``law``, and has ``young`` (Pa), ``poisson`` (1), ``density`` (kg/m3), and numbers in a table
    ``parameters``.
    """

    def __init__(
        self,
        function: LawFunction,
        history: Mapping[str, str] | None = None,
        *,
        positions: bool = False,
        version: str | None = None,
    ) -> None:
        if not callable(function):
            raise InputError(f"a law is a function of points, found {type(function).__name__}")
        #: The function.
        self.function = function
        #: Units of the history variables by name.
        self.history: dict[str, str] = dict(history or {})
        #: Whether the function has the positions of the points.
        self.positions = positions
        #: Text that changes with the function.
        self.version = version if version is not None else f"without a version {uuid.uuid4().hex}"

    def __repr__(self) -> str:
        name = getattr(self.function, "__name__", "function")
        return f"<Law {name}, history: {', '.join(self.history) or 'none'}>"


#: Name, function, history variables (name and unit), whether positions are used, version.
_Arguments = tuple[str, LawFunction, list[tuple[str, str]], bool, str]


def _arguments(laws: Mapping[str, Law | LawFunction] | None) -> list[_Arguments]:
    """Laws as the compiled part takes them; a function alone is a law without history variables."""
    found = [(name, law if isinstance(law, Law) else Law(law)) for name, law in (laws or {}).items()]
    return [(name, law.function, list(law.history.items()), law.positions, law.version) for name, law in found]


__all__ = ["Law", "LawFunction", "LawPoints"]
