"""Stage 1: training of the generative model (section 4.2)."""

from dataclasses import dataclass

import torch
from torch import Tensor

from garmentbench.method import FitRun
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.closed_form import random_garments, solve_encoder_path
from garmentbench.methods.motion_guided.config import Model, Stage1
from garmentbench.methods.motion_guided.displacement_space import displacement_scale, set_displacement_space
from garmentbench.methods.motion_guided.frames import BodyFrames, Pose, body_frames
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.limbs import Limbs
from garmentbench.methods.motion_guided.losses import edge_deviation, latent_regulariser, reconstruction, sdf_violation
from garmentbench.methods.motion_guided.posing import RandomPoses
from garmentbench.methods.motion_guided.sdf import SignedDistance
from garmentbench.methods.training import batch_at, generator, train
from garmentbench.sequence import Sequence


@dataclass(frozen=True)
class TrainingFrames:
    """The training sequences as tensors, one after another, T frames together.

    Attributes:
        garments: In the coordinates of `body` [m], shape (T, V, 3).
        body: The body in each frame.
        lengths: Frames of each sequence.
    """

    garments: Tensor
    body: BodyFrames
    lengths: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.garments)


def training_frames(
    sequences: tuple[Sequence, ...], canonical: Canonical, options: Model, device: torch.device
) -> TrainingFrames:
    """Garment and seeds of every frame of the sequences."""
    bodies = [
        body_frames(s.body_positions, canonical.seeds, options.seed_rotation, options.axes, device, canonical.upright)
        for s in sequences
    ]
    garments = [body.local(s.garment) for s, body in zip(sequences, bodies, strict=True)]
    return TrainingFrames(torch.cat(garments), BodyFrames.joined(bodies), tuple(len(s) for s in sequences))


def fit_stage1(
    frames: TrainingFrames,
    canonical: Canonical,
    limbs: Limbs,
    sdf: SignedDistance | None,
    sizes: Model,
    options: Stage1,
    run: FitRun,
) -> None:
    """Train S, E^Sta, D, R and the kernel radii; their weights go into the run's folder.

    Args:
        frames: Training frames.
        canonical: The canonical pose.
        limbs: What turns in random poses.
        sdf: SDF_0, frozen; None where there is no human body, and L_SDF0 is then not built.
        sizes: Of the model.
        options: Of the training.
        run: The stage's run.
    """
    torch.manual_seed(run.seed)
    model = GenerativeModel(canonical, sizes).to(frames.garments.device)
    pose = frames.body.pose
    if sizes.output_scale is None:
        model.unit.copy_(displacement_scale(model, frames.garments, pose))
    if sizes.centred_descriptor:
        model.centre_descriptor(frames.garments, pose.seeds)
    poses = None
    if sizes.linear_paths:
        poses = RandomPoses(limbs, model.canonical_seeds, options.posing)
        set_displacement_space(model, canonical, frames.garments, pose)
        solve_encoder_path(model, poses, pose, run.seed)

    def loss(step: int) -> dict[str, Tensor]:
        chosen = batch_at(step, options.training.batch, len(frames), run.seed)
        random = generator(run.seed, step)
        terms = stage1_loss(model, sdf, frames.garments[chosen], pose.at(chosen), step, options, random)
        return terms if poses is None else with_random_garments(model, poses, pose, terms, options, random)

    train(model, loss, options.training, run, "stage 1: generative space")


def stage1_loss(
    model: GenerativeModel,
    sdf: SignedDistance | None,
    garments: Tensor,
    pose: Pose,
    step: int,
    options: Stage1,
    random: torch.Generator,
) -> dict[str, Tensor]:
    """Terms of L = L_rec + L_rand + lambda_1 L_SDF0 + lambda_2 L_reg at some frames' garments, shape (batch, V, 3)."""
    code = model.encode(garments, pose.seeds)
    displaced = model.displaced(code)
    posed = model.pose(displaced, pose)
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


def with_random_garments(
    model: GenerativeModel,
    poses: RandomPoses,
    recorded: Pose,
    terms: dict[str, Tensor],
    options: Stage1,
    random: torch.Generator,
) -> dict[str, Tensor]:
    """The same terms, averaged with the reconstruction of as many random garments in random poses (ours)."""
    codes, garments, pose = random_garments(model, poses, recorded, options.training.batch, random)
    found = model.encode(garments, pose.seeds)
    posed = model.pose(model.displaced(found), pose)
    position, laplacian = reconstruction(posed, garments, model.laplacian)
    error = (found - codes).abs().mean()
    total = 0.5 * (terms["total"] + position + laplacian) + options.code_weight * error
    return {**terms, "total": total, "random_position": position, "random_code": error}
