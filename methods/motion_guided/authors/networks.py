"""The authors' released checkpoints in our networks: which of their tensors is which of ours.

A checkpoint is a dictionary of state dicts. Every tensor of theirs has its place here by name; one that is missing,
unknown or of another shape is an error. Where ours differ in form, the numbers are the same:
    - the first convolutions of S and C have 3N input channels, seed by seed (x, y, z): ours, shape (O, N, 3, 3, 3), are
      these channels in the same order;
    - biases before an instance norm have no effect, and ours has none;
    - where files have other axes than ours (`turn`), what is fed with vectors gets its input channels turned instead.
"""

from pathlib import Path

import torch
from torch import Tensor, nn

from garmentbench.errors import UserError
from garmentbench.methods.motion_guided.config import Sdf
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.sdf import SignedDistance

State = dict[str, Tensor]


def load_static(model: GenerativeModel, static: dict, path: Path, labels: Tensor, turn: Tensor) -> None:
    """Fill S, E^Sta, D, R and the kernel radii from `authors_checkpoint.read_checkpoint`.

    Args:
        model: Its weights are set.
        static: What was read.
        path: For messages.
        labels: The labels that seeds have, ascending; radius k of theirs belongs to label k.
        turn: Our axes in the file's, shape (3, 3).

    Raises `UserError`, one line, that lists tensors which are missing, unknown or of another shape.
    """
    halvings, names = len(model.encoder.convs.layers), {}
    names["Relative_encoder"] = {"encoder_1.0.conv.0": "features_block.first"} | {
        f"encoder_1.{k + 1}.conv.0": f"features_block.rest.layers.{k}" for k in range(3)
    }
    names["Pred_encoder"] = _encoder_names(halvings)
    names["Pre_decoder"] = _decoder_names(halvings + 1)
    problems = [p for block in names for p in _fill(model, static[block], names[block], block, turn.to(model.rest))]
    radii = static["skinRadius"]
    if radii.ndim != 1 or len(radii) <= labels.max() or not radii.abs().min() > 0:
        wanted = f"wanted a radius above 0 for each of the labels 0 to {int(labels.max())}"
        problems.append(f"skinRadius of shape {tuple(radii.shape)}, {wanted}")
    _refuse(path, problems)
    with torch.no_grad():
        model.log_radii.copy_(radii[labels].to(model.log_radii).abs().log())


def load_dynamic(dynamics: DynamicEncoder, checkpoint: dict, path: Path, turn: Tensor) -> None:
    """Fill C and E^Dyn from `read_checkpoint`. Otherwise as `load_static`."""
    change = {"encoder_1.0.conv.0": "motion_block.force"}
    change |= {f"encoder_1.{k + 1}.conv.0": f"motion_block.force_rest.layers.{k}" for k in range(2)}
    change |= {f"encoder_2.{k}.conv.0": f"motion_block.both.layers.{k}" for k in range(3)}
    turn = turn.to(next(dynamics.parameters()))
    problems = _fill(dynamics, checkpoint["Dynamic_ForceEncoder"], change, "Dynamic_ForceEncoder", turn)
    encoder = _encoder_names(len(dynamics.encoder.convs.layers))
    _refuse(path, problems + _fill(dynamics, checkpoint["Dynamic_Encoder"], encoder, "Dynamic_Encoder", turn))


def load_sdf(checkpoint: dict, path: Path, turn: Tensor) -> SignedDistance:
    """SDF_0 from `read_checkpoint`, in our axes. Otherwise as `load_static`."""
    network = SignedDistance(Sdf())
    names = {f"lin_{k}": f"layers.{k}" for k in range(len(network.layers))}
    problems = _fill(network, checkpoint["network"], names, "network", turn.to(network.centre))
    centre = checkpoint["data_center"]
    if centre.numel() != 3:
        problems.append(f"data_center of shape {tuple(centre.shape)}, wanted three numbers")
    _refuse(path, problems)
    network.centre.copy_(turn.to(network.centre) @ centre.flatten().to(network.centre))
    return network.requires_grad_(False)


def _encoder_names(halvings: int) -> dict[str, str]:
    return {f"encoder_1.{k}.conv.0": f"encoder.convs.layers.{k}" for k in range(halvings)} | {
        "in_ZLinear": "encoder.linear"
    }


def _decoder_names(doublings: int) -> dict[str, str]:
    names = {"out_ZLinear.FC.0": "decoder.linear"}
    names |= {f"decoder.decoder1.{k}.transConv.0": f"decoder.convs.layers.{k}" for k in range(doublings)}
    names |= {f"uvencoder.{k}.FC.0": f"displacement_block.uv.{k}" for k in range(4)}
    names |= {"MLP_pred.MLP_B.0.FC.0": "displacement_block.first"}
    names |= {f"MLP_pred.MLP_B.{k + 1}.MLP.FC.0": f"displacement_block.residual.{k}" for k in range(4)}
    return names | {
        "MLP_pred.LinearGeo.0.FC.0": "displacement_block.last.0",
        "MLP_pred.LinearGeo.1": "displacement_block.last.1",
    }


def _fill(module: nn.Module, theirs: State, names: dict[str, str], block: str, turn: Tensor) -> list[str]:
    """Copy a block's tensors by name, unless anything is wrong with them, which is returned."""
    ours = dict(module.named_parameters())
    wanted = {}
    for their_layer, our_layer in names.items():
        weight = ours[f"{our_layer}.weight"]
        bias = ours.get(f"{our_layer}.bias")
        wanted[f"{their_layer}.weight"] = (
            weight,
            tuple(weight.flatten(1, 2).shape if weight.ndim == 5 else weight.shape),
        )
        outputs = weight.shape[1] if "transConv" in their_layer else weight.shape[0]
        wanted[f"{their_layer}.bias"] = (bias, (outputs,))
    problems = [f"{block}: missing {name}" for name in wanted if name not in theirs]
    problems += [f"{block}: unknown {name}" for name in theirs if name not in wanted]
    problems += [
        f"{block}: {name} has shape {tuple(theirs[name].shape)}, wanted {shape}"
        for name, (_, shape) in wanted.items()
        if name in theirs and tuple(theirs[name].shape) != shape
    ]
    if not problems:
        with torch.no_grad():
            for name, (parameter, _) in wanted.items():
                if parameter is not None:
                    value = theirs[name].to(parameter).reshape(parameter.shape)
                    parameter.copy_(_turned(value, name, block, turn))
    return problems


def _turned(weight: Tensor, name: str, block: str, turn: Tensor) -> Tensor:
    """A weight for inputs in our axes.

    sum_k W_k p_k = sum_l W'_l p'_l with p' = turn p, so W'_l = sum_k turn_lk W_k.
    """
    if weight.ndim == 5:  # seeds' vectors
        return torch.einsum("onkyx,lk->onlyx", weight, turn)
    if (
        block == "Dynamic_ForceEncoder" and name == "encoder_2.0.conv.0.weight"
    ):  # velocity and acceleration are its last 6
        vectors = weight[:, -6:].unflatten(1, (2, 3))
        return torch.cat([weight[:, :-6], torch.einsum("okcyx,lc->oklyx", vectors, turn).flatten(1, 2)], dim=1)
    if block == "network" and name in ("lin_0.weight", "lin_4.weight"):  # the point, and the point again at the skip
        return torch.cat([weight[:, :-3], weight[:, -3:] @ turn.T], dim=1)
    return weight


def _refuse(path: Path, problems: list[str]) -> None:
    if problems:
        do = "use the checkpoint that belongs to this data"
        raise UserError(f"{path}: {'; '.join(problems)}: not the authors' networks of these sizes; {do}")
