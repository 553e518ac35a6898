"""Loads and incident fields that are functions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import box, keys

import powerhouse_fe as ph

#: Rock of the block: Young's modulus (Pa), Poisson's ratio, density (kg/m3).
ROCK = {"young": 9e9, "poisson": 0.27, "density": 2750.0}


def still(**changes: Any) -> dict[str, Any]:
    """The block without waves."""
    found = keys(**changes)
    del found["wave"]
    return found


def test_a_load_is_that_of_a_scene() -> None:
    """Forces of a function move the body as the same nodal load of the scene does."""
    force = [1e6, 0.0, -2e6]
    load = {"kind": "nodal", "set": "top", "force": force, "function": {"kind": "sine", "frequency": 5.0}}
    of_keys = ph.Scene(still(load=[load])).run(progress=False)

    seen: list[np.ndarray] = []

    def function(time: float, points: np.ndarray) -> np.ndarray:
        seen.append(points)
        return np.sin(2 * np.pi * 5.0 * time) * np.array(force)

    of_function = ph.Scene(still()).with_load("top", function).run(progress=False)
    assert seen[0].shape == (49, 3) and (seen[0][:, 2] == 120.0).all()
    expected, found = of_keys.histories["inside.uz"], of_function.histories["inside.uz"]
    peak = np.abs(expected).max()
    # Two sines, that of Rust and that of NumPy.
    assert peak > 0.0 and np.abs(found - expected).max() < 1e-12 * peak
    with pytest.raises(ph.InputError, match="top"):
        ph.Scene(still()).with_load("tip", function)


def p_wave(time: float, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smooth P wave straight up and its reflection at the surface, z = 120 m."""
    young, nu, density = ROCK.values()
    modulus = young * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    speed = np.sqrt(modulus / density)
    lateral = nu / (1 - nu)

    def pulse(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # A raised cosine of 0.02 m and 0.2 s.
        inside = (t > 0.0) & (t < 0.2)
        phase = 2 * np.pi * t / 0.2
        u = np.where(inside, 0.01 * (1 - np.cos(phase)), 0.0)
        return u, np.where(inside, 0.01 * 2 * np.pi / 0.2 * np.sin(phase), 0.0)

    z = points[:, 2]
    up, down = pulse(time - z / speed), pulse(time - (240.0 - z) / speed)
    zero = np.zeros_like(z)
    displacement = np.column_stack([zero, zero, up[0] + down[0]])
    velocity = np.column_stack([zero, zero, up[1] + down[1]])
    axial = modulus / speed * (down[1] - up[1])
    stress = np.column_stack([lateral * axial, lateral * axial, axial, zero, zero, zero])
    return displacement, velocity, stress


def test_a_field_is_that_of_a_scene() -> None:
    """A free field of a function moves the body as it moves the ground: within the error of the mesh."""
    scene = ph.Scene(still(mesh={"file": box(12)})).with_field(p_wave, **ROCK)
    results = scene.run(progress=False)
    times, found = results.histories.times, results.histories["inside.uz"]
    expected = np.array([p_wave(t, np.array([[60.0, 60.0, 60.0]]))[0][0, 2] for t in times])
    error = np.sqrt(((found - expected) ** 2).sum() / (expected**2).sum())
    # Edges of 10 m, 63 of them along the pulse.
    assert error < 0.02
    with pytest.raises(ph.SceneError, match="medium at node"):
        ph.Scene(still()).with_field(p_wave, **{**ROCK, "density": 2000.0}).run(progress=False)
    with pytest.raises(ph.InputError, match="poisson"):
        ph.Scene(still()).with_field(p_wave, young=9e9, poisson=0.7, density=2750)


def test_exceptions_of_functions_are_raised() -> None:
    """An exception of a function, and what is no array of forces, end the run with the results until then."""

    def late(time: float, points: np.ndarray) -> list[float]:
        if time > 0.1:
            raise LookupError("late")
        return [0.0, 0.0, 1.0]

    with pytest.raises(LookupError, match="late") as raised:
        ph.Scene(still()).with_load("top", late).run(progress=False)
    results = raised.value.results  # type: ignore[attr-defined]
    assert results.ended == "interrupted" and 0.05 < results.time < 0.2
    for value, text in [(np.zeros((3, 5)), "49 x 3"), (np.nan, "not finite"), ("x", "forces")]:
        with pytest.raises(ValueError, match=text):
            ph.Scene(still()).with_load("top", lambda time, points: value).run(progress=False)
    with pytest.raises(LookupError):
        list(ph.Scene(still()).with_load("top", late).simulation())

    def broken(time: float, points: np.ndarray) -> None:
        raise LookupError("broken")

    with pytest.raises(LookupError, match="broken"):
        ph.Scene(still()).with_field(broken, **ROCK).check()
