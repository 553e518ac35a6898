"""What a step by hand costs beside one of a run: microseconds for each step, the median of some pairs.

python benches/step_overhead.py [NUMBER OF ELEMENTS ALONG AN EDGE [THREADS]]
"""

from __future__ import annotations

import statistics
import sys
import time

import powerhouse_fe as ph

PAIRS = 9
STEPS = 20_000


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


def main(cells: int = 4, threads: int = 1) -> None:
    """Prints the time of a step of a run, and what a step by hand takes more."""
    whole = scene(cells)
    runs, more = [], []
    for _ in range(PAIRS):
        alone = whole.run(progress=False, threads=threads)
        by_hand = whole.simulation(threads=threads)
        iterator = iter(by_hand)
        next(iterator)
        started, count = time.perf_counter(), 0
        for _step in iterator:
            count += 1
        taken = (time.perf_counter() - started) / count
        runs.append(1e6 * alone.step_time)
        more.append(1e6 * (taken - alone.step_time))
    print(
        f"{cells}^3 elements, {threads} thread(s): a step of a run {statistics.median(runs):.2f} us, "
        f"by hand {statistics.median(more):+.2f} us ({min(more):+.2f} to {max(more):+.2f})"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
