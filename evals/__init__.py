"""The experiments: one file each, declarations over the shared layer. `EXPERIMENTS` lists them by name, `STUDIES` those of the
reference itself, which run only when they are named."""

from garmentbench.evals.ablations import ABLATIONS
from garmentbench.evals.baselines import BASELINES
from garmentbench.evals.convergence.study import STUDY as CONVERGENCE
from garmentbench.evals.crosscheck.study import STUDY as CROSSCHECK
from garmentbench.evals.experiment import Experiment
from garmentbench.evals.motions.study import STUDY as MOTIONS
from garmentbench.evals.stability import STABILITY
from garmentbench.evals.stick import STICK
from garmentbench.evals.study import Study
from garmentbench.evals.wardrobe import WARDROBE

EXPERIMENTS: dict[str, Experiment] = {e.name: e for e in (BASELINES, STICK, *ABLATIONS, *WARDROBE, STABILITY)}
STUDIES: dict[str, Study] = {s.name: s for s in (MOTIONS, CONVERGENCE, CROSSCHECK)}
