"""Linear blend skinning of a garment by seed points on the body, with fixed weights: what the baselines share."""

from dataclasses import dataclass

import numpy as np

from garmentbench.geometry.seed_features import root_map
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
    weights: np.ndarray
    rest: np.ndarray
    upright: bool = False

    @classmethod
    def of(
        cls, template: Template, count: int, vertices: np.ndarray | None = None, upright_objects: bool = False
    ) -> "Skin":
        """A skin of at most `count` seed points, or of given body `vertices`, shape (N,).

        With `upright_objects`, a rigid object is taken for its upright root alone.

        Weights are a softmax over the seeds of -d^2 / (2 radius^2), d between rest garment and rest seed (the blend
        weights of section 4.2 of Zhang et al. 2022, fixed and with one radius).
        """
        rest, body = template.garment.rest, template.body
        if body is None:
            return cls(None, np.ones((len(rest), 1), np.float32), rest)
        seeds = select_seeds(template, count) if vertices is None else seed_points(body.rest, body.faces, vertices)
        squared = np.sum((rest[:, None] - seeds.rest[None]) ** 2, axis=-1)
        kernel = np.exp((squared.min(axis=1, keepdims=True) - squared) / (2 * RADIUS**2))
        upright = upright_objects and body.kind == OBJECT
        return cls(seeds, (kernel / kernel.sum(axis=1, keepdims=True)).astype(np.float32), rest, upright)

    def blend(self, body: np.ndarray | None) -> np.ndarray:
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


class SkinOf:
    """The skin for a template. It keeps the last one: single steps begin anew at every frame of the same template."""

    def __init__(self, count: int, vertices: np.ndarray | None = None, upright_objects: bool = False) -> None:
        """count, vertices, upright_objects: as for `Skin.of`."""
        self.arguments = count, vertices, upright_objects
        self._last: tuple[Template, Skin] | None = None

    def __call__(self, template: Template) -> Skin:
        if self._last is None or self._last[0] is not template:
            self._last = template, Skin.of(template, *self.arguments)
        return self._last[1]


def place(maps: np.ndarray, canonical: np.ndarray) -> np.ndarray:
    """Canonical positions [m], shape (V, 3), carried by affine maps, shape (V, 3, 4)."""
    return np.einsum("vab,vb->va", maps[..., :3], canonical) + maps[..., 3]


def lift(maps: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """The canonical positions [m], shape (V, 3), that `place` carries to `positions`."""
    return np.linalg.solve(maps[..., :3], (positions - maps[..., 3])[..., None])[..., 0]
