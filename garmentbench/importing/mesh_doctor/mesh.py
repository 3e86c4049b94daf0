"""A garment's mesh as it was found: nothing about it is trusted but the shapes of its arrays."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from garmentbench.geometry.weld import weld
from garmentbench.importing.mesh_doctor.topology import Sides, sides

NO_PAIRS = np.zeros((0, 2), np.int64)


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh whose vertices are split at UV seams.

    Attributes:
        name: What messages call it.
        vertices: Positions, in the file's unit, shape (V, 3), float64.
        faces: Triangles, shape (F, 3), int64.
        uv: UV coordinates, shape (V, 2), float64, NaN where the file has none; None where it has none at all.
        seams: Pairs of vertices that the file says are one point, shape (S, 2), int64.
        pins: Vertices held fast, shape (P,), int64.
        numbers: Each vertex's number in the file, from 0, shape (V,); two vertices that a UV seam splits may share one.
        says_seams: The file's format has a place for seams, so those that it does not name are missing.
        notes: Licence and provenance, carried along.
        cut: Where each vertex lies in the flat pattern, in the file's unit, shape (V, 2), float64; None where the file
            has none.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None
    numbers: np.ndarray
    seams: np.ndarray = field(default_factory=lambda: NO_PAIRS)
    pins: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    says_seams: bool = False
    notes: dict[str, str] = field(default_factory=dict)
    cut: np.ndarray | None = None

    @property
    def required_uv(self) -> np.ndarray:
        """UV coordinates, shape (V, 2), for work on a mesh that has them."""
        assert self.uv is not None, "ask `uv.missing` first"
        return self.uv

    @cached_property
    def point(self) -> np.ndarray:
        """Point of each vertex, shape (V,): vertices joined by seams are one point."""
        return weld(len(self.vertices), self.seams)[0]

    @cached_property
    def vertex(self) -> np.ndarray:
        """First vertex of each point, shape (P,)."""
        return np.unique(self.point, return_index=True)[1]

    @cached_property
    def points(self) -> np.ndarray:
        """Positions of the points, shape (P, 3)."""
        return self.vertices[self.vertex]

    @cached_property
    def corners(self) -> np.ndarray:
        """The points at the faces' corners, shape (F, 3)."""
        return self.point[self.faces]

    @cached_property
    def sides(self) -> Sides:
        """How the faces meet."""
        return sides(self.corners)

    @cached_property
    def size(self) -> float:
        """Diagonal of the bounding box of all that the faces use, in the file's unit."""
        used = self.vertices[self.faces.ravel()]
        return float(np.linalg.norm(np.ptp(used, axis=0)))

    def scaled(self, factor: float) -> "Mesh":
        """The same mesh in another unit."""
        return replace(self, vertices=self.vertices * factor, cut=None if self.cut is None else self.cut * factor)

    def compact(self) -> "Mesh":
        """Only the vertices that faces use, in their order."""
        used = np.unique(self.faces)
        number = np.full(len(self.vertices), -1)
        number[used] = np.arange(len(used))
        whole = (number[self.seams] >= 0).all(axis=1)
        seams = np.concatenate([self.seams[whole], self._rejoined(used, self.point[self.seams[~whole]])])
        pins = number[self.pins]
        return replace(
            self,
            vertices=self.vertices[used],
            faces=number[self.faces],
            uv=None if self.uv is None else self.uv[used],
            numbers=self.numbers[used],
            seams=number[seams],
            pins=pins[pins >= 0],
            cut=None if self.cut is None else self.cut[used],
        )

    def _rejoined(self, used: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Seam pairs between the used vertices of some points, which a vertex that goes may have joined."""
        members = used[np.isin(self.point[used], points)]
        _, first, place = np.unique(self.point[members], return_index=True, return_inverse=True)
        pairs = np.stack([members[first][place.ravel()], members], axis=1)
        return pairs[pairs[:, 0] != pairs[:, 1]]
