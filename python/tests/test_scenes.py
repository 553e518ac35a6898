"""Scenes: from files and dictionaries, their checks, runs and results, beside the command."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import KEYS, box, keys

import powerhouse_fe as ph


def columns(path: Path) -> tuple[list[str], np.ndarray]:
    """Names and numbers of a table of results."""
    names = path.read_text().splitlines()[0].split(",")
    return names, np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)


def test_the_same_bits_as_the_command(scene_file: Path, command: Any) -> None:
    """Histories, energies and files of a run are those of the command, byte for byte."""
    out = scene_file.parent / "command"
    ended = command("run", scene_file, "--out", out)
    assert ended.returncode == 0, ended.stderr
    mine = scene_file.parent / "python"
    results = ph.Scene.from_file(scene_file).run(mine, progress=False)
    assert results.ended == "completed"
    files = lambda folder: {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()}  # noqa: E731
    assert files(mine) == files(out)
    differ = [
        name
        for name in sorted(files(out) - {"summary.json"})
        if (out / name).read_bytes() != (mine / name).read_bytes()
    ]
    assert differ == []
    # All but what the clock says.
    timeless = lambda text: re.sub(r'"wall_time": .*', "", text)  # noqa: E731
    assert timeless((out / "summary.json").read_text()) == timeless((mine / "summary.json").read_text())
    names, numbers = columns(out / "histories.csv")
    assert len(names) == 1 + len(results.histories)
    # Shortest decimal numbers that are read back to the same bits.
    assert np.array_equal(numbers[:, 0], results.histories.times)
    for index, name in enumerate(results.histories, 1):
        assert np.array_equal(numbers[:, index], results.histories[name]), name


def test_a_dictionary_is_the_file(scene_file: Path) -> None:
    """A dictionary with a mesh of arrays, and a text, move as the file with its mesh file."""
    of_file = ph.Scene.from_file(scene_file).run(progress=False)
    of_keys = ph.Scene(keys()).run(progress=False)
    of_text = ph.Scene.from_text(scene_file.read_text(), scene_file.parent).run(progress=False)
    assert len(of_file.histories) == 6
    for name, values in of_file.histories.items():
        assert np.abs(values).max() > 0.0
        assert np.array_equal(values, of_keys.histories[name]), name
        assert np.array_equal(values, of_text.histories[name]), name


def test_check_says_what_the_command_says(scene_file: Path, command: Any) -> None:
    """The text of a check is that of the command but for what is timed, and its figures are those of the text."""
    said = command("check", scene_file).stdout
    check = ph.Scene.from_file(scene_file).check()
    # Times, rates and what follows from them differ from one check to the next.
    timed = re.compile(
        r"[0-9.]+ (s|min|h) wall time|.*%  .*\n|changes that save most\n(  .*\n)*|shares of a step.*\n|saves .*\n"
    )
    plain = lambda text: timed.sub("", text)  # noqa: E731
    assert plain(str(check)) == plain(said)
    assert f"{check.nodes} nodes, {check.elements} elements" in said
    assert (check.nodes, check.elements) == (343, 216)
    assert f"{check.steps} steps, about" in said
    assert check.extent == ([0.0, 0.0, 0.0], [120.0, 120.0, 120.0])
    assert check.sets["rock"][:2] == ("elements", 216)
    assert check.step <= check.stable_step
    assert check.limiting_set == "rock"
    assert list(check.resolved_frequency) == ["rock"]
    assert check.memory > 0 and check.wall_time > 0.0


def test_results_of_a_run_without_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run without a folder writes nothing and keeps its snapshots; all arrays are read-only."""
    monkeypatch.chdir(tmp_path)
    scene = keys()
    # The last step ends at the last row of the history.
    scene["time"]["step"] = 0.0025
    results = ph.Scene(scene).run(progress=False)
    assert list(tmp_path.iterdir()) == []
    assert results.folder is None and results.files == []
    assert results.time == pytest.approx(0.3, abs=2 * results.step)
    assert results.histories.units["inside.ax"] == "m/s2"
    table = results.energies
    assert table.times.shape == table["loads"].shape
    assert results.energy_residual is not None and results.energy_residual.largest < 1e-9
    peak = results.peak("inside.ux")
    values = results.histories["inside.ux"]
    # Of all steps, those between two rows included.
    assert abs(peak.value) >= np.abs(values).max()
    assert peak.value == pytest.approx(values[np.abs(values).argmax()], rel=0.01)
    assert str(peak.name) in results.peaks_text
    assert [round(shot.time, 1) for shot in results.snapshots] == [0.0, 0.1, 0.2, 0.3]
    last = results.snapshots[-1]
    node = results.mesh.nearest_node([60, 60, 60])
    assert last.displacement is not None and last.displacement.shape == (343, 3)
    # The snapshot and the history are of the same step.
    at = np.abs(results.histories.times - last.time).argmin()
    assert results.histories["inside.ux"][at] == pytest.approx(last.displacement[node, 0], rel=1e-9)
    greatest = results.fields["displacement"]
    assert greatest.unit == "m" and greatest.values.shape == (343,)
    for array in [values, table.times, last.displacement, greatest.values, results.mesh.points]:
        with pytest.raises(ValueError):
            array[0] = 1.0


def test_arrays_are_the_recorded_data() -> None:
    """A column is one array each time it is read, not a copy."""
    results = ph.Scene(keys()).run(progress=False)
    first, second = results.histories["inside.ux"], results.histories["inside.ux"]
    assert np.shares_memory(first, second)
    assert results.histories.times is results.histories.times


def test_a_scene_is_run_again() -> None:
    """A scene can be run and checked any number of times, with any number of threads, to the same bits."""
    scene = ph.Scene(keys())
    first = scene.run(progress=False)
    scene.check()
    second = scene.run(progress=False, threads=1)
    assert np.array_equal(first.histories["inside.ux"], second.histories["inside.ux"])


def test_frames(scene_file: Path) -> None:
    """Tables and peaks become frames of pandas with names and units."""
    pytest.importorskip("pandas")
    results = ph.Scene.from_file(scene_file).run(progress=False)
    frame = results.histories.frame()
    assert list(frame.columns) == list(results.histories)
    assert frame.index.name == "time"
    assert np.array_equal(frame["inside.uz"].to_numpy(), results.histories["inside.uz"])
    assert frame.attrs["units"]["inside.uz"] == "m"
    peaks = results.peak_frame()
    assert peaks.loc["inside.ux", "value"] == results.peak("inside.ux").value


def test_grids(scene_file: Path) -> None:
    """Envelopes and snapshots become grids of PyVista, from memory and from files alike."""
    pytest.importorskip("pyvista")
    scene = ph.Scene.from_file(scene_file)
    results = scene.run(progress=False)
    grid = results.grid()
    assert grid.n_points == 343 and grid.n_cells == 216
    assert np.isclose(grid.volume, 120.0**3)
    assert np.array_equal(grid.point_data["displacement"], results.fields["displacement"].values)
    in_memory = results.grids()
    on_disk = scene.run(scene_file.parent / "out", progress=False).grids()
    assert len(in_memory) == len(on_disk) == 4
    for here, there in zip(in_memory.values(), on_disk.values()):
        # Files have single precision.
        scale = np.abs(here.point_data["displacement"]).max()
        assert np.allclose(
            here.point_data["displacement"], there.point_data["displacement"], atol=1e-6 * scale, rtol=1e-6
        )


def test_plots() -> None:
    """Histories are drawn; columns of several units, and names that there are not, are refused."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    results = ph.Scene(keys()).run(progress=False)
    axes = results.plot("inside.u*")
    assert [line.get_label() for line in axes.get_lines()] == ["inside.ux", "inside.uy", "inside.uz"]
    assert axes.get_ylabel() == "m"
    with pytest.raises(ValueError, match="m, m/s2"):
        results.plot()
    with pytest.raises(KeyError, match="available: inside.ux"):
        results.plot("inside.vx")


def test_cases() -> None:
    """Cases of a scene are scenes of their own; one that there is not is refused with the names of the others."""
    cases = [{"name": "steep", "wave": [{"kind": "sv", "incidence": 0, "pulse": KEYS["wave"][0]["pulse"]}]}]
    scene = ph.Scene(keys(case=cases))
    assert scene.cases == ["steep"] and scene.case is None
    steep = ph.Scene(keys(case=cases), case="steep")
    assert steep.case == "steep"
    with pytest.raises(ph.InputError, match="its cases are: steep"):
        ph.Scene(keys(case=cases), case="flat")


def test_values_of_a_dictionary() -> None:
    """Numbers and lists of NumPy are values; what is none of TOML is refused by the name of its key."""
    changed = keys()
    changed["time"] = {"duration": np.float64(0.1)}
    changed["boundary"]["scatterer"] = np.array([60.0, 60.0, 120.0])
    changed["boundary"]["region"] = None
    scene = ph.Scene(changed)
    assert scene.duration == 0.1
    assert "scatterer = [60.0, 60.0, 120.0]" in scene.text
    changed["part"][0]["set"] = object()
    with pytest.raises(TypeError, match=r"part\[0\].set"):
        ph.Scene(changed)


def test_the_mesh_of_a_scene() -> None:
    """The mesh of a scene has its points, cells and sets."""
    mesh = ph.Scene(keys()).mesh
    assert mesh.points.shape == (343, 3)
    assert mesh.cells["hex8"].shape == (216, 8)
    assert set(mesh.facet_sets) == {"left", "right", "front", "back", "bottom", "top"}
    assert box().element_count == mesh.element_count


def test_a_report_is_that_of_the_command(scene_file: Path, command: Any) -> None:
    """The report of a run is that of the command; a folder without results is refused with its message."""
    out = scene_file.parent / "out"
    results = ph.Scene.from_file(scene_file).run(out, progress=False)
    page = results.report()
    assert page == out / "report.html"
    written = page.read_bytes()
    assert command("report", out).returncode == 0
    assert page.read_bytes() == written
    with pytest.raises(ph.InputError, match="no folder"):
        ph.Scene(keys()).run(progress=False).report()
    empty = scene_file.parent / "empty"
    with pytest.raises(ph.InputError) as raised:
        ph.write_report(empty)
    assert f"error: {raised.value}\n" == command("report", empty).stderr
