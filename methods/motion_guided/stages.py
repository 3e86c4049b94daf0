"""Training in stages, each a run of its own that all variants share which do not differ in what decides it."""

import hashlib
from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

import torch

from garmentbench.geometry.seeds import SeedPoints
from garmentbench.method import FitRun
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.config import Config
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.limbs import Limbs, find_limbs
from garmentbench.methods.motion_guided.samples import encode_all
from garmentbench.methods.motion_guided.sdf import SignedDistance, fit_sdf
from garmentbench.methods.motion_guided.stage1 import TrainingFrames, fit_stage1, training_frames
from garmentbench.methods.motion_guided.stage2 import fit_stage2
from garmentbench.methods.novelty import Novelty
from garmentbench.methods.training import WEIGHTS, load
from garmentbench.sequence import Sequence, Template
from garmentbench.storage.fingerprint import fingerprint


def train_stages(
    train: tuple[Sequence, ...], canonical: Canonical, config: Config, run: FitRun, device: torch.device
) -> tuple[GenerativeModel, DynamicEncoder, Novelty]:
    """SDF_0 (where there is a human body), stage 1 and stage 2, and what they were trained on; finished stages are read
    back."""
    template = train[0].template
    identity = {"seed": run.seed, "device": device.type, "template": _digest(_template_arrays(template))}
    sdf = _sdf(template, config, run, device, identity) if template.needs.body else None
    identity |= {
        "frames": _digest(array for s in train for array in (*_template_arrays(s.template), s.garment, s.body))
    }
    frames = training_frames(train, canonical, config.model, device)
    assert isinstance(canonical.seeds, SeedPoints), "seeds inside triangles are only read, never trained"
    limbs = find_limbs(template.required_body, canonical.seeds)
    generative = _stage1(frames, canonical, limbs, sdf, config, run, identity)
    return generative, _stage2(frames, generative, limbs, config, run, identity), novelty(generative, frames)


def novelty(model: GenerativeModel, frames: TrainingFrames) -> Novelty:
    """How far others are from the training frames: by the seeds in the frame's coordinates and the code."""
    seeds, codes = frames.body.pose.seeds, encode_all(model, frames)
    return Novelty.of(seeds.flatten(1).cpu().numpy(), codes.cpu().numpy(), list(frames.lengths))


def _sdf(template: Template, config: Config, run: FitRun, device: torch.device, identity: dict) -> SignedDistance:
    about = {**identity, "sdf": asdict(config.sdf), "code": fingerprint("garmentbench.methods.motion_guided.sdf")}
    stage = run.stage("sdf", about)
    if not stage.finished:
        fit_sdf(template, config.sdf, stage, device)
        stage.finish()
    network = SignedDistance(config.sdf).to(device)
    network.load_state_dict(load(stage.folder / WEIGHTS, device))
    return network.requires_grad_(False)


def _stage1(
    frames: TrainingFrames,
    canonical: Canonical,
    limbs: Limbs,
    sdf: SignedDistance | None,
    config: Config,
    run: FitRun,
    identity: dict,
) -> GenerativeModel:
    code = fingerprint("garmentbench.methods.motion_guided.stage1")
    options = {part: asdict(getattr(config, part)) for part in ("model", "sdf", "stage1")}
    stage = run.stage("stage1", {**identity, **options, "code": code})
    if not stage.finished:
        fit_stage1(frames, canonical, limbs, sdf, config.model, config.stage1, stage)
        stage.finish()
    model = GenerativeModel(canonical, config.model).to(frames.garments.device)
    model.load_state_dict(load(stage.folder / WEIGHTS, frames.garments.device))
    return model.requires_grad_(False)


def _stage2(
    frames: TrainingFrames,
    generative: GenerativeModel,
    limbs: Limbs,
    config: Config,
    run: FitRun,
    identity: dict,
) -> DynamicEncoder:
    code = fingerprint("garmentbench.methods.motion_guided.stage2")
    options = {part: asdict(getattr(config, part)) for part in ("model", "sdf", "stage1", "stage2")}
    stage = run.stage("stage2", {**identity, **options, "code": code})
    if not stage.finished:
        fit_stage2(generative, frames, limbs, config.model, config.stage2, stage)
        stage.finish()
    dynamics = DynamicEncoder(config.model, len(generative.canonical_seeds), config.stage2)
    dynamics.to(frames.garments.device).load_state_dict(load(stage.folder / WEIGHTS, frames.garments.device))
    return dynamics.requires_grad_(False)


def _template_arrays(template: Template) -> list[Any]:
    return [*vars(template.garment).values(), *vars(template.body).values()]


def _digest(arrays: Iterable[Any]) -> str:
    """Hash of arrays and names."""
    digest = hashlib.blake2b(digest_size=8)
    for array in arrays:
        digest.update(array.tobytes() if hasattr(array, "tobytes") else repr(array).encode())
    return digest.hexdigest()
