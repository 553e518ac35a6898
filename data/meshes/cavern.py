#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""A closed powerhouse cavern with a concrete lining in a rock block: mapped hexahedra by Gmsh.

    pip install gmsh
    python3 data/meshes/cavern.py            writes cavern.msh and cavern_small.msh beside this file

Box: x -80..80, y -70..70, z -150..0 (free surface). Inside: a void 20 m wide, 32 m high and 50 m
long, crown at z = -60, floor at z = -92, roof a circular arc with a rise of a quarter of the span,
lined on roof, walls, floor and both end walls by one layer of elements that shares its nodes with
the rock. Lengths in metres.

Section (x, z), extruded along y in five slabs:

    +-------+-----------+-------+  z = 0        o  outer blocks, a rectangular grid
    |   o   |     o     |   o   |               r  rock ring, from the extrados to a rectangle
    +-------+-----------+-------+  ring_top     l  lining ring, mitred at its corners
    |       | \   r   / |       |               v  void; rock beyond the end walls, lining in them
    |       |  .-'l'-.  |       |
    |   o   |  |  v  |  |   o   |
    |       |  '--l--'  |       |
    |       | /   r   \ |       |
    +-------+-----------+-------+  ring_bottom
    |   o   |     o     |   o   |
    +-------+-----------+-------+  z = -150
"""

import math
from dataclasses import dataclass
from pathlib import Path

import gmsh

HALF_X, HALF_Y, DEPTH = 80.0, 70.0, 150.0
HALF_SPAN, CROWN, FLOOR, HALF_LENGTH = 10.0, -60.0, -92.0, 25.0
RISE = 2 * HALF_SPAN / 4
ARCH_RADIUS = (HALF_SPAN**2 + RISE**2) / (2 * RISE)
ARCH_CENTRE = CROWN - ARCH_RADIUS
# Coordinates are stored to 0.1 mm: the planes stay exact and the text file stays short.
DIGITS = 4


@dataclass(frozen=True)
class Plan:
    """How finely one mesh is cut."""

    lining: float  # thickness
    arch_cells: int  # along the roof, and as many along the floor; even, so that the crown is a node
    wall_cells: int  # along each wall
    ring_cells: int  # rock between the extrados and the ring's rectangle
    ring_growth: float
    ring_half_x: float
    ring_top: float
    ring_bottom: float
    side_cells: int  # from the rectangle to x = +-80
    cover_cells: int  # from the rectangle to the free surface
    base_cells: int  # from the rectangle to the bottom
    half_void_layers: tuple  # element lengths along y from y = 0 to the end wall
    end_layers: tuple  # element lengths along y from the end wall's outside to y = +-70


PLANS = {
    "cavern": Plan(
        1.0, 8, 8, 3, 1.35, 22.0, -49.0, -104.0, 8, 7, 6,
        (5.75, 5.75, 5.5, 4.5, 3.5), (2.5, 4.5, 7.0, 7.5, 7.5, 7.5, 7.5),
    ),
    "cavern_small": Plan(
        1.5, 4, 4, 2, 1.4, 22.0, -48.0, -105.0, 5, 4, 4,
        (9.0, 9.0, 7.0), (4.5, 8.0, 10.0, 10.5, 10.5),
    ),
}  # fmt: skip


def section(plan, y):
    """Draws the section at y; returns its surfaces by region."""
    geo = gmsh.model.geo
    points, lines = {}, {}

    def point(x, z):
        if (x, z) not in points:
            points[x, z] = geo.addPoint(x, y, z)
        return points[x, z]

    def line(a, b, cells, growth=1.0, centre=None):
        a, b = point(*a), point(*b)
        if (b, a) in lines:
            return -lines[b, a]
        if (a, b) not in lines:
            tag = geo.addLine(a, b) if centre is None else geo.addCircleArc(a, centre, b)
            geo.mesh.setTransfiniteCurve(tag, cells + 1, "Progression", growth)
            lines[a, b] = tag
        return lines[a, b]

    def patch(*edges):
        surface = geo.addPlaneSurface([geo.addCurveLoop(edges)])
        geo.mesh.setTransfiniteSurface(surface)
        geo.mesh.setRecombine(2, surface)
        return surface

    t = plan.lining
    spring_in = CROWN - RISE
    half_out = HALF_SPAN + t
    spring_out = ARCH_CENTRE + math.sqrt((ARCH_RADIUS + t) ** 2 - half_out**2)
    # Four corners of three nested loops, from the lower left, counter-clockwise in (x, z).
    intrados = [(-HALF_SPAN, FLOOR), (HALF_SPAN, FLOOR), (HALF_SPAN, spring_in), (-HALF_SPAN, spring_in)]
    extrados = [(-half_out, FLOOR - t), (half_out, FLOOR - t), (half_out, spring_out), (-half_out, spring_out)]
    rx, top, bottom = plan.ring_half_x, plan.ring_top, plan.ring_bottom
    rectangle = [(-rx, bottom), (rx, bottom), (rx, top), (-rx, top)]
    centre = geo.addPoint(0.0, y, ARCH_CENTRE)
    cells = [plan.arch_cells, plan.wall_cells, plan.arch_cells, plan.wall_cells]

    def loop_edge(corners, i, arched):
        arc = centre if arched and i == 2 else None
        return line(corners[i], corners[(i + 1) % 4], cells[i], centre=arc)

    def ring(inner, outer, outer_arched, across, growth):
        surfaces = []
        for i in range(4):
            j = (i + 1) % 4
            out = loop_edge(outer, i, outer_arched)
            back = -loop_edge(inner, i, True)
            rung_j = -line(inner[j], outer[j], across, growth)
            rung_i = line(inner[i], outer[i], across, growth)
            surfaces.append(patch(out, rung_j, back, rung_i))
        return surfaces

    regions = {
        "void": [patch(*(loop_edge(intrados, i, True) for i in range(4)))],
        "lining": ring(intrados, extrados, True, 1, 1.0),
        "rock": ring(extrados, rectangle, False, plan.ring_cells, plan.ring_growth),
    }
    xs, zs = [-HALF_X, -rx, rx, HALF_X], [-DEPTH, bottom, top, 0.0]
    x_cells = [plan.side_cells, plan.arch_cells, plan.side_cells]
    z_cells = [plan.base_cells, plan.wall_cells, plan.cover_cells]
    for i in range(3):
        for k in range(3):
            if (i, k) == (1, 1):
                continue
            a, b = (xs[i], zs[k]), (xs[i + 1], zs[k])
            c, d = (xs[i + 1], zs[k + 1]), (xs[i], zs[k + 1])
            regions["rock"].append(
                patch(line(a, b, x_cells[i]), line(b, c, z_cells[k]), line(c, d, x_cells[i]), line(d, a, z_cells[k]))
            )
    return regions


def build(plan, path):
    """Meshes the plan and writes it to path."""
    gmsh.model.add(path.stem)
    geo = gmsh.model.geo
    current = section(plan, -HALF_Y)
    end, half = list(plan.end_layers), list(plan.half_void_layers)
    # Slab: element lengths along y, and the volume set that the section's void region becomes.
    slabs = [
        (end[::-1], "rock"),
        ([plan.lining], "lining"),
        (half[::-1] + half, None),
        ([plan.lining], "lining"),
        (end, "rock"),
    ]
    total = sum(sum(lengths) for lengths, _ in slabs)
    assert abs(total - 2 * HALF_Y) < 1e-9 and abs(sum(half) - HALF_LENGTH) < 1e-9, total
    volumes = {"rock": [], "lining": []}
    for number, (lengths, void_becomes) in enumerate(slabs):
        height, passed, heights = sum(lengths), 0.0, []
        for length in lengths:
            passed += length
            heights.append(passed / height)
        further = {}
        for region, surfaces in current.items():
            further[region] = []
            for surface in surfaces:
                made = geo.extrude([(2, surface)], 0, height, 0, [1] * len(lengths), heights, recombine=True)
                further[region].append(made[0][1])
                if region == "void":
                    target = void_becomes
                elif region == "lining":
                    # Beyond the end walls the lining's ring is rock.
                    target = "rock" if number in (0, 4) else "lining"
                else:
                    target = "rock"
                if target is not None:
                    volumes[target].append(made[1][1])
        current = further
    geo.synchronize()

    # A surface with one saved volume beside it is a boundary: of the box, or of the void.
    saved = set(volumes["rock"]) | set(volumes["lining"])
    faces = {name: [] for name in ("left", "right", "front", "back", "bottom", "top", "intrados")}
    planes = [("left", 0, -HALF_X), ("right", 0, HALF_X), ("front", 1, -HALF_Y),
              ("back", 1, HALF_Y), ("bottom", 2, -DEPTH), ("top", 2, 0.0)]  # fmt: skip
    for _, surface in gmsh.model.getEntities(2):
        beside, _ = gmsh.model.getAdjacencies(2, surface)
        if sum(int(v) in saved for v in beside) != 1:
            continue
        box = gmsh.model.getBoundingBox(2, surface)
        name = "intrados"
        for plane, axis, value in planes:
            if max(abs(box[axis] - value), abs(box[axis + 3] - value)) < 1e-3:
                name = plane
        faces[name].append(surface)
    for tag, name in enumerate(volumes, 1):
        gmsh.model.addPhysicalGroup(3, volumes[name], tag, name)
    for tag, name in enumerate(faces, 11):
        gmsh.model.addPhysicalGroup(2, faces[name], tag, name)

    gmsh.model.mesh.generate(3)
    turn_outward(faces)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    for tag, xyz in zip(tags, coordinates.reshape(-1, 3)):
        gmsh.model.mesh.setNode(tag, [round(float(c), DIGITS) + 0.0 for c in xyz], [])
    gmsh.write(str(path))
    gmsh.model.remove()


def turn_outward(faces):
    """Turns the quads of each face so that their normals point out of the solid."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = dict(zip(tags, coordinates.reshape(-1, 3)))
    middle = (0.0, 0.0, (CROWN + FLOOR) / 2)
    for name, surfaces in faces.items():
        for surface in surfaces:
            _, _, nodes = gmsh.model.mesh.getElements(2, surface)
            a, b, c, d = (place[n] for n in nodes[0][:4])
            u, v = c - a, d - b
            normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            # Box and void are star-shaped about the void's middle.
            outward = sum(n * (p - m) for n, p, m in zip(normal, (a + b + c + d) / 4, middle))
            if (outward < 0) != (name == "intrados"):
                gmsh.model.mesh.reverse([(2, surface)])


def main():
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 2)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.option.setNumber("Mesh.SaveAll", 0)
    for name, plan in PLANS.items():
        path = Path(__file__).resolve().parent / f"{name}.msh"
        build(plan, path)
        print(f"{path.name}: {path.stat().st_size} bytes")
    gmsh.finalize()


if __name__ == "__main__":
    main()
