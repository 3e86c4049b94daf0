"""Contact sheets: a clip's poses in one picture."""

from pathlib import Path

import numpy as np

from garmentbench.motion.clip import Clip
from garmentbench.scenes.bodies import BakedBody, pose
from garmentbench.storage.atomic import written_whole

_COLUMNS, _ROWS = 8, 3
_TILE = (200, 290)
_BOX = np.array([[-0.9, -0.9, 0.0], [0.9, 0.9, 2.1]])  # [m] round the body's place


def contact_sheet(clip: Clip, baked: BakedBody, path: Path) -> None:
    """Draw 24 evenly spread frames of a clip into a PNG file, each with the body in the middle. Raises `UserError`."""
    from PIL import Image

    from garmentbench.viewing.render import RenderMesh, render

    clip = clip.from_origin(0)
    chosen = np.linspace(0, len(clip) - 1, _COLUMNS * _ROWS).round().astype(int)
    vertices = pose(baked, clip.rotations[chosen], clip.root[chosen] * [0.0, 0.0, 1.0])
    tiles = [render([RenderMesh(v, baked.body.faces)], size=_TILE, focus=_BOX) for v in vertices]
    rows = [np.concatenate(tiles[i : i + _COLUMNS], axis=1) for i in range(0, len(tiles), _COLUMNS)]
    with written_whole(path) as partial:
        Image.fromarray(np.concatenate(rows)).save(partial, format="PNG")
