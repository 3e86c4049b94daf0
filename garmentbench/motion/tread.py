"""How a foot rolls over the floor at any pitch: where its ankle is, so that what touches the floor stands still."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d

from garmentbench.motion.foot import sole
from garmentbench.scenes.bodies import BakedBody

_PITCHES = np.radians(np.arange(-85.0, 45.25, 0.25))
_BLUR = 8.0  # the contact jumps from vertex to vertex: smoothed over this many steps of pitch (2 degrees)
_CHUNK = 512  # pitches at which the sole is worked out at once


@dataclass(frozen=True)
class Tread:
    """A body's foot on the floor.

    Attributes:
        baked: The body.
        rolled: By pitch [rad]: the ankle, forward of its place when flat [m], on a foot that rolls without sliding.
        ball: From the ankle to the ball of the flat left foot, over the floor [m], shape (2,).
        ankle: Height of the ankle above the floor when the foot is flat [m].
    """

    baked: BakedBody
    rolled: CubicSpline
    ball: np.ndarray
    ankle: float

    def height(self, pitch: np.ndarray, bend: np.ndarray) -> np.ndarray:
        """Ankle [m] above the floor at which the lowest point of the foot touches it, shape (T,)."""
        lowest = [
            sole(self.baked, pitch[i : i + _CHUNK], bend[i : i + _CHUNK])[:, :, 2].min(axis=1)
            for i in range(0, len(pitch), _CHUNK)
        ]
        return -np.concatenate(lowest)


def tread(baked: BakedBody) -> Tread:
    """Work it out from the sole of the left foot, whose toes stay flat under a rising heel."""
    points = sole(baked, _PITCHES, np.maximum(-_PITCHES, 0.0))
    lowest = points[:, :, 2].argmin(axis=1)
    at = np.arange(len(_PITCHES) - 1)
    moves = points[at, lowest[:-1], 1] - points[at + 1, lowest[:-1], 1]  # forward is -y
    forward = gaussian_filter1d(-np.concatenate([[0.0], np.cumsum(moves)]), _BLUR, mode="nearest")
    rolled = CubicSpline(_PITCHES, forward - np.interp(0.0, _PITCHES, forward))
    ankle, toes = (baked.joints[baked.joint_names.index(name)] for name in ("foot.L", "toes.L"))
    flat = -float(sole(baked, np.zeros(1), np.zeros(1))[0, :, 2].min())
    return Tread(baked, rolled, (toes - ankle)[:2], flat)
