"""The canonical pose: all that a trained model keeps of the template that it was trained on."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from garmentbench.errors import UserError
from garmentbench.geometry.cloth_rest import rest_lengths
from garmentbench.geometry.mesh import tangent_frames
from garmentbench.geometry.seeds import SeedPoints, select_seeds
from garmentbench.geometry.surface_seeds import SurfaceSeeds
from garmentbench.geometry.uvmap import Chart, bilinear_table, chart
from garmentbench.methods.motion_guided.config import Model
from garmentbench.methods.motion_guided.uv_tables import UVTables, table_matrix
from garmentbench.sequence import OBJECT, Garment, Template
from garmentbench.storage.atomic import written_whole


@dataclass(frozen=True)
class Canonical:
    """Garment and seed points in the canonical pose.

    Attributes:
        rest: g_0 [m], shape (V, 3).
        faces: Garment triangles, shape (F, 3).
        uv: Where each vertex lies in the maps, in [0, 1], shape (V, 2).
        seams: Pairs of vertices that are one point of cloth, shape (S, 2).
        seeds: The seed points. Their labels count only where the scene needs a radius per part, else they are None.
        body_size: Vertices of the body.
        tables: A released model's own; None where they follow from the template.
        cut: The flat pattern [m], shape (V, 2); None where there is none.
        upright: The body is an object that eq. 1 takes for its upright root.
    """

    rest: np.ndarray
    faces: np.ndarray
    uv: np.ndarray
    seams: np.ndarray
    seeds: SeedPoints | SurfaceSeeds
    body_size: int
    tables: UVTables | None = None
    cut: np.ndarray | None = None
    upright: bool = False

    @classmethod
    def of(cls, template: Template, options: Model) -> "Canonical":
        """From a training template. Raises `UserError` where there is no body to be relative to."""
        if template.body is None:
            raise UserError(
                "motion_guided describes a garment relative to a body, and this scene has none; "
                "train it on a scene with a body or an object"
            )
        g, seeds = template.garment, select_seeds(template, options.seeds)
        if not template.needs.part_radii:
            seeds = SeedPoints(**{**vars(seeds), "labels": None})
        uv, upright = bordered(g.uv, options.map_border / options.map_size), options.upright_objects
        upright = upright and template.body.kind == OBJECT
        return cls(g.rest, g.faces, uv, g.seams, seeds, len(template.body.rest), cut=g.cut, upright=upright)

    @property
    def edges(self) -> tuple[np.ndarray, np.ndarray]:
        """Mesh edges and seam pairs, shape (E + S, 2), and lengths without load [m], 0 at a seam, shape (E + S,)."""
        edges, lengths = rest_lengths(Garment("", self.rest, self.faces, self.uv, self.seams, cut=self.cut))
        return np.concatenate([edges, self.seams]), np.concatenate([lengths, np.zeros(len(self.seams))])

    @property
    def frames(self) -> np.ndarray:
        """H_0, columns tangent, bitangent and normal, shape (V, 3, 3)."""
        return tangent_frames(self.rest, self.faces, self.uv) if self.tables is None else self.tables.frames

    def chart(self, size: int) -> Chart:
        """From vertices to a map of `size` pixels a side."""
        return chart(self.uv, self.faces, size) if self.tables is None else self.tables.chart

    def sampling(self, size: int) -> sp.csr_matrix:
        """From a map of `size` pixels a side to vertices, shape (V, size^2), bilinearly."""
        if self.tables is None:
            return table_matrix(*bilinear_table(self.uv, size), size)
        return self.tables.sampling(size)

    def check_fits(self, template: Template) -> None:
        """Raise `UserError` unless the template has the same garment and a body of the same mesh."""
        bodies = 0 if template.body is None else len(template.body.rest)
        if len(template.garment.rest) != len(self.rest) or bodies != self.body_size:
            raise UserError(
                f"this model was trained on a garment of {len(self.rest)} vertices and a body of {self.body_size}; "
                f"the scene has {len(template.garment.rest)} and {bodies}; "
                "use a scene of the same garment, preset and body mesh"
            )

    def save(self, path: Path) -> None:
        """Write to an npz file, whole."""
        arrays = {f"seed_{k}": v for k, v in asdict(self.seeds).items() if v is not None}
        arrays |= {k: v for k, v in vars(self).items() if k not in ("seeds", "tables") and v is not None}
        arrays |= {} if self.tables is None else self.tables.arrays()
        with written_whole(path) as partial, partial.open("wb") as file:
            np.savez(file, **arrays)

    @classmethod
    def load(cls, path: Path) -> "Canonical":
        """Read what `save` wrote."""
        with np.load(path, allow_pickle=False) as z:
            seeds: dict[str, Any] = {"labels": None} | {
                k.removeprefix("seed_"): z[k] for k in z.files if k.startswith("seed_")
            }
            return cls(
                *(z[k] for k in ("rest", "faces", "uv", "seams")),
                seeds=SurfaceSeeds(**seeds) if "corners" in seeds else SeedPoints(**seeds),
                body_size=int(z["body_size"]),
                tables=UVTables.from_arrays(dict(z)),
                cut=z.get("cut"),
                upright=bool(z["upright"]),
            )


def bordered(uv: np.ndarray, border: float) -> np.ndarray:
    """UV coordinates, shape (V, 2), drawn in towards the middle where they come nearer to the edge than `border`."""
    reach = np.abs(uv - 0.5).max()
    return (0.5 + min(1.0, (0.5 - border) / reach) * (uv - 0.5)).astype(np.float32)
