"""The paper's sheet of cloth on a moving stick (figures 9 and 10): no human body, another motion in test.

In one scene the sheet is held by a row of points and the stick rolls; in the other the sheet is laid over the stick,
which moves and turns about the vertical, and nothing but weight and friction holds it.

A sheet that is wound up has many more states than a shirt on a walk, and the paper's 300 frames hold few of them. So
methods are trained on five times as many, too.
"""

from garmentbench.evals.comparison import Comparison
from garmentbench.evals.trial import FULL, SIMPLE, TUNED, Entry

LONG = 1500  # frames, all that the training scenes have


LONGER = tuple(Entry(method, train_frames=LONG) for method in ("linear_subspace", "tuned", "motion_guided"))
STICK = Comparison(
    name="stick",
    table="stick",
    title="Sheet and stick",
    train=("sheet-stick-a",),
    tests=("sheet-stick-b",),
    entries=(
        *SIMPLE,
        TUNED,
        FULL,
        *(Entry("motion_guided", v) for v in ("no_virtual_sample", "linear_paths")),
        *LONGER,
    ),
)
STICK_SWING = Comparison(
    name="stick-swing",
    table=STICK.table,
    title=STICK.title,
    train=("laid_sheet-stick-swing-a",),
    tests=("laid_sheet-stick-swing-b",),
    entries=(*SIMPLE, TUNED, FULL, *LONGER),
)
