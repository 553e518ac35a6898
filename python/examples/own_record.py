"""A block of ground under a record of one's own, all in memory: mesh, record and results are arrays.

An incident SV pulse at 20 degrees reaches a free surface. The surface about doubles the incident motion; the script says
by how much, and draws the motion if there is matplotlib.

    python examples/own_record.py [NUMBER OF ELEMENTS ALONG AN EDGE]
"""

from __future__ import annotations

import sys

import numpy as np

import powerhouse_fe as ph


def scene(cells: int) -> ph.Scene:
    """A cube of 400 m under a Ricker pulse of 3 Hz."""
    step = 0.005
    time = np.arange(0.0, 1.2, step) - 0.6
    phase = (np.pi * 3.0 * time) ** 2
    # The second derivative of a Ricker pulse, so that velocity and displacement end at rest.
    acceleration = (1.0 - 4.0 * phase + 4.0 / 3.0 * phase**2) * np.exp(-phase)  # m/s2
    return ph.Scene(
        {
            "title": "a record of one's own",
            "mesh": ph.Mesh.box([0, 0, 0], [400, 400, 400], [cells] * 3),
            "material": [{"name": "rock", "law": "elastic", "young": 9e9, "poisson": 0.27, "density": 2750}],
            "part": [{"set": "rock", "material": "rock"}],
            "record": [
                {
                    "name": "pulse",
                    "file": (step, acceleration),
                    "units": "m/s2",
                    "convention": "incident",
                    "baseline": {"kind": "velocity-polynomial", "order": 3},
                }
            ],
            "wave": [{"kind": "sv", "incidence": 20, "record": "pulse"}],
            "boundary": {
                "kind": "viscous-spring",
                "faces": ["left", "right", "front", "back", "bottom"],
                "scatterer": [200, 200, 400],
            },
            "time": {"duration": 1.6},
            "output": {
                "every": 0.01,
                "history": [{"name": "surface", "at": [200, 200, 400], "quantities": ["acceleration"]}],
            },
        }
    )


def main(cells: int = 20) -> float:
    """Runs the scene; returns the peak acceleration of the surface along x over that of the incident wave along x."""
    results = scene(cells).run(progress=cells > 10)
    peak = results.peak("surface.ax")
    # The record is that of the incident SV wave, whose x component is its cosine.
    ratio = abs(peak.value) / np.cos(np.radians(20.0))
    print(
        f"peak of the surface along x: {peak.value:.3f} m/s2 at {peak.time:.2f} s, {ratio:.2f} times the incident one"
    )
    for warning in results.warnings:
        print(f"warning: {warning}")
    try:
        import matplotlib
    except ImportError:
        return ratio
    if not sys.flags.interactive:
        matplotlib.use("agg")
    results.plot("surface.ax", "surface.az")
    return ratio


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
