"""Stage 1: training of the generative model (section 4.2)."""

from dataclasses import dataclass

import torch
from torch import Tensor

from garmentbench.method import FitRun
from garmentbench.sequence import Sequence
from methods.motion_guided.canonical import Canonical
from methods.motion_guided.config import Model, Stage1
from methods.motion_guided.frames import BodyFrames, body_frames
from methods.motion_guided.generative import GenerativeModel
from methods.motion_guided.losses import edge_deviation, latent_regulariser, reconstruction, sdf_violation
from methods.motion_guided.pose_noise import PoseNoise
from methods.motion_guided.sdf import SignedDistance
from methods.motion_guided.training import batch_at, generator, train


@dataclass(frozen=True)
class TrainingFrames:
    """The training sequence as tensors. `garments`: in the coordinates of `body` [m], shape (T, V, 3)."""

    garments: Tensor
    body: BodyFrames

    def __len__(self) -> int:
        return len(self.garments)


def training_frames(
    sequence: Sequence, canonical: Canonical, options: Model, device: torch.device
) -> TrainingFrames:
    """Garment and seeds of every frame of a sequence."""
    body = body_frames(sequence.body, canonical.seeds, options.seed_rotation, options.axes, device)
    return TrainingFrames(body.local(sequence.garment), body)


def fit_stage1(
    frames: TrainingFrames,
    canonical: Canonical,
    sdf: SignedDistance | None,
    sizes: Model,
    options: Stage1,
    run: FitRun,
) -> None:
    """Train S, E^Sta, D, R and the kernel radii; their weights go into the run's folder.

    Args:
        frames: Training frames.
        canonical: The canonical pose.
        sdf: SDF_0, frozen; None where there is no human body, and L_SDF0 is then not built.
        sizes: Of the model.
        options: Of the training.
        run: The stage's run.
    """
    torch.manual_seed(run.seed)
    model = GenerativeModel(canonical, sizes).to(frames.garments.device)
    if sizes.centred_descriptor:
        model.centre_descriptor(frames.garments, frames.body.seeds)

    noise = PoseNoise(model, options.pose_noise) if options.pose_noise else None

    def loss(step: int) -> dict[str, Tensor]:
        chosen = batch_at(step, options.training.batch, len(frames), run.seed)
        return stage1_loss(model, sdf, noise, frames, chosen, step, options, generator(run.seed, step))

    train(model, loss, options.training, run, "stage 1: generative space")


def stage1_loss(
    model: GenerativeModel,
    sdf: SignedDistance | None,
    noise: PoseNoise | None,
    frames: TrainingFrames,
    chosen: Tensor,
    step: int,
    options: Stage1,
    random: torch.Generator,
) -> dict[str, Tensor]:
    """Terms of L = L_rec + L_rand + lambda_1 L_SDF0 + lambda_2 L_reg at the frames `chosen`, shape (batch,)."""
    body = frames.body.at(chosen)
    garments = frames.garments[chosen]
    code = model.encode(*(noise(garments, body.seeds, random) if noise else (garments, body.seeds)))
    displaced = model.displaced(code)
    posed = model.pose(displaced, body.seeds, body.rotations)
    position, laplacian = reconstruction(posed, garments, model.laplacian)
    terms = {"position": position, "laplacian": laplacian, "latent": latent_regulariser(code)}
    total = position + laplacian + options.latent_weight * terms["latent"]
    if step % options.random_every == 0:
        drawn = torch.randn(code.shape, generator=random).to(code.device)
        imagined = model.displaced(drawn)
        terms["edge"] = edge_deviation(imagined, model.edges, model.edge_lengths)
        regular = options.edge_weight * terms["edge"]
        if sdf is not None and step >= options.sdf_from_step:
            terms["sdf"] = sdf_violation(sdf(displaced), options.sdf_margin)
            if options.sdf_on_random:
                terms["sdf"] = terms["sdf"] + sdf_violation(sdf(imagined), options.sdf_margin)
            regular = regular + options.sdf_weight * terms["sdf"]
        total = total + options.random_every * regular
    return {"total": total, **terms}
