"""Draw the garments' cards: datasets/garments/cards/{name}.png, each worn by the base body at rest, and its UV charts.

Needed only after a garment was baked anew: `python datasets/bake/draw_cards.py`.
"""

import numpy as np
from matplotlib.image import imsave

from garmentbench.motion.stick import stick
from garmentbench.paths import GARMENTS
from garmentbench.scenes.bodies import load_body
from garmentbench.scenes.garments import load_garment
from garmentbench.viewing.render import CLOTH, RenderMesh, bounds, render

SIZE = (260, 400)  # [pixels] of each of the three pictures
INNER = (0.87, 0.75, 0.42)  # colour of what is worn beneath
BENEATH = {"over_skirt": "dress"}
STICKS = ("sheet", "laid_sheet")


def card(name: str) -> np.ndarray:
    """Front, back and charts beside each other, uint8, shape (height, width, 3)."""
    garment = load_garment(name, "laptop")
    body = stick() if name in STICKS else load_body("base", "full").body
    meshes = [RenderMesh(garment.rest, garment.faces, CLOTH, cloth=True), RenderMesh(body.rest, body.faces)]
    if name in BENEATH:
        inner = load_garment(BENEATH[name], "laptop")
        meshes.append(RenderMesh(inner.rest, inner.faces, INNER, cloth=True))
    focus = bounds(*(mesh.vertices for mesh in meshes))
    worn = [render(meshes, view, SIZE, focus) for view in ("front", "back")]
    flat = np.stack([garment.uv[:, 0], np.zeros(len(garment.uv)), garment.uv[:, 1]], axis=1)
    square = np.array([[0, 0, 0], [1, 0, 1]], np.float32)
    return np.concatenate(
        [*worn, render([RenderMesh(flat, garment.faces, CLOTH)], "front", (400, 400), square)], axis=1
    )


def main() -> None:
    (GARMENTS / "cards").mkdir(exist_ok=True)
    for name in ("bodysuit", "dress", "laid_sheet", "over_skirt", "pleated_skirt", "sheet", "tshirt"):
        imsave(GARMENTS / "cards" / f"{name}.png", card(name))


if __name__ == "__main__":
    main()
