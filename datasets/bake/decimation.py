"""Fewer vertices on a closed surface: even triangles where garments touch, small errors where one looks.

Edges are collapsed one by one, the cheapest first. A collapse that would leave a surface which is no manifold any more,
or turn a triangle over, is left out (Hoppe et al. 1993, "Mesh optimization").
"""

import heapq
from collections.abc import Callable

import numpy as np

_TURNS = 0.3  # cosine of the angle by which a triangle may turn in a collapse
_SLIM = 0.05  # area over longest edge squared, below which a triangle may not fall (an even one has 0.43)
_LENGTH = 1e-3  # what a collapsed edge's length counts for besides the error


class Surface:
    """A closed triangle mesh whose edges can be collapsed.

    Attributes:
        points: Vertices [m], shape (V, 3); those that are gone stay in place.
        ring: The faces round each vertex, by number; empty where it is gone.
        corners: Of each face.
    """

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self.points = vertices.astype(np.float64).copy()
        self.corners = [tuple(face) for face in faces.tolist()]
        self.ring: list[set[int]] = [set() for _ in vertices]
        for number, face in enumerate(self.corners):
            for vertex in face:
                self.ring[vertex].add(number)
        self._quadrics = _quadrics(self.points, faces)

    def neighbours(self, vertex: int) -> set[int]:
        return {corner for face in self.ring[vertex] for corner in self.corners[face]} - {vertex}

    def collapse(self, inside: np.ndarray, count: int, cost: "Cost") -> None:
        """Collapse edges between vertices of `inside`, shape (V,), bool, until at most `count` of them are left."""
        left = sum(bool(self.ring[v]) for v in np.flatnonzero(inside))
        stamp = np.zeros(len(self.points), np.int64)
        heap: list[tuple[float, int, int, int, int]] = []

        def push(u: int, v: int) -> None:
            heapq.heappush(heap, (cost(self, u, v)[0], u, v, stamp[u], stamp[v]))

        for u in np.flatnonzero(inside).tolist():
            for v in self.neighbours(u):
                if u < v and inside[v]:
                    push(u, v)
        while left > count and heap:
            _, u, v, at_u, at_v = heapq.heappop(heap)
            if at_u != stamp[u] or at_v != stamp[v]:
                continue
            place = cost(self, u, v)[1]
            if not self._may(u, v, place):
                continue
            self._merge(u, v, place)
            left -= 1
            stamp[u] = -1
            changed = [v, *(n for n in self.neighbours(v) if inside[n])]
            stamp[changed] += 1
            for a in changed:
                for b in self.neighbours(a):
                    if inside[b] and (a < b or b not in changed):
                        push(min(a, b), max(a, b))

    def error(self, u: int, v: int, place: np.ndarray) -> float:
        """Mean squared distance [m^2] of a place from the planes of the faces that u and v stand for."""
        q = self._quadrics[u] + self._quadrics[v]
        h = np.append(place, 1.0)
        return float(h @ q[:4] @ h) / q[4, 0]

    def _may(self, u: int, v: int, place: np.ndarray) -> bool:
        """Does the surface stay a manifold, without triangles turned over or slivers?"""
        if len(self.neighbours(u) & self.neighbours(v)) != 2 or min(len(self.ring[u]), len(self.ring[v])) < 4:
            return False
        for kept, gone in ((u, v), (v, u)):
            for number in self.ring[kept] - self.ring[gone]:
                before = self.points[list(self.corners[number])]
                after = before.copy()
                after[self.corners[number].index(kept)] = place
                a, b = (np.cross(t[1] - t[0], t[2] - t[0]) for t in (before, after))
                longest = max(np.sum((after - np.roll(after, 1, axis=0)) ** 2, axis=1))
                slim = 0.5 * np.sqrt(b @ b) / longest
                if a @ b < _TURNS * np.sqrt((a @ a) * (b @ b)) or slim < min(_SLIM, _shape(before)):
                    return False
        return True

    def _merge(self, u: int, v: int, place: np.ndarray) -> None:
        """u goes, v is at the new place."""
        for number in self.ring[u] & self.ring[v]:
            for corner in self.corners[number]:
                self.ring[corner].discard(number)
        for number in self.ring[u]:
            self.corners[number] = tuple(v if corner == u else corner for corner in self.corners[number])
            self.ring[v].add(number)
        self.ring[u] = set()
        self.points[v] = place
        self._quadrics[v] += self._quadrics[u]

    def result(self) -> tuple[np.ndarray, np.ndarray]:
        """Vertices and faces of what is left."""
        kept = np.array([bool(ring) for ring in self.ring])
        number = np.cumsum(kept) - 1
        faces = sorted(set().union(*self.ring))
        return self.points[kept], number[np.array([self.corners[face] for face in faces])]


Cost = Callable[
    [Surface, int, int], tuple[float, np.ndarray]
]  # what an edge's collapse costs, and the place it leads to


def by_length(fine: np.ndarray) -> Cost:
    """The shortest edge first, into its middle: leaves even triangles.

    fine: By how much shorter edges shall be at each vertex, shape (V,).
    """

    def cost(surface: Surface, u: int, v: int) -> tuple[float, np.ndarray]:
        a, b = surface.points[u], surface.points[v]
        return float(np.sum((a - b) ** 2)) * max(fine[u], fine[v]) ** 2, 0.5 * (a + b)

    return cost


def by_error(care: np.ndarray) -> Cost:
    """What changes the surface least (Garland and Heckbert 1997), into one of its ends: keeps tips, rims and creases.

    care: How much an error at each vertex counts, shape (V,).
    """

    def cost(surface: Surface, u: int, v: int) -> tuple[float, np.ndarray]:
        ends = surface.points[[u, v]]
        errors = [max(care[u], care[v]) * surface.error(u, v, end) for end in ends]
        return min(errors) + _LENGTH * float(np.sum((ends[0] - ends[1]) ** 2)), ends[int(np.argmin(errors))]

    return cost


def _shape(triangle: np.ndarray) -> float:
    longest = max(np.sum((triangle - np.roll(triangle, 1, axis=0)) ** 2, axis=1))
    return float(0.5 * np.linalg.norm(np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])) / longest)


def _quadrics(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Of each vertex, shape (V, 5, 4): a 4 x 4 quadric of its faces' planes, times their areas; below it the area."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    double = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(double, 1e-30)[:, None]
    plane = np.column_stack([normal, -np.sum(normal * a, axis=1)])
    of_face = np.zeros((len(faces), 5, 4))
    of_face[:, :4] = 0.5 * double[:, None, None] * plane[:, :, None] * plane[:, None, :]
    of_face[:, 4, 0] = 0.5 * double
    of_vertex = np.zeros((len(points), 5, 4))
    for k in range(3):
        np.add.at(of_vertex, faces[:, k], of_face)
    return of_vertex
