#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The meshes of the published problems, MSH 2.2, written beside this file without any package.

    python3 data/published/meshes.py

column.msh            a hundred bricks of 1 m one upon the other: sets foot (the lowest), head (the highest), body
ring.msh              a quarter of a lined circle in a square of ground, one layer along y
koyna.msh             a slice of Koyna dam, one layer of 3 m along y: sets dam, upstream, foot, crest
beam_20.msh .. _5     a notched beam with bricks of 20, 10 and 5 mm in its ligament, 50 mm thick
"""

import math
from pathlib import Path

FOLDER = Path(__file__).parent
# Corners of the faces of a brick whose corners are numbered around its lower and then its upper side.
FACES = {"bottom": (0, 3, 2, 1), "top": (4, 5, 6, 7), "front": (0, 1, 5, 4), "right": (1, 2, 6, 5),
         "back": (2, 3, 7, 6), "left": (3, 0, 4, 7)}


class Mesh:
    """Bricks by their corners, and named sides of them."""

    def __init__(self):
        self.nodes, self.places, self.bricks, self.sides = {}, [], [], []

    def node(self, point):
        """The number of the node at a place, to a hundredth of a millimetre."""
        key = tuple(round(x, 5) + 0.0 for x in point)
        if key not in self.nodes:
            self.nodes[key] = len(self.places) + 1
            self.places.append(key)
        return self.nodes[key]

    def brick(self, name, corners, sides=None):
        """Adds a brick; `sides` gives names to some of its faces."""
        numbers = [self.node(corner) for corner in corners]
        self.bricks.append((name, numbers))
        for face, side in (sides or {}).items():
            self.sides.append((side, [numbers[i] for i in FACES[face]]))

    def write(self, name):
        """Writes the file."""
        sets = {}
        for dimension, members in ((3, self.bricks), (2, self.sides)):
            for member, _ in members:
                sets.setdefault((dimension, member), len(sets) + 1)
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(sets))]
        lines += [f'{dimension} {tag} "{member}"' for (dimension, member), tag in sets.items()]
        lines += ["$EndPhysicalNames", "$Nodes", str(len(self.places))]
        lines += [f"{i} " + " ".join(f"{x:g}" if abs(x) < 1 else f"{x:.7g}" for x in place)
                  for i, place in enumerate(self.places, 1)]
        lines += ["$EndNodes", "$Elements", str(len(self.bricks) + len(self.sides))]
        number = 0
        for dimension, kind, members in ((2, 3, self.sides), (3, 5, self.bricks)):
            for member, corners in members:
                number += 1
                tag = sets[(dimension, member)]
                lines.append(f"{number} {kind} 2 {tag} {tag} " + " ".join(map(str, corners)))
        lines.append("$EndElements")
        (FOLDER / name).write_text("\n".join(lines) + "\n")


def box(low, high):
    """The corners of a brick along the axes."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0),
            (x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)]


def column():
    """A column of cubes."""
    mesh, count = Mesh(), 100
    for i in range(count):
        name = "foot" if i == 0 else "head" if i == count - 1 else "body"
        sides = {face: face for face in ("left", "right", "front", "back")}
        if i == 0:
            sides["bottom"] = "bottom"
        if i == count - 1:
            sides["top"] = "top"
        mesh.brick(name, box((0, 0, i), (1, 1, i + 1)), sides)
    mesh.write("column.msh")


def ring(radius=5.0, thickness=0.2, half_size=200.0, around=24, outward=30):
    """A quarter of a ring of one brick across, in ground that ends at a square; x to the right, z up."""
    mesh = Mesh()
    inner, outer = radius - thickness / 2, radius + thickness / 2
    angles = [math.pi / 2 * i / around for i in range(around + 1)]

    def place(angle, layer):
        """A point of the section: layers 0 and 1 are the lining's, then the circle turns into the square."""
        direction = (math.cos(angle), math.sin(angle))
        if layer < 2:
            return tuple((inner, outer)[layer] * c for c in direction)
        edge = half_size / max(direction)
        share = (layer - 1) / outward
        growth = (half_size / outer) ** share
        # Circles near the tunnel, squares far from it.
        square = ((growth - 1) / (half_size / outer - 1)) ** 0.5
        reach = outer * growth * (1 - square) + outer * growth * (edge / half_size) * square
        return tuple(reach * c for c in direction)

    for i in range(around):
        for layer in range(outward + 1):
            a, b = place(angles[i], layer), place(angles[i], layer + 1)
            c, d = place(angles[i + 1], layer + 1), place(angles[i + 1], layer)
            # Around the lower side: y is the third direction of the section turned into the page.
            corners = [(p[0], y, p[1]) for y in (0.0, 1.0) for p in (a, d, c, b)]
            sides = {"bottom": "front", "top": "back"}
            if i == 0:
                sides["left"] = "floor"
            if i == around - 1:
                sides["right"] = "axis"
            if layer == outward:
                middle = (angles[i] + angles[i + 1]) / 2
                sides["back"] = "right" if middle < math.pi / 4 else "roof"
            mesh.brick("lining" if layer == 0 else "ground", corners, sides)
    mesh.write("ring.msh")


def beam(size, name):
    """A beam 2 m long and 0.2 m high, notched by one brick over half its height, under a load on its top."""
    mesh = Mesh()
    half = [size / 2]
    step = size
    while half[-1] < 1.0 - 1e-9:
        left = 1.0 - half[-1]
        if half[-1] >= 0.06:
            step *= 1.5
        step = min(step, 0.1)
        count = max(1, round(left / step)) if step == 0.1 else None
        half.append(half[-1] + (left / count if count else min(step, left)))
    xs = [-x for x in reversed(half)] + half
    rows = round(0.2 / size)
    for i, (x0, x1) in enumerate(zip(xs, xs[1:])):
        middle = i == len(half) - 1
        for j in range(rows):
            z0, z1 = j * size, (j + 1) * size
            if middle and z1 < 0.1 + 1e-9:
                continue
            near = abs(x0 + x1) / 2 < 0.05 and z1 > 0.1 + 1e-9
            sides = {}
            if middle and j == rows - 1:
                sides["top"] = "load"
            mesh.brick("crack" if middle else "near" if near else "beam", box((x0, 0, z0), (x1, 0.05, z1)), sides)
            if j == 0 and i in (0, len(xs) - 2):
                mesh.sides.append(("end", [mesh.node((x0 if i == 0 else x1, y, z)) for y, z in
                                           ((0, z0), (0.05, z0), (0.05, z1), (0, z1))]))
    mesh.write(name)


def dam():
    """A monolith of Koyna dam: a vertical upstream face at x = 0, a downstream face that changes its slope."""
    mesh, across = Mesh(), 20
    heights = [66.5 * k / 24 for k in range(24)] + [66.5 + 36.5 * k / 14 for k in range(15)]

    def width(height):
        if height < 66.5:
            return 70.0 + (19.25 - 70.0) * height / 66.5
        return 19.25 + (14.8 - 19.25) * (height - 66.5) / 36.5

    for k, (low, high) in enumerate(zip(heights, heights[1:])):
        for i in range(across):
            corners = [(width(z) * (i + s) / across, y, z) for z in (low, high)
                       for s, y in ((0, 0.0), (1, 0.0), (1, 3.0), (0, 3.0))]
            sides = {}
            if i == 0:
                sides["left"] = "upstream"
            if k == 0:
                sides["bottom"] = "foot"
            if k == len(heights) - 2:
                sides["top"] = "crest"
            mesh.brick("dam", corners, sides)
    mesh.write("koyna.msh")


if __name__ == "__main__":
    column()
    ring()
    dam()
    for millimetres in (20, 10, 5):
        beam(millimetres / 1000, f"beam_{millimetres}.msh")
