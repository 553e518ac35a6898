"""Sweeps and trades: those of the command."""

from __future__ import annotations

import csv
import os
import signal
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import box, keys, write_gmsh
from test_laws import elastic

import powerhouse_fe as ph

CASES = """
[[case]]
name = "steep"
[[case.wave]]
kind = "sv"
incidence = 5
pulse = { kind = "smooth", displacement = 0.02, duration = 0.25 }

[[case]]
name = "p"
[[case.wave]]
kind = "p"
incidence = 20
pulse = { kind = "smooth", displacement = 0.02, duration = 0.25 }
"""


@pytest.fixture
def cases_file(scene_file: Path) -> Path:
    """The block in two cases."""
    write_gmsh(scene_file.parent / "mesh.msh", box(4))
    scene_file.write_text(scene_file.read_text() + CASES)
    return scene_file


def test_a_sweep_is_that_of_the_command(cases_file: Path, command: Any) -> None:
    """Table and histories of the cases are those of the command, to the byte but for wall times."""
    pytest.importorskip("pandas")
    folder, of_command = cases_file.parent / "python", cases_file.parent / "command"
    lines: list[str] = []
    scene = ph.Scene.from_file(cases_file)
    sweep = scene.sweep(folder, lambda new, running: lines.extend(new))
    said = command("sweep", cases_file, "--out", of_command)
    assert said.returncode == 0, said.stderr
    assert sweep.cases == ["steep", "p"] and sweep.folder == folder
    frame = sweep.frame()
    table = [line.split(",") for line in (of_command / "sweep.csv").read_text().splitlines()]
    assert table[0] == ["case", *frame.columns] and [row[0] for row in table[1:]] == list(frame.index)
    for column, name in enumerate(frame.columns, 1):
        if name != "wall time [s]":
            assert [float(row[column]) for row in table[1:]] == list(frame[name]), name
    for case in sweep.cases:
        files = [which / case / "histories.csv" for which in (folder, of_command)]
        assert files[0].read_bytes() == files[1].read_bytes()
    assert sweep.outcomes["p"]["steps"] == frame.loc["p", "steps"]
    assert np.abs(sweep.histories("p").to_numpy()).max() > 0.0
    assert "case 1 of 2: steep" in lines
    # Finished cases are not run again.
    lines.clear()
    again = scene.sweep(folder, lambda new, running: lines.extend(new), cases=["p"])
    assert again.cases == ["p"] and "  p: finished before" in lines
    assert list(again.frame().index) == ["p"]


def test_a_trade_is_that_of_the_command(scene_file: Path, command: Any) -> None:
    """The runs of a trade, their errors and the histories are those of the command."""
    pytest.importorskip("pandas")
    write_gmsh(scene_file.parent / "mesh.msh", box(4))
    folder, of_command = scene_file.parent / "python", scene_file.parent / "command"
    trade = ph.Scene.from_file(scene_file).trade(folder, False, error=0.9, factors=["kernel"], window=0.2)
    arguments = ["--error", "0.9", "--factors", "kernel", "--window", "0.2"]
    said = command("trade", scene_file, "--out", of_command, *arguments)
    assert said.returncode == 0, said.stderr
    assert trade.cases[0].name == "reference" and trade.cases[0].error == 0.0
    # The cheapest run is one by the clock.
    assert trade.chosen in trade.cases and "chosen: " in said.stdout
    frame = trade.frame()
    assert list(frame["kernel"]) == [case.levels["kernel"] for case in trade.cases]
    assert len(frame) > 1 and frame["on_front"].any()
    with open(of_command / "trade.csv", encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    assert [row["levels"] for row in table] == [case.name for case in trade.cases]
    assert [float(row["error [1]"]) for row in table] == [case.error for case in trade.cases]
    assert [float(row["step [s]"]) for row in table] == [case.step for case in trade.cases]
    assert max(case.error for case in trade.cases) > 0.01
    histories = sorted(file.relative_to(folder) for file in folder.rglob("histories.csv"))
    assert histories and all((folder / file).read_bytes() == (of_command / file).read_bytes() for file in histories)


def test_what_studies_refuse(cases_file: Path, command: Any) -> None:
    """Studies need a whole scene file with cases; names that do not exist have the command's message."""
    scene = ph.Scene.from_file(cases_file)
    with pytest.raises(ph.InputError, match="a study needs a scene file"):
        ph.Scene(keys()).sweep(progress=False)
    with pytest.raises(ph.InputError, match="leave out the case"):
        ph.Scene.from_file(cases_file, case="p").sweep(progress=False)
    with pytest.raises(ph.InputError, match="no loads or fields of functions"):
        scene.with_load("top", lambda time, points: [0, 0, 0]).trade(progress=False)
    with pytest.raises(ph.InputError) as raised:
        scene.sweep(cases_file.parent / "out", False, cases=["q"])
    said = command("sweep", cases_file, "--out", cases_file.parent / "out", "--case", "q").stderr
    assert f"error: {raised.value}\n" == said
    for arguments, text in [
        ({"error": 0.1, "budget": 1.0}, "expected one of them"),
        ({"error": -0.1}, "above 0"),
        ({"of": ["colour"]}, "available: "),
        ({"reference": "best"}, "available: finest, closed-form"),
        ({"factors": ["colour"]}, "colour"),
        ({"checkpoint_every": "soon"}, "or `never`"),
    ]:
        with pytest.raises(ph.InputError, match=text):
            scene.trade(cases_file.parent / "out", False, **arguments)
    with pytest.raises(ph.InputError, match="jobs"):
        scene.sweep(cases_file.parent / "out", False, jobs=0)


def test_sweeps_have_laws_of_arrays(cases_file: Path) -> None:
    """Cases run with a law of one's own; they are run again when its version changes, and not otherwise."""
    cases_file.write_text(cases_file.read_text().replace('law = "elastic"', 'law = "own"'))
    folder = cases_file.parent / "out"

    def reused(version: str | None) -> int:
        lines: list[str] = []
        scene = ph.Scene.from_file(cases_file, laws={"own": ph.Law(elastic, version=version)})
        scene.sweep(folder, lambda new, running: lines.extend(new), jobs=2)
        return sum("finished before" in line for line in lines)

    assert [reused("1"), reused("1"), reused("2"), reused(None), reused(None)] == [0, 2, 0, 0, 0]


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interrupted_sweep_goes_on(cases_file: Path) -> None:
    """Ctrl-C ends a sweep, and another one continues to the same bytes."""
    cases_file.write_text(cases_file.read_text().replace("duration = 0.3", "duration = 20.0"))
    seen = threading.Event()

    def progress(lines: list[str], running: dict[str, tuple[int, int, float]]) -> None:
        if any(at > 0.2 for _, _, at in running.values()) and not seen.is_set():
            seen.set()
            os.kill(os.getpid(), signal.SIGINT)

    scene = ph.Scene.from_file(cases_file)
    out, whole = cases_file.parent / "out", cases_file.parent / "whole"
    with pytest.raises(ph.Interrupted, match="another sweep continues from there"):
        scene.sweep(out, progress)
    assert seen.is_set()
    scene.sweep(out, False)
    scene.sweep(whole, False)
    for case in ["steep", "p"]:
        files = [which / case / "histories.csv" for which in (out, whole)]
        assert files[0].read_bytes() == files[1].read_bytes()


def test_the_display(capsys: pytest.CaptureFixture[str]) -> None:
    """Lines of a study are on the error stream; how far its runs are is shown on a terminal alone."""
    from powerhouse_fe.studies import StudyDisplay

    with StudyDisplay.of(True) as display:
        assert display is not None
        display(["case 1 of 1: p"], {"p": (1, 2, 0.1)})
    said = capsys.readouterr()
    assert said.out == "" and said.err == "case 1 of 1: p\n"
