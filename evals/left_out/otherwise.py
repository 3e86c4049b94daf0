"""The motion-guided model with one part otherwise than a scene needs it: left out where it is needed, or built where it
is not. It runs the method's own code, on a template that says something else."""

import json
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Self

import numpy as np
import torch

from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.geometry.seeds import REACH, SeedPoints, farthest_points, seed_points
from garmentbench.method import FitRun, History
from garmentbench.methods.motion_guided import config as motion_guided
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.config import Config
from garmentbench.methods.motion_guided.method import MotionGuided, State
from garmentbench.methods.motion_guided.stages import train_stages
from garmentbench.sequence import OBJECT, Body, Needs, Sequence, Template
from garmentbench.storage.atomic import write_text

BANDS = 5  # parts of a body that has none
PARTS = ("interaction_force", "velocity", "collision_stage", "sdf", "part_radii", "far_seeds", "heading_axes")
_FLAGS = {
    "interaction_force": "interaction_force",
    "collision_stage": "collision_stage",
    "sdf": "body",
    "part_radii": "part_radii",
    "interpenetration": "interpenetration",
}
_UNTOLD = ("sdf", "part_radii", "far_seeds")  # they change a training, and its configuration does not say so
_KEPT = "otherwise.json"


@dataclass(frozen=True)
class Otherwise(Config):
    """The method's configuration, and the part that is otherwise, `built` or not. It has no part as the full model."""

    part: str = ""
    built: bool = False


@dataclass(frozen=True)
class MarkedBody(Body):
    """A body of which something else is said; `said` tells its trainings from others', which share their stages."""

    said: str = ""


@dataclass(frozen=True)
class Said(Template):
    """A template that states its needs."""

    stated: Needs | None = None

    @cached_property
    def needs(self) -> Needs:
        """As stated."""
        assert self.stated is not None
        return self.stated


def said(template: Template, part: str, built: bool) -> Template:
    """A template that needs a part, or does not need it, and for the rest what it needed before."""
    body = template.required_body
    needs = template.needs
    if part in _FLAGS:
        needs = replace(needs, **{_FLAGS[part]: built})
    labels, names = body.labels, body.part_names
    if part == "part_radii" and built and labels is None:
        labels = (np.arange(len(body.rest)) * BANDS // len(body.rest)).astype(np.int8)
        names = tuple(f"part_{k}" for k in range(BANDS))
    # A rigid object is one point to eq. 1, whatever else is built for it: its kind stays.
    about = (body.name, body.rest, body.faces, labels, names, body.kind)
    seen = MarkedBody(*about, f"{part}={built}") if part in _UNTOLD else Body(*about)
    return Said(template.garment, seen, template.fps, needs)


def configured(config: Config, part: str, built: bool) -> Config:
    """The full configuration with a part built or left out, where the configuration has that to say."""
    if part in ("interaction_force", "velocity"):
        name = "force" if part == "interaction_force" else part
        return replace(config, stage2=replace(config.stage2, **{name: built}))
    if part == "collision_stage":
        return replace(config, collision=replace(config.collision, enabled=built))
    if part == "heading_axes":
        return replace(config, model=replace(config.model, axes="heading" if built else "world"))
    return config


def seeds_everywhere(template: Template, near: int) -> SeedPoints:
    """Seed points on the whole body, as dense as `near` of them are where the garment is within reach."""
    body = template.required_body
    distance, _ = nearest_vertices(body.rest, template.garment.rest)
    a, b, c = body.rest[body.faces].transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    within = areas[(distance[body.faces] < REACH).any(axis=1)].sum()
    everything = np.arange(len(body.rest))
    count = min(round(near * float(areas.sum() / within)), len(everything))
    vertices = farthest_points(body.rest, body.faces, everything, count)
    labels = None if body.labels is None else body.labels[vertices].astype(np.int64)
    return seed_points(body.rest, body.faces, vertices, labels)


class OtherwiseMotionGuided(MotionGuided):
    """The motion-guided model with one part otherwise."""

    name = "motion_guided_otherwise"
    Config = Otherwise
    otherwise: tuple[str, bool] = ("", False)

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> Self:
        """Train as the method does, on what is said of the sequences."""
        assert isinstance(config, Otherwise)
        part, built = config.part, config.built
        full = configured(Config(**{f.name: getattr(config, f.name) for f in fields(Config)}), part, built)
        if part:
            train = tuple(replace(s, template=said(s.template, part, built)) for s in train)
        template = train[0].template
        canonical = Canonical.of(template, full.model)
        if part == "far_seeds" and built and template.required_body.kind != OBJECT:
            seeds = seeds_everywhere(template, len(canonical.seeds.rest))
            labels = seeds.labels if template.needs.part_radii else None
            canonical = replace(canonical, seeds=replace(seeds, labels=labels))
        full = motion_guided.for_scene(full, template.needs)
        method = cls(canonical, full, *train_stages(train, canonical, full, run, _device()))
        method.otherwise = part, built
        return method

    def begin(self, template: Template, history: History) -> State:
        """As the method does, on what is said of the template."""
        part, built = self.otherwise
        return super().begin(said(template, part, built) if part else template, history)

    def save(self, folder: Path) -> None:
        """What the method keeps, and what is otherwise."""
        super().save(folder)
        write_text(folder / _KEPT, json.dumps(self.otherwise))

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Read it back."""
        method = super().load(folder)
        assert isinstance(method, cls)
        part, built = json.loads((folder / _KEPT).read_text())
        method.otherwise = part, built
        return method


def config_for(size: str) -> Otherwise:
    """The full model's configuration at a network size."""
    return Otherwise(**vars(motion_guided.config_for(size)))


def _set(full: Otherwise, part: str, built: bool) -> Otherwise:
    return replace(full, part=part, built=built)


def _device() -> torch.device:
    return torch.device("cuda" if torch.cuda.is_available() else "cpu")


VARIANTS = {"full": lambda full: full} | {
    f"{word}_{part}": partial(_set, part=part, built=built)
    for part in PARTS
    for word, built in (("no", False), ("with", True))
}
