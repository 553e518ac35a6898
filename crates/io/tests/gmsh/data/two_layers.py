"""Two layers of hexes, the lower one in two physical groups, in four formats.

Writes two_layers_{22,41}_{text,binary}.msh beside itself, the same in three partitions as two_layers_{22,41}_parts.msh,
and one of these partitions as two_layers_41_part.msh. Made with Gmsh 4.15.2.
"""

import os

import gmsh

HERE = os.path.dirname(os.path.abspath(__file__))

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
geometry = gmsh.model.geo
corner = geometry.addPoint(0, 0, 0, 1.0)
geometry.addPoint(0.3, 0.7, -5, 1.0)  # belongs to nothing
line = geometry.extrude([(0, corner)], 1, 0, 0, [2], recombine=True)
face = geometry.extrude([line[1]], 0, 1, 0, [2], recombine=True)
lower = geometry.extrude([face[1]], 0, 0, 1, [1], recombine=True)
upper = geometry.extrude([lower[0]], 0, 0, 1, [1], recombine=True)
geometry.synchronize()
for dimension, entities, number, name in [
    (3, [lower[1][1]], 7, "rock mass"),
    (3, [lower[1][1], upper[1][1]], 9, "both"),
    (2, [face[1][1]], 3, "bottom é"),
    (1, [line[1][1]], 4, ""),
    (0, [corner], 5, "probe"),
]:
    gmsh.model.addPhysicalGroup(dimension, entities, number)
    if name:
        gmsh.model.setPhysicalName(dimension, number, name)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.setPeriodic(2, [upper[0][1]], [face[1][1]], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 0, 0, 0, 1])
for version in ("2.2", "4.1"):
    gmsh.option.setNumber("Mesh.MshFileVersion", float(version))
    for binary, kind in enumerate(("text", "binary")):
        gmsh.option.setNumber("Mesh.Binary", binary)
        name = f"two_layers_{version.replace('.', '')}_{kind}.msh"
        gmsh.write(os.path.join(HERE, name))
gmsh.option.setNumber("Mesh.Binary", 0)
gmsh.option.setNumber("Mesh.PartitionCreateTopology", 1)
gmsh.option.setNumber("Mesh.PartitionCreateGhostCells", 1)
gmsh.model.mesh.partition(3)
for version in ("2.2", "4.1"):
    gmsh.option.setNumber("Mesh.MshFileVersion", float(version))
    gmsh.write(os.path.join(HERE, f"two_layers_{version.replace('.', '')}_parts.msh"))
gmsh.option.setNumber("Mesh.PartitionSplitMeshFiles", 1)
gmsh.write(os.path.join(HERE, "two_layers_41_part.msh"))
for part in (1, 3):
    os.remove(os.path.join(HERE, f"two_layers_41_part_{part}.msh"))
os.rename(os.path.join(HERE, "two_layers_41_part_2.msh"), os.path.join(HERE, "two_layers_41_part.msh"))
gmsh.finalize()
