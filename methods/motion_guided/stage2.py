"""Stage 2: training of the dynamic-aware encoder (section 5), teacher-forced, one step ahead."""

import torch
from torch import Tensor

from garmentbench.method import FitRun
from garmentbench.methods.motion_guided.closed_form import RIDGE, ridge
from garmentbench.methods.motion_guided.config import Model, Stage2
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.frames import Pose
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.inputs import Inputs, dynamic_inputs, flat_place
from garmentbench.methods.motion_guided.limbs import Limbs
from garmentbench.methods.motion_guided.losses import dynamic_pair, latent_regulariser
from garmentbench.methods.motion_guided.posing import RandomPoses
from garmentbench.methods.motion_guided.samples import CHUNK, Recorded, Reposed, Sample
from garmentbench.methods.motion_guided.stage1 import TrainingFrames
from garmentbench.methods.training import batch_at, generator, train

POSES = 8  # random poses of each frame that the pose path is solved on


def fit_stage2(
    model: GenerativeModel,
    frames: TrainingFrames,
    limbs: Limbs,
    sizes: Model,
    options: Stage2,
    run: FitRun,
) -> None:
    """Train C and E^Dyn with S, D, R and the radii fixed; their weights go into the run's folder.

    Args:
        model: The trained generative model.
        frames: Training frames.
        limbs: What turns in random poses.
        sizes: Of the model.
        options: Of the training.
        run: The stage's run.
    """
    torch.manual_seed(run.seed)
    device = frames.garments.device
    dynamics = DynamicEncoder(sizes, len(model.canonical_seeds), options).to(device)
    recorded, posing = Recorded(model, frames), options.posing
    varied = posing.limb_angle or posing.whole_angle or posing.code_spread
    reposed = Reposed(model, frames, recorded, RandomPoses(limbs, model.canonical_seeds, posing)) if varied else None
    cached = all_inputs(model, recorded, options) if options.cache_inputs and not varied else None

    if options.units == "spread":
        parts = (sample_inputs(model, recorded.at(t), options) for t in recorded.targets.split(CHUNK))
        dynamics.set_units([cached] if cached else parts, int(model.to_map.mask.sum()))
    if options.pose_path:
        solve_pose_path(model, dynamics, recorded, reposed, run.seed)

    def loss(step: int) -> dict[str, Tensor]:
        chosen = batch_at(step, options.training.batch, len(recorded.targets), run.seed)
        t = recorded.targets[chosen]
        sample = recorded.at(t) if reposed is None else reposed.at(t, generator(run.seed, step))
        inputs = cached.at(chosen) if cached else sample_inputs(model, sample, options)
        return stage2_loss(model, dynamics, sample, inputs, options)

    train(dynamics, loss, options.training, run, "stage 2: dynamics")


def sample_inputs(model: GenerativeModel, sample: Sample, options: Stage2) -> Inputs:
    """Teacher-forced inputs of samples."""
    return dynamic_inputs(model, sample.past, sample.before, sample.now, sample.on, options)


@torch.no_grad()
def solve_pose_path(
    model: GenerativeModel, dynamics: DynamicEncoder, recorded: Recorded, reposed: Reposed | None, seed: int
) -> None:
    """Set the pose path to the ridge regression of the codes on the seeds, over all frames in `POSES` random poses."""
    places, codes = [], []
    for k in range(POSES if reposed else 1):
        for chunk in recorded.targets.split(CHUNK):
            sample = reposed.at(chunk, generator(seed, k, int(chunk[0]))) if reposed else recorded.at(chunk)
            places.append(flat_place(model, sample.now.seeds, sample.on(sample.before.seeds)))
            codes.append(sample.code)
    weight, bias = ridge(torch.cat(places), torch.cat(codes), RIDGE)
    dynamics.path_weight.copy_(weight)
    dynamics.path_bias.copy_(bias)


def all_inputs(model: GenerativeModel, recorded: Recorded, options: Stage2) -> Inputs:
    """Inputs of all `recorded.targets`."""
    chunks = recorded.targets.split(CHUNK)
    return Inputs.joined([sample_inputs(model, recorded.at(t), options) for t in chunks])


def stage2_loss(
    model: GenerativeModel, dynamics: DynamicEncoder, sample: Sample, inputs: Inputs, options: Stage2
) -> dict[str, Tensor]:
    """Terms of eq. 2: each once for the frame and once for the virtual sample, in which nothing changes."""
    found, code, garment, pose = dynamics(inputs), sample.code, sample.garment, sample.now
    kinds = 2 if options.virtual_sample else 1
    if options.virtual_sample:
        found = torch.cat([found, dynamics.still(inputs)])
        code, garment = torch.cat([code, sample.code_before]), torch.cat([garment, sample.past.garment])
        pose = Pose.joined([pose, sample.before])
    posed = model.pose(model.displaced(found), pose)
    terms = {  # a mean over both kinds, times their number, is a sum of two means
        "geometry": kinds * dynamic_pair(posed, garment),
        "code": kinds * dynamic_pair(found, code),
        "latent": kinds * latent_regulariser(found),
    }
    pair = terms["geometry"] + options.code_weight * terms["code"]
    return {"total": options.pair_weight * pair + options.latent_weight * terms["latent"], **terms}
