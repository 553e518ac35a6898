#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Checks the cavern meshes as they stand on disk, without Gmsh, and prints their figures.

    pip install numpy
    python3 data/meshes/check.py [FILE.msh ...]

Reads MSH 4.1 text itself. Fails on: a tag or count that does not fit; a doubled, orphan or dangling
node; a corner Jacobian that is not positive, a scaled Jacobian below 0.3; a quad face of the hexes
that is neither shared by exactly two of them nor in exactly one face set; a face set with the wrong
plane, area or normal; a void of the wrong volume, or solid and void that do not fill the box.
"""

import sys
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np

# Gmsh's hex: corners in units of the reference cube, its six faces, its twelve edges.
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]  # outward
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
PLANES = {"left": (0, -80), "right": (0, 80), "front": (1, -70), "back": (1, 70), "bottom": (2, -150), "top": (2, 0)}
# E in Pa, Poisson's ratio, density: Wang, Chen & Xiao (2019), Table 1.
MATERIALS = {"rock": (9.0e9, 0.27, 2750.0), "lining": (25.0e9, 0.17, 2500.0)}


def read(path):
    """Nodes by tag, and quads and hexes by the name of their physical group."""
    lines = iter(path.read_text().splitlines())
    sections = {}
    for head in lines:
        body = []
        for row in lines:
            if row == "$End" + head[1:]:
                break
            body.append(row)
        else:
            raise SystemExit(f"{head} is not closed")
        sections[head[1:]] = body
    assert sections["MeshFormat"] == ["4.1 0 8"]
    names = {}
    for row in sections["PhysicalNames"][1:]:
        dim, tag, name = row.split()
        names[int(dim), int(tag)] = name.strip('"')
    rows = iter(sections["Entities"])
    counts = [int(v) for v in next(rows).split()]
    group = {}
    for dim, count in enumerate(counts):
        for _ in range(count):
            fields = next(rows).split()
            first = 4 if dim == 0 else 7
            physical = [int(v) for v in fields[first + 1 : first + 1 + int(fields[first])]]
            if physical:
                assert len(physical) == 1
                group[dim, int(fields[0])] = names[dim, physical[0]]
    rows = iter(sections["Nodes"])
    blocks, count, low, high = (int(v) for v in next(rows).split())
    tags, xyz = [], []
    for _ in range(blocks):
        *_, here = (int(v) for v in next(rows).split())
        tags += [int(next(rows)) for _ in range(here)]
        xyz += [[float(v) for v in next(rows).split()] for _ in range(here)]
    assert len(tags) == len(set(tags)) == count and min(tags) == low and max(tags) == high
    place = {tag: i for i, tag in enumerate(tags)}
    rows = iter(sections["Elements"])
    blocks, count, _, _ = (int(v) for v in next(rows).split())
    cells, seen = {2: defaultdict(list), 3: defaultdict(list)}, set()
    for _ in range(blocks):
        dim, entity, kind, here = (int(v) for v in next(rows).split())
        assert (dim, kind) in {(2, 3), (3, 5)}, "only quads and hexes"
        for _ in range(here):
            tag, *nodes = (int(v) for v in next(rows).split())
            seen.add(tag)
            cells[dim][group[dim, entity]].append([place[n] for n in nodes])
    assert len(seen) == count
    return np.array(xyz), cells[2], {k: np.array(v) for k, v in cells[3].items()}


def jacobians(corners, at):
    """dx/dxi of every hex at one reference point; and the gradients of the shape functions there."""
    factors = 1 + CORNERS * at
    slope = np.stack([CORNERS[:, d] * np.prod(np.delete(factors, d, 1), 1) / 8 for d in range(3)], 1)
    jacobian = np.einsum("eni,nj->eij", corners, slope)
    return jacobian, np.einsum("nj,eji->eni", slope, np.linalg.inv(jacobian))


def strain_matrix(gradient):
    """B (e, 6, 24), components xx yy zz xy yz zx."""
    b = np.zeros((len(gradient), 6, 8, 3))
    for row, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]):
        b[:, row, :, i] += gradient[:, :, j]
        if i != j:
            b[:, row, :, j] += gradient[:, :, i]
    return b.reshape(len(gradient), 6, 24)


def step_bounds(corners, material):
    """2/omega of each free element, equal lumped masses: one point, and 2x2x2 points."""
    young, nu, density = material
    lam, shear = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    law = np.diag([2 * shear] * 3 + [shear] * 3)
    law[:3, :3] += lam
    root = np.linalg.cholesky(law)
    gauss = 1 / np.sqrt(3)
    points = [CORNERS[i] * gauss for i in range(8)]
    weights = [np.linalg.det(jacobians(corners, p)[0]) for p in points]
    mass = density * sum(weights) / 8

    def bound(stiffness):
        return 2 / np.sqrt(np.linalg.eigvalsh(stiffness)[:, -1] / mass)

    def part(at, weight):
        scaled = np.einsum("ki,ekn->ein", root, strain_matrix(jacobians(corners, at)[1]))
        return weight[:, None, None] * np.einsum("ein,eim->enm", scaled, scaled)

    return bound(part(np.zeros(3), sum(weights))), bound(sum(part(p, w) for p, w in zip(points, weights)))


def check(path):
    xyz, quads, hexes = read(path)
    assert set(hexes) == set(MATERIALS) and set(quads) == set(PLANES) | {"intrados"}
    print(f"{path.name}: {path.stat().st_size} bytes, {len(xyz)} nodes, {sum(map(len, hexes.values()))} hexes")
    print("  extent", xyz.min(0).tolist(), xyz.max(0).tolist())
    # Nodes.
    assert np.isfinite(xyz).all()
    cell = Counter(map(tuple, np.floor(xyz / 0.05).astype(int)))
    near = {(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)}
    for c, n in cell.items():
        assert n == 1 and sum((c[0] + d[0], c[1] + d[1], c[2] + d[2]) in cell for d in near) == 1, "doubled node"
    every = np.concatenate(list(hexes.values()))
    assert np.array_equal(np.unique(every), np.arange(len(xyz))), "orphan or dangling node"
    assert all(len(set(h)) == 8 for h in every)
    # Shape.
    for name, cells in hexes.items():
        corners = xyz[cells]
        worst, volume = np.inf, np.zeros(len(cells))
        for at in CORNERS:
            jacobian, _ = jacobians(corners, at)
            det = np.linalg.det(jacobian)
            assert (det > 0).all(), "a corner is turned inside out"
            worst = min(worst, (det / np.linalg.norm(jacobian, axis=1).prod(1)).min())
            volume += np.linalg.det(jacobians(corners, at / np.sqrt(3))[0])
        edge = np.stack([np.linalg.norm(corners[:, a] - corners[:, b], axis=1) for a, b in EDGES])
        one, eight = step_bounds(corners, MATERIALS[name])
        e, nu, rho = MATERIALS[name]
        cp = np.sqrt(e * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * rho))
        assert worst >= 0.3
        print(f"  {name}: {len(cells)} hexes, volume {volume.sum():.3f}, edges {edge.min():.4f}..{edge.max():.4f},"
              f" aspect <= {(edge.max(0) / edge.min(0)).max():.2f}, scaled Jacobian >= {worst:.4f}")  # fmt: skip
        print(f"    step: edge/cp {edge.min() / cp:.4e}, one point {one.min():.4e}, 2x2x2 {eight.min():.4e} s (cp {cp:.1f})")
        hexes[name] = (cells, volume.sum())
    # Faces: each in two hexes, or in one hex and one set.
    owners = Counter()
    outward = {}
    for h in every:
        for face in FACES:
            nodes = [int(h[i]) for i in face]
            owners[frozenset(nodes)] += 1
            outward[frozenset(nodes)] = nodes
    named = Counter(frozenset(q) for cells in quads.values() for q in cells)
    assert set(owners.values()) <= {1, 2} and set(named.values()) == {1}
    assert set(named) == {f for f, n in owners.items() if n == 1}, "free face without a set, or the reverse"
    for name, cells in quads.items():
        p = xyz[np.array(cells)]
        normal = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]) / 2
        agree = sum(outward[frozenset(q)][(outward[frozenset(q)].index(q[0]) + 1) % 4] == q[1] for q in cells)
        assert agree == len(cells), f"{name}: {agree} of {len(cells)} normals point outward"
        area = np.linalg.norm(normal, axis=1).sum()
        print(f"  {name}: {len(cells)} quads, area {area:.3f}")
        if name in PLANES:
            axis, value = PLANES[name]
            assert (p[:, :, axis] == value).all()
            assert abs(area - np.prod([s for i, s in enumerate((160, 140, 150)) if i != axis])) < 1e-6
        else:
            # Divergence theorem; the roof is a polygon inscribed in its circle.
            void = -(p.mean(1) * normal).sum() / 3
            roof = len({round(float(z), 3) for _, y, z in p.reshape(-1, 3) if y == 0 and z > -65.0 + 1e-6}) * 2
            half = np.arcsin(10 / 12.5)
            closed = 50 * (20 * 27 + roof * 12.5**2 / 2 * np.sin(2 * half / roof) - 10 * 7.5)
            assert abs(void - closed) < 1.0, (void, closed)
            assert abs(sum(v for _, v in hexes.values()) + void - 160 * 140 * 150) < 1e-3
            print(f"    void {void:.3f}, with a roof of {roof} chords {closed:.3f}, with a round roof {50 * (540 + 12.5**2 * half - 75):.3f}")
            on = np.unique(np.array(cells))
            for what, x, z in [("crown", 0, -60), ("left springing", -10, -65), ("right springing", 10, -65),
                               ("left wall", -10, -78.5), ("right wall", 10, -78.5), ("floor", 0, -92)]:  # fmt: skip
                n = on[np.argmin(np.linalg.norm(xyz[on] - [x, 0, z], axis=1))]
                print(f"    {what}: node at {xyz[n].tolist()}")
    # The lining: one element everywhere between intrados and rock.
    cells, _ = hexes["lining"]
    inside = Counter()
    rock = set(map(frozenset, (tuple(h[list(f)]) for h in hexes["rock"][0] for f in FACES)))
    skin = set(map(frozenset, quads["intrados"]))
    for h in cells:
        faces = [frozenset(h[list(f)]) for f in FACES]
        inside[sum(f in skin for f in faces), sum(f in rock for f in faces)] += 1
    print("  lining hexes by (faces on the void, faces on rock):", dict(inside))


if __name__ == "__main__":
    here = Path(__file__).resolve().parent
    for file in [Path(a) for a in sys.argv[1:]] or [here / "cavern.msh", here / "cavern_small.msh"]:
        check(file)
