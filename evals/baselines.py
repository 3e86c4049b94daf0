"""The main table: the full model beside trivial and strong baselines, T-shirt, trained on armspace-75, tested on
armspace-90.

The T-shirt row of the paper's Table 3 is this experiment.
"""

from garmentbench.evals.comparison import Comparison
from garmentbench.evals.trial import FULL, SIMPLE, STRONG, TUNED

BASELINES = Comparison(
    name="baselines",
    table="baselines",
    title="Main table",
    train=("tshirt-armspace-75",),
    tests=("tshirt-armspace-90",),
    entries=(*SIMPLE, *STRONG, TUNED, FULL),
)
