"""Broken: a roll-out that ran to its end and is no longer cloth.

A frame is broken where one of three holds:

    strain: the 99th percentile of the absolute edge strain is above 100 % and above twice the reference's largest
    inside: the share of vertices inside the body (`interpenetration_strict`) is 25 points above the reference's largest
    speed:  the root mean square of the vertices' speed is above 0.5 m/s and above 3 times the reference's largest

Between "ok" and "diverged": its numbers stay in the tables, marked, with the first such frame and the rule that it
broke, and they don't compete.

When it lies. The reference's largest values are those of the whole scene, so a roll-out may be wild in a calm part of a
wild one. What leaps away in the first predicted frame and then stays there is judged by its strain alone. A garment
that is stretched by half, or a tenth of which is behind the skin for a frame, is bad and not broken: read strain and
inside themselves. (At those bounds, tried first, skinning was broken on every skirt, and each linear method somewhere
on the T-shirt's walk; what nearly everybody has tells nothing.)
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from garmentbench.evaluation.rollout import BROKEN, OK, RollOut
from garmentbench.geometry.cloth_rest import rest_lengths
from garmentbench.metrics.metric import Motion, has_inside
from garmentbench.metrics.strain import strain_percentile

STRAIN, TIMES_STRAIN = 1.0, 2.0
INSIDE = 0.25
SPEED, TIMES_SPEED = 0.5, 3.0  # [m/s]


def judged(roll: RollOut, motion: Motion) -> RollOut:
    """A free roll-out that came to its end, "broken" from its first broken frame on where there is one.

    Args:
        roll: The roll-out.
        motion: Its predicted frames.
    """
    if roll.status != OK:
        return roll
    found = [
        (int(np.argmax(bad)), rule, float(value[np.argmax(bad)])) for rule, bad, value in _rules(motion) if bad.any()
    ]
    if not found:
        return roll
    frame, rule, value = min(found)
    return replace(roll, status=BROKEN, first_bad_frame=roll.start + frame, message=_SAID[rule].format(value))


_SAID = {
    "strain": "the 99th percentile of the strain is {:.0%}",
    "inside": "{:.0%} of the vertices are inside the body",
    "speed": "the vertices' speed is {:.1f} m/s, root mean square",
}


def _rules(motion: Motion) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Each rule, which frames break it, shape (T,), and the value that it is about, shape (T,)."""
    truth = motion.truth
    strain, usual = _strain(motion), _strain(truth)
    yield "strain", strain > max(STRAIN, TIMES_STRAIN * usual.max()), strain
    if has_inside(motion):
        inside = np.mean(motion.distances < 0, axis=1)
        if inside.max() > INSIDE:  # else nobody has to ask for the reference's, which takes time
            yield "inside", inside > INSIDE + np.mean(truth.distances < 0, axis=1).max(), inside
    if len(motion.predicted) > 1:
        speed, usual = _speed(motion), _speed(truth)
        yield "speed", speed > max(SPEED, TIMES_SPEED * usual.max()), speed


def _strain(motion: Motion) -> Float[np.ndarray, " frames"]:
    return strain_percentile(motion.predicted, *rest_lengths(motion.template.garment), 99)


def _speed(motion: Motion) -> Float[np.ndarray, " frames"]:
    """Of each frame's vertices since the frame before [m/s]; 0 in the first."""
    moved = np.diff(motion.predicted, axis=0).astype(np.float64)
    return np.concatenate([[0.0], motion.template.fps * np.sqrt((moved**2).sum(axis=2).mean(axis=1))])
