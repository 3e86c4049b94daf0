"""The experiments, in the report's order.

One file or folder each, with what it computes, its table and its pictures.
"""

from garmentbench.evals.ablations import ABLATIONS, TRAINING_LENGTHS, TUNED_PARTS
from garmentbench.evals.baselines import BASELINES
from garmentbench.evals.contact_sheets.study import SHEETS
from garmentbench.evals.convergence.study import STUDY as CONVERGENCE
from garmentbench.evals.crosscheck.study import STUDY as CROSSCHECK
from garmentbench.evals.data import CARDS
from garmentbench.evals.difficulty.study import STUDY as DIFFICULTY
from garmentbench.evals.error_time.study import STUDY as ERROR_TIME
from garmentbench.evals.error_time.study import WHOLE as ERROR_TIME_WHOLE
from garmentbench.evals.experiment import Companion, Experiment
from garmentbench.evals.fabrics.study import STUDY as FABRICS
from garmentbench.evals.left_out.study import LEAVING_OUT, LEAVING_OUT_WHOLE
from garmentbench.evals.motions.study import STUDY as MOTIONS
from garmentbench.evals.stability.study import STABILITY
from garmentbench.evals.stability.study import WHOLE as WHOLE_LADDER
from garmentbench.evals.stick import STICK, STICK_SWING
from garmentbench.evals.training_data.study import STUDY as TRAINING_DATA
from garmentbench.evals.validation.study import STUDY as VALIDATION
from garmentbench.evals.wardrobe import WARDROBE

EXPERIMENTS: dict[str, Experiment] = {
    e.name: e
    for e in (
        BASELINES,
        ERROR_TIME,
        ERROR_TIME_WHOLE,
        DIFFICULTY,
        STICK,
        STICK_SWING,
        *ABLATIONS,
        *WARDROBE,
        TRAINING_LENGTHS,
        TUNED_PARTS,
        TRAINING_DATA,
        STABILITY,
        WHOLE_LADDER,
        SHEETS,
        MOTIONS,
        VALIDATION,
        FABRICS,
        CONVERGENCE,
        CROSSCHECK,
        LEAVING_OUT,
        LEAVING_OUT_WHOLE,
        CARDS,
    )
}
COMPANIONS: tuple[Companion, ...] = (SHEETS, CARDS)
