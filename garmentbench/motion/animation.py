"""What a motion makes: the moving body, warm-up first."""

from dataclasses import dataclass

import numpy as np

from garmentbench.sequence import Body


@dataclass(frozen=True)
class Animation:
    """A moving body.

    Attributes:
        body: Its template.
        positions: Vertex positions [m], shape (warm_up + T, B, 3), float64, one a frame.
        warm_up: Frames before frame 0. The first of them is the rest pose, in which the garment is put on.
    """

    body: Body
    positions: np.ndarray
    warm_up: int
