"""What a law in NumPy costs over 10,000 integration points: microseconds for each step, beside the same law compiled.

python benches/law_overhead.py [THREADS]
"""

from __future__ import annotations

import statistics
import sys
import time

import numpy as np

import powerhouse_fe as ph

#: 1250 bricks of eight points, in one block of elements.
CELLS = [10, 5, 25]
YOUNG, POISSON = 9e9, 0.27
STEPS = 200
PAIRS = 5

LAMBDA = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
MU = YOUNG / (2 * (1 + POISSON))
SHEARS = np.array([2.0, 2.0, 2.0, 1.0, 1.0, 1.0]) * MU


def hooke(points: ph.LawPoints) -> np.ndarray:
    """Hooke's law."""
    stress = points.strain * SHEARS
    stress[:, :3] += LAMBDA * points.strain[:, :3].sum(axis=1, keepdims=True)
    return stress


def softening(points: ph.LawPoints) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Hooke's law whose stiffness falls with the largest shear so far."""
    shear = np.sqrt((points.strain[:, 3:] ** 2).sum(axis=1))
    largest = np.maximum(points.history["largest"], shear)
    return hooke(points) / (1.0 + 1e3 * largest)[:, None], {"largest": largest}


def nothing(points: ph.LawPoints) -> float:
    """No stress: what the call alone costs."""
    return 0.0


LAWS = {"hooke": hooke, "softening": ph.Law(softening, {"largest": "1"}), "nothing": nothing}


def step_time(law: str, threads: int) -> float:
    """Wall time of a step (us)."""
    material = {"name": "rock", "law": law, "young": YOUNG, "poisson": POISSON, "density": 2750}
    if law == "mohr-coulomb":
        # So strong that no point yields.
        material |= {"friction": 40, "dilation": 0, "cohesion": 1e9}
    keys = {
        "title": "overhead",
        "mesh": ph.Mesh.box([0, 0, 0], [100, 50, 250], CELLS),
        "material": [material],
        "part": [{"set": "rock", "material": "rock", "kernel": "hex8-full"}],
        "load": [{"kind": "nodal", "set": "top", "force": [1e3, 0, 0], "function": {"kind": "sine", "frequency": 5.0}}],
        "support": [{"kind": "fixed", "set": "bottom"}],
        "time": {"duration": 0.2},
        "energy_residual": "off",
    }
    count, begun = 0, 0.0
    with ph.Scene(keys, laws=LAWS).simulation(every=STEPS, threads=threads) as simulation:
        for _ in simulation:
            now = time.perf_counter()
            if count:
                return 1e6 * (now - begun) / STEPS
            count, begun = count + 1, now
    raise RuntimeError("the run is shorter than two chunks of steps")


def main(threads: int = 1) -> None:
    """Prints the time of a step with each law."""
    laws = ["elastic", "mohr-coulomb", *LAWS]
    taken: dict[str, list[float]] = {law: [] for law in laws}
    for _ in range(PAIRS):
        for law in laws:
            taken[law].append(step_time(law, threads))
    points = 8 * CELLS[0] * CELLS[1] * CELLS[2]
    for law in laws:
        of_step = statistics.median(taken[law])
        which = "in NumPy" if law in LAWS else "compiled"
        print(f"{law} ({which}): {of_step:.0f} us a step, {1e3 * of_step / points:.0f} ns a point of {points}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
