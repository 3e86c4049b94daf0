"""What is seen of a run, a method's or a simulator's, frame by frame, and whether it is still cloth.

The rules are those of `garmentbench.evaluation.broken`, and a run's first bad frame is the first that breaks one:

    finite: a coordinate is not a finite number
    far:    a vertex is farther from the body's centre than the body is high
    strain: the 99th percentile of the absolute edge strain is above 100 %
    inside: more than 25 % of the vertices are inside the body
    speed:  the root mean square of the vertices' speed is above 0.5 m/s and above 3 times the body's fastest

A run that breaks one of the first two has diverged, one that breaks another is broken. Here the bounds are the same for
methods and simulators, and so don't go by a reference simulation, which may have blown up itself.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from garmentbench.evaluation.broken import INSIDE, SPEED, STRAIN, TIMES_SPEED
from garmentbench.evaluation.rollout import BROKEN, DIVERGED, FAILED, OK
from garmentbench.geometry.cloth_rest import cloth_at_rest, rest_lengths
from garmentbench.geometry.signed_distance import signed_distances
from garmentbench.method import HISTORY
from garmentbench.metrics.energy_left import LAST, energy_left
from garmentbench.metrics.liveliness import vertex_areas
from garmentbench.metrics.strain import strain_percentile
from garmentbench.sequence import Template

SAID = {
    "finite": "not finite",
    "far": "a vertex is {:.3g} m from the body's centre",
    "strain": "the 99th percentile of the strain is {:.0%}",
    "inside": "{:.0%} of the vertices are inside the body",
    "speed": "the vertices' speed is {:.3g} m/s, root mean square",
}
ENDS = ("finite", "far")  # rules of a run that has diverged


@dataclass(frozen=True)
class Outcome:
    """How a run went.

    Attributes:
        status: "ok", "broken", "diverged" or "failed".
        frames: How many there were to predict.
        first_bad_frame: The first that breaks a rule, or None.
        rule: That rule; empty where none is broken. "raised" where a method raised.
        message: What happened there.
        strain: The largest 99th percentile of the edges' strain in a frame before it ended [%].
        inside: The largest share of vertices inside the body likewise [%].
        energy: The largest kinetic energy of a frame, in any unit that is the same for all runs of a course.
        energy_left: Of its motion, when the body has come to rest [%]; None where it doesn't, or the run ended.
    """

    status: str
    frames: int
    first_bad_frame: int | None = None
    rule: str = ""
    message: str = ""
    strain: float | None = None
    inside: float | None = None
    energy: float | None = None
    energy_left: float | None = None

    @property
    def survived(self) -> int:
        """Predicted frames before the first bad one."""
        return self.frames if self.first_bad_frame is None else self.first_bad_frame - HISTORY


def judged(
    garment: Float[np.ndarray, "frames vertices 3"],
    bodies: Float[np.ndarray, "frames body 3"],
    template: Template,
    rest_from: int | None = None,
    raised: str = "",
) -> Outcome:
    """How a run went.

    Args:
        garment: [m], shape (T, V, 3), its history included, which isn't judged.
        bodies: [m], shape (T, B, 3).
        template: What doesn't move.
        rest_from: The frame from which the body comes to rest.
        raised: What a method raised; where it did the frames from then on are not finite.
    """
    ends, count = whole(garment, bodies, template), len(garment)
    seen = slice(HISTORY, ends)  # what can be measured
    strain = strain_percentile(garment[seen], *rest_lengths(template.garment), 99)
    inside = _inside(garment[seen], bodies[seen], template)
    speed = template.fps * _moved(garment[HISTORY - 1 : ends])
    fastest = max(SPEED, TIMES_SPEED * template.fps * float(_moved(bodies).max()))
    broken = {
        "strain": (strain, strain > STRAIN),
        "inside": (inside, inside > INSIDE),
        "speed": (speed, speed > fastest),
    }
    found = [(HISTORY + int(np.argmax(bad)), rule) for rule, (_, bad) in broken.items() if bad.any()]
    if ends < count:
        away = _away(garment[ends], bodies[ends])
        found.append((ends, "raised" if raised else "far" if np.isfinite(away) else "finite"))
    frame, rule = min(found, key=lambda f: f[0]) if found else (None, "")
    if frame is None:
        message = ""
    elif rule == "raised":
        message = raised
    else:
        values = broken[rule][0][frame - HISTORY] if rule in broken else _away(garment[frame], bodies[frame])
        message = SAID[rule].format(values)
    ended = ends < count
    status = FAILED if raised else DIVERGED if ended else BROKEN if found else OK
    return Outcome(
        status,
        count - HISTORY,
        frame,
        rule,
        message,
        strain=_largest(100 * strain),
        inside=_largest(100 * inside),
        energy=largest_energy(garment[:ends], template),
        energy_left=None if ended else _left(garment, rest_from, template),
    )


def whole(garment: np.ndarray, bodies: np.ndarray, template: Template) -> int:
    """Frames before the first in which a run has diverged, its history not looked at; arguments as for `judged`."""
    height = float(np.ptp(template.required_body.rest[:, 2]))
    ends = (t for t in range(HISTORY, len(garment)) if not _away(garment[t], bodies[t]) <= height)
    return next(ends, len(garment))


def largest_energy(garment: Float[np.ndarray, "frames vertices 3"], template: Template) -> float | None:
    """The largest kinetic energy of a predicted frame, in any unit; None where there is none."""
    mass = vertex_areas(cloth_at_rest(template.garment), template.garment.faces)
    moved = (np.square(b - a, dtype=np.float64).sum(axis=-1) for a, b in pairwise(garment[HISTORY - 1 :]))
    return _largest(np.array([m @ mass for m in moved]))


def _away(garment: np.ndarray, body: np.ndarray) -> float:
    """How far the farthest vertex of a frame is from the body's centre [m]; not finite where a vertex isn't."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.linalg.norm(garment.astype(np.float64) - body.mean(axis=0, dtype=np.float64), axis=1).max())


def _inside(garment: np.ndarray, bodies: np.ndarray, template: Template) -> Float[np.ndarray, " frames"]:
    if not len(garment):
        return np.zeros(0)
    return np.mean(signed_distances(garment, bodies, template.required_body.faces) < 0, axis=1)


def _moved(points: np.ndarray) -> Float[np.ndarray, " frames-1"]:
    """Root mean square of the points' ways from frame to frame [m]."""
    return np.array([np.sqrt(np.square(b - a, dtype=np.float64).sum(axis=1).mean()) for a, b in pairwise(points)])


def _left(garment: np.ndarray, rest_from: int | None, template: Template) -> float | None:
    """Energy that is left [%] when the body has come to rest; None where it doesn't, or not for long enough."""
    if rest_from is None or len(garment) <= rest_from + LAST:
        return None
    mass = vertex_areas(cloth_at_rest(template.garment), template.garment.faces)
    left = energy_left(garment, rest_from, mass)
    return left if np.isfinite(left) else None


def _largest(values: np.ndarray) -> float | None:
    return float(values.max()) if len(values) else None
