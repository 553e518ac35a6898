"""Meshes as arrays, from arrays and from meshio, and as PyVista grids."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._lazy import needed
from .errors import InputError

if TYPE_CHECKING:
    import pyvista

#: Names of kinds of elements in meshio, and here.
_SOLIDS = {
    "hexahedron": "hex8",
    "wedge": "wedge6",
    "pyramid": "pyramid5",
    "tetra": "tet4",
    "tetra10": "tet10",
    "line": "bar2",
}
_FACETS = {"triangle": 3, "quad": 4, "triangle6": 6}
#: Number of VTK of each kind of elements, and the order of its nodes there.
_VTK = {
    "hex8": (12, None),
    "wedge6": (13, None),
    "pyramid5": (14, None),
    "tet4": (10, None),
    "tet10": (24, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
    "bar2": (3, None),
}


def _whole(values: ArrayLike, what: str) -> NDArray[np.int64]:
    array = np.asarray(values)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise InputError(
            f"{what}: found {array.dtype} numbers, expected whole numbers, the indices of nodes or elements"
        )
    return np.ascontiguousarray(array, dtype=np.int64)


class Mesh:
    """A finite element mesh.

    ``points`` are positions (m), one row for a node, z up, the ground surface on top. ``cells`` maps kinds of elements
    to the indices of their nodes, one row for an element. Kinds are named as in meshio (``hexahedron``, ``wedge``,
    ``pyramid``, ``tetra``, ``tetra10``, ``line``) or as in scenes (``hex8``, ``wedge6``, ``pyramid5``, ``tet4``,
    ``tet10``, ``bar2``); nodes are in the order of meshio and VTK.

    ``element_sets`` maps names, those of parts, to indices of elements, counted through all kinds in the order of
    ``cells``, or to a dictionary of indices within each kind; without it all elements are the set ``all``.
    ``facet_sets`` maps the names of faces to the nodes of their facets, one row each (a list of such arrays if triangles
    and quadrilaterals are mixed); a facet must be a side of an element. ``node_sets`` maps names to indices of nodes.

    Raises :class:`InputError` for an index out of range, a facet that is no side, a degenerate element.
    """

    def __init__(
        self,
        points: ArrayLike,
        cells: Mapping[str, ArrayLike],
        element_sets: Mapping[str, ArrayLike | Mapping[str, ArrayLike]] | None = None,
        facet_sets: Mapping[str, ArrayLike | Sequence[ArrayLike]] | None = None,
        node_sets: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        positions = np.ascontiguousarray(points, dtype=np.float64)
        if positions.ndim != 2:
            raise InputError(f"points have {positions.ndim} dimensions, expected 2: one row of x, y, z for a node")
        blocks: list[tuple[str, NDArray[np.int64]]] = []
        first: dict[str, int] = {}
        count = 0
        for name, rows in cells.items():
            kind = _SOLIDS.get(name, name)
            nodes = _whole(rows, f"cells of kind '{name}'")
            if nodes.ndim != 2:
                raise InputError(f"cells of kind '{name}' have {nodes.ndim} dimensions, expected 2")
            order = _VTK.get(kind, (0, None))[1]
            blocks.append((kind, np.ascontiguousarray(nodes[:, order]) if order else nodes))
            first[name] = count
            count += len(nodes)
        if element_sets is None:
            element_sets = {"all": np.arange(count)}
        elements: dict[str, list[int]] = {}
        for name, members in element_sets.items():
            what = f"element set '{name}'"
            if isinstance(members, Mapping):
                unknown = [kind for kind in members if kind not in first]
                if unknown:
                    raise InputError(
                        f"{what}: there are no cells of kind '{unknown[0]}'; available: {', '.join(first)}"
                    )
                parts = [_whole(rows, what) + first[kind] for kind, rows in members.items()]
                elements[name] = [int(i) for part in parts for i in part]
            else:
                elements[name] = _whole(members, what).ravel().tolist()
        facets = {name: _facets(name, rows) for name, rows in (facet_sets or {}).items()}
        nodes_of = {
            name: _whole(rows, f"node set '{name}'").ravel().tolist() for name, rows in (node_sets or {}).items()
        }
        self._mesh = _core.Mesh(positions, blocks, elements, facets, nodes_of)

    @classmethod
    def _of(cls, mesh: _core.Mesh) -> Mesh:
        found = cls.__new__(cls)
        found._mesh = mesh
        return found

    @classmethod
    def box(cls, low: Sequence[float], high: Sequence[float], counts: Sequence[int], set: str = "rock") -> Mesh:
        """A box of bricks between two corners (m), with numbers of elements along x, y and z.

        Its facet sets are ``left`` and ``right`` (x), ``front`` and ``back`` (y), ``bottom`` and ``top``.
        """
        return cls._of(_core.Mesh.box_of_bricks(list(map(float, low)), list(map(float, high)), list(counts), set))

    @classmethod
    def from_meshio(cls, mesh: Any) -> Mesh:
        """The mesh of a ``meshio.Mesh``.

        Element and facet sets are the groups of Gmsh (``gmsh:physical`` with ``field_data``) and the ``cell_sets``;
        node sets are the ``point_sets``. Facets must be in a set, elements without one are in ``ungrouped``.
        """
        names = {(int(d[0]), int(d[1])): name for name, d in (mesh.field_data or {}).items()}
        tags = (mesh.cell_data or {}).get("gmsh:physical")
        cells: dict[str, list[NDArray[np.int64]]] = {}
        elements: dict[str, dict[str, list[NDArray[np.int64]]]] = {}
        facets: dict[str, list[NDArray[np.int64]]] = {}
        grouped: dict[str, list[NDArray[np.int64]]] = {}
        for index, block in enumerate(mesh.cells):
            rows = _whole(block.data, f"cells of kind '{block.type}'")
            dimension = 3 if block.type in _SOLIDS else 2
            dimension = 1 if block.type == "line" else dimension
            members: dict[str, NDArray[np.int64]] = {}
            if tags is not None:
                of_block = np.asarray(tags[index])
                for tag in np.unique(of_block):
                    if tag:
                        name = names.get((int(tag), dimension), f"{tag}")
                        members[name] = np.flatnonzero(of_block == tag)
            for name, sets in (mesh.cell_sets or {}).items():
                if not name.startswith("gmsh:") and sets[index] is not None and len(sets[index]):
                    members[name] = _whole(sets[index], f"cell set '{name}'")
            if block.type in _FACETS:
                for name, chosen in members.items():
                    facets.setdefault(name, []).append(rows[chosen])
            elif block.type in _SOLIDS:
                if block.type == "line" and not members:
                    continue
                start = sum(len(part) for part in cells.get(block.type, []))
                cells.setdefault(block.type, []).append(rows)
                for name, chosen in members.items():
                    elements.setdefault(name, {}).setdefault(block.type, []).append(chosen + start)
                    grouped.setdefault(block.type, []).append(chosen + start)
            elif block.type != "vertex":
                known = ", ".join(list(_SOLIDS) + list(_FACETS))
                raise InputError(f"cells of kind '{block.type}' are not supported; available: {known}")
        joined = {kind: np.concatenate(parts) for kind, parts in cells.items()}
        found: dict[str, Any] = {
            name: {kind: np.concatenate(parts) for kind, parts in kinds.items()} for name, kinds in elements.items()
        }
        if found:
            rest = {}
            for kind, rows in joined.items():
                seen = np.zeros(len(rows), dtype=bool)
                for part in grouped.get(kind, []):
                    seen[part] = True
                if not seen.all():
                    rest[kind] = np.flatnonzero(~seen)
            if rest:
                found["ungrouped"] = rest
        points = np.asarray(mesh.points, dtype=np.float64)
        used = np.unique(np.concatenate([rows.ravel() for rows in joined.values()])) if joined else np.arange(0)
        renumbered = np.full(len(points), -1, dtype=np.int64)
        renumbered[used] = np.arange(len(used))
        nodes = {name: renumbered[_whole(chosen, name)] for name, chosen in (mesh.point_sets or {}).items()}
        return cls(
            points[used],
            {kind: renumbered[rows] for kind, rows in joined.items()},
            found or None,
            {name: [renumbered[rows] for rows in parts] for name, parts in facets.items()},
            {name: chosen[chosen >= 0] for name, chosen in nodes.items()},
        )

    @property
    def points(self) -> NDArray[np.float64]:
        """Positions of the nodes (m), one row each."""
        return self._mesh.points

    @property
    def cells(self) -> dict[str, NDArray[np.uint32]]:
        """Indices of the nodes of the elements by kind (``hex8`` ...), one row each, in the order of VTK."""
        return {kind: _in_vtk(kind, nodes) for kind, _, nodes in self._mesh.cells}

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return self._mesh.node_count

    @property
    def element_count(self) -> int:
        """Number of elements."""
        return self._mesh.element_count

    @property
    def node_numbers(self) -> NDArray[np.uint64]:
        """Numbers of the nodes in the mesh file, as messages name them; of a mesh of arrays their indices."""
        return self._mesh.node_numbers

    @property
    def element_numbers(self) -> NDArray[np.uint64]:
        """Numbers of the elements in the mesh file, as messages name them; of a mesh of arrays their indices."""
        return self._mesh.element_numbers

    @property
    def element_sets(self) -> dict[str, NDArray[np.uint32]]:
        """Indices of the elements of each element set."""
        return self._mesh.element_sets

    @property
    def node_sets(self) -> dict[str, NDArray[np.uint32]]:
        """Indices of the nodes of each node set."""
        return self._mesh.node_sets

    @property
    def facet_sets(self) -> dict[str, list[list[int]]]:
        """Indices of the nodes of each facet of each facet set."""
        return self._mesh.facet_sets

    def nearest_node(self, point: Sequence[float]) -> int:
        """Index of the node nearest to a point (m)."""
        away = self.points - np.asarray(point, dtype=np.float64)
        return int(np.argmin((away * away).sum(axis=1)))

    def pyvista(self) -> pyvista.UnstructuredGrid:
        """The mesh as a PyVista grid; the cell data ``set`` is the number of the first element set in rising order."""
        grid = needed("pyvista")
        kinds = np.zeros(self.element_count, dtype=np.uint8)
        cells: list[Any] = [None] * self.element_count
        for kind, elements, nodes in self._mesh.cells:
            kinds[elements] = _VTK[kind][0]
            rows = _in_vtk(kind, nodes)
            counted = np.column_stack([np.full(len(rows), rows.shape[1]), rows])
            for element, row in zip(elements, counted):
                cells[element] = row
        found: pyvista.UnstructuredGrid = grid.UnstructuredGrid(np.concatenate(cells), kinds, np.array(self.points))
        number = np.full(self.element_count, -1, dtype=np.int32)
        for index, members in enumerate(self.element_sets.values()):
            number[members[number[members] < 0]] = index
        found.cell_data["set"] = number
        return found

    def __repr__(self) -> str:
        sets = ", ".join(self.element_sets)
        return f"<Mesh of {self.node_count} nodes and {self.element_count} elements: {sets}>"


def _facets(name: str, rows: ArrayLike | Sequence[ArrayLike]) -> list[NDArray[np.int64]]:
    try:
        whole = [_whole(rows, f"facet set '{name}'")]  # type: ignore[arg-type]
    except ValueError:
        whole = []
    if len(whole) == 1 and whole[0].ndim == 2:
        return whole
    parts = [_whole(part, f"facet set '{name}'") for part in rows]  # type: ignore[union-attr]
    if any(part.ndim != 2 for part in parts):
        raise InputError(f"facet set '{name}': expected one row of nodes for a facet, or a list of such arrays")
    return parts


def _in_vtk(kind: str, nodes: NDArray[np.uint32]) -> NDArray[np.uint32]:
    order = _VTK[kind][1]
    return nodes[:, order] if order else nodes


__all__ = ["Mesh"]
