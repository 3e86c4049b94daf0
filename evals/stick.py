"""The paper's sheet of cloth wrapped round a moving stick (figures 9 and 10): no human body, another motion in test."""

from garmentbench.evals.comparison import FULL, SIMPLE, Comparison, Entry

STICK = Comparison(
    name="stick",
    table="stick",
    title="Sheet and stick",
    train=("sheet-stick-a",),
    tests=("sheet-stick-b",),
    entries=(*SIMPLE, FULL, *(Entry("motion_guided", v) for v in ("no_virtual_sample", "linear_paths"))),
)
