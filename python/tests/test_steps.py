"""Runs that are taken step by step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import keys

import powerhouse_fe as ph


def test_steps_are_those_of_a_run() -> None:
    """Every step is seen once, with the motion that a run records, and the results are those of the run."""
    every_step = keys()
    every_step["output"]["every"] = 1e-6
    scene = ph.Scene(every_step)
    run = scene.run(progress=False)
    simulation = scene.simulation()
    node = run.mesh.nearest_node([60, 60, 60])
    numbers, times, motions, accelerations = [], [], [], []
    for step in simulation:
        numbers.append(step.number)
        times.append(step.time)
        motions.append(step.displacement[node])
        accelerations.append(step.acceleration[node])
    results = simulation.finish()
    assert numbers == list(range(run.steps))
    assert np.array_equal(times, run.histories.times)
    for axis, name in enumerate("xyz"):
        assert np.array_equal(np.array(motions)[:, axis], run.histories[f"inside.u{name}"])
        assert np.array_equal(np.array(accelerations)[:, axis], run.histories[f"inside.a{name}"])
    assert results.ended == "completed" and results.steps == run.steps
    for name, values in run.histories.items():
        assert np.array_equal(results.histories[name], values)
    assert simulation.step == run.step


def test_every_so_many_steps() -> None:
    """Of many steps every tenth and the last are seen."""
    scene = ph.Scene(keys())
    simulation = scene.simulation(every=10)
    numbers = [step.number for step in simulation]
    last = simulation.finish().steps - 1
    assert numbers == sorted({*range(0, last, 10), last})
    with pytest.raises(ph.InputError, match="every"):
        scene.simulation(every=0)


def test_a_run_that_is_left_early(tmp_path: Path) -> None:
    """A loop that is left ends the run at its step, with results and files."""
    with ph.Scene(keys()).simulation(tmp_path / "out") as simulation:
        for step in simulation:
            if np.abs(step.velocity).max() > 0.05:
                reached = step.time
                break
    results = simulation.finish()
    assert results.time == pytest.approx(reached, abs=1.5 * results.step)
    assert results.time < 0.29
    assert (tmp_path / "out" / "histories.csv").exists()
    assert results.ended == "stepping by hand" and results.ended in results.summary["ended"]
    with pytest.raises(ph.Error, match="at no step"):
        _ = simulation.displacement


def test_fields_at_a_step() -> None:
    """Stress at a step is that of a snapshot; arrays are read-only; a variable that there is not has no numbers."""
    scene = ph.Scene(keys())
    run = scene.run(progress=False)
    request = keys()
    request["output"]["snapshots"] = {"every": 0.1, "fields": ["displacement", "stress"]}
    with ph.Scene(keys()).simulation() as simulation:
        for step in simulation:
            stress = step.stress
            assert stress.shape == (216, 6)
            assert np.isnan(step.history("damage")).all()
            if step.number == 20:
                break
        with pytest.raises(ValueError):
            stress[0, 0] = 1.0
    assert np.abs(stress).max() > 0.0
    assert run.steps > 20


def test_a_faulty_scene_is_reported() -> None:
    """A scene that cannot be run is reported with the first step."""
    changed = keys()
    changed["output"]["history"] = changed["output"]["history"] * 2
    with pytest.raises(ph.SceneError):
        ph.Scene(changed)
    changed = keys()
    changed["time"]["step"] = 0.5
    with pytest.raises(ph.Error) as of_run:
        ph.Scene(changed).run(progress=False)
    with pytest.raises(ph.Error) as of_steps:
        list(ph.Scene(changed).simulation())
    assert str(of_steps.value) == str(of_run.value)


def test_an_error_in_the_loop_ends_the_run() -> None:
    """An exception of the loop's body passes through, and the run ends."""
    with pytest.raises(ZeroDivisionError), ph.Scene(keys()).simulation() as simulation:
        for _ in simulation:
            raise ZeroDivisionError
    assert simulation.finished
    del simulation


def test_a_run_that_nobody_ends() -> None:
    """A simulation that is dropped ends its run."""
    simulation = ph.Scene(keys(time={"duration": 1000.0})).simulation()
    next(iter(simulation))
    del simulation
