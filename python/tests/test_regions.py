"""Regions of meshes that meshio has read."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import powerhouse_fe as ph

meshio = pytest.importorskip("meshio")

#: Two bricks side by side with a wedge and a pyramid on the first; the upper face of the second.
POINTS = np.array(
    [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)] + [[0.5, 0, 1.5], [0.5, 1, 1.5], [1.5, 0.5, 2]],
    dtype=float,
)
BRICKS = np.array([[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]])
WEDGE = np.array([[6, 7, 12, 9, 10, 13]])
PYRAMID = np.array([[7, 8, 11, 10, 14]])
TOP = np.array([[7, 8, 11, 10]])
MIRRORS = {
    "hexahedron": [0, 3, 2, 1, 4, 7, 6, 5],
    "wedge": [0, 2, 1, 3, 5, 4],
    "pyramid": [0, 3, 2, 1, 4],
}


def quiet(mesh: Any, **more: Any) -> ph.Mesh:
    """The mesh, without a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return ph.Mesh.from_meshio(mesh, **more)


def volumes(mesh: ph.Mesh) -> dict[str, float]:
    """Volume of the bounding box of each set's nodes, which tells the elements of this mesh apart."""
    kinds = {kind: rows for kind, rows in mesh.cells.items()}
    number = np.concatenate([np.full(len(rows), index) for index, rows in enumerate(kinds.values())])
    rows_of = [row for rows in kinds.values() for row in rows]
    assert len(number) == len(rows_of)
    sizes = [float(np.prod(np.ptp(mesh.points[row], axis=0))) + np.mean(mesh.points[row]) for row in rows_of]
    return {name: sum(sizes[i] for i in members) for name, members in mesh.element_sets.items()}


def test_groups_of_med(tmp_path: Path) -> None:
    """The groups of a MED file are sets, of nodes and elements, and its left-handed elements are turned."""
    h5py = pytest.importorskip("h5py")
    blocks = [("hexahedron", BRICKS), ("wedge", WEDGE), ("pyramid", PYRAMID), ("quad", TOP)]
    left = [(kind, rows[:, MIRRORS[kind]] if kind in MIRRORS else rows) for kind, rows in blocks]
    mesh = meshio.Mesh(POINTS, left)
    mesh.cell_data = {"cell_tags": [np.array([-6, -7]), np.array([-7]), np.array([0]), np.array([-8])]}
    mesh.cell_tags = {-6: ["rock"], -7: ["lining", "all of it"], -8: ["top"]}
    mesh.point_data = {"point_tags": np.where(POINTS[:, 2] == 0, 2, 0)}
    mesh.point_tags = {2: ["base"]}
    path = tmp_path / "mesh.med"
    mesh.write(path)
    with h5py.File(path) as file:
        assert "ENS_MAA" in file
    read = quiet(meshio.read(path))
    right = ph.Mesh(
        POINTS,
        dict(blocks[:3]),
        {
            "rock": {"hexahedron": [0]},
            "lining": {"hexahedron": [1], "wedge": [0]},
            "all of it": {"hexahedron": [1], "wedge": [0]},
            "ungrouped": {"pyramid": [0]},
        },
    )
    assert volumes(read) == pytest.approx(volumes(right), rel=1e-12)
    assert len(read.node_sets["base"]) == 6 and np.all(read.points[read.node_sets["base"], 2] == 0)
    assert len(read.facet_sets["top"]) == 2


def test_left_handed_tetrahedra_with_midpoints() -> None:
    """Midpoints follow the corners when an element is turned; one that is not left-handed is as it was."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    points = np.concatenate([corners, [(corners[a] + corners[b]) / 2 for a, b in edges]])
    right = np.arange(10)[None]
    left = right[:, [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    for rows in [right, left]:
        mesh = quiet(meshio.Mesh(points, [("tetra10", rows)]))
        [row] = mesh.cells["tet10"]
        at = mesh.points[row]
        assert np.linalg.det(at[1:4] - at[0]) > 0
        assert np.allclose(at[4:], [(at[a] + at[b]) / 2 for a, b in edges])


FLAC3D = """* GRIDPOINTS
{points}
* ZONES
Z W6 1 7 8 10 13 11 14
Z B8 2 1 2 4 7 5 10 8 11
Z B8 3 2 3 5 8 6 11 9 12
* ZONE GROUPS
ZGROUP "core" SLOT 1
1
ZGROUP "lining" SLOT 1
3
"""


def test_groups_of_flac3d(tmp_path: Path) -> None:
    """Groups of FLAC3D are those of its zones where kinds are mixed and some zones have no group."""
    path = tmp_path / "mesh.f3grid"
    points = "\n".join(f"G {i + 1} {x} {y} {z}" for i, (x, y, z) in enumerate(POINTS[:14]))
    path.write_text(FLAC3D.format(points=points))
    found = meshio.read(path)
    mesh = quiet(found)
    bricks = mesh.points[mesh.cells["hex8"]][:, :, 0].mean(axis=1)
    assert bricks[mesh.element_sets["lining"] - 1] == pytest.approx([1.5])
    assert mesh.element_sets["core"].tolist() == [0]
    assert mesh.element_sets["ungrouped"].tolist() == [1]
    found.cell_sets["zone:lining:1"][1] = np.array([7])
    with pytest.raises(ph.InputError, match="index 7 in a block of 2"):
        ph.Mesh.from_meshio(found)


def test_cell_data_and_blocks_are_regions(tmp_path: Path) -> None:
    """Whole numbers of cell data and blocks of a file are sets where they are named; where nothing is, a warning says which."""
    blocks = [("hexahedron", BRICKS[:1]), ("hexahedron", BRICKS[1:]), ("wedge", WEDGE), ("quad", TOP)]
    values = [np.array([7]), np.array([3]), np.array([3]), np.array([5])]
    for name, suffix in [("attribute", "vtu"), ("medit:ref", "mesh"), ("attribute", "vtk")]:
        path = tmp_path / f"mesh.{suffix}"
        meshio.Mesh(POINTS[:14], blocks, cell_data={name: values}).write(path)
        read = meshio.read(path)
        with pytest.warns(UserWarning, match=f'regions="{name}"'):
            assert list(ph.Mesh.from_meshio(read).element_sets) == ["all"]
        mesh = quiet(read, regions=name)
        assert {name: len(own) for name, own in mesh.element_sets.items()} == {"3": 2, "7": 1}
        assert len(mesh.facet_sets["5"]) == 1
    netcdf = pytest.importorskip("netCDF4")
    path = tmp_path / "mesh.e"
    meshio.Mesh(POINTS[:14], blocks[:3]).write(path)
    assert netcdf.Dataset(path).dimensions["num_el_blk"].size == 3
    read = meshio.read(path)
    with pytest.warns(UserWarning, match="3 blocks.*regions=\"blocks\""):
        ph.Mesh.from_meshio(read)
    mesh = quiet(read, regions="blocks")
    assert {name: len(own) for name, own in mesh.element_sets.items()} == {"block_1": 1, "block_2": 1, "block_3": 1}
    with pytest.raises(ph.InputError, match="no cell data 'region'; available"):
        ph.Mesh.from_meshio(read, regions="region")


def test_empty_blocks_and_plane_meshes() -> None:
    """Empty blocks of any type are left out; a mesh of facets alone has no solids."""
    for empty in [np.array([]), np.empty((0, 8), int), np.array([], int)]:
        block = meshio.CellBlock("hexahedron", empty)
        mesh = quiet(meshio.Mesh(POINTS, [("hexahedron", BRICKS), block]))
        assert mesh.element_count == 2
    with pytest.raises(ph.InputError, match="no solids.*Extrude"):
        ph.Mesh.from_meshio(meshio.Mesh(POINTS[:, :2], [("quad", TOP)], cell_sets={"rock": [np.array([0])]}))
