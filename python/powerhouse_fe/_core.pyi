"""The compiled part of the package; private."""

from collections.abc import Callable
from os import PathLike

import numpy as np
from numpy.typing import NDArray

version: str

def toml_of(keys: dict[str, object]) -> str: ...
def write_report(folder: PathLike[str]) -> str: ...

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
    accelerations: Table
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

class LawPoints:
    strain: NDArray[np.float64]
    initial_stress: NDArray[np.float64]
    history: dict[str, NDArray[np.float64]]
    widths: NDArray[np.float64]
    positions: NDArray[np.float64] | None
    parameters: dict[str, float]
    def __len__(self) -> int: ...

class Trade:
    folder: str
    factors: list[str]
    cases: list[tuple[str, list[str], float, float, float, int, int, float, float, str]]
    sensitive: list[tuple[str, float]]
    failed: list[tuple[str, str]]
    reference_error: float | None
    mesh_error: tuple[float, str] | None
    partial_window: float | None
    front: list[int]
    chosen: int | None
    files: list[str]

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
    def from_file(
        path: PathLike[str],
        case: str | None,
        laws: list[tuple[str, Callable[[LawPoints], object], list[tuple[str, str]], bool, str]],
    ) -> Scene: ...
    @staticmethod
    def from_text(
        text: str,
        path: PathLike[str],
        case: str | None,
        mesh: Mesh | None,
        records: list[tuple[str, float, NDArray[np.float64]]],
        laws: list[tuple[str, Callable[[LawPoints], object], list[tuple[str, str]], bool, str]],
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
        restart: bool,
    ) -> Results: ...
    def simulation(
        self, folder: PathLike[str] | None, every: int, threads: int | None, restart: bool
    ) -> Steps: ...
    def sweep(
        self,
        folder: PathLike[str] | None,
        cases: list[str] | None,
        duration: float | None,
        jobs: int,
        checkpoint_every: str | None,
        callback: Callable[[list[str], dict[str, tuple[int, int, float]]], object] | None,
    ) -> tuple[str, list[str]]: ...
    def trade(
        self,
        folder: PathLike[str] | None,
        goal: tuple[float | None, float | None],
        reference: str,
        window: float | None,
        quantities: list[str] | None,
        factors: list[str] | None,
        every_history: bool,
        every_combination: bool,
        mesh: bool,
        checkpoint_every: str | None,
        callback: Callable[[list[str], dict[str, tuple[int, int, float]]], object] | None,
    ) -> Trade: ...
