"""The named ablations, each beside the full model on the main table's experiment.

The first three follow figures 7, 8 and 10 of the paper, the training lengths are its Table 4. What guides the motion is
taken away next: velocity and acceleration, the interaction force, all of the garment's past. "push-out" has another
collision stage; "linear-paths" adds to the paper's blocks what makes them generalise like linear regression. Both are
ours. "tuned" takes the parts of `tuned` away, one at a time, where it was made for: a lively garment, much training.

Training lengths keep the number of optimiser steps, as one does who compares what data are worth: 50 frames are seen
120 times each at laptop size, 900 frames 6.7 times.
"""

from dataclasses import replace

from garmentbench.evals.baselines import BASELINES
from garmentbench.evals.comparison import Comparison
from garmentbench.evals.trial import FULL, TUNED, Entry
from garmentbench.report.lines import Line, label


def _ablation(variant: str) -> Comparison:
    name = f"ablation-{variant.replace('_', '-')}"
    return replace(
        BASELINES, name=name, table="ablations", title="Ablations", entries=(FULL, Entry("motion_guided", variant))
    )


class TrainingLengths(Comparison):
    """The full model by its training length, which every line says."""

    def label(self, line: Line) -> str:
        own = line.variant == "full" and line.train_frames is not None
        return label(replace(line, variant=f"train_{line.train_frames}") if own else line)

    def order(self, line: Line) -> tuple:
        return line.method, line.train_frames or 0, line.variant, line.scene


TAKEN_AWAY = ("fixed_weights", "no_virtual_sample", "no_collision", "no_velocity", "no_force", "pose_only")
ABLATIONS = tuple(map(_ablation, (*TAKEN_AWAY, "push_out", "linear_paths")))
TRAINING_LENGTHS = TrainingLengths(
    name="ablation-train-length",
    table="table4",
    title="Training length",
    train=BASELINES.train,
    tests=BASELINES.tests,
    entries=(FULL, *(Entry("motion_guided", train_frames=n) for n in (50, 150, 900))),
)
PARTS_OF_TUNED = ("no_push_out", "no_turns", "no_offset", "no_noise", "one_step", "narrow", "short")
TUNED_PARTS = Comparison(
    name="ablation-tuned",
    table="tuned_parts",
    title="What the parts of tuned are worth",
    train=("pleated_skirt@varied",),
    tests=("pleated_skirt-dance-latin-late", "pleated_skirt-dance-bounce"),  # new phrases of a seen kind; a new kind
    entries=(TUNED, *(Entry("tuned", part) for part in PARTS_OF_TUNED)),
    on_request=True,  # the varied set is simulated for it, and each variant trained three times
    seeds=3,
)
