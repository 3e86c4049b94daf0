"""Constant velocity: every vertex goes on moving as it did in the body's own frame.

Right for one step, and bound to drift away in a roll-out.
"""

from dataclasses import dataclass, replace

import numpy as np

from garmentbench.geometry.blend_skinning import Skin, lift, place
from garmentbench.method import BodyFrame, History, span
from garmentbench.methods.baselines.untrained import Untrained
from garmentbench.sequence import Template


@dataclass(frozen=True)
class State:
    """The last shape and its change over a frame, in the canonical pose.

    skin: what carries the garment. canonical: [m], shape (V, 3). velocity: [m a frame], shape (V, 3).
    """

    skin: Skin
    canonical: np.ndarray
    velocity: np.ndarray


class ConstantVelocity(Untrained):
    """The last displacement in the body's own frame, continued."""

    name = "constant_velocity"

    def begin(self, template: Template, history: History) -> State:
        """Take the last two garments back to the canonical pose."""
        skin = self.skin_of(template)
        bodies = (None, None) if history.bodies is None else history.bodies[-2:]
        before, last = (lift(skin.blend(b), g) for b, g in zip(bodies, history.garments[-2:], strict=True))
        return State(skin, last, last - before)

    def step(self, state: State, body: BodyFrame) -> tuple[np.ndarray, State]:
        """One displacement further, on the present pose [m], shape (V, 3)."""
        with span("prepare"):
            maps = state.skin.blend(body.vertices)
        canonical = state.canonical + state.velocity
        return place(maps, canonical), replace(state, canonical=canonical)
