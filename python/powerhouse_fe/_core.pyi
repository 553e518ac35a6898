"""The compiled part of the package; private."""

from collections.abc import Callable
from os import PathLike

import numpy as np
from numpy.typing import NDArray

version: str

def toml_of(keys: dict[str, object]) -> str: ...

class Table:
    times: NDArray[np.float64]
    names: list[str]
    units: list[str]
    values: list[NDArray[np.float64]]

class Mesh:
    def __init__(
        self,
        points: NDArray[np.float64],
        blocks: list[tuple[str, NDArray[np.int64]]],
        elements: dict[str, list[int]],
        facets: dict[str, list[NDArray[np.int64]]],
        nodes: dict[str, list[int]],
    ) -> None: ...
    @staticmethod
    def box_of_bricks(low: list[float], high: list[float], counts: list[int], set: str) -> Mesh: ...
    points: NDArray[np.float64]
    cells: list[tuple[str, NDArray[np.uint32], NDArray[np.uint32]]]
    node_count: int
    element_count: int
    node_numbers: NDArray[np.uint64]
    element_numbers: NDArray[np.uint64]
    element_sets: dict[str, NDArray[np.uint32]]
    node_sets: dict[str, NDArray[np.uint32]]
    facet_sets: dict[str, list[list[int]]]

class Check:
    text: str
    title: str
    nodes: int
    elements: int
    extent: tuple[list[float], list[float]]
    sets: list[tuple[str, str, int, list[float], list[float]]]
    resolution: list[tuple[str, float, float, float]]
    shortest_edge: float
    longest_edge: float
    largest_aspect: float
    least_scaled_jacobian: float
    stable_step: float
    limiting_element: int
    limiting_set: str
    step: float
    steps: int
    wall_time: float
    memory: int
    output: int
    savings: list[str]
    remarks: list[str]
    warnings: list[str]

class KeptSnapshot:
    time: float
    displacement: NDArray[np.float64] | None
    velocity: NDArray[np.float64] | None
    acceleration: NDArray[np.float64] | None
    stress: NDArray[np.float64] | None
    state: list[tuple[str, str, NDArray[np.float64]]]

class Results:
    title: str
    ended: str
    steps: int
    step: float
    time: float
    wall_time: float
    step_time: float
    histories: Table
    sections: Table
    energies: Table
    joints: Table
    bolts: Table
    fields: list[tuple[str, str, str, NDArray[np.uint32], NDArray[np.float64], NDArray[np.float64] | None]]
    peaks: list[tuple[str, str, float, float, str | None]]
    peaks_text: str
    energy_residual: tuple[float, float | None, float] | None
    warnings: list[str]
    remarks: list[str]
    advice: list[str]
    folder: str | None
    files: list[str]
    mesh: Mesh
    present: NDArray[np.bool_] | None
    snapshots: list[KeptSnapshot]

class Steps:
    number: int
    time: float
    step: float
    displacement: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    stress: NDArray[np.float64]
    node_count: int
    element_count: int
    def go_on(self) -> bool: ...
    def history(self, name: str) -> NDArray[np.float64]: ...
    def finish(self) -> Results | None: ...

class Scene:
    title: str
    text: str
    path: str
    case: str | None
    cases: list[str]
    duration: float
    folder: str
    mesh: Mesh
    @staticmethod
    def from_file(path: PathLike[str], case: str | None) -> Scene: ...
    @staticmethod
    def from_text(
        text: str,
        path: PathLike[str],
        case: str | None,
        mesh: Mesh | None,
        records: list[tuple[str, float, NDArray[np.float64]]],
    ) -> Scene: ...
    def with_load(self, set: str, function: Callable[..., object]) -> Scene: ...
    def with_field(self, function: Callable[..., object], young: float, poisson: float, density: float) -> Scene: ...
    def check(self) -> Check: ...
    def run(
        self,
        folder: PathLike[str] | None,
        progress: Callable[[str | None, int, int, float], object] | None,
        threads: int | None,
        checkpoint_every: str | None,
    ) -> Results: ...
    def simulation(self, folder: PathLike[str] | None, every: int, threads: int | None) -> Steps: ...
