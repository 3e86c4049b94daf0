"""What is measured of a scene without predicting it: how much its garment moves, and how near codes can come."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from garmentbench import sequence_file
from garmentbench.evaluation.results import Row
from garmentbench.geometry.blend_skinning import Skin
from garmentbench.method import HISTORY
from garmentbench.methods.baselines.code_dynamics import CodeDynamics
from garmentbench.methods.baselines.linear_subspace import LinearSubspace
from garmentbench.metrics import Metric
from garmentbench.metrics.l2 import l2
from garmentbench.metrics.spread import SPREAD
from garmentbench.sequence import Sequence


def variation(canonical: Float[np.ndarray, "frames vertices 3"]) -> float:
    """How far a garment is from its own mean shape [cm], in the canonical pose: 100 / (T V) sum |c_ti - mean_t c_i|.

    What holds the mean shape errs about by so much. When it lies: what the body carries along is taken off by skinning,
    whose own errors are counted as motion.
    """
    return l2(canonical, np.broadcast_to(canonical.mean(axis=0), canonical.shape))


def pca_floor(method: CodeDynamics, sequence: Sequence) -> float:
    """The error [cm] of the best codes for a method's subspace, over the frames that a roll-out predicts.

    When it lies: it is a floor of methods with this basis of these training scenes, and of no other.
    """
    skin, errors = method.skin_of(sequence.template), []
    for t in range(HISTORY, len(sequence)):
        body = None if sequence.body is None else sequence.body[t]
        codes = method.garment.encode(skin.displacement(body, sequence.garment[t]).ravel())
        errors.append(l2(skin.pose(body, method.garment.decode(codes).reshape(-1, 3))[None], sequence.garment[t, None]))
    return float(np.mean(errors))


VARIATION = Metric("variation", "cm", "variation", variation)
PCA_FLOOR = Metric("pca_floor", "cm", "PCA floor", pca_floor)


def measured(path: Path, trained: Path) -> list[Row]:
    """Rows of a scene's sequence file; `trained` is the folder of a linear_subspace."""
    sequence, method = sequence_file.load(path), LinearSubspace.load(trained)
    skin = Skin.of(sequence.template, method.seeds, upright_objects=True)
    shapes = skin.displacement(sequence.body, sequence.garment)[HISTORY:]
    spread = sequence.spread_cm
    values = {VARIATION: variation(shapes), PCA_FLOOR: pca_floor(method, sequence)}
    values |= {} if spread is None else {SPREAD: spread}
    return [Row.of(metric, value, horizon=len(sequence)) for metric, value in values.items()]
