"""The named ablations, each beside the full model on the main table's experiment.

The first three follow figures 7, 8 and 10 of the paper, the last is its Table 4. "linear-paths" adds to the
paper's blocks what makes them generalise like linear regression (ours).
"""

from dataclasses import replace

from garmentbench.evals.baselines import BASELINES
from garmentbench.evals.experiment import FULL, Entry


def _ablation(name: str, *entries: Entry, table: str = "ablations"):
    return replace(BASELINES, name=f"ablation-{name}", table=table, entries=(FULL, *entries), needs=False)


ABLATIONS = (
    _ablation("fixed-weights", Entry("motion_guided", "fixed_weights")),
    _ablation("no-virtual-sample", Entry("motion_guided", "no_virtual_sample")),
    _ablation("no-collision", Entry("motion_guided", "no_collision")),
    _ablation("linear-paths", Entry("motion_guided", "linear_paths")),
    _ablation(
        "train-length",
        *(Entry("motion_guided", train_frames=n) for n in (50, 150, 900)),
        table="table4",
    ),
)
