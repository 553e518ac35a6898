# SPDX-License-Identifier: MIT OR Apache-2.0
"""The tunnel in OpenSees, called from Python: bricks, lumped masses, springs, dashpots and nodal forces of the wave."""

import ctypes
import importlib.util
import time
from pathlib import Path

import numpy as np

from tunnel import AROUND


def load():
    """OpenSees, or nothing where the package `openseespy` is missing."""
    package = importlib.util.find_spec("openseespylinux")
    if package:
        # The wheel for Linux has libraries of its own, which it does not always find by itself.
        for library in 2 * sorted(Path(package.origin).parent.glob("lib/*.so*")):
            try:
                ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
            except OSError:
                pass
    try:
        import openseespy.opensees as opensees
    except (ImportError, RuntimeError):
        return None
    return opensees


def run(opensees, tunnel, media, boundary, element, step, rows, every, places, sections, implicit=False):
    """Histories of the places and sections: rows every so many steps, and the processor seconds that the steps took.

    Explicit central differences with the steps of powerhouse, or an implicit step from row to row.

    Forces of sections are means over the length of a brick, as in powerhouse: the work of the nodal forces of bricks in a motion that is
    zero on one side, a unit on the other one and linear in between.
    """
    opensees.wipe()
    opensees.model("basic", "-ndm", 3, "-ndf", 3)
    masses = tunnel.masses({name: medium.density for name, medium in media.items()})
    for node, (point, mass) in enumerate(zip(tunnel.points, masses)):
        opensees.node(node, *map(float, point))
        opensees.mass(node, *[float(mass)] * 3)
        opensees.fix(node, 0, 1, 0)  # plane strain
    count, first, lining = 0, {}, tunnel.bricks["lining"]
    for material, (name, bricks) in enumerate(tunnel.bricks.items(), 1):
        opensees.nDMaterial("ElasticIsotropic", material, media[name].young, media[name].poisson, 0.0)
        first[name] = count
        for brick in bricks:
            opensees.element(element, count, *brick, material)
            count += 1
    carried = weigh(opensees, tunnel, masses)
    # A fixed node beside each one of the boundary, and a spring with a dashpot between them along each direction.
    for index, (node, springs, dashpots) in enumerate(zip(boundary.nodes, boundary.springs, boundary.dashpots)):
        fixed = len(tunnel.points) + index
        opensees.node(fixed, *map(float, tunnel.points[node]))
        opensees.fix(fixed, 1, 1, 1)
        materials = [3 + 2 * index, 4 + 2 * index]
        for material, axis in zip(materials, (0, 2)):
            opensees.uniaxialMaterial("Elastic", material, float(springs[axis]), float(dashpots[axis]))
        opensees.element("zeroLength", count + index, fixed, node, "-mat", *materials, "-dir", 1, 3)
    for index, (node, forces) in enumerate(zip(boundary.nodes, boundary.forces)):
        for axis in (0, 2):
            tag = 2 + 2 * index + axis // 2
            load = forces[:, axis] + carried.get((node, axis), 0.0)
            opensees.timeSeries("Path", tag, "-dt", step, "-values", *load.tolist(), "-useLast")
            opensees.pattern("Plain", tag, tag)
            opensees.load(node, *[float(i == axis) for i in range(3)])
    opensees.constraints("Plain")
    opensees.algorithm("Linear", *(["-factorOnce"] if implicit else []))
    if implicit:
        opensees.numberer("RCM")
        opensees.system("ProfileSPD")
        opensees.integrator("Newmark", 0.5, 0.25)
    else:
        opensees.numberer("Plain")
        opensees.system("Diagonal")
        opensees.integrator("CentralDifference")
    opensees.analysis("Transient")

    nodes = [tunnel.nearest(place) for place in places.values()]
    at_rest = {(node, i): opensees.nodeDisp(node, i) for node in nodes for i in (1, 3)}

    def values():
        motions = [opensees.nodeDisp(node, i) - start for (node, i), start in at_rest.items()]
        forces = [force for brick, _ in sections.values() for force in section(brick)]
        return motions + forces

    def section(brick):
        points = tunnel.points[lining[brick]]
        middle = points.mean(axis=0)
        normal = points[[1, 2, 5, 6]].mean(axis=0) - points[[0, 3, 4, 7]].mean(axis=0)
        normal /= np.linalg.norm(normal)
        across = np.cross([0.0, 1.0, 0.0], normal)
        length = np.ptp(points @ normal)
        total = np.zeros(3)
        for near in range(brick - 2, brick + 3):
            place = tunnel.points[lining[near]] - middle
            along, inward = place @ normal, place @ across
            forces = np.reshape(opensees.eleResponse(first["lining"] + near % AROUND, "forces"), (8, 3))
            pull, shear = forces @ normal, forces @ across
            share = np.clip(along / length + 0.5, 0, 1)
            total += [share @ pull, share @ shear, share @ (inward * pull - along * shear)]
        return total.tolist()

    history, seconds = [values()], 0.0
    for _ in range(rows):
        began = time.process_time()
        if opensees.analyze(*((1, every * step) if implicit else (every, step))):
            raise RuntimeError("OpenSees does not take a step")
        seconds += time.process_time() - began
        history.append(values())
    opensees.wipe()
    return np.array(history), seconds


def weigh(opensees, tunnel, masses):
    """Brings the weight on, on rollers, which are then taken away: their reactions (N) by node and axis."""
    held = set()
    for face, axis in (("left", 0), ("right", 0), ("bottom", 2)):
        held |= {(node, axis) for facet in tunnel.facets[face][0] for node in facet}
    for node, axis in held:
        opensees.fix(node, *[int(i == axis) for i in range(3)])
    opensees.timeSeries("Linear", 1)
    opensees.pattern("Plain", 1, 1)
    for node, mass in enumerate(masses):
        opensees.load(node, 0.0, 0.0, -9.81 * float(mass))
    opensees.constraints("Plain")
    opensees.numberer("RCM")
    opensees.system("ProfileSPD")
    opensees.algorithm("Linear")
    opensees.integrator("LoadControl", 1.0)
    opensees.analysis("Static")
    if opensees.analyze(1):
        raise RuntimeError("OpenSees does not solve for the weight")
    opensees.reactions()
    carried = {(node, axis): opensees.nodeReaction(node, axis + 1) for node, axis in held}
    for node, axis in held:
        opensees.remove("sp", node, axis + 1)
    opensees.loadConst("-time", 0.0)
    opensees.wipeAnalysis()
    return carried
