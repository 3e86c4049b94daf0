"""Cusick's drape test (BS 5058, ISO 9073-9): a disc of cloth, 30 cm wide, over a table of 18 cm."""

import math
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw
from scipy.spatial import Delaunay

from garmentbench.evals.validation.strips import FPS, HEIGHT
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment
from garmentbench.simulation.drive import drive

TABLE, DISC = 0.09, 0.15  # radii [m]
PIXEL = 2.5e-4  # [m]
SECONDS = 2.5
SETTLE = 8.0  # [1/s]
PUSH = 2e-3  # [m] so that folds can begin
STILL = 1e-3  # kinetic energy over its largest, below which the cloth has come to rest


@dataclass(frozen=True)
class Drape:
    """How a disc of cloth hangs.

    Attributes:
        coefficient: (A - A_table) / (A_disc - A_table) [%], A the shadow's area.
        vertices: Of the mesh.
        substeps: A frame at 30 frames a second.
        ms_per_frame: [ms], wall time.
        at_rest: It has come to rest.
        positions: At the end [m], shape (V, 3).
        faces: Shape (F, 3).
    """

    coefficient: float
    vertices: int
    substeps: int
    ms_per_frame: float
    at_rest: bool
    positions: np.ndarray
    faces: np.ndarray


def ring(edge: float) -> Garment:
    """The part of the disc that hangs over, triangles of about that edge [m].

    Its two innermost circles are pinned, as far inside and outside of the table's border: a clamp acts half a row
    inside of its last row.
    """
    inner, outer = TABLE - HEIGHT * edge / 2, TABLE + HEIGHT * edge / 2
    circles = [_circle(r, edge, k / 2) for k, r in enumerate((inner, outer, DISC))]
    count = round(2 * DISC / edge) + 2
    i, j = np.meshgrid(np.arange(-count, count + 1), np.arange(-count, count + 1))
    lattice = edge * np.column_stack([(i + 0.5 * (j % 2)).ravel(), (HEIGHT * j).ravel()])
    far = np.linalg.norm(lattice, axis=1)
    room = 0.6 * edge
    points = np.concatenate([*circles, lattice[(far > outer + room) & (far < DISC - room)]])
    faces = Delaunay(points).simplices
    a, b, c = points[faces].transpose(1, 0, 2)
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    faces[turned] = faces[turned][:, ::-1]
    faces = faces[np.linalg.norm((a + b + c) / 3, axis=1) > inner * math.cos(math.pi / len(circles[0]))]
    rest = np.column_stack([points, np.zeros(len(points))]).astype(np.float32)
    pins = np.arange(len(circles[0]) + len(circles[1]), dtype=np.int32)
    return Garment("disc", rest, faces.astype(np.int32), rest[:, :2], np.zeros((0, 2), np.int32), pins)


def _circle(radius: float, edge: float, turned: float) -> np.ndarray:
    count = round(2 * math.pi * radius / edge)
    angle = 2 * math.pi * (np.arange(count) + turned) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def drape(material: Material, edge: float, seed: int = 0) -> Drape:
    """Let a disc of triangles of that edge [m] hang until it rests. The cloth does not touch itself."""
    cloth = ring(edge)
    settings = Settings(queries=1, start_noise=PUSH, noise_seed=seed, self_contact=False, settling=SETTLE)
    out = drive(cloth, cloth.rest.astype(np.float64), None, 1 + round(SECONDS * FPS), FPS, material, settings)
    last = out.positions[-1]
    whole, table = math.pi * DISC**2, math.pi * TABLE**2
    coefficient = 100 * (shadow(last, cloth.faces) - table) / (whole - table)
    rest = bool(out.kinetic[-1] < STILL * out.kinetic.max())
    return Drape(coefficient, len(last), out.substeps, out.ms_per_frame, rest, last, cloth.faces)


def shadow(positions: np.ndarray, faces: np.ndarray) -> float:
    """Area [m^2] of the shadow from above of cloth and table, folds counted once."""
    size = 2 * math.ceil(1.2 * DISC / PIXEL)
    image = Image.new("1", (size, size))
    draw = ImageDraw.Draw(image)
    at = positions[:, :2] / PIXEL + size / 2
    for corners in at[faces]:
        draw.polygon([tuple(p) for p in corners], fill=1)
    radius = TABLE / PIXEL
    draw.ellipse([size / 2 - radius] * 2 + [size / 2 + radius] * 2, fill=1)
    return float(np.asarray(image).sum()) * PIXEL**2
