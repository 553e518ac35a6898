"""Results of runs: tables, fields, meshes of fields, drawings."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._lazy import needed
from .errors import InputError
from .meshes import Mesh
from .tables import Table

if TYPE_CHECKING:
    import pandas
    import pyvista


@dataclass(frozen=True)
class Peak:
    """The value of largest magnitude of a quantity."""

    #: Name of the quantity, such as ``crown.ux``.
    name: str
    #: Value with its sign, in ``unit``.
    value: float
    #: Unit of the value, such as ``m/s2``.
    unit: str
    #: Time of the peak (s).
    time: float
    #: Where it is, in words, unless the name implies it.
    place: str | None


@dataclass(frozen=True, eq=False)
class Field:
    """Greatest values of a quantity at nodes or elements over the run."""

    #: Name, such as ``displacement`` or ``greatest_principal_stress``.
    name: str
    #: Unit of the values.
    unit: str
    #: What the values are of: ``nodes`` or ``elements``.
    of: str
    #: Indices of the nodes or elements of the mesh, in the order of the values.
    members: NDArray[np.uint32]
    #: The values, read-only.
    values: NDArray[np.float64]
    #: Their times (s); ``None`` for flags, whose values are those at the end.
    times: NDArray[np.float64] | None

    def on(self, count: int) -> NDArray[np.float64]:
        """The values at all of ``count`` nodes or elements, NaN where there are none."""
        whole = np.full(count, np.nan)
        whole[self.members] = self.values
        return whole


@dataclass(frozen=True)
class EnergyResidual:
    """What is missing in the energy balance."""

    #: At the end of the run (J).
    energy: float
    #: Over the work of loads and prescribed motions (1); ``None`` without such work.
    share_of_input: float | None
    #: Largest one over the run, over the largest energy until then (1).
    largest: float


class Snapshot:
    """Fields of the body at one time, in memory. Arrays are read-only; those that were not requested are ``None``."""

    def __init__(self, shot: _core.KeptSnapshot) -> None:
        #: Time (s).
        self.time: float = shot.time
        #: Displacement (m), one row for a node.
        self.displacement: NDArray[np.float64] | None = shot.displacement
        #: Velocity (m/s), one row for a node.
        self.velocity: NDArray[np.float64] | None = shot.velocity
        #: Acceleration (m/s2), one row for a node.
        self.acceleration: NDArray[np.float64] | None = shot.acceleration
        #: Mean stress (Pa), one row for an element: xx, yy, zz, xy, yz, zx; tension positive.
        self.stress: NDArray[np.float64] | None = shot.stress
        #: History variables of laws by name, one value for an element.
        self.state: dict[str, NDArray[np.float64]] = {name: values for name, _, values in shot.state}

    def __repr__(self) -> str:
        return f"<Snapshot at t = {self.time:.6g} s>"


class Results:
    """Results of a run.

    Tables and fields are those of the dynamic run, which begins with the body as the construction stages left it.
    """

    def __init__(self, results: _core.Results) -> None:
        #: Title of the scene.
        self.title: str = results.title
        #: How the run ended: ``completed``, ``interrupted`` (Ctrl-C), ``failed``, or the name of what ended it.
        self.ended: str = results.ended
        #: Number of time steps.
        self.steps: int = results.steps
        #: Length of a time step (s).
        self.step: float = results.step
        #: Time at the end (s).
        self.time: float = results.time
        #: Wall time of stages and run (s).
        self.wall_time: float = results.wall_time
        #: Mean wall time of a time step (s).
        self.step_time: float = results.step_time
        #: Motions, stresses, history variables and relative displacements against time.
        self.histories = Table(results.histories)
        #: Accelerations of the histories up to the band (100 Hz unless the scene names another), five rows to its period: for spectra.
        self.accelerations = Table(results.accelerations)
        #: Section forces (N, N m, and per metre) against time.
        self.sections = Table(results.sections)
        #: Energy balance (J) against time.
        self.energies = Table(results.energies)
        #: Joints against time: shares of area, slips, openings, tractions, energies.
        self.joints = Table(results.joints)
        #: Greatest axial force (N) of each bolt group against time.
        self.bolts = Table(results.bolts)
        #: Greatest values at nodes and elements, by name: envelopes, and history variables of laws.
        self.fields: dict[str, Field] = {field[0]: Field(*field) for field in results.fields}
        #: Peaks of all recorded quantities.
        self.peaks: list[Peak] = [
            Peak(name, value, unit, time, place) for name, unit, value, time, place in results.peaks
        ]
        #: The table of peaks as the command prints it.
        self.peaks_text: str = results.peaks_text
        residual = results.energy_residual
        #: Residual of the energy balance; ``None`` if energies were not recorded.
        self.energy_residual: EnergyResidual | None = EnergyResidual(*residual) if residual else None
        #: Warnings about the results; read them.
        self.warnings: list[str] = results.warnings
        #: Facts about the composition of the scene.
        self.remarks: list[str] = results.remarks
        #: Advice on a run that failed.
        self.advice: list[str] = results.advice
        #: Folder of the files; ``None`` for a run without files.
        self.folder: Path | None = Path(results.folder) if results.folder is not None else None
        #: Paths of the files of the run.
        self.files: list[Path] = [Path(file) for file in results.files]
        #: The mesh.
        self.mesh = Mesh._of(results.mesh)
        #: Which elements are present when the body moves; ``None`` if all are.
        self.present: NDArray[np.bool_] | None = results.present
        #: Snapshots in memory, of a run without a folder; with one they are files, see :meth:`grids`.
        self.snapshots: list[Snapshot] = [Snapshot(shot) for shot in results.snapshots]

    @property
    def summary(self) -> dict[str, Any]:
        """The content of ``summary.json``; of a run with a folder."""
        if self.folder is None:
            raise InputError("the run has no folder and no summary: give one to `Scene.run`")
        found: dict[str, Any] = json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))
        return found

    def report(self) -> Path:
        """Writes ``report.html`` into the folder, as ``powerhouse report`` does, and returns its path."""
        if self.folder is None:
            raise InputError("the run has no folder for a report: give one to `Scene.run`")
        return write_report(self.folder)

    def peak(self, name: str) -> Peak:
        """The peak of a quantity by its name."""
        for peak in self.peaks:
            if peak.name == name:
                return peak
        names = ", ".join(peak.name for peak in self.peaks) or "none"
        raise KeyError(f"there is no peak '{name}'; available: {names}")

    def peak_frame(self) -> pandas.DataFrame:
        """The peaks as a pandas frame, with their names as index."""
        pandas = needed("pandas")
        rows = [vars(peak) for peak in self.peaks]
        columns = ["name", "value", "unit", "time", "place"]
        return pandas.DataFrame(rows, columns=columns).set_index("name")

    def plot(self, *names: str, axes: Any = None) -> Any:
        """Draws histories against time; see :meth:`Table.plot`."""
        return self.histories.plot(*names, axes=axes)

    def grid(self, snapshot: Snapshot | None = None) -> pyvista.UnstructuredGrid:
        """The body as a PyVista grid with the envelopes as point and cell data, or with the fields of a snapshot.

        ``present`` is 1 for elements that are there when the body moves.
        """
        grid = self.mesh.pyvista()
        if self.present is not None:
            grid.cell_data["present"] = self.present.astype(np.uint8)
        if snapshot is None:
            for field in self.fields.values():
                if field.of == "nodes":
                    grid.point_data[field.name] = field.on(self.mesh.node_count)
                else:
                    grid.cell_data[field.name] = field.on(self.mesh.element_count)
            return grid
        for name in ["displacement", "velocity", "acceleration"]:
            values = getattr(snapshot, name)
            if values is not None:
                grid.point_data[name] = np.array(values)
        if snapshot.stress is not None:
            grid.cell_data["stress"] = np.array(snapshot.stress)
        for name, values in snapshot.state.items():
            grid.cell_data[name] = np.array(values)
        return grid

    def grids(self) -> Mapping[float, pyvista.UnstructuredGrid]:
        """Snapshots as PyVista grids by time (s), from memory or from the files of the folder; read when they are used."""
        if self.folder is None:
            return _Grids({shot.time: (lambda shot=shot: self.grid(shot)) for shot in self.snapshots})
        return _Grids(_files_of(self.folder / "snapshots.pvd"))

    def __repr__(self) -> str:
        return (
            f"<Results of '{self.title}': {self.ended}, {self.steps} steps of {self.step:.3e} s to t = {self.time:.3f} s, "
            f"{len(self.warnings)} warnings>"
        )


class _Grids(Mapping[float, Any]):
    """Grids by time, each made when it is asked for."""

    def __init__(self, makers: dict[float, Any]) -> None:
        self._makers = makers

    def __getitem__(self, time: float) -> Any:
        return self._makers[time]()

    def __iter__(self) -> Any:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)


def _files_of(collection: Path) -> dict[float, Any]:
    """Readers of the files of the body in a PVD collection, by time (s)."""
    from xml.etree import ElementTree

    if not collection.exists():
        return {}
    pyvista = needed("pyvista")
    found: dict[float, Any] = {}
    for entry in ElementTree.parse(collection).iter("DataSet"):
        file = collection.parent / entry.attrib["file"]
        time = float(entry.attrib["timestep"])
        # The body is the first part of each time; the sides of joints follow it.
        found.setdefault(time, lambda file=file: pyvista.read(file))
    return found


def write_report(folder: Path | str) -> Path:
    """Writes the report ``report.html`` of a folder with the results of a run or a sweep, and returns its path.

    Raises :class:`InputError` for a folder without results.
    """
    return Path(_core.write_report(Path(folder)))


__all__ = ["EnergyResidual", "Field", "Peak", "Results", "Snapshot", "write_report"]
