"""Meshes and records from arrays."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY, box, keys

import powerhouse_fe as ph


def moved(scene: ph.Scene) -> dict[str, np.ndarray]:
    histories = scene.run(progress=False).histories
    assert max(np.abs(values).max() for values in histories.values()) > 0.0
    return dict(histories)


def same(first: dict[str, np.ndarray], second: dict[str, np.ndarray]) -> bool:
    return first.keys() == second.keys() and all(np.array_equal(first[name], second[name]) for name in first)


def test_a_mesh_of_arrays_is_the_mesh() -> None:
    """Points, cells and sets of a mesh make the same mesh again, which moves to the same bits."""
    mesh = box()
    again = ph.Mesh(
        mesh.points,
        {"hexahedron": mesh.cells["hex8"]},
        {"rock": mesh.element_sets["rock"]},
        {name: np.array(facets) for name, facets in mesh.facet_sets.items()},
    )
    assert np.array_equal(mesh.points, again.points)
    assert mesh.facet_sets == again.facet_sets
    assert same(moved(ph.Scene(keys(mesh=mesh))), moved(ph.Scene(keys(mesh={"file": again}))))


def test_a_mesh_of_meshio() -> None:
    """The groups of a mesh that meshio has read from Gmsh are those that a scene reads from the file."""
    meshio = pytest.importorskip("meshio")
    path = REPOSITORY / "data" / "meshes" / "cavern_small.msh"
    own = ph.Scene.from_file(REPOSITORY / "data" / "scenes" / "cavern_small.toml").mesh
    mesh = ph.Mesh.from_meshio(meshio.read(path))
    assert mesh.node_count == own.node_count
    assert {name: len(members) for name, members in mesh.element_sets.items()} == {
        name: len(members) for name, members in own.element_sets.items()
    }
    assert {name: len(facets) for name, facets in mesh.facet_sets.items()} == {
        name: len(facets) for name, facets in own.facet_sets.items()
    }
    centre = lambda of, name: of.points[of.cells["hex8"][of.element_sets[name]]].mean(axis=(0, 1))  # noqa: E731
    assert np.allclose(centre(mesh, "lining"), centre(own, "lining"))


def test_tetrahedra_with_midpoints() -> None:
    """Midpoints are in the order of meshio and VTK."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    points = np.concatenate([corners, [(corners[a] + corners[b]) / 2 for a, b in edges]])
    mesh = ph.Mesh(points, {"tetra10": [range(10)]}, {"rock": [0]})
    assert np.array_equal(mesh.cells["tet10"], [range(10)])
    # In the order of the engine, that of Gmsh, the last two edges are 23 and 13.
    [(_, _, [nodes])] = mesh._mesh.cells
    middle = (corners[[2, 1]] + corners[[3, 3]]) / 2
    assert np.array_equal(points[nodes[8:]], middle)
    pv = pytest.importorskip("pyvista")
    assert isinstance(mesh.pyvista(), pv.UnstructuredGrid)
    assert np.isclose(mesh.pyvista().volume, 1 / 6)


def test_mixed_elements_and_sets() -> None:
    """Sets count elements through all kinds, or within each."""
    bricks = box(1)
    points = np.concatenate([bricks.points, [[60.0, 60.0, 200.0]]])
    top = bricks.facet_sets["top"][0]
    pyramid = [[*top, 8]]
    by_number = ph.Mesh(points, {"hexahedron": bricks.cells["hex8"], "pyramid": pyramid}, {"a": [0], "b": [1]})
    by_kind = ph.Mesh(
        points,
        {"hexahedron": bricks.cells["hex8"], "pyramid": pyramid},
        {"a": {"hexahedron": [0]}, "b": {"pyramid": [0]}},
        node_sets={"apex": [8]},
    )
    for mesh in [by_number, by_kind]:
        assert mesh.element_sets["a"].tolist() == [0] and mesh.element_sets["b"].tolist() == [1]
    assert by_kind.node_sets["apex"].tolist() == [8]
    assert list(ph.Mesh(points, {"pyramid": pyramid, "hexahedron": bricks.cells["hex8"]}).element_sets) == ["all"]


def pulse(count: int = 60) -> np.ndarray:
    at = np.arange(count + 1)
    return np.sin(0.1 * at) * np.sin(np.pi * at / count)


def under(file: Any, **more: Any) -> ph.Scene:
    record = {
        "name": "motion",
        "file": file,
        "convention": "incident",
        "baseline": {"kind": "velocity-polynomial", "order": 3},
        **more,
    }
    wave = [{"kind": "sv", "incidence": 20, "record": "motion"}]
    return ph.Scene(keys(record=[record], wave=wave))


def test_records_of_arrays(tmp_path: Path) -> None:
    """Records of arrays and traces in any unit are the record of a file."""
    path = tmp_path / "motion.txt"
    path.write_text("\n".join(map(repr, pulse().tolist())))
    of_file = moved(under(path, units="m/s2", time_step=0.01))
    assert same(of_file, moved(under((0.01, pulse()), units="m/s2")))
    assert same(of_file, moved(under(ph.Record(0.01, pulse()))))
    trace = SimpleNamespace(data=pulse(), stats=SimpleNamespace(delta=0.01))
    assert same(of_file, moved(under(trace, units="m/s2")))
    assert same(of_file, moved(under(ph.Record.from_trace(trace))))
    of_file = moved(under(path, units="g", time_step=0.01))
    assert same(of_file, moved(under(trace, units="g")))


def test_components_of_arrays() -> None:
    """Components of a station may be arrays."""
    record = {
        "name": "station",
        "components": {"x": ph.Record(0.01, pulse()), "z": (0.01, 0.5 * pulse())},
        "units": None,
        "convention": "incident",
        "baseline": {"kind": "velocity-polynomial", "order": 3},
    }
    wave = [{"kind": "sv", "incidence": 20, "record": "station.x"}]
    with pytest.raises(ph.InputError, match="record 'station': the unit"):
        ph.Scene(keys(record=[record], wave=wave))
    record["components"]["z"] = ph.Record(0.01, 0.5 * pulse())
    assert same(moved(ph.Scene(keys(record=[record], wave=wave))), moved(under(ph.Record(0.01, pulse()))))


def test_records_are_checked() -> None:
    """Arrays that are no record are refused by name."""
    for make, text in [
        (lambda: under((0.01, pulse())), "the unit of the accelerations is missing"),
        (lambda: under(ph.Record(0.01, pulse()), units="g"), "given by the record itself"),
        (lambda: under(ph.Record(0.0, pulse())), "step"),
        (lambda: ph.Record(0.01, pulse(), "mm/s2"), "available: m/s2, cm/s2, g"),
        (lambda: ph.Record(0.01, [pulse(), pulse()]), "2 dimensions"),
        (lambda: ph.Record(0.01, np.ma.masked_less(pulse(), 0.1)), "gaps"),
        (lambda: ph.Record(0.01, ["a", "b"]), "expected real numbers"),
        (lambda: under(ph.Record(0.01, [0.0, np.nan, 0.0])), "record 'arrays/motion'"),
    ]:
        with pytest.raises(ph.InputError, match=text):
            make()


def test_counts_of_a_trace_are_named() -> None:
    """A trace of counts, with a calibration that was not applied, is refused with the way to accelerations."""
    values = 1e4 * pulse()
    trace = lambda data, calib: SimpleNamespace(data=data, stats=SimpleNamespace(delta=0.01, calib=calib))  # noqa: E731
    with pytest.raises(ph.InputError, match="apply_calib=True"):
        ph.Record.from_trace(trace(values, 9.5e-6), "cm/s2")
    for data, calib in [(9.5e-6 * values, 9.5e-6), (values, 1.0)]:
        assert len(ph.Record.from_trace(trace(data, calib), "cm/s2").values) == len(values)
