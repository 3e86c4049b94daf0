"""What we would run, beyond the paper: codes that a recurrent network advances, and cloth put outside of the body.

It keeps of the motion-guided model that a garment is a displacement of the canonical one, carried by the body, and that
what advances it is told how the body moves; and it departs where measurements spoke against it. Codes are principal
components, which take in a garment that was never seen where the paper's encoder takes it for one that was; the network
is trained on free roll-outs, as it is used; and no optimiser runs while it is.

Its settings were chosen on validation scenes alone (armspace-60 and the held part of dance-latin for the pleated skirt,
armspace-60 for the T-shirt, stick-c).
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np

from garmentbench.method import BodyFrame, FitRun, History, span
from garmentbench.methods.baselines import code_dynamics, rollouts
from garmentbench.methods.baselines.pose_gru import PoseGru
from garmentbench.methods.motion_guided.config import Collision
from garmentbench.methods.motion_guided.push_out import PushOut
from garmentbench.sequence import OBJECT, Sequence, Template
from garmentbench.storage.atomic import write_text

__all__ = ["VARIANTS", "Config", "Tuned", "config_for"]

_SETTINGS = "tuned.json"


@dataclass(frozen=True)
class Config(rollouts.Config):
    """Settings beside those of networks in a subspace.

    Attributes:
        object_offset: In place of `offset` where the body is an object [m]. One short recording of it has few motions,
            and its faint accelerations tell them apart too well: with a tenth of a metre the error on stick-c fell
            from 4.5 to 3.4 cm (one seed). It does not make the stick work: on stick-b a linear map is ahead.
        push_out: Cloth is put outside of a body at each frame.
    """

    object_offset: float = 0.1
    push_out: bool = True


@dataclass(frozen=True)
class State(code_dynamics.State):
    """outside: puts the garment outside; None where nothing does. before_collision: the last garment before that [m],
    shape (V, 3); None where there is none."""

    outside: PushOut | None = None
    before_collision: np.ndarray | None = None


class Tuned(PoseGru):
    """A larger recurrent network of the seed points, and its garment put outside of the body."""

    name = "tuned"
    Config = Config
    push_out = True

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> Self:
        """Train on free roll-outs; a training that was interrupted goes on. Raises `UserError` for short sequences."""
        body = train[0].template.body
        if body is not None and body.kind == OBJECT:
            config = replace(config, offset=config.object_offset)
        method = super().fit(train, config, run)
        method.push_out = config.push_out
        return method

    def save(self, folder: Path) -> None:
        """Write the fitted arrays, and whether garments are put outside."""
        super().save(folder)
        write_text(folder / _SETTINGS, json.dumps({"push_out": self.push_out}))

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Read them back."""
        method = super().load(folder)
        method.push_out = json.loads((folder / _SETTINGS).read_text())["push_out"]
        return method

    def begin(self, template: Template, history: History) -> State:
        """Encode the last two garments."""
        g, outside = template.garment, None
        if self.push_out and template.needs.collision_stage:
            outside = PushOut.of(g.rest, g.faces, g.seams, template.required_body, Collision())
        return State(**vars(super().begin(template, history)), outside=outside)

    def step(self, state: State, body: BodyFrame) -> tuple[np.ndarray, State]:
        """The next code, decoded, carried to the present pose and put outside of the body [m], shape (V, 3)."""
        garment, after = super().step(state, body)
        if after.outside is None or body.vertices is None:
            return garment, after
        with span("collide"):
            pushed = after.outside(garment, body.vertices)
        return pushed, replace(after, before_collision=garment)


def config_for(size: str) -> Config:
    """The configuration at a network size: "smoke" trains for seconds.

    More steps brought nothing: 4,000 made 1.27 cm of the skirt's dance-latin-held where 1,200 made 1.28, and half the
    width in half the batch 1.43 (one seed).
    """
    small = rollouts.config_for(size)
    steps, width = (small.training.steps, small.width) if size == "smoke" else (1_200, 256)
    training = replace(small.training, steps=steps, batch=64)
    return Config(**{**vars(small), "width": width, "unroll": 32, "training": training})


VARIANTS: dict[str, Callable[[Config], Config]] = {
    "full": lambda full: full,
    "no_push_out": lambda full: replace(full, push_out=False),
    "no_turns": lambda full: replace(full, turns=False),
    "no_offset": lambda full: replace(full, offset=0.0, object_offset=0.0),
    "no_noise": lambda full: replace(full, noise=0.0),
    "one_step": lambda full: replace(full, unroll=1),
    "narrow": lambda full: replace(full, width=full.width // 4),
    "short": lambda full: replace(full, training=replace(full.training, steps=full.training.steps // 4)),
}
"""What each of its parts is worth: without it, or with less of it."""
