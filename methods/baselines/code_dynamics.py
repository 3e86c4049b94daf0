"""What methods have in common that advance a garment's code frame by frame, beside the body's."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from garmentbench.geometry.blend_skinning import Skin, SkinOf, place
from garmentbench.method import HISTORY, BodyFrame, History, span
from garmentbench.methods.baselines.subspace import Subspace, features
from garmentbench.methods.novelty import Novelty, Telling
from garmentbench.sequence import Template

AGO = tuple(range(HISTORY, -1, -1))  # frames before the present one, in which the body is looked at


@dataclass(frozen=True)
class State(Telling):
    """skin: carries the garment. bodies: the last three [m], (3, B, 3), or None. memory: the method's, as after
    `CodeDynamics.start`."""

    skin: Skin
    bodies: np.ndarray | None
    memory: Any


AnyState = TypeVar("AnyState", bound=State)


class CodeDynamics(ABC):
    """Codes that are advanced frame by frame, to be given `following`. What is remembered between frames is the last
    two codes, unless `start` says otherwise."""

    def __init__(
        self, seeds: np.ndarray, garment: Subspace, body: Subspace, novelty: Novelty, turns: bool = False
    ) -> None:
        """seeds: body vertices, shape (N,). turns: see `subspace.Sizes`."""
        self.seeds, self.garment, self.body, self.novelty, self.turns = seeds, garment, body, novelty, turns
        self.skin_of = SkinOf(seeds, upright_objects=True)

    def start(self, last: np.ndarray, before: np.ndarray, seen: np.ndarray) -> Any:
        """What is remembered before the first step: of the last code and the one before it, shape (K,), and of the
        body's, shape (Q,), at the last one."""
        return last, before

    @abstractmethod
    def following(self, memory: Any, seen: np.ndarray) -> tuple[np.ndarray, Any]:
        """The next code, shape (K,), and what is remembered then, from the body's code, shape (Q,)."""

    def begin(self, template: Template, history: History) -> State:
        """Encode the last two garments."""
        skin = self.skin_of(template)
        shapes = skin.displacement(history.bodies, history.garments).reshape(HISTORY, -1)
        _, before, last = self.garment.encode(shapes)
        return State(skin, history.bodies, self.start(last, before, self._seen(skin, history.bodies)))

    def step(self, state: AnyState, body: BodyFrame) -> tuple[np.ndarray, AnyState]:
        """The next code, decoded and carried to the present pose [m], shape (V, 3)."""
        with span("prepare"):
            maps = state.skin.blend(body.vertices)
            bodies = None
            if state.bodies is not None and body.vertices is not None:
                bodies = np.concatenate([state.bodies, body.vertices[None]])
            seen = self._seen(state.skin, bodies)
        code, memory = self.following(state.memory, seen)
        garment = place(maps, state.skin.rest + self.garment.decode(code).reshape(-1, 3)).astype(np.float32)
        look = partial(self.novelty, seen, code)
        return garment, replace(state, bodies=None if bodies is None else bodies[1:], memory=memory, look=look)

    def _seen(self, skin: Skin, bodies: np.ndarray | None) -> np.ndarray:
        """The body's code in the last of some frames, shape (Q,)."""
        return self.body.encode(features(skin, bodies, AGO, self.turns))
