"""The body that a garment is checked against: a baked one, or one from a file."""

from dataclasses import dataclass

import numpy as np

from garmentbench.scenes.bodies import body_names, load_body
from garmentbench.sequence import Body


@dataclass(frozen=True)
class Wearer:
    """A body, and what each of its vertices is called.

    Attributes:
        body: Its rest positions [m] and faces are used.
        parts: Name of the part of each vertex, e.g. "upper_arm.L", shape (B,); None where there are none.
    """

    body: Body
    parts: np.ndarray | None


def baked(name: str) -> Wearer:
    """A baked body at full size; a vertex is called after the bone that moves it most. Raises as `load_body`."""
    found = load_body(name, "full")
    return Wearer(found.body, np.array(found.joint_names)[found.weights.argmax(axis=1)])


def of_body(body: Body) -> Wearer:
    """A sequence's body."""
    return Wearer(body, None if body.labels is None else np.array(body.part_names)[body.labels])


def is_baked(name: str) -> bool:
    """Is that the name of a baked body?"""
    return name in body_names()
