"""What a garment touches while it moves: a body, or a body and the garment beneath."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentbench.sequence import OBJECT, Body


@dataclass(frozen=True)
class Obstacle:
    """One moving set of points with a surface or several.

    Attributes:
        surfaces: Triangles of each surface, from the skin outwards, shape (K, 3) each, indices into the points.
        positions: Of the points [m], world axes, shape (T, B, 3), float64; the body's come first.
        skin: How many points are the body's.
        still_air: The air does not move along with the body.
    """

    surfaces: tuple[Int[np.ndarray, "_ 3"], ...]
    positions: Float[np.ndarray, "frames points 3"]
    skin: int
    still_air: bool

    @classmethod
    def of(
        cls,
        body: Body,
        positions: Float[np.ndarray, "frames body_vertices 3"],
        inner: tuple[Body, Float[np.ndarray, "frames inner_vertices 3"]] | None,
    ) -> "Obstacle":
        """A body at its positions [m], shape (T, B, 3), and the garment beneath with its own over the same frames."""
        surfaces = (body.faces,)
        if inner is not None:
            surfaces += (inner[0].faces + len(body.rest),)
            positions = np.concatenate([positions, inner[1]], axis=1)
        return cls(surfaces, positions, len(body.rest), body.kind == OBJECT)

    def between(
        self, t: int, origin: Float[np.ndarray, "3"], fps: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """What leads from frame t to t + 1, cubic Hermite: positions at both, relative to `origin`, and tangents [m a
        frame] from central differences, shape (B, 3) each; the wind [m/s], shape (3,).

        Before the first frame and after the last it moves on as it did.
        """
        here, there = self.positions[t], self.positions[t + 1]
        before = self.positions[t - 1] if t > 0 else 2 * here - there
        after = self.positions[t + 2] if t + 2 < len(self.positions) else 2 * there - here
        wind = np.zeros(3) if self.still_air else fps * (there - here)[: self.skin].mean(axis=0)
        return here - origin, there - origin, (there - before) / 2, (after - here) / 2, wind
