"""Skinning: the rest garment, carried by the body. It knows nothing of cloth, and sets the scale for `skill`."""

import numpy as np

from garmentbench.geometry.blend_skinning import Skin, place
from garmentbench.method import BodyFrame, History, span
from garmentbench.methods.baselines.untrained import Untrained
from garmentbench.sequence import Template


class Skinning(Untrained):
    """Linear skinning of the rest garment by fixed weights."""

    name = "skinning"

    def begin(self, template: Template, history: History) -> Skin:
        """Find out what carries the garment."""
        return self.skin_of(template)

    def step(self, state: Skin, body: BodyFrame) -> tuple[np.ndarray, Skin]:
        """The rest garment on the present pose [m], shape (V, 3)."""
        with span("prepare"):
            maps = state.blend(body.vertices)
        return place(maps, state.rest), state
