"""The experiments: one file each, declarations over the shared layer. `EXPERIMENTS` lists them by name."""

from evals.ablations import ABLATIONS
from evals.baselines import BASELINES
from evals.experiment import Experiment
from evals.stability import STABILITY
from evals.stick import STICK

EXPERIMENTS: dict[str, Experiment] = {e.name: e for e in (BASELINES, STICK, *ABLATIONS, STABILITY)}
