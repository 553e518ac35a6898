"""Explicit dynamic finite element analysis of underground structures under obliquely incident earthquake waves.

>>> import powerhouse_fe as ph
>>> scene = ph.Scene.from_file("data/scenes/cavern_small.toml")  # doctest: +SKIP
>>> print(scene.check())  # doctest: +SKIP
>>> results = scene.run()  # doctest: +SKIP
>>> results.histories["crown.ux"]  # doctest: +SKIP

Units are SI (m, s, kg, N, Pa), z points up, tension is positive.
"""

from ._core import version as __version__
from .errors import Error, FolderError, InputError, Interrupted, RunError, SceneError
from .laws import Law, LawPoints
from .meshes import Mesh
from .records import Record
from .results import EnergyResidual, Field, Peak, Results, Snapshot, write_report
from .scenes import Check, Scene
from .simulations import Simulation
from .studies import Sweep, Trade
from .tables import Table

__all__ = [
    "Check",
    "EnergyResidual",
    "Error",
    "Field",
    "FolderError",
    "InputError",
    "Interrupted",
    "Law",
    "LawPoints",
    "Mesh",
    "Peak",
    "Record",
    "Results",
    "RunError",
    "Scene",
    "SceneError",
    "Simulation",
    "Snapshot",
    "Sweep",
    "Table",
    "Trade",
    "__version__",
    "write_report",
]
