"""What methods have in common that step from a garment's last two codes, and the body's, to its next code."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from garmentbench.geometry.blend_skinning import Skin, SkinOf, place
from garmentbench.method import HISTORY, BodyFrame, History, span
from garmentbench.methods.baselines.subspace import Subspace, features
from garmentbench.sequence import Template

AGO = tuple(range(HISTORY, -1, -1))  # frames before the present one, in which the body is looked at


@dataclass(frozen=True)
class State:
    """skin: carries the garment. bodies: the last three [m], (3, B, 3), or None. last, before: the last two codes."""

    skin: Skin
    bodies: np.ndarray | None
    last: np.ndarray
    before: np.ndarray


class CodeDynamics(ABC):
    """Codes that are advanced frame by frame, to be given `following`."""

    def __init__(self, seeds: np.ndarray, garment: Subspace, body: Subspace) -> None:
        """seeds: body vertices, shape (N,)."""
        self.seeds, self.garment, self.body = seeds, garment, body
        self.skin_of = SkinOf(seeds, upright_objects=True)

    @abstractmethod
    def following(self, last: np.ndarray, before: np.ndarray, seen: np.ndarray) -> np.ndarray:
        """The next code, shape (K,), from the last one, the one before it, and the body's, shape (Q,)."""

    def begin(self, template: Template, history: History) -> State:
        """Encode the last two garments."""
        skin = self.skin_of(template)
        shapes = skin.displacement(history.bodies, history.garments).reshape(HISTORY, -1)
        _, before, last = self.garment.encode(shapes)
        return State(skin, history.bodies, last, before)

    def step(self, state: State, body: BodyFrame) -> tuple[np.ndarray, State]:
        """The next code, decoded and carried to the present pose [m], shape (V, 3)."""
        with span("prepare"):
            maps = state.skin.blend(body.vertices)
            bodies = None
            if state.bodies is not None and body.vertices is not None:
                bodies = np.concatenate([state.bodies, body.vertices[None]])
            seen = self.body.encode(features(state.skin, bodies, AGO))
        code = self.following(state.last, state.before, seen)
        garment = place(maps, state.skin.rest + self.garment.decode(code).reshape(-1, 3)).astype(np.float32)
        return garment, replace(state, bodies=None if bodies is None else bodies[1:], last=code, before=state.last)
