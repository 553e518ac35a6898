"""A run that is watched step by step, and stopped when it has shown what is looked for.

The lined cavern of the repository on its coarse mesh: the run ends when the crown has moved 5 mm. Then the greatest
displacement is drawn on the body if there is PyVista.

    python examples/watched_run.py [SCENE [DISPLACEMENT IN M]]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import powerhouse_fe as ph

CAVERN = Path(__file__).resolve().parents[2] / "data" / "scenes" / "cavern_small.toml"


def main(path: Path = CAVERN, limit: float = 0.005) -> ph.Results:
    """Runs until the crown has moved by the limit (m)."""
    scene = ph.Scene.from_file(path)
    print(f"{scene.title}: {scene.mesh.node_count} nodes, {scene.duration} s")
    crown = scene.mesh.nearest_node([0, 0, -60])
    with scene.simulation(every=20) as simulation:
        for step in simulation:
            moved = np.linalg.norm(step.displacement[crown])
            if moved > limit:
                print(f"the crown has moved {1000 * moved:.2f} mm at t = {step.time:.3f} s")
                break
    results = simulation.finish()
    print(results)
    return results


if __name__ == "__main__":
    main(*([Path(sys.argv[1])] if sys.argv[1:] else []), *map(float, sys.argv[2:3]))
