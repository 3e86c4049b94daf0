"""What networks in the subspace share: they are trained on free roll-outs, and can't run away.

A training roll-out starts from codes with some noise, and sees the body a little beside where it is: an offset of its
code that stays the same for all of its frames. So a network learns to come back from its own errors, and does not take
the body's shape, which a few sequences tell apart, for their motion.
"""

from abc import abstractmethod
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
import torch
from torch import Tensor, nn

from garmentbench.errors import UserError
from garmentbench.method import HISTORY, FitRun
from garmentbench.methods.baselines.code_dynamics import AGO, CodeDynamics
from garmentbench.methods.baselines.subspace import Encoded, Sizes, Subspace, load, save
from garmentbench.methods.novelty import Novelty
from garmentbench.methods.training import Training, generator, train
from garmentbench.sequence import Sequence

SCALES = ("mean", "codes", "changes", "centre", "inputs", "far", "reach")
ROOM = 1.1  # how much farther out than in training a code, or an input, may be
_FLOOR = 1e-2  # the least spread that an input is measured by, relative to the largest


@dataclass(frozen=True)
class Config(Sizes):
    """Settings beside the sizes.

    Attributes:
        width: Of the hidden layers.
        unroll: Frames of a training roll-out, at most.
        noise: Of the codes that it starts from, relative to each code's spread.
        offset: Of the body's code, the same in all frames of a training roll-out [m].
        training: The optimiser.
    """

    body_codes: int = 96
    turns: bool = True
    width: int = 256
    unroll: int = 16
    noise: float = 0.1
    offset: float = 0.01
    training: Training = Training(steps=1500, batch=64, learning_rate=1e-3, schedule="one_cycle", weight_decay=1e-2)


def config_for(size: str) -> Config:
    """The configuration at a network size: "smoke" trains for a second."""
    config = Config()
    return replace(config, width=64, training=replace(config.training, steps=100)) if size == "smoke" else config


class CodeNet(nn.Module):
    """A step of codes. What it works on is measured by its spread in training, and kept as near as it was there.

    mean, codes: mean and spread of the codes, shape (K,). changes: spread of their change in a frame, shape (K,).
    centre, inputs: mean and spread of the inputs, shape (Q,). far: how far from the mean each was at most, in its
    spread, shape (Q,). reach: likewise of the whole code.
    """

    def __init__(self, width: int, **scales: Tensor) -> None:
        super().__init__()
        self.width = width
        self.mean, self.codes, self.changes, self.centre, self.inputs, self.far, self.reach = (
            nn.Buffer(scales[name]) for name in SCALES
        )
        self.build(width, len(scales["codes"]), len(scales["inputs"]))

    @abstractmethod
    def build(self, width: int, codes: int, inputs: int) -> None:
        """Make the layers."""

    @abstractmethod
    def start(self, last: Tensor, before: Tensor, seen: Tensor) -> Any:
        """What is remembered before the first step: of the last two codes, shape (B, K), and the last input, (B, Q)."""

    @abstractmethod
    def forward(self, memory: Any, seen: Tensor) -> tuple[Tensor, Any]:
        """The next codes, shape (B, K), and what is remembered then, of inputs, shape (B, Q)."""

    def near(self, seen: Tensor) -> Tensor:
        """Inputs in units of their spread, no farther out than in training, shape (B, Q)."""
        return ((seen - self.centre) / self.inputs).clamp(-self.far, self.far)

    def within(self, codes: Tensor) -> Tensor:
        """Codes, shape (B, K), no farther from the mean than in training."""
        from_mean = codes - self.mean
        distance = (from_mean / self.codes).norm(dim=-1, keepdim=True)
        return self.mean + from_mean * (self.reach / distance.clamp(min=self.reach))


class TrainedDynamics(CodeDynamics):
    """Codes that a network advances. A subclass says by its `Net` how."""

    name: ClassVar[str]
    Net: ClassVar[type[CodeNet]]
    Config = Config

    def __init__(
        self, seeds: np.ndarray, garment: Subspace, body: Subspace, novelty: Novelty, turns: bool, net: CodeNet
    ) -> None:
        """seeds: body vertices, shape (N,)."""
        super().__init__(seeds, garment, body, novelty, turns)
        self.net = net

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> Self:
        """Train on free roll-outs; a training that was interrupted goes on. Raises `UserError` for short sequences."""
        known = Encoded.of(train, config, AGO)
        net = fit_net(cls.Net, known.recordings, config, run, cls.name)
        return cls(known.seeds, known.garment, known.body, known.novelty, config.turns, net)

    def save(self, folder: Path) -> None:
        """Write the fitted arrays."""
        weights = {f"net.{name}": value.numpy() for name, value in self.net.state_dict().items()}
        width = np.array(self.net.width)
        further = {"seeds": self.seeds, "turns": np.array(self.turns), "width": width, **weights}
        save(_file(folder), self.garment, self.body, self.novelty, **further)

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Read them back."""
        arrays = load(_file(folder))
        state = {k.removeprefix("net."): torch.from_numpy(arrays.pop(k)) for k in list(arrays) if k.startswith("net.")}
        turns = bool(arrays.pop("turns"))
        net = cls.Net(int(arrays.pop("width")), **{name: state[name] for name in SCALES})
        net.load_state_dict(state)
        return cls(**arrays, turns=turns, net=net)

    def start(self, last: np.ndarray, before: np.ndarray, seen: np.ndarray) -> Any:
        """As the network remembers it."""
        with torch.inference_mode():
            return self.net.start(*(_row(x) for x in (last, before, seen)))

    def following(self, memory: Any, seen: np.ndarray) -> tuple[np.ndarray, Any]:
        """The next code, shape (K,), by the network."""
        with torch.inference_mode():
            code, memory = self.net(memory, _row(seen))
        return code[0].numpy(), memory


def fit_net(
    kind: type[CodeNet], recordings: list[tuple[np.ndarray, np.ndarray]], config: Config, run: FitRun, name: str
) -> CodeNet:
    """A network trained on recordings: codes, shape (T, K), and the input of each frame, shape (T, Q)."""
    lengths = [len(z) for z, _ in recordings]
    frames = min(config.unroll, min(lengths) - 2)
    if frames < 1:
        found = HISTORY + min(lengths)
        raise UserError(f"{name}: a training sequence has {found} frames; wanted at least {HISTORY + 3}")
    begins = np.cumsum([0, *lengths[:-1]])
    starts = np.concatenate([b + np.arange(2, n - frames + 1) for b, n in zip(begins, lengths, strict=True)])
    codes, inputs = (torch.from_numpy(np.concatenate(p).astype(np.float32)) for p in zip(*recordings, strict=True))
    scales = _scales(codes, inputs, [torch.from_numpy(np.diff(z, axis=0).astype(np.float32)) for z, _ in recordings])
    torch.manual_seed(run.seed)
    net = kind(config.width, **scales)

    def loss(step: int) -> dict[str, Tensor]:
        random = generator(run.seed, step)
        at = torch.from_numpy(starts)[torch.randint(len(starts), (config.training.batch,), generator=random)]
        shift, jolt = (
            config.noise * scales[of] * torch.randn(len(at), codes.shape[1], generator=random)
            for of in ("codes", "changes")
        )
        seen = config.offset * torch.randn(len(at), inputs.shape[1], generator=random)
        memory = net.start(codes[at - 1] + shift + jolt, codes[at - 2] + shift, inputs[at - 1] + seen)
        missed = []
        for k in range(frames):
            code, memory = net(memory, inputs[at + k] + seen)
            missed.append((code - codes[at + k]).norm(dim=1).mean())
        return {"total": torch.stack(missed).mean() / scales["codes"].norm()}

    train(net, loss, config.training, run, name.replace("_", " "))
    return net


def _scales(codes: Tensor, inputs: Tensor, changes: list[Tensor]) -> dict[str, Tensor]:
    """What `CodeNet` measures by, of all frames' codes and inputs and of the changes within each recording."""
    mean, centre = codes.mean(dim=0), inputs.mean(dim=0)
    spread, seen = _spread(codes), _spread(inputs)
    far, reach = ((inputs - centre) / seen).abs().amax(dim=0), ((codes - mean) / spread).norm(dim=1).max()
    return {
        "mean": mean, "codes": spread, "changes": _spread(torch.cat(changes)), "centre": centre, "inputs": seen,
        "far": ROOM * far, "reach": ROOM * reach,
    }  # fmt: skip


def _spread(values: Tensor) -> Tensor:
    """By what each column is measured, shape (K,): its standard deviation, or a little of the largest one."""
    if values.shape[1] == 0:  # there is no body
        return values.sum(dim=0)
    found = values.std(dim=0, correction=0)
    return found.clamp(min=max(_FLOOR * found.max().item(), 1e-9))


def _row(values: np.ndarray) -> Tensor:
    return torch.from_numpy(np.asarray(values, np.float32))[None]


def _file(folder: Path) -> Path:
    return folder / "dynamics.npz"
