"""Faults: every one is an exception with the text and place of the command's message."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from conftest import keys

import powerhouse_fe as ph

#: What is replaced in the scene file by what, the exception, and a part of its text.
FAULTS = [
    ("[mesh]", "[mesh", ph.SceneError, "unclosed table"),
    ('title = "block"', 'titel = "block"', ph.SceneError, "unknown key 'titel'"),
    ("density = 2750", "densty = 2750", ph.SceneError, "unknown key 'densty'"),
    ("density = 2750", "", ph.SceneError, "missing"),
    ("duration = 0.3", 'duration = "0.3"', ph.SceneError, "expected a number above 0"),
    ("duration = 0.3", "duration = -1.0", ph.SceneError, "-1"),
    ("poisson = 0.27", "poisson = 0.5", ph.SceneError, "expected a number above -1 and below 0.5"),
    ("young = 9000000000.0", "young = 30.0", ph.SceneError, "30"),
    ('material = "rock"', 'material = "rok"', ph.SceneError, "did you mean 'rock'?"),
    ('set = "rock"', 'set = "?"', ph.SceneError, "available: rock"),
    ('"left", ', '"links", ', ph.SceneError, "available: back, bottom"),
    ('law = "elastic"', 'law = "elastik"', ph.SceneError, "did you mean 'elastic'?"),
    ('kind = "viscous-spring"', 'kind = "sponge"', ph.SceneError, "there is no boundary 'sponge'"),
    ('file = "mesh.msh"', 'file = "mash.msh"', ph.SceneError, "mash.msh"),
    ('kind = "sv"', 'kind = "love"', ph.SceneError, "'love'"),
    ("incidence = 20", "incidence = 95", ph.SceneError, "95"),
    ("every = 0.01", "every = 0.0", ph.SceneError, "every"),
    ("at = [60, 60, 60]", "at = [60, 60, 600]", ph.SceneError, "600"),
    ("at = [60, 60, 60]", "at = [60, 60]", ph.SceneError, "expected a list of length 3"),
    ("duration = 0.3", "duration = 0.3\nstep = 0.5", ph.SceneError, "0.5"),
    ("incidence = 20", 'incidence = 20\nrecord = "r"', ph.SceneError, "there is no record 'r'"),
    ("at = [60, 60, 60]", "at = [60, 60, 60]\nnode = 3", ph.SceneError, "exactly one of"),
    ('quantities = ["displacement", "stress"]', 'quantities = ["strain"]', ph.SceneError, "'strain' is not permitted"),
]


@pytest.mark.parametrize(
    ("old", "new", "kind", "text"), FAULTS, ids=[new[:24] or "no density" for _, new, _, _ in FAULTS]
)
def test_messages_are_those_of_the_command(
    scene_file: Path, command: Any, old: str, new: str, kind: type, text: str
) -> None:
    """The exception has the text of the command's error stream, and its place."""
    sound = scene_file.read_text()
    assert old in sound, sound
    scene_file.write_text(sound.replace(old, new, 1))
    said = command("run", scene_file, "--out", scene_file.parent / "out")
    assert said.returncode == 2
    with pytest.raises(kind) as raised:
        ph.Scene.from_file(scene_file).run(progress=False)
    error = raised.value
    assert f"error: {error}\n" == said.stderr
    assert text in str(error)
    assert Path(error.path) == scene_file
    assert f"{scene_file}:{error.line}:{error.column}" in said.stderr
    assert error.problem in str(error)
    assert not (scene_file.parent / "out").exists()


def test_files_that_cannot_be_read(tmp_path: Path, command: Any) -> None:
    """A scene file that is not there has the message of the command."""
    missing = tmp_path / "none.toml"
    with pytest.raises(ph.InputError) as raised:
        ph.Scene.from_file(missing)
    assert f"error: {raised.value}\n" == command("run", missing).stderr


def test_a_folder_that_is_in_the_way(scene_file: Path, command: Any) -> None:
    """A results folder with a folder at the path of a file has the message of the command, before the run."""
    out = scene_file.parent / "out"
    (out / "histories.csv").mkdir(parents=True)
    said = command("run", scene_file, "--out", out).stderr
    with pytest.raises(ph.FolderError) as raised:
        ph.Scene.from_file(scene_file).run(out, progress=False)
    assert f"error: {raised.value}\n" == said


def test_a_free_field_that_is_too_coarse(scene_file: Path, command: Any) -> None:
    """The check of the free field before a run refuses as the command does."""
    scene_file.write_text("self_check = 0.0001\n" + scene_file.read_text())
    said = command("run", scene_file, "--out", scene_file.parent / "out").stderr
    with pytest.raises(ph.InputError, match="is above the scene's self_check") as raised:
        ph.Scene.from_file(scene_file).run(progress=False)
    assert f"error: {raised.value}" in said


def test_a_run_that_fails_has_results(scene_file: Path, command: Any) -> None:
    """A run that fails raises the command's message, with the results until then and their files."""
    scene_file.write_text("energy_residual = 1e-300\n" + scene_file.read_text())
    said = command("run", scene_file, "--out", scene_file.parent / "command")
    assert said.returncode == 2
    out = scene_file.parent / "out"
    with pytest.raises(ph.RunError) as raised:
        ph.Scene.from_file(scene_file).run(out, progress=False)
    error = raised.value
    assert f"error: {error}\n" in said.stderr
    assert error.results is not None and error.results.ended == "failed"
    assert error.results.steps > 0
    assert error.results.summary["failure"] == str(error)


def test_faults_of_a_dictionary() -> None:
    """A fault of a dictionary has its place in the text of the scene."""
    changed = keys()
    changed["material"][0]["poisson"] = 0.7
    with pytest.raises(ph.SceneError) as raised:
        ph.Scene(changed)
    error = raised.value
    assert error.path == "./scene.toml" or error.path == "scene.toml"
    shown = "poisson = 0.7"
    assert f"{error.line} | {shown}" in str(error)
    assert issubclass(ph.SceneError, ph.Error) and not issubclass(ph.Interrupted, ph.Error)


def test_meshes_of_arrays_are_checked() -> None:
    """Arrays that are no mesh are refused by name and index."""
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    for arguments, text in [
        ((points, {"tetra": [[0, 1, 2, 4]]}), "node 4 is none of the 4 points"),
        ((points, {"tetra": [[0, 1, 2]]}), "have 3 nodes, expected 4"),
        ((points, {"tetraeder": [[0, 1, 2, 3]]}), "available: hex8, wedge6"),
        ((points, {"tetra": [[0.0, 1.0, 2.0, 3.0]]}), "expected whole numbers"),
        (([[0, 0], [1, 0]], {"tetra": [[0, 1, 2, 3]]}), "have 2 coordinates"),
        ((points, {"tetra": [[0, 1, 2, 3]]}, {"rock": [1]}), "element 1 is none of the 1 elements"),
        ((points, {"tetra": [[0, 1, 2, 3]]}, None, {"top": [[0, 1, 1]]}), "top"),
        ((points, {"tetra": [[0, 1, 2, 3]]}, {"rock": {"hexahedron": [0]}}), "available: tetra"),
    ]:
        with pytest.raises(ph.InputError, match=text):
            ph.Mesh(*arguments)


def test_a_scene_is_not_overwritten(scene_file: Path, command: Any) -> None:
    """A folder in which the copy of the scene would take the place of the scene has the message of the command."""
    before = scene_file.read_bytes()
    said = command("run", scene_file, "--out", scene_file.parent)
    assert said.returncode == 2
    with pytest.raises(ph.FolderError, match="would take the place of") as raised:
        ph.Scene.from_file(scene_file).run(scene_file.parent, progress=False)
    assert f"error: {raised.value}\n" == said.stderr
    assert scene_file.read_bytes() == before and not (scene_file.parent / "summary.json").exists()
    # A scene of a text has no file that could be lost.
    text = scene_file.read_text()
    assert ph.Scene.from_text(text, scene_file.parent).run(scene_file.parent / "out", progress=False).files
