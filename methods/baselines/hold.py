"""Hold: the garment keeps the shape that it had on the body when the prediction began."""

from dataclasses import dataclass

import numpy as np

from garmentbench.geometry.blend_skinning import Skin, lift, place
from garmentbench.method import BodyFrame, History, span
from garmentbench.methods.baselines.untrained import Untrained
from garmentbench.sequence import Template


@dataclass(frozen=True)
class State:
    """skin: what carries the garment. canonical: the shape it keeps, in the canonical pose [m], shape (V, 3)."""

    skin: Skin
    canonical: np.ndarray


class Hold(Untrained):
    """The last offset in the body's own frame, carried by skinning."""

    name = "hold"

    def begin(self, template: Template, history: History) -> State:
        """Take the last garment back to the canonical pose."""
        skin = self.skin_of(template)
        last = None if history.bodies is None else history.bodies[-1]
        return State(skin, lift(skin.blend(last), history.garments[-1]))

    def step(self, state: State, body: BodyFrame) -> tuple[np.ndarray, State]:
        """The same shape on the present pose [m], shape (V, 3)."""
        with span("prepare"):
            maps = state.skin.blend(body.vertices)
        return place(maps, state.canonical), state
