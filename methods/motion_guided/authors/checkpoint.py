"""Reading the authors' released checkpoints: as data only, with their sizes, and the options that go with them."""

import pickle
import struct
from dataclasses import replace
from pathlib import Path

import torch
from torch import Tensor

from garmentbench.errors import UserError
from garmentbench.methods.motion_guided.config import Collision, Config, Model, Stage1, Stage2, Training

STATIC = ("Relative_encoder", "Pred_encoder", "Pre_decoder", "skinRadius")
DYNAMIC = ("Dynamic_ForceEncoder", "Dynamic_Encoder")
SDF = ("network", "data_center")
_TENSORS = ("skinRadius", "data_center")  # the other parts are state dicts
_DAMAGED = (
    pickle.UnpicklingError,
    RuntimeError,
    EOFError,
    ValueError,
    KeyError,
    OSError,
    AttributeError,
    TypeError,
    IndexError,
    MemoryError,
    OverflowError,
    AssertionError,
    struct.error,
)


def read_checkpoint(path: Path, parts: tuple[str, ...]) -> dict:
    """The named parts of a checkpoint, as data only: a file that asks for code to be run is refused.

    Raises `UserError` for a file that is missing, damaged, or lacks one of them.
    """
    try:
        found = torch.load(path, map_location="cpu", weights_only=True)
    except _DAMAGED as e:
        why = str(e).strip().splitlines()[0][:120] if str(e).strip() else type(e).__name__
        do = "copy it from the authors' release again"
        raise UserError(f"{path}: no checkpoint that can be read as data only ({why}); {do}") from e
    wrong = [part for part in parts if not isinstance(found, dict) or not _is_part(part, found.get(part))]
    if wrong:
        holds = ", ".join(map(str, found)) if isinstance(found, dict) else type(found).__name__
        raise UserError(
            f"{path}: lacks {', '.join(wrong)}, or they are no state dicts; it holds {holds}; "
            f"wanted a checkpoint of the authors with {', '.join(parts)}"
        )
    return {part: found[part] for part in parts}


def _is_part(part: str, value: object) -> bool:
    if part in _TENSORS:
        return isinstance(value, Tensor)
    return isinstance(value, dict) and all(isinstance(tensor, Tensor) for tensor in value.values())


def sizes_of(static: dict) -> Model:
    """The sizes of a checkpoint's blocks; the paper's where it does not tell."""
    paper = Model()

    def length(block: str, name: str, axis: int, else_: int) -> int:
        tensor = static[block].get(name)
        return int(tensor.shape[axis]) if tensor is not None and tensor.ndim > axis else else_

    halvings = sum(name.endswith("conv.0.weight") for name in static["Pred_encoder"])
    return replace(
        paper,
        map_size=2 ** (halvings + 1) if halvings else paper.map_size,
        width=length("Relative_encoder", "encoder_1.3.conv.0.weight", 0, paper.width),
        mlp_width=length("Pre_decoder", "MLP_pred.MLP_B.0.FC.0.weight", 0, paper.mlp_width),
        latent=length("Pred_encoder", "in_ZLinear.weight", 0, paper.latent),
        seeds=length("Relative_encoder", "encoder_1.0.conv.0.weight", 1, 3 * paper.seeds) // 3,
        seed_rotation="normal",
    )


def code_config(sizes: Model) -> Config:
    """A configuration as the authors' code has it, where that differs from the paper."""
    training = Training(steps=50_000, batch=1, halve_every=5_000, betas=(0.0, 0.9))
    return Config(
        model=replace(sizes, seed_rotation="normal"),
        stage1=Stage1(training, edge_weight=0.1, sdf_weight=1.0, sdf_from_step=500, sdf_on_random=False),
        stage2=Stage2(replace(training, amsgrad=True), pair_weight=0.5, latent_weight=5e-4, force_distance="previous"),
        collision=Collision(
            map_size=sizes.map_size,
            trigger="mean",
            threshold=5e-6,
            position_weight=10.0,
            laplacian_weight=1e4,
            collision_weight=1e4,
            betas=(0.0, 0.9),
        ),
    )
