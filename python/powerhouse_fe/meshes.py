"""Meshes as arrays, from arrays and from meshio, and as PyVista grids."""

from __future__ import annotations

import warnings
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
    def from_meshio(cls, mesh: Any, regions: str | None = None) -> Mesh:
        """The mesh of a ``meshio.Mesh``.

        Element and facet sets are the groups of Gmsh (``gmsh:physical`` with ``field_data``), of MED (families of
        Salome and Code_Aster), of FLAC3D (by zone, with the name alone where it is that of one slot) and the
        ``cell_sets``; node sets are the groups of nodes of MED and the ``point_sets``. ``regions`` names cell data of
        whole numbers, such as ``"medit:ref"`` or the ``"attribute"`` of a VTU file, whose values become sets;
        ``regions="blocks"`` makes sets ``block_1``, ``block_2`` ... of the blocks of the file, as Exodus has them.
        Facets must be in a set, elements without one are in ``ungrouped``. Elements whose nodes are numbered the other
        way round, as in MED, are turned.

        Warns of regions in cell data or blocks that become no sets. The side sets of Exodus are not in a
        ``meshio.Mesh``.
        """
        blocks = [(block.type, block.data) for block in mesh.cells]
        members = _regions(mesh, blocks, regions)
        cells: dict[str, list[NDArray[np.int64]]] = {}
        elements: dict[str, dict[str, list[NDArray[np.int64]]]] = {}
        facets: dict[str, list[NDArray[np.int64]]] = {}
        grouped: dict[str, list[NDArray[np.int64]]] = {}
        points = _positions(mesh.points)
        for (kind, data), of_block in zip(blocks, members):
            # An empty block may have an array of one dimension and of any type.
            if not len(data):
                continue
            rows = _whole(data, f"cells of kind '{kind}'")
            if kind in _FACETS:
                for name, chosen in of_block.items():
                    facets.setdefault(name, []).append(rows[chosen])
            elif kind in _SOLIDS:
                if kind == "line" and not of_block:
                    continue
                start = sum(len(part) for part in cells.get(kind, []))
                cells.setdefault(kind, []).append(_turned(points, kind, rows))
                for name, chosen in of_block.items():
                    elements.setdefault(name, {}).setdefault(kind, []).append(chosen + start)
                    grouped.setdefault(kind, []).append(chosen + start)
            elif kind != "vertex":
                known = ", ".join(list(_SOLIDS) + list(_FACETS))
                raise InputError(f"cells of kind '{kind}' are not supported; available: {known}")
        joined = {kind: np.concatenate(parts) for kind, parts in cells.items()}
        if not set(joined) - {"line"} and any(kind in _FACETS for kind, _ in blocks):
            raise InputError(
                "the mesh has no solids, only triangles and quadrilaterals: extrude it, in Gmsh by "
                "`Extrude {0, 0, 1} { Surface{:}; Layers{1}; Recombine; }`"
            )
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
        used = np.unique(np.concatenate([rows.ravel() for rows in joined.values()])) if joined else np.arange(0)
        renumbered = np.full(len(points), -1, dtype=np.int64)
        renumbered[used] = np.arange(len(used))
        nodes = {name: renumbered[_whole(chosen, name)] for name, chosen in _node_groups(mesh).items()}
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


def _positions(points: ArrayLike) -> NDArray[np.float64]:
    positions = np.asarray(points, dtype=np.float64)
    if positions.ndim == 2 and positions.shape[1] == 2:
        return np.column_stack([positions, np.zeros(len(positions))])
    return positions


def _regions(mesh: Any, blocks: list[tuple[str, Any]], regions: str | None) -> list[dict[str, NDArray[np.int64]]]:
    """The sets of each block: indices within the block by name."""
    members: list[dict[str, NDArray[np.int64]]] = [{} for _ in blocks]
    data = mesh.cell_data or {}

    def add(block: int, name: str, chosen: NDArray[np.int64]) -> None:
        if not len(chosen):
            return
        if chosen.min() < 0 or chosen.max() >= len(blocks[block][1]):
            raise InputError(
                f"cell set '{name}': found index {int(chosen.max())} in a block of {len(blocks[block][1])} cells of "
                f"kind '{blocks[block][0]}'"
            )
        own = members[block].get(name)
        members[block][name] = chosen if own is None else np.unique(np.concatenate([own, chosen]))

    names = {(int(d[0]), int(d[1])): name for name, d in (mesh.field_data or {}).items() if np.size(d) == 2}
    for index, of_block in enumerate(data.get("gmsh:physical", [])):
        kind = blocks[index][0]
        dimension = 1 if kind == "line" else 3 if kind in _SOLIDS else 2
        for tag in np.unique(of_block):
            if tag:
                add(index, names.get((int(tag), dimension), f"{tag}"), np.flatnonzero(np.asarray(of_block) == tag))
    # A family of MED has any number of groups.
    for index, of_block in enumerate(data.get("cell_tags", [])):
        for family, groups in (getattr(mesh, "cell_tags", None) or {}).items():
            for name in groups:
                add(index, name, np.flatnonzero(np.asarray(of_block) == family))
    for name, sets in _cell_sets(mesh, blocks).items():
        for index, chosen in enumerate(sets):
            if chosen is not None and len(chosen):
                add(index, name, _whole(chosen, f"cell set '{name}'"))
    if regions == "blocks":
        for index, (_, rows) in enumerate(blocks):
            add(index, f"block_{index + 1}", np.arange(len(rows)))
    elif regions is not None:
        if regions not in data:
            raise InputError(f"there are no cell data '{regions}'; available: {', '.join(data) or 'none'}")
        for index, of_block in enumerate(data[regions]):
            values = np.asarray(of_block)
            if values.size and np.any(values != np.round(values)):
                raise InputError(f"cell data '{regions}': found {values.dtype} numbers, expected whole numbers")
            for value in np.unique(values):
                add(index, f"{int(value)}", np.flatnonzero(values == value))
    if regions is None:
        _warn_of_regions(blocks, data, members)
    return members


def _warn_of_regions(blocks: list[tuple[str, Any]], data: Any, members: list[dict[str, NDArray[np.int64]]]) -> None:
    """Warns of cell data of several whole numbers, and of several blocks, that become no element sets."""
    solids = [index for index, (kind, rows) in enumerate(blocks) if kind in _SOLIDS and kind != "line" and len(rows)]
    if any(members[index] for index in solids):
        return
    lost = []
    for name, values in data.items():
        known = name.startswith("gmsh:") or name == "cell_tags"
        parts = [np.asarray(values[index]) for index in solids if index < len(values)]
        whole = [part for part in parts if part.ndim == 1 and np.issubdtype(part.dtype, np.integer)]
        if not known and whole and len(np.unique(np.concatenate(whole))) > 1:
            lost.append(name)
    several = len({kind for kind, _ in (blocks[index] for index in solids)}) < len(solids)
    ways = [f'regions="{name}"' for name in lost] + (['regions="blocks"'] if several else [])
    if ways:
        what = [f"cell data '{name}'" for name in lost] + ([f"{len(solids)} blocks"] if several else [])
        warnings.warn(
            f"the mesh has {' and '.join(what)}, which become no sets: all elements are the set 'all'; give "
            f"{' or '.join(ways)}",
            stacklevel=4,
        )


def _cell_sets(mesh: Any, blocks: list[tuple[str, Any]]) -> dict[str, list[Any]]:
    """Cell sets with indices within each block."""
    sets = {name: found for name, found in (mesh.cell_sets or {}).items() if not name.startswith("gmsh:")}
    # meshio counts the groups of FLAC3D, `zone:NAME:SLOT`, through all blocks.
    flac = {name: name.split(":", 1)[1].rsplit(":", 1) for name in sets if name.startswith(("zone:", "face:"))}
    flac = {name: parts for name, parts in flac.items() if len(parts) == 2}
    first = np.cumsum([0] + [len(rows) for _, rows in blocks])

    def is_global(index: int) -> bool:
        chosen = [np.asarray(sets[name][index]) for name in flac if sets[name][index] is not None]
        return all(np.all((part >= first[index]) & (part < first[index + 1])) for part in chosen if part.size)

    shift = [first[index] if flac and is_global(index) else 0 for index in range(len(blocks))]
    short = [parts[0].strip('"') for parts in flac.values()]
    found: dict[str, list[Any]] = {}
    for name, parts in sets.items():
        if name in flac:
            own = flac[name][0].strip('"')
            key = own if short.count(own) == 1 else name
            found[key] = [
                None if part is None else np.asarray(part, dtype=np.int64) - by for part, by in zip(parts, shift)
            ]
        else:
            found[name] = list(parts)
    return found


def _node_groups(mesh: Any) -> dict[str, ArrayLike]:
    found: dict[str, ArrayLike] = dict(mesh.point_sets or {})
    families = (mesh.point_data or {}).get("point_tags")
    if families is not None:
        groups: dict[str, list[NDArray[np.int64]]] = {}
        for family, names in (getattr(mesh, "point_tags", None) or {}).items():
            for name in names:
                groups.setdefault(name, []).append(np.flatnonzero(np.asarray(families) == family))
        found.update({name: np.concatenate(parts) for name, parts in groups.items()})
    return found


#: A corner with its three neighbours of each kind, right-handed, and the order of the nodes in the mirror.
_HANDS: dict[str, tuple[list[int], list[int]]] = {
    "hexahedron": ([0, 1, 3, 4], [0, 3, 2, 1, 4, 7, 6, 5]),
    "wedge": ([0, 1, 2, 3], [0, 2, 1, 3, 5, 4]),
    "pyramid": ([0, 1, 3, 4], [0, 3, 2, 1, 4]),
    "tetra": ([0, 1, 2, 3], [0, 2, 1, 3]),
    "tetra10": ([0, 1, 2, 3], [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]),
}


def _turned(points: NDArray[np.float64], kind: str, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """The elements of a block, mirrored if the nodes of all of them are numbered left-handed."""
    if kind not in _HANDS or rows.min() < 0 or rows.max() >= len(points):
        return rows
    corners, mirrored = _HANDS[kind]
    at = points[rows[:, corners]]
    volumes = np.einsum("ij,ij->i", np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]), at[:, 3] - at[:, 0])
    return np.ascontiguousarray(rows[:, mirrored]) if np.all(volumes < 0) else rows


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
