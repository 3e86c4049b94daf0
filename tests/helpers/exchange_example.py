"""A garment on a standing body as other programs would write it, and shorthands for the tests of import and export."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.mesh import vertex_normals
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.meshes.exporting import meshes_of
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.motion.gait import GAITS
from garmentbench.motion.walk import walk
from garmentbench.scenes.bodies import load_body, pose
from garmentbench.scenes.garments import load_garment
from garmentbench.sequence import Sequence

SEQUENCE = tiny_sequence(6, fps=25.0)
MESHES = meshes_of(SEQUENCE)
TO_Y_UP_CM = np.array([[100, 0, 0], [0, 0, 100], [0, -100, 0]], np.float32)  # x' = M x


def as_film(mesh: MeshSequence) -> MeshSequence:
    """The same mesh as Maya would write it: centimetres, y up."""
    turned = {"frames": mesh.frames @ TO_Y_UP_CM.T, "rest": mesh.still @ TO_Y_UP_CM.T, "unit": None, "up": None}
    return MeshSequence(**vars(mesh) | turned)


def typed(capsys, *arguments: object) -> tuple[int, str, list[str]]:
    """Exit code, output and lines of complaint of a command."""
    code = main([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return code, out, [line for line in err.splitlines() if "Warp" not in line]


def imported(path: Path) -> Sequence:
    return sequence_file.load(path)


def positions_agree(found: Sequence, wanted: Sequence, within: float) -> bool:
    """Do garment and body lie where they should [m], with the same faces and seams?"""
    a, b = found.template, wanted.template
    pairs = [
        (found.garment, wanted.garment),
        (found.body, wanted.body),
        (a.garment.rest, b.garment.rest),
        (a.body.rest, b.body.rest),
    ]
    same = [(a.garment.faces, b.garment.faces), (a.body.faces, b.body.faces), (a.garment.seams, b.garment.seams)]
    return all(np.abs(x - y).max() <= within for x, y in pairs) and all(np.array_equal(x, y) for x, y in same)


def beside(mesh: MeshSequence, shift: float) -> MeshSequence:
    """Moved along x."""
    return replace(mesh, frames=mesh.frames + np.float32([shift, 0, 0]), rest=mesh.still + np.float32([shift, 0, 0]))


def dancer(frames: int = 16) -> tuple[MeshSequence, MeshSequence]:
    """A bodysuit that keeps to a body which steps aside, in a pose that is no mirror image of itself."""
    baked, suit = load_body("base", "small"), load_garment("bodysuit", "smoke")
    steps = walk(baked, GAITS["armspace-75"], 2 + np.arange(frames) / 12, np.ones(frames))
    root = steps.root + np.arange(frames)[:, None] * [0.08, 0.0, 0.0]
    skin = pose(baked, steps.rotations, root).astype(np.float32)
    distance, nearest = nearest_vertices(suit.rest, baked.body.rest)
    normals = np.stack([vertex_normals(x.astype(np.float64), baked.body.faces)[nearest] for x in skin])
    cloth = (skin[:, nearest] + 1.5 * np.maximum(distance, 0.012)[:, None] * normals).astype(np.float32)
    says = {"fps": 25.0, "unit": 1.0, "up": "z"}
    return (MeshSequence("suit", cloth, suit.faces, suit.uv[suit.faces], **says),
            MeshSequence("body", skin, baked.body.faces, **says))  # fmt: skip
