"""A garment as what another one is worn over: the paper's two-layer outfits treat the inner garment as the body."""

import numpy as np

from garmentbench.geometry.weld import weld
from garmentbench.sequence import GARMENT, Body, Garment


def as_body(garment: Garment) -> Body:
    """The garment as the template of a body: sewn along its seams, so that they are no borders."""
    particle, _ = weld(len(garment.rest), garment.seams)
    return Body(garment.name, sewn(garment, garment.rest), particle[garment.faces].astype(np.int32), kind=GARMENT)


def sewn(garment: Garment, positions: np.ndarray) -> np.ndarray:
    """Of a garment's vertices [m], shape (..., V, 3), those that `as_body` keeps, in its order.

    One of each seam point.
    """
    particle, _ = weld(len(garment.rest), garment.seams)
    return positions[..., np.unique(particle, return_index=True)[1], :]
