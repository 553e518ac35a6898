"""Constitutive laws that are functions of arrays."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import KEYS, box, keys, write_gmsh

import powerhouse_fe as ph

ROCK = {"young": 9e9, "poisson": 0.27, "density": 2750}


def elastic(points: ph.LawPoints) -> np.ndarray:
    """Hooke's law of the rock."""
    young, nu = ROCK["young"], ROCK["poisson"]
    lam, mu = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    stress = mu * points.strain
    stress[:, :3] *= 2.0
    stress[:, :3] += lam * points.strain[:, :3].sum(axis=1, keepdims=True)
    return stress


def softening(points: ph.LawPoints) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Stiffness that falls with the largest volumetric strain so far, as Kachanov's damage does."""
    size = np.abs(points.strain[:, :3].sum(axis=1))
    largest = np.maximum(points.history["largest"], size)
    damage = largest / (largest + points.parameters["reference"])
    return (1 - damage)[:, None] * elastic(points), {"largest": largest, "damage": damage}


SOFTENING = ph.Law(softening, {"largest": "1", "damage": "1"}, version="1")


def material(law: str, **more: Any) -> list[dict[str, Any]]:
    return [{"name": "rock", "law": law, **ROCK, **more}]


#: The weight of the block acts before the wave.
WEIGHT: dict[str, Any] = {
    "load": [{"kind": "gravity"}],
    "stage": [
        {
            "name": "weight",
            "tolerance": 1e-8,
            "support": [{"kind": "roller", "set": name} for name in ["left", "right", "front", "back", "bottom"]],
        }
    ],
}


def test_a_law_of_arrays_is_the_law_of_the_software() -> None:
    """Hooke's law in NumPy has the motion of the elastic law, in every kernel of bricks, by threads and in stages."""
    for kernel, more in [
        ("hex8-full", {}),
        ("hex8-natural", {}),
        ("hex8-full", WEIGHT),
    ]:
        parts = [{"set": "rock", "material": "rock", "kernel": kernel}]
        changed = {"part": parts, "mesh": {"file": box(4)}, **more}
        expected = ph.Scene(keys(**changed)).run(progress=False)
        found = ph.Scene(keys(**changed, material=material("own")), laws={"own": elastic}).run(progress=False)
        for name in ["inside.ux", "inside.uz"]:
            peak = np.abs(expected.histories[name]).max()
            assert peak > 0.0
            error = np.abs(found.histories[name] - expected.histories[name]).max()
            # Hooke's law in two orders of operations, and two solutions of the stage to its tolerance.
            assert error < (1e-10 if not more else 1e-4) * peak, (kernel, name, error / peak)


def test_stages_with_a_law_of_arrays() -> None:
    """A stage with a law that softens finds its equilibrium, in which the column of ground carries its weight."""
    changed = keys(material=material("softening", parameters={"reference": 2e-3}), mesh={"file": box(4)}, **WEIGHT)
    changed["part"] = [{"set": "rock", "material": "rock", "kernel": "hex8-full"}]
    changed["output"] = {"every": 0.01, "history": [{"name": "deep", "at": [60, 60, 15], "quantities": ["stress"]}]}
    results = ph.Scene(changed, laws={"softening": SOFTENING}).run(progress=False)
    weight = -9.81 * 2750 * 105.0
    assert results.histories["deep.zz"][0] == pytest.approx(weight, rel=1e-6)
    # The strain of a bar of the elastic stiffness under the weight is a lower bound.
    young, nu = ROCK["young"], ROCK["poisson"]
    strain = -weight * (1 + nu) * (1 - 2 * nu) / (young * (1 - nu))
    assert results.fields["largest"].values.max() > strain


def test_history_variables_are_kept() -> None:
    """A law with history variables damages the rock: they rise, are in the results, and are independent of threads."""
    changed = keys(material=material("softening", parameters={"reference": 1e-3}), mesh={"file": box(4)})
    scene = ph.Scene(changed, laws={"softening": SOFTENING})
    results = scene.run(progress=False)
    largest, damage = results.fields["largest"].values, results.fields["damage"].values
    assert 0.01 < damage.max() < 0.9
    # Means of points of one element: equal for one point, as the default kernel has.
    np.testing.assert_allclose(damage, largest / (largest + 1e-3), rtol=1e-12)
    strong = keys(material=material("softening", parameters={"reference": 1.0}), mesh={"file": box(4)})
    unharmed = ph.Scene(strong, laws={"softening": SOFTENING}).run(progress=False)
    assert unharmed.fields["damage"].values.max() < 0.01
    one = scene.run(progress=False, threads=1)
    assert (one.histories["inside.ux"] == results.histories["inside.ux"]).all()
    mixed = keys(
        material=material("softening", parameters={"reference": 1e-3}),
        mesh={"file": box(4)},
        precision="mixed",
    )
    single = ph.Scene(mixed, laws={"softening": SOFTENING}).run(progress=False)
    peak = np.abs(one.histories["inside.ux"]).max()
    assert np.abs(single.histories["inside.ux"] - one.histories["inside.ux"]).max() < 1e-3 * peak


def test_points_have_their_places() -> None:
    """A law sees positions where it asks for them, widths, and initial stresses; arrays are read-only."""
    seen: list[ph.LawPoints] = []

    def law(points: ph.LawPoints) -> np.ndarray:
        seen.append(points)
        return elastic(points)

    changed = keys(
        material=material("own"),
        mesh={"file": box(4)},
        part=[{"set": "rock", "material": "rock", "kernel": "hex8-full"}],
        time={"duration": 0.01},
        output=None,
    )
    ph.Scene(changed, laws={"own": ph.Law(law, positions=True)}).run(progress=False)
    whole = seen[-1]
    assert len(whole) >= 64 and whole.strain.shape == (len(whole), 6)
    assert whole.positions is not None and 0.0 < whole.positions.min() < whole.positions.max() < 120.0
    np.testing.assert_allclose(whole.widths, 30.0)
    assert whole.initial_stress.shape == (len(whole), 6) and not whole.strain.flags.writeable
    seen.clear()
    ph.Scene(changed, laws={"own": law}).run(progress=False)
    assert seen[-1].positions is None


def test_exceptions_of_laws_are_raised() -> None:
    """An exception of a law ends the run with the results until then; so does what is no array of stresses."""

    def late(points: ph.LawPoints) -> np.ndarray:
        if np.abs(points.strain).max() > 1e-5:
            raise LookupError("late")
        return elastic(points)

    changed = keys(material=material("own"))
    with pytest.raises(LookupError, match="late") as raised:
        ph.Scene(changed, laws={"own": late}).run(progress=False)
    results = raised.value.results  # type: ignore[attr-defined]
    assert 0.0 < results.time < 0.3
    for law, text in [
        (lambda points: points.strain[:, :3], "stress"),
        (lambda points: np.nan, "not finite"),
        (ph.Law(elastic, {"damage": "1"}), "expected a tuple"),
        (ph.Law(lambda points: (elastic(points), {}), {"damage": "1"}), "'damage' is missing"),
        (ph.Law(lambda points: (elastic(points), {"damage": [1.0, 2.0]}), {"damage": "1"}), "'damage'"),
    ]:
        with pytest.raises((ValueError, TypeError), match=text):
            ph.Scene(changed, laws={"own": law}).run(progress=False)


def test_faults_of_laws_are_those_of_the_scene() -> None:
    """Names, keys and values of a material with a law of one's own are checked as all others are."""
    for changed, text in [
        (material("owm"), "did you mean 'own'?"),
        (material("own", cohesion=1e6), "unknown key 'cohesion'"),
        (material("own", parameters={"n": "x"}), "expected a number"),
        (material("own", poisson=0.6), "poisson"),
    ]:
        with pytest.raises(ph.SceneError, match=text.replace("?", r"\?")):
            ph.Scene(keys(material=changed), laws={"own": elastic})
    with pytest.raises(ph.InputError, match="'elastic' is a law of the software"):
        ph.Scene(keys(), laws={"elastic": elastic})
    with pytest.raises(ph.InputError, match="is a function of points"):
        ph.Law(3)  # type: ignore[arg-type]


def test_laws_of_scene_files(scene_file: Path) -> None:
    """A scene file names a law of one's own; without it the file has a fault."""
    write_gmsh(scene_file.parent / "mesh.msh", box(4))
    scene_file.write_text(scene_file.read_text().replace('law = "elastic"', 'law = "own"'))
    results = ph.Scene.from_file(scene_file, laws={"own": elastic}).run(progress=False)
    expected = ph.Scene(keys(mesh={"file": box(4)})).run(progress=False)
    found, expected = results.histories["inside.ux"], expected.histories["inside.ux"]
    np.testing.assert_allclose(found, expected, atol=1e-10 * np.abs(expected).max())
    with pytest.raises(ph.SceneError, match="there is no law 'own'"):
        ph.Scene.from_file(scene_file)
    assert KEYS["material"][0]["law"] == "elastic"
