"""The main table: the full model beside four simple baselines, T-shirt, trained on armspace-75, tested on armspace-90.

The T-shirt row of the paper's Table 3 is this experiment.
"""

from garmentbench.evals.experiment import FULL, SIMPLE, Experiment

BASELINES = Experiment(
    name="baselines",
    table="baselines",
    train="tshirt-armspace-75",
    tests=("tshirt-armspace-90",),
    entries=(*SIMPLE, FULL),
    needs=True,
)
