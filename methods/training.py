"""The training loop of all that is learnt by steps: Adam, a log, and checkpoints from which it goes on after a kill.

All that is random follows from the seed and the number of the step, so that a stage resumed after a kill ends, on one
CPU thread, with the same bits as one that was never interrupted.
"""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor, nn

from garmentbench.method import FitRun
from garmentbench.storage.atomic import written_whole

CHECKPOINT_SECONDS = 20.0
LOG_STEPS = 50
CHECKPOINT, WEIGHTS = "checkpoint.pt", "weights.pt"

Loss = Callable[[int], dict[str, Tensor]]


@dataclass(frozen=True)
class Training:
    """How a stage is optimised."""

    steps: int = 26_250
    """Optimiser steps. Default: the paper's 350 epochs of 300 frames in batches of 4 (the code's checkpoints: 50,000
    steps of batch 1)."""
    batch: int = 4
    """Frames a step (paper: 1 to 4, code: 1)."""
    learning_rate: float = 1e-4
    """Of Adam; the peak where the schedule is "one_cycle"."""
    schedule: str = "halving"
    """"halving": halved every `halve_every` steps (paper and code); "one_cycle" (ours): a linear rise over a tenth of
    the steps, then a cosine down to nothing."""
    halve_every: int = 3_750
    """Default: 50 epochs."""
    betas: tuple[float, float] = (0.9, 0.999)
    """Of Adam (code: 0, 0.9)."""
    amsgrad: bool = False
    """Code: True in stage 2."""
    weight_decay: float = 0.0
    """Share of each weight that a step of learning rate 1 takes off (AdamW)."""


def train(module: nn.Module, loss: Loss, options: Training, run: FitRun, label: str) -> None:
    """Train the parameters of `module` that require a gradient, and write its weights into the run's folder.

    Args:
        module: What is trained; its whole state goes into checkpoints.
        loss: Step number to the terms of the loss, by name; "total" is what is minimised.
        options: Steps and optimiser.
        run: Where to write and log.
        label: Of the progress bar.
    """
    parameters = [p for p in module.parameters() if p.requires_grad]
    adam = torch.optim.AdamW(
        parameters, betas=options.betas, weight_decay=options.weight_decay, amsgrad=options.amsgrad, fused=True
    )
    first = _resume(run.folder / CHECKPOINT, module, adam)
    saved = time.monotonic()
    with run.track(options.steps, label, done=first) as advance, without_denormals():
        for step in range(first, options.steps):
            if time.monotonic() - saved > CHECKPOINT_SECONDS:
                save({"step": step, "module": module.state_dict(), "adam": adam.state_dict()}, run.folder / CHECKPOINT)
                saved = time.monotonic()
            adam.param_groups[0]["lr"] = learning_rate(options, step)
            terms = loss(step)
            adam.zero_grad()
            terms["total"].backward()
            adam.step()
            if step % LOG_STEPS == 0 or step == options.steps - 1:
                run.log(step, **{name: term.item() for name, term in terms.items()})
            advance()
    save(module.state_dict(), run.folder / WEIGHTS)
    (run.folder / CHECKPOINT).unlink(missing_ok=True)


@contextmanager
def without_denormals() -> Iterator[None]:
    """Denormal numbers are 0 within, which slow convolutions sixfold. Within alone: it is so for the whole thread, and
    scipy's KDTree, which looks for the next number above a median of 0, then recurses until the process dies."""
    torch.set_flush_denormal(True)
    try:
        yield
    finally:
        torch.set_flush_denormal(False)


def learning_rate(options: Training, step: int) -> float:
    """The learning rate at a step, by the option `Training.schedule`."""
    if options.schedule == "halving":
        return options.learning_rate * 0.5 ** (step // options.halve_every)
    rise = options.steps / 10
    if step < rise:
        return options.learning_rate * (step + 1) / (rise + 1)
    return options.learning_rate * 0.5 * (1 + math.cos(math.pi * (step - rise) / (options.steps - rise)))


def batch_at(step: int, batch: int, count: int, seed: int) -> Tensor:
    """Indices below `count` of the frames of a step, shape (batch,): every frame once an epoch, in random order."""
    places = range(step * batch, (step + 1) * batch)
    orders = {epoch: torch.randperm(count, generator=generator(seed, epoch)) for epoch in {p // count for p in places}}
    return torch.stack([orders[p // count][p % count] for p in places])


def generator(*numbers: int) -> torch.Generator:
    """A random generator of its own for whole numbers below 2^31, such as a seed and a step."""
    mixed = 0
    for number in numbers:
        mixed = (mixed * 6364136223846793005 + number * 1442695040888963407 + 1) % 2**63
    return torch.Generator().manual_seed(mixed)


def save(values: dict, path: Path) -> None:
    """Write tensors and plain values, whole."""
    with written_whole(path) as partial:
        torch.save(values, partial)


def load(path: Path, device: torch.device) -> dict:
    """Read what `save` wrote, as data only."""
    return torch.load(path, map_location=device, weights_only=True)


def _resume(path: Path, module: nn.Module, adam: torch.optim.Adam) -> int:
    """Take up a checkpoint if there is one; the step to go on with."""
    if not path.is_file():
        return 0
    state = load(path, next(module.parameters()).device)
    module.load_state_dict(state["module"])
    adam.load_state_dict(state["adam"])
    return state["step"]
