"""A small scene, the command to compare with, and the folder of the repository."""

from __future__ import annotations

import copy
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

import powerhouse_fe as ph

REPOSITORY = Path(__file__).resolve().parents[2]

#: A block of ground under a pulse, 216 bricks.
KEYS: dict[str, Any] = {
    "title": "block",
    "mesh": {"file": "mesh.msh"},
    "material": [{"name": "rock", "law": "elastic", "young": 9e9, "poisson": 0.27, "density": 2750}],
    "part": [{"set": "rock", "material": "rock"}],
    "wave": [{"kind": "sv", "incidence": 20, "pulse": {"kind": "smooth", "displacement": 0.02, "duration": 0.25}}],
    "boundary": {
        "kind": "viscous-spring",
        "faces": ["left", "right", "front", "back", "bottom"],
        "scatterer": [60, 60, 120],
    },
    "time": {"duration": 0.3},
    "output": {
        "every": 0.01,
        "energies": 0.01,
        "history": [{"name": "inside", "at": [60, 60, 60], "quantities": ["displacement", "acceleration"]}],
        "envelope": {"quantities": ["displacement", "stress"]},
        "snapshots": {"every": 0.1},
    },
}


def box(cells: int = 6) -> ph.Mesh:
    """The mesh of the block, 120 m wide."""
    return ph.Mesh.box([0, 0, 0], [120, 120, 120], [cells] * 3)


def keys(**changes: Any) -> dict[str, Any]:
    """The keys of the block with its mesh in memory, and with other tables."""
    found = copy.deepcopy(KEYS)
    found["mesh"] = {"file": box()}
    found.update(changes)
    return {key: value for key, value in found.items() if value is not None}


def write_gmsh(path: Path, mesh: ph.Mesh) -> None:
    """Writes a mesh of bricks as a file of Gmsh 2.2."""
    names = list(mesh.element_sets) + list(mesh.facet_sets)
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    for number, name in enumerate(names, 1):
        lines.append(f'{3 if name in mesh.element_sets else 2} {number} "{name}"')
    lines += ["$EndPhysicalNames", "$Nodes", str(mesh.node_count)]
    lines += [f"{i} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(mesh.points.tolist(), 1)]
    lines.append("$EndNodes")
    elements: list[str] = []
    for name, facets in mesh.facet_sets.items():
        tag = names.index(name) + 1
        elements += [f"3 2 {tag} {tag} " + " ".join(str(i + 1) for i in facet) for facet in facets]
    bricks = mesh.cells["hex8"]
    for name, members in mesh.element_sets.items():
        tag = names.index(name) + 1
        elements += [f"5 2 {tag} {tag} " + " ".join(str(i + 1) for i in bricks[e].tolist()) for e in members]
    lines += ["$Elements", str(len(elements))]
    lines += [f"{i} {element}" for i, element in enumerate(elements, 1)]
    lines.append("$EndElements")
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    """The block as a scene file with its mesh file, in a folder of its own."""
    write_gmsh(tmp_path / "mesh.msh", box())
    path = tmp_path / "scene.toml"
    path.write_text(ph._core.toml_of(copy.deepcopy(KEYS)))
    return path


def _command() -> Path | None:
    named = os.environ.get("POWERHOUSE")
    if named:
        return Path(named)
    target = Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target"))
    for kind in ["release", "debug"]:
        found = target / kind / "powerhouse"
        if found.exists():
            return found
    return None


@pytest.fixture(scope="session")
def command() -> Any:
    """Runs the command `powerhouse` of the repository: of the environment variable POWERHOUSE, or of the target folder."""
    found = _command()
    if found is None:
        pytest.skip("there is no command to compare with: cargo build -p powerhouse-cli, or set POWERHOUSE")

    def call(*arguments: Any, **options: Any) -> subprocess.CompletedProcess[str]:
        whole = [str(found), *map(str, arguments)]
        return subprocess.run(whole, capture_output=True, text=True, check=False, **options)

    return call
