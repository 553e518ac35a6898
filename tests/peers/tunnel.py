# SPDX-License-Identifier: MIT OR Apache-2.0
"""The bricks of the tunnel, and what a program needs to know of them: masses, boundary and incident wave.

Everything is worked out here from the scene file and from the formulas of `docs/theory.md`, not taken from powerhouse.
"""

import math

import numpy as np

RADIUS, THICKNESS, DEPTH = 5.0, 0.5, 30.0  # m, of the inside of the lining; its centre below the surface
AROUND, ROWS = 48, 5  # bricks around the lining, rows of bricks between it and a square around it
HALF_SQUARE, HALF_WIDTH, HEIGHT = 11.0, 40.0, 60.0  # m
# Sides of a brick by its corners, numbered around its lower and then its upper side.
SIDES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
                    [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float)


class Tunnel:
    """One layer, 1 m along y, of a lined circular tunnel and its rock: points (m), bricks by set, facets by face."""

    def __init__(self):
        self.numbers, self.points = {}, []
        self.bricks = {"lining": [], "rock": []}
        self.ring()
        self.ground()
        self.points = np.array(self.points)
        self.facets = self.faces()

    def node(self, x, y, z):
        key = (round(x, 6) + 0.0, y, round(z, 6) + 0.0)
        if key not in self.numbers:
            self.numbers[key] = len(self.points)
            self.points.append(key)
        return self.numbers[key]

    def brick(self, name, corners):
        """Adds a brick over a quadrilateral, whose corners (x, z) are counterclockwise with z up."""
        self.bricks[name].append([self.node(x, y, z) for y in (0.0, 1.0) for x, z in reversed(corners)])

    def ring(self):
        """Lining and rock between the circle and the square, the first brick clockwise from the crown first."""
        def place(row, i):
            angle = 2 * math.pi * i / AROUND
            direction = np.array([math.sin(angle), math.cos(angle)])
            if row == 0:
                return direction * RADIUS
            circle = direction * (RADIUS + THICKNESS)
            side, along = divmod((i + AROUND // 8) % AROUND, AROUND // 4)
            t = HALF_SQUARE * (8 * along / AROUND - 1)
            square = [(t, HALF_SQUARE), (HALF_SQUARE, -t), (-t, -HALF_SQUARE), (-HALF_SQUARE, t)][side]
            share = (row - 1) / ROWS
            return (1 - share) * circle + share * np.array(square)

        for row in range(ROWS + 1):
            for i in range(AROUND):
                quad = [place(row, i), place(row, i + 1), place(row + 1, i + 1), place(row + 1, i)]
                self.brick("rock" if row else "lining", [(x, z - DEPTH) for x, z in quad])

    def ground(self):
        """Bricks along the axes around the square."""
        inner = np.linspace(-HALF_SQUARE, HALF_SQUARE, AROUND // 4 + 1)
        xs = [*np.linspace(-HALF_WIDTH, -HALF_SQUARE, 11)[:-1], *inner, *np.linspace(HALF_SQUARE, HALF_WIDTH, 11)[1:]]
        zs = [*np.linspace(DEPTH - HEIGHT, -HALF_SQUARE, 8)[:-1], *inner, *np.linspace(HALF_SQUARE, DEPTH, 8)[1:]]
        for x0, x1 in zip(xs, xs[1:]):
            for z0, z1 in zip(zs, zs[1:]):
                if max(abs(x0 + x1), abs(z0 + z1)) > 2 * HALF_SQUARE:
                    self.brick("rock", [(x, z - DEPTH) for x, z in ((x0, z0), (x1, z0), (x1, z1), (x0, z1))])

    def faces(self):
        """The facets on the sides of the box: the corners of each, and its outward normal."""
        planes = {"left": (0, -HALF_WIDTH, [-1.0, 0, 0]), "right": (0, HALF_WIDTH, [1.0, 0, 0]),
                  "bottom": (2, -HEIGHT, [0, 0, -1.0]), "front": (1, 0.0, [0, -1.0, 0]), "back": (1, 1.0, [0, 1.0, 0])}
        facets = {name: ([], np.array(normal)) for name, (_, _, normal) in planes.items()}
        for brick in self.bricks["lining"] + self.bricks["rock"]:
            for side in SIDES:
                corners = [brick[i] for i in side]
                for name, (axis, value, _) in planes.items():
                    if np.all(np.abs(self.points[corners, axis] - value) < 1e-6):
                        facets[name][0].append(corners)
        return facets

    def write(self, path):
        """Writes the mesh as MSH 2.2."""
        sets = [(3, 5, name, bricks) for name, bricks in self.bricks.items()]
        sets += [(2, 3, name, corners) for name, (corners, _) in self.facets.items()]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(sets))]
        lines += [f'{dimension} {tag} "{name}"' for tag, (dimension, _, name, _) in enumerate(sets, 1)]
        lines += ["$EndPhysicalNames", "$Nodes", str(len(self.points))]
        lines += [f"{i} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(self.points.tolist(), 1)]
        members = [(kind, tag, nodes) for tag, (_, kind, _, members) in enumerate(sets, 1) for nodes in members]
        lines += ["$EndNodes", "$Elements", str(len(members))]
        lines += [f"{i} {kind} 2 {tag} {tag} " + " ".join(str(node + 1) for node in nodes)
                  for i, (kind, tag, nodes) in enumerate(members, 1)]
        path.write_text("\n".join([*lines, "$EndElements"]) + "\n")

    def nearest(self, point):
        return int(np.argmin(np.linalg.norm(self.points - point, axis=1)))

    def masses(self, density):
        """Lumped masses (kg) by the densities of the sets: the integrals of the shape functions."""
        masses = np.zeros(len(self.points))
        for name, bricks in self.bricks.items():
            for brick in bricks:
                for gauss in CORNERS / math.sqrt(3):
                    terms = 1 + CORNERS * gauss
                    shape = terms.prod(axis=1) / 8
                    gradient = np.stack([CORNERS[:, i] * terms[:, (i + 1) % 3] * terms[:, (i + 2) % 3] / 8
                                         for i in range(3)])
                    masses[brick] += density[name] * shape * np.linalg.det(gradient @ self.points[brick])
        return masses

    def shares(self, faces):
        """Share of the area (m2) of each node in each of some faces, by node: pairs of area and outward normal."""
        shares = {}
        for name in faces:
            corners, normal = self.facets[name]
            for facet in corners:
                a, b, c, d = self.points[facet]
                area = np.linalg.norm(np.cross(c - a, d - b)) / 2
                for node in facet:  # rectangles
                    shares.setdefault(node, {}).setdefault(name, [0.0, normal])[0] += area / 4
        return {node: list(of_node.values()) for node, of_node in shares.items()}


class Medium:
    """An elastic medium: moduli (Pa), density (kg/m3) and wave speeds (m/s)."""

    def __init__(self, material):
        self.young, self.poisson, self.density = (material[key] for key in ("young", "poisson", "density"))
        self.shear = self.young / (2 * (1 + self.poisson))
        self.constrained = 2 * self.shear * (1 - self.poisson) / (1 - 2 * self.poisson)
        self.p_speed, self.s_speed = (math.sqrt(m / self.density) for m in (self.constrained, self.shear))


class Wave:
    """A plane SV wave, a Ricker pulse of displacement, below a free surface at z = 0, with what the surface reflects."""

    def __init__(self, medium, table, corner):
        self.medium, self.corner, self.pulse = medium, corner, table["pulse"]
        angle = math.radians(table["incidence"])
        p = math.sin(angle) / medium.s_speed
        eta, xi = (math.sqrt(1 / speed**2 - p**2) for speed in (medium.s_speed, medium.p_speed))
        shear, compression = np.array([p, 0, eta]), np.array([p, 0, xi])
        down = np.array([1, 1, -1])
        incident = np.array([eta, 0, -p]) * medium.s_speed
        reflected, converted = incident * [-1, 1, 1], compression * down * medium.p_speed
        waves = [(incident, shear), (reflected, shear * down), (converted, compression * down)]
        # The amplitudes that leave no traction on the surface.
        tractions = np.array([self.stress(vector, slowness)[[0, 2], 2] for vector, slowness in waves]).T
        amplitudes = [1.0, *np.linalg.solve(tractions[:, 1:], -tractions[:, 0])]
        rise = -eta * corner[2]  # s, from the corner to the surface
        self.waves = [(factor * vector, slowness, 0.0 if slowness[2] > 0 else rise)
                      for factor, (vector, slowness) in zip(amplitudes, waves)]

    def stress(self, vector, slowness):
        """Stress (Pa) over the velocity of a plane wave."""
        strain = -(np.outer(vector, slowness) + np.outer(slowness, vector)) / 2
        lame = self.medium.constrained - 2 * self.medium.shear
        return lame * np.trace(strain) * np.eye(3) + 2 * self.medium.shear * strain

    def motion(self, point, times):
        """Displacement (m), velocity (m/s) and stress (Pa) at a point and some times."""
        displacement, velocity = np.zeros((len(times), 3)), np.zeros((len(times), 3))
        stress = np.zeros((len(times), 3, 3))
        rate = math.pi * self.pulse["frequency"]
        for vector, slowness, rise in self.waves:
            start = self.corner if slowness[2] > 0 else self.corner * [1, 1, 0]
            x = rate * (times - self.pulse["delay"] - rise - slowness @ (point - start))
            size = self.pulse["displacement"] * np.exp(-x * x)
            signal, change = size * (1 - 2 * x * x), size * rate * x * (4 * x * x - 6)
            displacement += signal[:, None] * vector
            velocity += change[:, None] * vector
            stress += change[:, None, None] * self.stress(vector, slowness)
        return displacement, velocity, stress


class Boundary:
    """Viscous-spring boundary: of each node springs (N/m), dashpots (N s/m) and the forces (N) of the incident wave."""

    def __init__(self, tunnel, medium, table, wave, times):
        self.nodes, self.springs, self.dashpots, self.forces = [], [], [], []
        scatterer = np.array(table["scatterer"])
        for node, shares in sorted(tunnel.shares(table["faces"]).items()):
            spring, dashpot, vector_area = np.zeros(3), np.zeros(3), np.zeros(3)
            for area, normal in shares:
                along = np.abs(normal)
                # A = 0.8, and half of it for waves that spread as cylinders; B = 1.
                share = area / (2 * 1.8 * ((tunnel.points[node] - scatterer) @ normal))
                spring += share * (medium.constrained * along + medium.shear * (1 - along))
                dashpot += area * medium.density * (medium.p_speed * along + medium.s_speed * (1 - along))
                vector_area += area * normal
            displacement, velocity, stress = wave.motion(tunnel.points[node], times)
            self.nodes.append(node)
            self.springs.append(spring)
            self.dashpots.append(dashpot)
            self.forces.append(spring * displacement + dashpot * velocity + stress @ vector_area)
