"""Standing still, as people do: they breathe, and sway by a centimetre."""

import numpy as np

from garmentbench.motion.notation import Bearing, Hips, Score
from garmentbench.motion.steps import ALWAYS, Plant
from garmentbench.motion.variation import drift
from garmentbench.scenes.bodies import BakedBody

_BREATH = 4.0  # seconds


def still_score(baked: BakedBody, _: float) -> Score:
    """Standing on the feet's places of the rest pose."""
    feet = [baked.joints[baked.joint_names.index(f"foot.{side}")] for side in "LR"]
    left, right = ([Plant(-ALWAYS, ALWAYS, foot[0], foot[1])] for foot in feet)
    low = (-0.012, 0.0, 0.0)
    return Score(
        left, right, height=[(0.0, (0.0, 0.0, 0.0)), (0.4, low), (1.0, low)], bearing=_bearing, hips=Hips(0.0, 0.0)
    )


def _bearing(t: np.ndarray) -> Bearing:
    breath = np.sin(2 * np.pi * (t / _BREATH + 0.02 * drift(t / _BREATH, 0)))
    sway = drift(t / 3, 1)
    arms = {
        f"{name}.{side}": mean + share * breath + wander * drift(t / 3, k)
        for side, k in (("L", 2), ("R", 3))
        for name, mean, share, wander in (
            ("space", 24.0, 0.7, 0.5),
            ("swing", 2.0, 0.0, 1.0),
            ("elbow", 22.0, 0.0, 1.0),
        )
    }
    return arms | {
        "sway": 0.008 * sway, "surge": 0.006 * drift(t / 3, 4), "list": -0.6 * sway,
        "lean": 2.5 - 0.8 * breath + 0.5 * drift(t / 3, 4), "twist": 0.8 * drift(t / 4, 5),
        "look": 2.0 * drift(t / 4, 0),
    }  # fmt: skip
