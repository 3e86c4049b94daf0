"""The experiments: one file each, declarations over the shared layer. `EXPERIMENTS` lists them by name, `STUDIES` those of the
reference itself, which run only when they are named."""

from evals.ablations import ABLATIONS
from evals.baselines import BASELINES
from evals.convergence import STUDY as CONVERGENCE
from evals.crosscheck import STUDY as CROSSCHECK
from evals.experiment import Experiment
from evals.motions import STUDY as MOTIONS
from evals.stability import STABILITY
from evals.stick import STICK
from evals.study import Study
from evals.wardrobe import WARDROBE

EXPERIMENTS: dict[str, Experiment] = {e.name: e for e in (BASELINES, STICK, *ABLATIONS, *WARDROBE, STABILITY)}
STUDIES: dict[str, Study] = {s.name: s for s in (MOTIONS, CONVERGENCE, CROSSCHECK)}
