"""A picture of a sequence file's first frame, for `check`."""

from pathlib import Path

import numpy as np

from garmentbench import sequence_file
from garmentbench.storage.atomic import written_whole
from garmentbench.viewing.render import CLOTH, RenderMesh, render


def draw_first_frame(path: Path, png: Path) -> None:
    """Draw frame 0 from two sides into a PNG file. Raises `UserError` as `sequence_file.load`."""
    from matplotlib.image import imsave

    sequence = sequence_file.load(path, frames=1)
    template = sequence.template
    meshes = [RenderMesh(sequence.garment[0], template.garment.faces, CLOTH, cloth=True)]
    if sequence.body is not None:
        meshes.append(RenderMesh(sequence.body[0], template.required_body.faces))
    image = np.concatenate([render(meshes, view, size=(450, 600)) for view in ("three-quarter", "back")], axis=1)
    with written_whole(png) as partial:
        imsave(partial, image, format="png")
