"""Scenes: from files, from dictionaries, from arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .laws import Law, LawFunction, _arguments
from .meshes import Mesh
from .progress import Display
from .records import records_of
from .results import Results
from .simulations import Simulation
from .studies import StudyDisplay, StudyProgress, Sweep, Trade

PathLike = Union[str, "os.PathLike[str]"]
#: Called with the stage that is being solved or ``None``, steps done, steps planned, and the time (s).
Progress = Callable[[str | None, int, int, float], object]
#: Called with the time (s) and positions (m), one row each; returns forces (N), one row for each or one for all.
LoadFunction = Callable[[float, NDArray[np.float64]], ArrayLike]
#: Called with the time (s) and points (m), one row each; returns displacement (m), velocity (m/s) and stress (Pa).
FieldFunction = Callable[[float, NDArray[np.float64]], tuple[ArrayLike, ArrayLike, ArrayLike]]


class Check:
    """Report of a check before a run. ``str(check)`` is the text that the command prints."""

    def __init__(self, check: _core.Check) -> None:
        #: The text that the command ``powerhouse check`` prints.
        self.text: str = check.text
        #: Title of the scene.
        self.title: str = check.title
        #: Number of nodes of the mesh.
        self.nodes: int = check.nodes
        #: Number of elements of the mesh.
        self.elements: int = check.elements
        #: Lower and upper corner of the box of the mesh (m).
        self.extent: tuple[list[float], list[float]] = check.extent
        #: Boxes (m) of the sets by name: kind of members, their number, lower and upper corner.
        self.sets: dict[str, tuple[str, int, list[float], list[float]]] = {
            name: (of, count, low, high) for name, of, count, low, high in check.sets
        }
        #: Highest frequency (Hz) that each part resolves, with ten elements per shear wavelength.
        self.resolved_frequency: dict[str, float] = {name: frequency for name, frequency, _, _ in check.resolution}
        #: Length of the shortest edge (m).
        self.shortest_edge: float = check.shortest_edge
        #: Length of the longest edge (m).
        self.longest_edge: float = check.longest_edge
        #: Largest aspect ratio of an element (1).
        self.largest_aspect: float = check.largest_aspect
        #: Least scaled Jacobian of an element (1).
        self.least_scaled_jacobian: float = check.least_scaled_jacobian
        #: Stable time step (s).
        self.stable_step: float = check.stable_step
        #: Number of the element that limits the stable step, in the mesh file.
        self.limiting_element: int = check.limiting_element
        #: Name of the set of this element.
        self.limiting_set: str = check.limiting_set
        #: Time step of the run (s).
        self.step: float = check.step
        #: Number of time steps of the run.
        self.steps: int = check.steps
        #: Predicted wall time of the dynamic run (s), without stages.
        self.wall_time: float = check.wall_time
        #: Predicted peak memory (bytes).
        self.memory: int = check.memory
        #: Upper bound of the size of the result files (bytes).
        self.output: int = check.output
        #: Changes that save most, in words.
        self.savings: list[str] = check.savings
        #: Facts about the composition of the scene.
        self.remarks: list[str] = check.remarks
        #: Warnings about the accuracy of the results; read them.
        self.warnings: list[str] = check.warnings

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<Check of '{self.title}': {self.steps} steps, {len(self.warnings)} warnings>"


class Scene:
    """A scene, everything that a run needs: mesh, materials, parts, ground motion, boundary, output.

    ``keys`` mirrors a scene file: tables are dictionaries, lists of tables are lists of dictionaries. Units are SI (m,
    s, kg, N, Pa), z points up, tension is positive. ``keys["mesh"]`` may be a :class:`Mesh`, or a table with one as its
    ``file``, and the ``file`` of a ``record`` a :class:`Record`, a trace of ObsPy or a tuple of time step (s) and values, the
    latter two with ``units``. Paths are relative to ``folder``. A key whose value is ``None`` is one that is not given.
    ``laws`` has constitutive laws of one's own by the names that materials give, see :class:`Law`.

    Line and column of a :class:`SceneError` refer to :attr:`text`, the same scene in TOML.

    A scene can be checked and run any number of times, by several threads at once; its text stays as it was read,
    its files of mesh and records are read again each time.

    >>> scene = Scene.from_file("data/scenes/cavern_small.toml")  # doctest: +SKIP
    >>> results = scene.run()  # doctest: +SKIP
    """

    def __init__(
        self,
        keys: Mapping[str, Any],
        folder: PathLike = ".",
        case: str | None = None,
        *,
        laws: Mapping[str, Law | LawFunction] | None = None,
    ) -> None:
        tables = dict(keys)
        mesh = _mesh_of(tables)
        records = records_of(tables)
        text = _core.toml_of(tables)
        path = Path(folder) / "scene.toml"
        self._scene = _core.Scene.from_text(text, path, case, mesh._mesh if mesh else None, records, _arguments(laws))

    @classmethod
    def from_file(
        cls, path: PathLike, case: str | None = None, *, laws: Mapping[str, Law | LawFunction] | None = None
    ) -> Scene:
        """The scene of a file in TOML, or one of its cases, with ``laws`` of one's own by name.

        Raises :class:`SceneError` with line and column for a fault, :class:`InputError` for a file that cannot be read.
        """
        found = cls.__new__(cls)
        found._scene = _core.Scene.from_file(Path(path), case, _arguments(laws))
        return found

    @classmethod
    def from_text(
        cls,
        text: str,
        folder: PathLike = ".",
        case: str | None = None,
        *,
        laws: Mapping[str, Law | LawFunction] | None = None,
    ) -> Scene:
        """The scene of a text in TOML, with paths relative to ``folder`` and ``laws`` of one's own by name."""
        found = cls.__new__(cls)
        found._scene = _core.Scene.from_text(text, Path(folder) / "scene.toml", case, None, [], _arguments(laws))
        return found

    @property
    def title(self) -> str:
        """Title of the scene."""
        return self._scene.title

    @property
    def text(self) -> str:
        """The scene in TOML, to which lines and columns of messages refer."""
        return self._scene.text

    @property
    def path(self) -> Path:
        """Path of the scene file; of a dictionary that under which messages name it."""
        return Path(self._scene.path)

    @property
    def case(self) -> str | None:
        """Name of the case that the scene is, if any."""
        return self._scene.case

    @property
    def cases(self) -> list[str]:
        """Names of the cases of the scene file."""
        return self._scene.cases

    @property
    def duration(self) -> float:
        """Duration of the dynamic run (s)."""
        return self._scene.duration

    @property
    def folder(self) -> Path:
        """Folder into which the command would write the results, relative to the working directory."""
        return Path(self._scene.folder)

    @property
    def mesh(self) -> Mesh:
        """The mesh as it was when the scene was made."""
        return Mesh._of(self._scene.mesh)

    @classmethod
    def _of(cls, scene: _core.Scene) -> Scene:
        found = cls.__new__(cls)
        found._scene = scene
        return found

    def with_load(self, set: str, function: LoadFunction) -> Scene:
        """The scene with forces at the nodes of a set that a function returns.

        ``set`` is a set of nodes, facets or elements. ``function(time, points)`` is called once in every time step with
        the time (s) and the positions of the nodes (m), one row each, and returns forces (N): one row for a node, or one
        for all. It depends on these alone, and is called from other threads. An exception ends the run in order and is
        raised with the ``results`` until then. A step takes some ten microseconds more, and what the function takes.
        """
        return Scene._of(self._scene.with_load(set, function))

    def with_field(self, function: FieldFunction, *, young: float, poisson: float, density: float) -> Scene:
        """The scene in a free field that a function returns, in place of the waves of the scene.

        The field is the motion of the site without the structure, an elastic half-space of Young's modulus ``young``
        (Pa), Poisson's ratio ``poisson`` (1) and ``density`` (kg/m3), those of the elements at the absorbing faces. It
        satisfies the equations of motion, has no traction at the ground surface, and is at rest when the run begins.
        ``function(time, points)`` is called with a time (s) and points (m), one row each, and returns displacement (m)
        and velocity (m/s), rows of x, y, z, and stress (Pa), rows of xx, yy, zz, xy, yz, zx, tension positive. It depends
        on these alone, and is called at any times, also before the run, from other threads; exceptions are those of
        :meth:`with_load`.
        """
        return Scene._of(self._scene.with_field(function, float(young), float(poisson), float(density)))

    def check(self) -> Check:
        """Checks the scene without running it, as ``powerhouse check`` does: mesh, resolved frequencies, stable step,
        predicted cost, warnings. Some steps are computed and timed.

        Raises any error that would prevent the run.
        """
        return Check(self._scene.check())

    def run(
        self,
        folder: PathLike | None = None,
        progress: bool | Progress = True,
        *,
        threads: int | None = None,
        checkpoint_every: str | None = None,
        restart: bool = False,
    ) -> Results:
        """Runs the scene, as ``powerhouse run`` does, and returns its results.

        ``folder`` receives the same files as those of the command (``scene.folder`` is where the command would put them);
        without it no file is written, and snapshots that the scene requests are kept in memory. ``progress`` shows how
        far the run is; a function is called with the stage or ``None``, steps done and planned, and the time (s), some
        times in a second on the calling thread. ``threads`` is the number of threads in place of the scene's; results do
        not depend on it. ``checkpoint_every`` is the wall time between two checkpoints of a scene from a file, such as
        ``"10min"`` or ``"never"``: the command resumes such a run (``powerhouse run --resume FOLDER``). A folder where a
        run of the same scene was interrupted raises :class:`FolderError`; ``restart=True`` begins anew and removes its
        checkpoint and results.

        Other threads of Python go on meanwhile. Ctrl-C ends the run after one more step and raises
        :class:`Interrupted`, whose ``results``, and the files, are complete until then; an exception of a progress
        function does the same. Raises :class:`SceneError`, :class:`InputError`, :class:`FolderError`, and
        :class:`RunError` with the results until a failure.
        """
        display = Display() if progress is True else None
        callback = display if display else (progress if callable(progress) else None)
        path = None if folder is None else Path(folder)
        try:
            found = self._scene.run(path, callback, threads, checkpoint_every, restart)
        except BaseException as error:
            results = getattr(error, "results", None)
            if isinstance(results, _core.Results):
                error.results = Results(results)  # type: ignore[attr-defined]
            raise
        finally:
            if display:
                display.end()
        return Results(found)

    def simulation(
        self,
        folder: PathLike | None = None,
        *,
        every: int = 1,
        threads: int | None = None,
        restart: bool = False,
    ) -> Simulation:
        """Starts a run that waits at every step, or at every one of ``every`` steps, and at the last one.

        ``folder``, ``threads`` and ``restart`` are those of :meth:`run`. A faulty scene is reported when the first step is taken, or
        by :meth:`Simulation.finish`.
        """
        path = None if folder is None else Path(folder)
        return Simulation(self._scene.simulation(path, every, threads, restart))

    def sweep(
        self,
        folder: PathLike | None = None,
        progress: bool | StudyProgress = True,
        *,
        cases: Sequence[str] | None = None,
        duration: float | None = None,
        jobs: int = 1,
        checkpoint_every: str | None = None,
    ) -> Sweep:
        """Runs the cases of the scene file, as ``powerhouse sweep`` does, and returns their outcomes.

        ``folder`` receives the results, one folder for each case, :attr:`folder` by default. Cases that an earlier sweep
        has finished there, with the same inputs, are not run again, and unfinished ones go on from their last checkpoint.
        ``cases`` are those to run, all by default but those that run on request. ``duration`` (s) takes the place of the
        scene's. ``jobs`` is the number of cases at once; the results do not depend on it. ``checkpoint_every`` is that of
        :meth:`run`. ``progress`` shows what the command prints; a function is called some times in a second with new lines
        and a dictionary of the runs that go on: steps done and planned, and the time (s).

        The scene file is read again. Scenes in memory are refused: a sweep that is continued needs their files. Ctrl-C
        raises :class:`Interrupted`; another sweep continues from there. Raises what :meth:`run` raises, with the name of
        the case.
        """
        with StudyDisplay.of(progress) as report:
            found = self._scene.sweep(
                None if folder is None else Path(folder),
                None if cases is None else list(cases),
                duration,
                jobs,
                checkpoint_every,
                report,
            )
        return Sweep(*found)

    def trade(
        self,
        folder: PathLike | None = None,
        progress: bool | StudyProgress = True,
        *,
        error: float | None = None,
        budget: float | None = None,
        window: float | None = None,
        reference: str = "finest",
        of: Sequence[str] | None = None,
        factors: Sequence[str] | None = None,
        every_combination: bool = False,
        every_history: bool = False,
        mesh: bool = False,
        checkpoint_every: str | None = None,
    ) -> Trade:
        """Measures errors against costs of numerical options of the scene file, as ``powerhouse trade`` does.

        ``folder`` receives the results, ``trade`` in :attr:`folder` by default. With a permitted relative ``error`` (1),
        or a permitted wall time ``budget`` of a whole run (s), the scene of the cheapest or the most accurate run that
        meets it is written. ``window`` (s) is the duration of the runs; by default they contain half of the intensity of
        the records. ``reference`` is ``"finest"``, the most accurate run, or ``"closed-form"``. ``of`` are quantities whose
        errors count, ``factors`` those that are varied, by name; all by default. ``every_combination`` runs all
        combinations, ``every_history`` counts histories that depend sensitively on the input, ``mesh`` estimates the error
        of the mesh by one more run, sixteen times as long. ``progress`` and ``checkpoint_every`` are those of :meth:`sweep`,
        as are files, interruption and errors.
        """
        with StudyDisplay.of(progress) as report:
            found = self._scene.trade(
                None if folder is None else Path(folder),
                (error, budget),
                reference,
                window,
                None if of is None else list(of),
                None if factors is None else list(factors),
                every_history,
                every_combination,
                mesh,
                checkpoint_every,
                report,
            )
        return Trade(found)

    def __repr__(self) -> str:
        case = f", case '{self.case}'" if self.case else ""
        return f"<Scene '{self.title}'{case}>"


def _mesh_of(tables: dict[str, Any]) -> Mesh | None:
    """The mesh of arrays of a dictionary, which its generator then stands for."""
    table = tables.get("mesh")
    if isinstance(table, Mesh):
        table = {"file": table}
    mesh = table.get("file") if isinstance(table, Mapping) else None
    if not isinstance(table, Mapping) or not isinstance(mesh, Mesh):
        return None
    tables["mesh"] = {**table, "file": "arrays", "generator": "arrays"}
    return mesh


__all__ = ["Check", "Progress", "Scene"]
