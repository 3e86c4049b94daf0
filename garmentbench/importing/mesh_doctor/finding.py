"""What the doctor found: a problem, and the places to mark in a picture."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from garmentbench.errors import Problem

_LISTED = 5  # indices named in a message


@dataclass(frozen=True)
class Finding:
    """A problem and where it is.

    Attributes:
        problem: What, how many, where, what to do.
        vertices: Vertices to mark, shape (N,).
        edges: Vertex pairs to mark, shape (N, 2).
        faces: Faces to mark, shape (N,).
        in_uv: The faces are marked in the UV map, not on the garment.
    """

    problem: Problem
    vertices: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    edges: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    faces: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    in_uv: bool = False


def listed(indices: np.ndarray | Sequence) -> str:
    """The first few indices, or pairs of them.

    >>> listed([3, 7]), listed([[1, 2]] * 9)
    ('3, 7', '1-2, 1-2, 1-2, 1-2, 1-2 ...')
    """
    named = ["-".join(map(str, np.atleast_1d(i).tolist())) for i in indices[:_LISTED]]
    return ", ".join(named) + (" ..." if len(indices) > _LISTED else "")
