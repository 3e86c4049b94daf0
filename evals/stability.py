"""The stress ladder: stiff cloth, fast, frozen, pushed, heavy and far-away bodies, for simulator and methods alike.

The methods are the ones trained for the main table, on nothing of all this.
"""

from evals.experiment import FULL, Entry, Experiment

CASES = ("stiff-10", "stiff-100", "speed-2", "speed-4", "frozen", "push", "heavy", "far")

STABILITY = Experiment(
    name="stability",
    table="stability",
    train="tshirt-armspace-75",
    tests=tuple(f"stress-{case}" for case in CASES),
    entries=(Entry("skinning"), Entry("linear_subspace"), FULL),
    simulator=True,
)
