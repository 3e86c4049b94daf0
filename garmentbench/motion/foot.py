"""How a foot rolls: heel strike, flat, push-off over the ball, swing; on the ground it neither slides nor sinks in."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BPoly, CubicSpline
from scipy.ndimage import gaussian_filter1d

from garmentbench.motion.easing import bump, cyclic_steps, smoothstep
from garmentbench.motion.gait import Gait
from garmentbench.scenes.bodies import BakedBody

FLAT = 0.25  # a phase at which the foot is flat
HEEL_OFF = 0.39
CLEARANCE = 0.035  # lowest point of the foot in mid-swing [m]
_GRID = 720  # phases at which the rolling is worked out
_BLUR = 6.0  # the contact jumps from vertex to vertex: smoothed over this many grid phases (a quarter of a frame)


@dataclass(frozen=True)
class FootRoll:
    """A foot's cycle, relative to where it would stand flat. All are functions of its own phase (0: heel strike).

    Attributes:
        gait: Whose heel strike and push-off.
        forward: Ankle, forward of its place when flat [m]; periodic.
        height: Ankle above the ground [m]; periodic.
    """

    gait: Gait
    forward: CubicSpline
    height: CubicSpline

    def pitch(self, phase: np.ndarray) -> np.ndarray:
        """Pitch of the foot, toes up [rad]."""
        return foot_pitch(self.gait, phase)

    def bend(self, phase: np.ndarray) -> np.ndarray:
        """Bend of the toes against the foot, up [rad]."""
        return toe_bend(self.gait, phase)


def foot_pitch(gait: Gait, phase: np.ndarray) -> np.ndarray:
    """Pitch of the foot against the ground, toes up [rad]; exactly 0 between foot-flat and heel-off."""
    strike, push = np.radians(gait.heel_strike), np.radians(gait.push_off)
    off = gait.stance
    return strike + cyclic_steps(
        phase, ((-0.03, 0.10, -strike), (HEEL_OFF, off + 0.10, -push), (off, 0.97, strike + push))
    )


def toe_bend(gait: Gait, phase: np.ndarray) -> np.ndarray:
    """Bend of the toes [rad]: they stay flat under the rising heel, and straighten after they left the ground."""
    straightened = smoothstep((phase - np.floor(phase) - (gait.stance - 0.04)) / 0.2)
    return np.maximum(-foot_pitch(gait, phase), 0.0) * (1 - straightened)


def roll_foot(baked: BakedBody, gait: Gait) -> FootRoll:
    """Work out a cycle from the sole of the left foot.

    On the ground the lowest vertex is at height 0 and stands still, so the ankle moves against it. In swing the lowest
    vertex is lifted, and the ankle is brought back to where the next roll begins.
    """
    phase = np.arange(_GRID + 1) / _GRID
    pitch = foot_pitch(gait, phase)
    points = sole(baked, pitch, toe_bend(gait, phase))
    lowest = points[:, :, 2].argmin(axis=1)
    needed = -points[:, :, 2].min(axis=1) + CLEARANCE * bump((phase - gait.stance) / (1 - gait.stance)) ** 0.75
    height = _smooth(needed)
    sunk_in = (needed - height).max()  # under 1 mm, by the smoothing; the flat foot stands as at rest
    height += sunk_in * smoothstep(np.abs(pitch) / np.radians(5))

    frames = np.arange(_GRID)
    contact_moves = points[frames, lowest[:-1], 1] - points[frames + 1, lowest[:-1], 1]  # forward is -y
    forward = -np.concatenate([[0.0], np.cumsum(contact_moves)])
    last = round(gait.stance * _GRID)
    lifted = [forward[last], (forward[last] - forward[last - 1]) * _GRID, 0.0]
    landed = [forward[0], (forward[1] - forward[0]) * _GRID, 0.0]
    forward[last:] = BPoly.from_derivatives([phase[last], 1.0], [lifted, landed])(phase[last:])
    forward = _smooth(forward)
    return FootRoll(
        gait,
        forward=CubicSpline(phase, forward - forward[round(FLAT * _GRID)], bc_type="periodic"),
        height=CubicSpline(phase, height, bc_type="periodic"),
    )


def sole(baked: BakedBody, pitch: np.ndarray, bend: np.ndarray) -> np.ndarray:
    """The left foot's lower vertices relative to the ankle, shape (phases, vertices, 3)."""
    ankle, toes = (baked.joint_names.index(name) for name in ("foot.L", "toes.L"))
    weight = baked.weights[:, [ankle, toes]]
    kept = (weight.sum(axis=1) > 0.99) & (baked.body.rest[:, 2] < baked.joints[ankle, 2])
    rest = baked.body.rest[kept].astype(np.float64)
    bone = baked.joints[toes] - baked.joints[ankle]
    by_foot = (rest - baked.joints[ankle]) @ pitch_up(pitch).swapaxes(1, 2)
    by_toes = (rest - baked.joints[toes]) @ pitch_up(pitch + bend).swapaxes(1, 2)
    by_toes += (pitch_up(pitch) @ bone)[:, None]
    share = weight[kept, 1] / weight[kept].sum(axis=1)
    return by_foot + share[:, None] * (by_toes - by_foot)


def pitch_up(angle: np.ndarray) -> np.ndarray:
    """Rotations that lift what points forward (-y), shape (..., 3, 3)."""
    c, s, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.stack([one, zero, zero, zero, c, s, zero, -s, c], axis=-1).reshape(*np.shape(angle), 3, 3)


def _smooth(values: np.ndarray) -> np.ndarray:
    """Smoothed over a cycle whose last value is the first."""
    smooth = gaussian_filter1d(values[:-1], _BLUR, mode="wrap")
    return np.append(smooth, smooth[0])
