"""Runs: interruption, progress, threads, folders, memory."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import box, keys

import powerhouse_fe as ph

#: Long enough that nobody sees its end.
FOREVER = {"duration": 1000.0}


def interrupt_soon(seen: threading.Event) -> None:
    seen.wait(60)
    os.kill(os.getpid(), signal.SIGINT)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interrupted_run_is_complete_until_then(scene_file: Path, command: Any) -> None:
    """Ctrl-C raises with the results until then and writes all files; the command resumes the run to the same bits."""
    sound = scene_file.read_text()
    scene_file.write_text(sound.replace("duration = 0.3", "duration = 400.0").replace("every = 0.1", "every = 100.0"))
    out = scene_file.parent / "out"
    seen = threading.Event()

    def progress(stage: str | None, done: int, planned: int, at: float) -> None:
        if at > 0.2:
            seen.set()

    thread = threading.Thread(target=interrupt_soon, args=(seen,))
    thread.start()
    with pytest.raises(ph.Interrupted) as raised:
        ph.Scene.from_file(scene_file).run(out, progress)
    thread.join()
    results = raised.value.results
    assert isinstance(raised.value, KeyboardInterrupt)
    assert results is not None and results.ended == "interrupted"
    assert results.histories.times[-1] > 0.2
    assert results.summary["ended"] == "stopped"
    assert all(file.exists() for file in results.files)
    assert "histories.csv" in [file.name for file in results.files]
    assert (out / "checkpoint").is_dir()
    resumed = command("run", "--resume", out)
    assert resumed.returncode == 0, resumed.stderr
    whole = scene_file.parent / "whole"
    ph.Scene.from_file(scene_file).run(whole, progress=False)
    assert (out / "histories.csv").read_bytes() == (whole / "histories.csv").read_bytes()


class Enough(Exception):
    """What ends a run in these tests."""


def enough(stage: str | None, done: int, planned: int, at: float) -> None:
    """A progress function that ends the run after some steps."""
    if done > 10:
        raise Enough


def test_an_interrupted_run_is_not_discarded_silently(scene_file: Path) -> None:
    """A run where one of the same scene was interrupted is refused, and its checkpoint and results are kept, unless it
    begins anew on purpose; one of another scene says which checkpoint it removes."""
    scene_file.write_text(scene_file.read_text().replace("duration = 0.3", "duration = 400.0"))
    scene = ph.Scene.from_file(scene_file)
    out = scene_file.parent / "out"
    with pytest.raises(Enough):
        scene.run(out, enough)
    left = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    assert out / "checkpoint" / "latest.run" in left
    doors: list[Callable[[], object]] = [
        lambda: scene.run(out, progress=False),
        lambda: next(iter(scene.simulation(out))),
    ]
    for door in doors:
        with pytest.raises(ph.FolderError) as refused:
            door()
        assert "ended before its time in" in str(refused.value) and "`restart=True`" in str(refused.value)
        assert left == {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    with scene.simulation(out, restart=True) as simulation:
        next(iter(simulation))
    with pytest.raises(Enough):
        scene.run(out, enough, restart=True)
    assert (out / "checkpoint" / "latest.run").exists()
    scene_file.write_text(scene_file.read_text().replace("duration = 400.0", "duration = 0.1"))
    other = ph.Scene.from_file(scene_file).run(out, progress=False)
    assert any("the checkpoint of another run in" in warning for warning in other.warnings)
    assert not (out / "checkpoint").exists()


@pytest.mark.parametrize("precision", ["f32", "mixed", "f64"])
def test_the_files_and_warnings_are_those_of_the_command(precision: str, scene_file: Path, command: Any) -> None:
    """A run has the files of the command, byte for byte but for wall times, and its warnings, that of the number format
    included."""
    text = f'precision = "{precision}"\n' + scene_file.read_text()
    scene_file.write_text(text.replace("every = 0.1\n", "every = 7.0\n"))
    here, there = scene_file.parent / "here", scene_file.parent / "there"
    results = ph.Scene.from_file(scene_file).run(here, progress=False)
    ended = command("run", scene_file, "--out", there)
    assert ended.returncode == 0, ended.stderr
    found = {path.relative_to(there) for path in there.rglob("*") if path.is_file()}
    assert found == {path.relative_to(here) for path in here.rglob("*") if path.is_file()}
    for file in found:
        timeless = [
            [line for line in path.read_bytes().splitlines() if b'"wall_time"' not in line]
            for path in (here / file, there / file)
        ]
        assert timeless[0] == timeless[1], file
    assert any("snapshots" in warning for warning in results.warnings)
    for warning in results.warnings:
        assert f"warning: {warning}" in ended.stdout
    formats = [warning for warning in results.warnings if f'number format "{precision}"' in warning]
    assert len(formats) == ("number format" in ended.stdout)


def test_an_exception_of_progress_ends_a_run() -> None:
    """An exception of a progress function stops the run in order and is raised, with the results until then."""

    class Enough(Exception):
        pass

    def progress(stage: str | None, done: int, planned: int, at: float) -> None:
        if done > 0:
            raise Enough("enough")

    changed = keys(time=FOREVER, output={"every": 0.01, "history": keys()["output"]["history"]})
    with pytest.raises(Enough) as raised:
        ph.Scene(changed).run(progress=progress)
    assert raised.value.results.ended == "interrupted"  # type: ignore[attr-defined]


def test_progress_is_reported() -> None:
    """A progress function sees the last step."""
    calls: list[tuple] = []
    results = ph.Scene(keys()).run(progress=lambda *now: calls.append(now))
    stage, done, planned, at = calls[-1]
    assert stage is None and done == planned == results.steps
    assert at == pytest.approx(results.time)


def test_the_display(capsys: pytest.CaptureFixture[str]) -> None:
    """The display of progress writes to the error stream alone."""
    from powerhouse_fe.progress import Display

    display = Display()
    display._last -= 100.0
    display(None, 50, 100, 0.5)
    display._last -= 100.0
    display("excavation", 0, 0, 0.0)
    said = capsys.readouterr()
    assert said.out == ""
    assert "50 %, t = 0.500 s" in said.err and "stage 'excavation'" in said.err


def test_other_threads_go_on() -> None:
    """Threads of Python go on during a run, which does not hold the interpreter's lock."""
    counted = 0
    ended = threading.Event()

    def count() -> None:
        nonlocal counted
        while not ended.is_set():
            counted += 1
            time.sleep(0.0005)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    ph.Scene(keys(mesh={"file": box(12)}, time={"duration": 1.0})).run(progress=False)
    during = counted - before
    ended.set()
    thread.join()
    assert during > 3


def test_two_runs_at_once(tmp_path: Path) -> None:
    """Two runs of one scene at once, into two folders, have the files of a run alone; one folder is for one run."""
    scene = ph.Scene(keys())
    alone = scene.run(tmp_path / "alone", progress=False)
    found: dict[str, ph.Results] = {}

    def run(name: str) -> None:
        found[name] = scene.run(tmp_path / name, progress=False)

    threads = [threading.Thread(target=run, args=(name,)) for name in ["first", "second"]]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for name in ["first", "second"]:
        assert found[name].ended == "completed"
        for file in alone.files:
            here = tmp_path / name / file.relative_to(tmp_path / "alone")
            timeless = [
                [line for line in path.read_bytes().splitlines() if b'"wall_time"' not in line] for path in (here, file)
            ]
            assert timeless[0] == timeless[1], here


@pytest.mark.skipif(os.name != "posix", reason="locks of POSIX")
def test_a_folder_in_use_is_refused(tmp_path: Path) -> None:
    """A second run into the folder of one that goes on is refused."""
    refused: list[ph.FolderError] = []
    scene = ph.Scene(keys())

    def progress(stage: str | None, done: int, planned: int, at: float) -> None:
        if done > 0 and not refused:
            with pytest.raises(ph.FolderError) as raised:
                scene.run(tmp_path / "out", progress=False)
            refused.append(raised.value)
            raise KeyboardInterrupt

    changed = keys(time=FOREVER, output={"every": 0.01, "history": keys()["output"]["history"]})
    with pytest.raises(ph.Interrupted):
        ph.Scene(changed).run(tmp_path / "out", progress=progress)
    assert len(refused) == 1


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory as Linux reports it")
def test_memory_does_not_grow() -> None:
    """A hundred runs of a small scene take no more memory than twenty, but for a few pages."""
    code = textwrap.dedent(
        """
        import gc, resource, sys
        sys.path.insert(0, sys.argv[1])
        from conftest import box, keys
        import powerhouse_fe as ph
        scene = ph.Scene(keys(mesh={"file": box(3)}))
        def resident():
            gc.collect()
            return int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()
        for _ in range(20):
            scene.run(progress=False, threads=1)
        before = resident()
        for _ in range(100):
            scene.run(progress=False, threads=1)
        print(resident() - before)
        """
    )
    # A process of its own, whose memory is that of the runs; one arena, so that freed memory is used again.
    environment = {**os.environ, "MALLOC_ARENA_MAX": "1"}
    arguments = [sys.executable, "-c", code, str(Path(__file__).parent)]
    ended = subprocess.run(arguments, capture_output=True, text=True, env=environment, check=True)
    # Kept results of a hundred runs take more than twice as much.
    assert int(ended.stdout) < 2_000_000, ended.stdout


def test_snapshots_of_stages_and_bodies_are_released() -> None:
    """Results go away with their last name."""
    import weakref

    results = ph.Scene(keys()).run(progress=False)
    column = results.histories["inside.ux"]
    gone = weakref.ref(results)
    del results
    gc.collect()
    assert gone() is None
    assert np.abs(column).max() > 0.0
