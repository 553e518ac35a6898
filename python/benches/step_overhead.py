"""What a step by hand costs beside one of a run: microseconds for each step, in chunks of a hundred.

python benches/step_overhead.py [NUMBER OF ELEMENTS ALONG AN EDGE [THREADS]]
"""

from __future__ import annotations

import statistics
import sys
import time

import powerhouse_fe as ph

PAIRS = 9
STEPS = 20_000
CHUNK = 100


def scene(cells: int) -> ph.Scene:
    """A cube under a load, without an absorbing boundary."""
    keys = {
        "title": "overhead",
        "mesh": ph.Mesh.box([0, 0, 0], [120, 120, 120], [cells] * 3),
        "material": [{"name": "rock", "law": "elastic", "young": 9e9, "poisson": 0.27, "density": 2750}],
        "part": [{"set": "rock", "material": "rock"}],
        "load": [{"kind": "nodal", "set": "top", "force": [1e3, 0, 0], "function": {"kind": "sine", "frequency": 5.0}}],
        "support": [{"kind": "fixed", "set": "bottom"}],
        "time": {"duration": 1.0},
        "energy_residual": "off",
    }
    steps = STEPS if cells < 6 else STEPS // 10
    keys["time"]["duration"] = steps * ph.Scene(keys).check().step
    return ph.Scene(keys)


def chunks(scene: ph.Scene, every: int, threads: int) -> list[float]:
    """Wall time of a step (us) in chunks of a hundred steps, of a run that waits at every so many steps."""
    taken, count = [], 0
    with scene.simulation(every=every, threads=threads) as simulation:
        started = time.perf_counter()
        for _ in simulation:
            count += every
            if count >= CHUNK:
                now = time.perf_counter()
                taken.append(1e6 * (now - started) / count)
                started, count = now, 0
    return taken


def main(cells: int = 4, threads: int = 1) -> None:
    """Prints the time of a step of a run, and what a step by hand takes more."""
    whole = scene(cells)
    run, hand = [], []
    for _ in range(PAIRS):
        run += chunks(whole, CHUNK, threads)
        hand += chunks(whole, 1, threads)
    # Where other programs share the processors, chunks that they interrupt say nothing: the fastest tenth is shown too.
    for name, of in [("median", statistics.median), ("fastest tenth", lambda all: statistics.quantiles(all, n=10)[0])]:
        print(
            f"{cells}^3 elements, {threads} thread(s), {name}: a step of a run {of(run):.2f} us, "
            f"by hand {of(hand) - of(run):+.2f} us"
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
