"""A sequence in four pictures: its garment from four sides, in the frame in which it moves most."""

import numpy as np
from jaxtyping import Float, UInt8

from garmentbench.geometry.crossing import crossing_faces
from garmentbench.geometry.signed_distance import signed_distances, signed_distances_between
from garmentbench.metrics.faces_inside import THROUGH
from garmentbench.sequence import HUMAN, Sequence
from garmentbench.viewing.render import CLOTH, RenderMesh, bounds, render

SIDES = ("front", "side", "back", "other side")
SIZE = (360, 460)  # of one picture [pixels]
AROUND = 0.05  # what is seen around the garment [m]
SKIN, BENEATH = (0.87, 0.66, 0.53), (0.85, 0.75, 0.45)  # nothing like the cloth, so that a hole shows


def lively_frame(garment: Float[np.ndarray, "frames vertices 3"]) -> int:
    """The frame in which a garment moves most against its own middle: where a fault shows, if there is one.

    garment: [m]; frames that are not finite, and those beside them, are left out.
    """
    if len(garment) < 3:
        return 0
    moved = garment[2:].astype(np.float64) - garment[:-2]
    energy = np.square(moved - moved.mean(axis=1, keepdims=True)).sum(axis=2).mean(axis=1)
    whole = np.isfinite(energy) & np.isfinite(garment[1:-1]).all(axis=(1, 2))
    return 1 + int(np.argmax(np.where(whole, energy, -1.0)))


def four_sides(sequence: Sequence, frame: int) -> UInt8[np.ndarray, "height width 3"]:
    """A frame's garment and what it is on, from four sides, side by side."""
    template, garment = sequence.template, sequence.garment[frame]
    meshes = [RenderMesh(garment, template.garment.faces, CLOTH, cloth=True)]
    if sequence.body is not None:
        body = template.required_body
        skin = body.kind == HUMAN
        meshes.append(RenderMesh(sequence.body[frame], body.faces, SKIN if skin else BENEATH, cloth=not skin))
    focus = bounds(garment, margin=AROUND)
    return np.concatenate([render(meshes, side, SIZE, focus) for side in SIDES], axis=1)


def faults(sequence: Sequence, frame: int) -> dict[str, float]:
    """How many faults the metrics find in one frame: faces of the garment through others, and, where there is an
    inside, middles of edges and faces with what is beneath more than 0.5 mm through."""
    template, garment = sequence.template, sequence.garment[frame, None]
    cloth = template.garment
    found = {"crossing_faces": float(crossing_faces(garment, cloth.faces, cloth.seams).sum())}
    if template.needs.interpenetration and sequence.body is not None:
        body, faces = sequence.body[frame, None], template.required_body.faces
        distances = signed_distances(garment, body, faces)
        between = signed_distances_between(garment, cloth.faces, distances, body, faces)
        found["skin_through"] = float((between < -THROUGH).sum())
    return found
