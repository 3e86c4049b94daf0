"""How the knee bends over a cycle of the walk, from which the pelvis' height follows."""

import numpy as np
from scipy.interpolate import CubicSpline

from garmentbench.motion.gait import Gait

# Phase and bend [degrees]: nearly straight at heel strike, giving way as the weight comes on (in parts of `knee_load`),
# straight again before the heel rises, then swinging through. Source: the sagittal knee angle at natural cadence of
# Winter 1991, "The Biomechanics and Motor Control of Human Gait", and Perry and Burnfield 2010, "Gait Analysis".
_AT_STRIKE = 3.5
_LOADED = ((0.04, 0.50), (0.08, 0.86), (0.12, 1.0), (0.16, 0.97), (0.22, 0.77), (0.30, 0.40), (0.38, 0.12))
_SWINGING = ((0.50, 10.0), (0.62, 38.0), (0.72, 60.0), (0.80, 45.0), (0.88, 14.0), (0.94, 4.0))


def knee_bend(gait: Gait) -> CubicSpline:
    """Bend of the knee [rad] by the leg's own phase (0: heel strike); periodic, C2."""
    loaded = [(phase, _AT_STRIKE + share * (gait.knee_load - _AT_STRIKE)) for phase, share in _LOADED]
    phase, bend = np.transpose([(0.0, _AT_STRIKE), *loaded, *_SWINGING, (1.0, _AT_STRIKE)])
    return CubicSpline(phase, np.radians(bend), bc_type="periodic")
