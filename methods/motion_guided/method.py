"""The motion-guided model through the contract of `garmentbench.method`."""

import json
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from garmentbench.method import BodyFrame, FitRun, History, span
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.collision import CollisionStage, Residual
from garmentbench.methods.motion_guided.config import VARIANTS, Config, config_for, config_from, for_scene
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.frames import BodyFrames, body_frames
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.runtime import Runtime
from garmentbench.methods.motion_guided.seams import Seams
from garmentbench.methods.motion_guided.stages import train_stages
from garmentbench.methods.novelty import Novelty, Telling
from garmentbench.methods.training import load, save, without_denormals
from garmentbench.sequence import Sequence, Template
from garmentbench.storage.atomic import write_text

__all__ = ["VARIANTS", "Config", "MotionGuided", "config_for"]

_NOVELTY = "novelty.npz"


@dataclass(frozen=True)
class State(Telling):
    """What a roll-out carries from frame to frame.

    Attributes:
        garments: The last three frames' garments, the model's own after the first steps [m], world, shape (3, V, 3).
            Seams as they were decoded, as in the authors' roll-outs; closed in what is given out.
        body: The body at the last frame.
        before_collision: The last garment before its collision stage [m], shape (V, 3); None before the first step and
            where there is no such stage.
        collision: The stage itself; None where the scene or the configuration has none.
        residual: The residual displacement map that it goes on from.
    """

    garments: np.ndarray
    body: BodyFrames
    before_collision: np.ndarray | None
    collision: CollisionStage | None
    residual: Residual | None


class MotionGuided:
    """Zhang, Ceylan, Mitra 2022: a generative space of garments, a dynamic-aware encoder, and a collision stage."""

    name = "motion_guided"
    Config = Config

    def __init__(
        self,
        canonical: Canonical,
        config: Config,
        generative: GenerativeModel,
        dynamics: DynamicEncoder,
        novelty: Novelty | None = None,
    ) -> None:
        """novelty: How far others are from the training frames; None where these are not known."""
        self.canonical, self.config, self.novelty = canonical, config, novelty
        self.generative, self.dynamics = generative, dynamics
        self.device = generative.rest.device
        with torch.no_grad():
            self.runtime = Runtime(generative, dynamics, config.stage2)
        self.seams = Seams(len(canonical.rest), canonical.seams).to(self.device)

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> "MotionGuided":
        """Train on sequences; the canonical pose is that of the first one's body and garment.

        Raises `UserError` where there is no body to be relative to.
        """
        template = train[0].template
        canonical, config = Canonical.of(template, config.model), for_scene(config, template.needs)
        return cls(canonical, config, *train_stages(train, canonical, config, run, _device()))

    def save(self, folder: Path) -> None:
        """Write config.json, canonical.npz, weights.pt, and novelty.npz where the training frames are known."""
        write_text(folder / "config.json", json.dumps(asdict(self.config), indent=1))
        self.canonical.save(folder / "canonical.npz")
        weights = {"generative": self.generative.state_dict(), "dynamics": self.dynamics.state_dict()}
        save(weights, folder / "weights.pt")
        if self.novelty is not None:
            self.novelty.save(folder / _NOVELTY)

    @classmethod
    def load(cls, folder: Path) -> "MotionGuided":
        """Read what `save` wrote, as data only."""
        config = config_from(json.loads((folder / "config.json").read_text()))
        canonical, weights = Canonical.load(folder / "canonical.npz"), load(folder / "weights.pt", _device())
        generative = GenerativeModel(canonical, config.model)
        dynamics = DynamicEncoder(config.model, len(canonical.seeds.rest), config.stage2)
        for module, state in ((generative, weights["generative"]), (dynamics, weights["dynamics"])):
            module.to(_device()).requires_grad_(False).load_state_dict(state)
        known = folder / _NOVELTY
        return cls(canonical, config, generative, dynamics, Novelty.load(known) if known.is_file() else None)

    def begin(self, template: Template, history: History) -> State:
        """From true position, velocity and acceleration (three frames).

        The body may have another shape than in training: the canonical pose stays the training body's, and a seed's
        translation is T_t = b_t - b_0. Raises `UserError` for another garment or another body mesh.
        """
        self.canonical.check_fits(template)
        collision = residual = None
        if template.needs.collision_stage and self.config.collision.enabled:
            collision = CollisionStage(self.canonical, template.required_body, self.config.collision)
            residual = Residual.none(self.config.collision.map_size)
        return State(history.garments, self._body(_there(history.bodies)[-1]), None, collision, residual)

    @torch.no_grad()
    def step(self, state: State, body: BodyFrame) -> tuple[np.ndarray, State]:
        """Garment vertices [m], shape (V, 3), at the frame of `body`. Not finite where the model has blown up."""
        with span("prepare"):
            now = self._body(_there(body.vertices))
        with span("predict"), without_denormals():
            code = self.runtime.code(state.garments, state.body, now)
            posed, rotations = self.runtime.garment(code, now.pose)
            garment, closed = self._world(now, posed)
        before, residual = (None if state.collision is None else closed), state.residual
        if state.collision is not None and residual is not None and np.isfinite(garment).all():
            with span("collide"):
                obstacle = now.local(_there(body.vertices)[None])[0].cpu().numpy()
                decoded = posed.cpu().numpy()
                pushed, residual = state.collision.resolve(
                    decoded, lambda: self.runtime.directions(rotations).cpu().numpy(), obstacle, residual
                )
                if pushed is not decoded:
                    garment, closed = self._world(now, torch.from_numpy(pushed).to(posed))
        garments = np.concatenate([state.garments[1:], garment[None]])
        look = None if self.novelty is None else partial(_look, self.novelty, now.pose.seeds, code)
        return closed, State(garments, now, before, state.collision, residual, look=look)

    def _world(self, now: BodyFrames, posed: Tensor) -> tuple[np.ndarray, np.ndarray]:
        """A garment, shape (V, 3), in the world, as it goes on from and with its seams closed as it is given out."""
        garment, closed = now.world(torch.stack([posed, self.seams(posed)]))
        return garment, closed

    def _body(self, vertices: np.ndarray) -> BodyFrames:
        options, canonical = self.config.model, self.canonical
        turned = (options.seed_rotation, options.axes, self.device, canonical.upright)
        return body_frames(vertices[None], canonical.seeds, *turned)


def _look(novelty: Novelty, seeds: Tensor, code: Tensor) -> float:
    return novelty(seeds[0].flatten().cpu().numpy(), code[0].cpu().numpy())


def _there(body: np.ndarray | None) -> np.ndarray:
    """The body, which the canonical pose has already been checked against."""
    assert body is not None
    return body


def _device() -> torch.device:
    return torch.device("cuda" if torch.cuda.is_available() else "cpu")
