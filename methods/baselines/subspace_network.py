"""A small network in the subspace, trained on roll-outs: `linear_subspace` with a network in place of its linear map.

    z_t = z_t-1 + net(z_t-1, z_t-2, f_t),    z: PCA-64 codes of the garment, f: PCA-64 codes of the body's seed points

in the manner of Holden et al. 2019, "Subspace Neural Physics". It is trained on free roll-outs over 16 frames that
start from codes with a tenth of noise, so that it learns to come back from its own errors.

It can't run away: inputs and codes, measured by their spread, stay about as near as in training, whatever comes.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from garmentbench.errors import UserError
from garmentbench.method import HISTORY, FitRun
from garmentbench.methods.baselines.code_dynamics import AGO, CodeDynamics
from garmentbench.methods.baselines.subspace import Encoded, Sizes, Subspace, load, save
from garmentbench.methods.training import Training, generator, train
from garmentbench.sequence import Sequence

SCALES = ("codes", "changes", "inputs", "far", "reach")
ROOM = 1.1  # how much farther out than in training a code, or an input, may be
_FLOOR = 1e-2  # the least spread that an input is measured by, relative to the largest


@dataclass(frozen=True)
class Config(Sizes):
    """Settings beside the sizes.

    Attributes:
        width: Of the two hidden layers.
        unroll: Frames of a training roll-out, at most.
        noise: Of the codes that it starts from, relative to each code's spread.
        training: The optimiser.
    """

    width: int = 256
    unroll: int = 16
    noise: float = 0.1
    training: Training = Training(steps=1500, batch=64, learning_rate=1e-3, schedule="one_cycle", weight_decay=1e-2)


def config_for(size: str) -> Config:
    """The configuration at a network size: "smoke" trains for a second."""
    config = Config()
    return replace(config, width=64, training=replace(config.training, steps=100)) if size == "smoke" else config


class Net(nn.Module):
    """The step from two codes and the body's to the next code. Codes and inputs are in units of their spread.

    codes, changes: spread of the codes and of their change in a frame, shape (K,). inputs: of the inputs, shape (Q,).
    far: of each input the farthest, in its spread, shape (Q,). reach: the ball's radius.
    """

    def __init__(self, width: int, **scales: Tensor) -> None:
        super().__init__()
        self.codes, self.changes, self.inputs, self.far, self.reach = (nn.Buffer(scales[name]) for name in SCALES)
        count = len(self.codes)
        sizes = (2 * count + len(self.inputs), width, width)
        hidden = [part for a, b in pairwise(sizes) for part in (nn.Linear(a, b), nn.ELU())]
        self.layers = nn.Sequential(*hidden, nn.Linear(width, count))

    def forward(self, last: Tensor, before: Tensor, inputs: Tensor) -> Tensor:
        """The next codes, shape (B, K), of codes (B, K) and inputs (B, Q)."""
        seen = torch.maximum(torch.minimum(inputs / self.inputs, self.far), -self.far)
        known = torch.cat([last / self.codes, (last - before) / self.changes, seen], dim=-1)
        following = last + self.changes * self.layers(known)
        distance = (following / self.codes).norm(dim=-1, keepdim=True)
        return following * (self.reach / distance.clamp(min=self.reach))


class SubspaceNetwork(CodeDynamics):
    """A network of PCA codes, their predecessors and the seed points."""

    name = "subspace_network"
    Config = Config

    def __init__(self, seeds: np.ndarray, garment: Subspace, body: Subspace, net: Net) -> None:
        """seeds: body vertices, shape (N,)."""
        super().__init__(seeds, garment, body)
        self.net = net

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> "SubspaceNetwork":
        """Train on free roll-outs; a training that was interrupted goes on. Raises `UserError` for short sequences."""
        known = Encoded.of(train, config, AGO)
        return cls(known.seeds, known.garment, known.body, fit_net(known.recordings, config, run))

    def save(self, folder: Path) -> None:
        """Write the fitted arrays."""
        weights = {f"net.{name}": value.numpy() for name, value in self.net.state_dict().items()}
        save(folder / "subspace_network.npz", self.garment, self.body, seeds=self.seeds, **weights)

    @classmethod
    def load(cls, folder: Path) -> "SubspaceNetwork":
        """Read them back."""
        arrays = load(folder / "subspace_network.npz")
        state = {k.removeprefix("net."): torch.from_numpy(arrays.pop(k)) for k in list(arrays) if k.startswith("net.")}
        net = Net(len(state["layers.0.bias"]), **{name: state[name] for name in SCALES})
        net.load_state_dict(state)
        return cls(**arrays, net=net)

    def following(self, memory: tuple[np.ndarray, ...], seen: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
        """The next code, shape (K,), by the network."""
        with torch.inference_mode():
            code = self.net(*(torch.from_numpy(np.asarray(x, np.float32)) for x in (*memory, seen))).numpy()
        return code, (code, memory[0])


def fit_net(recordings: list[tuple[np.ndarray, np.ndarray]], config: Config, run: FitRun) -> Net:
    """A network trained on recordings: codes, shape (T, K), and the input of each frame, shape (T, Q)."""
    lengths = [len(z) for z, _ in recordings]
    frames = min(config.unroll, min(lengths) - 2)
    if frames < 1:
        found = HISTORY + min(lengths)
        raise UserError(f"subspace_network: a training sequence has {found} frames; wanted at least {HISTORY + 3}")
    begins = np.cumsum([0, *lengths[:-1]])
    starts = np.concatenate([b + np.arange(2, n - frames + 1) for b, n in zip(begins, lengths, strict=True)])
    codes, inputs = (torch.from_numpy(np.concatenate(p).astype(np.float32)) for p in zip(*recordings, strict=True))
    spread, seen = _spread(codes), _spread(inputs)
    changes = _spread(torch.cat([torch.from_numpy(np.diff(z, axis=0).astype(np.float32)) for z, _ in recordings]))
    far, reach = (inputs / seen).abs().amax(dim=0), (codes / spread).norm(dim=1).max()
    torch.manual_seed(run.seed)
    net = Net(config.width, codes=spread, changes=changes, inputs=seen, far=ROOM * far, reach=ROOM * reach)

    def loss(step: int) -> dict[str, Tensor]:
        random = generator(run.seed, step)
        at = torch.from_numpy(starts)[torch.randint(len(starts), (config.training.batch,), generator=random)]
        shift, jolt = (config.noise * s * torch.randn(len(at), len(s), generator=random) for s in (spread, changes))
        before, last = codes[at - 2] + shift, codes[at - 1] + shift + jolt
        missed = []
        for k in range(frames):
            last, before = net(last, before, inputs[at + k]), last
            missed.append((last - codes[at + k]).norm(dim=1).mean())
        return {"total": torch.stack(missed).mean() / spread.norm()}

    train(net, loss, config.training, run, "subspace network")
    return net


def _spread(values: Tensor) -> Tensor:
    """By what each column is measured, shape (K,): its standard deviation, or a little of the largest one."""
    if values.shape[1] == 0:  # there is no body
        return values.sum(dim=0)
    found = values.std(dim=0, correction=0)
    return found.clamp(min=max(_FLOOR * found.max().item(), 1e-9))
