"""How many substeps a frame needs: from the stability bound of the integrator, never by hand."""

import math

from garmentbench.scenes.material import Material, Settings
from garmentbench.simulation.assembly import Fabric

DAMPING_RATIO = 0.3  # of the critical damping; the step is a quarter shorter than without
STAGE_MARGIN = 0.9


def stretch_damping(material: Material, stretch: float) -> float:
    """The damping time of stretch [s] that a fabric gets; its fastest mode has the squared frequency `stretch` [1/s^2].

    It is the material's, but damps that mode by no more than `DAMPING_RATIO`: beyond, a stiff fabric's damping would
    set the time step.
    """
    return min(material.stretch_damping, 2 * DAMPING_RATIO / math.sqrt(stretch)) if stretch > 0 else 0.0


def damping_stages(bend_damping: float, bend: float, interval: float) -> int:
    """Stages of `damping` that are stable over an interval [s] for bending of squared frequency `bend` [1/s^2]; 0 where
    nothing is damped.

    RKL2 with s stages is stable while rate times interval <= (s^2 + s - 2) / 2 (Meyer, Balsara and Aslam 2014, eq. 20).
    """
    if bend_damping * bend == 0:
        return 0
    stages = math.ceil((math.sqrt(9 + 8 * bend_damping * bend * interval / STAGE_MARGIN) - 1) / 2)
    return max(3, stages | 1)  # odd ones damp the fastest mode better


def substeps(fabric: Fabric, material: Material, settings: Settings, frame_time: float) -> int:
    """Substeps a frame, a multiple of `settings.queries`.

    One mode of frequency w and damping time t is stable in symplectic Euler, forces explicit, while
    dt^2 w^2 + 2 dt t w^2 < 4, which is dt < 2 (sqrt(1 + z^2) - z) / w with z = t w / 2. Stretch and bending add up;
    bending is damped apart from the substeps (`damping`).
    """
    stretch, bend = fabric.squared_frequencies
    square = stretch + bend
    damping = stretch_damping(material, stretch) * stretch
    if square == 0:
        return settings.queries * settings.substep_factor
    bound = (math.sqrt(damping**2 + 4 * square) - damping) / square
    least = frame_time / (settings.step_margin * bound)
    return settings.queries * math.ceil(least / settings.queries) * settings.substep_factor
