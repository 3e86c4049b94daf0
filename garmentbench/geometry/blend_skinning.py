"""Linear blend skinning of a garment by seed points on the body, with fixed weights.

What the baselines share, and what a learned method can take off the garment before it learns the rest.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentbench.errors import UserError
from garmentbench.geometry.seed_features import root_map, seed_features
from garmentbench.geometry.seeds import SeedPoints, seed_frames, seed_points, select_seeds
from garmentbench.sequence import OBJECT, Template

RADIUS = 0.05  # [m] of the Gaussian kernel, where the paper's learnt radii start


@dataclass(frozen=True)
class Skin:
    """How a garment is carried by a body.

    Attributes:
        seeds: N seed points; None where there is no body, then the garment is carried by nothing (N is 1).
        weights: Blend weights, rows sum to 1, shape (V, N), float32.
        rest: The garment's rest shape [m], shape (V, 3), float32.
        upright: The body is taken for its root alone (`root_map`): all vertices move and turn about the vertical alike.
    """

    seeds: SeedPoints | None
    weights: Float[np.ndarray, "vertices seeds"]
    rest: Float[np.ndarray, "vertices 3"]
    upright: bool = False

    @classmethod
    def of(cls, template: Template, seeds: int | Int[np.ndarray, " seeds"], upright_objects: bool = False) -> "Skin":
        """The skin of a template.

        Args:
            template: Garment and body.
            seeds: The largest number of seed points; or the body vertices to take, shape (N,), as another body of the
                same mesh has them in its `seeds.vertices`.
            upright_objects: A rigid object is taken for its upright root alone.

        Weights are a softmax over the seeds of -d^2 / (2 radius^2), d between rest garment and rest seed (the blend
        weights of section 4.2 of Zhang et al. 2022, fixed and with one radius).
        """
        rest, body = template.garment.rest, template.body
        if body is None:
            return cls(None, np.ones((len(rest), 1), np.float32), rest)
        points = select_seeds(template, seeds) if isinstance(seeds, int) else seed_points(body.rest, body.faces, seeds)
        squared = np.sum((rest[:, None] - points.rest[None]) ** 2, axis=-1)
        kernel = np.exp((squared.min(axis=1, keepdims=True) - squared) / (2 * RADIUS**2))
        upright = upright_objects and body.kind == OBJECT
        return cls(points, (kernel / kernel.sum(axis=1, keepdims=True)).astype(np.float32), rest, upright)

    def blend(self, body: Float[np.ndarray, "body 3"] | None) -> Float[np.ndarray, "vertices 3 4"]:
        """Affine map of each vertex from the canonical pose to that of a body [m], shape (B, 3); shape (V, 3, 4)."""
        if self.seeds is None or body is None:
            assert self.seeds is None, "a garment that hangs from seed points needs the body's vertices"
            maps = np.eye(3, 4, dtype=np.float32)[None]
        elif self.upright:
            return np.broadcast_to(root_map(self.seeds, body).astype(np.float32), (len(self.rest), 3, 4))
        else:
            position, rotation, _ = seed_frames(body, self.seeds)
            offset = position - np.einsum("nab,nb->na", rotation, self.seeds.rest)
            maps = np.concatenate([rotation, offset[..., None]], axis=-1)
        return (self.weights @ maps.reshape(-1, 12).astype(np.float32)).reshape(-1, 3, 4)

    @property
    def vertices(self) -> Int[np.ndarray, " seeds"]:
        """Body vertices of the seeds, shape (N,). Raises `UserError` where there is no body."""
        if self.seeds is None:
            raise UserError("this scene has no body that a garment could be described by; take a scene that has one")
        return self.seeds.vertices

    def displacement(
        self, body: Float[np.ndarray, "*frames body 3"] | None, garment: Float[np.ndarray, "*frames vertices 3"]
    ) -> Float[np.ndarray, "*frames vertices 3"]:
        """How far a garment on a body is from skinning, in the canonical pose [m], shape of `garment`.

        Args:
            body: [m], shape (B, 3), or of T frames (T, B, 3); None where there is none.
            garment: [m], shape (V, 3), or of T frames (T, V, 3).
        """
        if garment.ndim == 3:
            bodies = [None] * len(garment) if body is None else body
            return np.array([self.displacement(b, g) for b, g in zip(bodies, garment, strict=True)])
        return lift(self.blend(body), garment) - self.rest

    def pose(
        self, body: Float[np.ndarray, "body 3"] | None, displacement: Float[np.ndarray, "vertices 3"]
    ) -> Float[np.ndarray, "vertices 3"]:
        """The garment [m], shape (V, 3), that has that `displacement` on that body."""
        return place(self.blend(body), self.rest + displacement)

    def motion(self, bodies: np.ndarray | list[np.ndarray], frames: int = 2) -> Float[np.ndarray, "windows features"]:
        """What `seed_features` says of every run of `frames` bodies, shape (T - frames + 1, frames * 3 N), float32.

        Args:
            bodies: T bodies in a row [m], shape (T, B, 3), or a list of them.
            frames: 1 tells poses, 2 velocities, too.
        """
        bodies = np.asarray(bodies)
        starts = range(len(bodies) - frames + 1)
        return np.array([seed_features(self.seeds, bodies[t : t + frames]) for t in starts], np.float32)


class SkinOf:
    """The skin for a template. It keeps the last one: single steps begin anew at every frame of the same template."""

    def __init__(self, seeds: int | np.ndarray, upright_objects: bool = False) -> None:
        """seeds, upright_objects: as for `Skin.of`."""
        self.arguments = seeds, upright_objects
        self._last: tuple[Template, Skin] | None = None

    def __call__(self, template: Template) -> Skin:
        if self._last is None or self._last[0] is not template:
            self._last = template, Skin.of(template, *self.arguments)
        return self._last[1]


def place(
    maps: Float[np.ndarray, "vertices 3 4"], canonical: Float[np.ndarray, "vertices 3"]
) -> Float[np.ndarray, "vertices 3"]:
    """Canonical positions [m], shape (V, 3), carried by affine maps, shape (V, 3, 4)."""
    return np.einsum("vab,vb->va", maps[..., :3], canonical) + maps[..., 3]


def lift(
    maps: Float[np.ndarray, "vertices 3 4"], positions: Float[np.ndarray, "vertices 3"]
) -> Float[np.ndarray, "vertices 3"]:
    """The canonical positions [m], shape (V, 3), that `place` carries to `positions`."""
    return np.linalg.solve(maps[..., :3], (positions - maps[..., 3])[..., None])[..., 0]
