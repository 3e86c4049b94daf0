"""Skill: how much better than skinning.

    skill = 1 - error / (skinning's error on the same frames)    [1]

1 is perfect, 0 no better than linear skinning of the rest garment, negative worse. Scores of different garments and
motions can be set side by side, which centimetres can't.

When it lies. Where the garment hardly moves on the body skinning is nearly right and skill is noise over noise; where
skinning is hopeless everything has skill. It inherits what is said of `l2`.
"""

from garmentbench.metrics.metric import Metric


def skill(error: float, skinning_error: float) -> float:
    """Skill of an error against skinning's, both in the same unit; NaN where skinning makes no error."""
    return 1 - error / skinning_error if skinning_error > 0 else float("nan")


SKILL = Metric("skill", "1", "skill", skill, best="high")
