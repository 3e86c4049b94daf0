"""A garment's mesh made finer without changing its shape: every triangle becomes four, by the middles of its edges."""

from dataclasses import replace

import numpy as np

from garmentbench.geometry.weld import weld
from garmentbench.sequence import Garment


def subdivided(garment: Garment) -> Garment:
    """The garment with a vertex in the middle of every edge.

    The first V vertices are the coarse ones, in their order, so that a fine vertex's position is compared with a coarse
    one's without any mapping. The rest surface is the same, its facets included. An edge whose two ends are joined by
    seams to those of another gets a seam in its middle; one between two pins gets a pin.
    """
    count, cut = len(garment.rest), garment.cut
    edges, middle_of = _edges(garment.faces)
    middles = count + np.arange(len(edges), dtype=np.int32)
    ab, bc, ca = count + middle_of.reshape(3, -1).astype(np.int32)
    a, b, c = garment.faces.T
    faces = np.concatenate([np.stack(f, axis=1) for f in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    pinned = np.isin(edges, garment.pins).all(axis=1)
    return replace(
        garment,
        rest=np.concatenate([garment.rest, garment.rest[edges].mean(axis=1)]).astype(np.float32),
        faces=faces.astype(np.int32),
        uv=np.concatenate([garment.uv, garment.uv[edges].mean(axis=1)]).astype(np.float32),
        seams=np.concatenate([garment.seams, _middle_seams(edges, middles, garment.seams, count)]).astype(np.int32),
        pins=np.concatenate([garment.pins, middles[pinned]]).astype(np.int32),
        cut=None if cut is None else np.concatenate([cut, cut[edges].mean(axis=1)]).astype(np.float32),
    )


def _edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Undirected edges, shape (E, 2), and the edge of each triangle's sides ab, bc, ca, shape (3 F,)."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges, index = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    return edges, index.ravel()


def _middle_seams(edges: np.ndarray, middles: np.ndarray, seams: np.ndarray, count: int) -> np.ndarray:
    """Pairs of middles, shape (S, 2), of edges that are the same line of cloth: both their ends are joined by seams."""
    particle, _ = weld(count, seams)
    lines = np.sort(particle[edges], axis=1)
    _, first, line = np.unique(lines, axis=0, return_index=True, return_inverse=True)
    same = first[line.ravel()]  # the first edge on each edge's line
    others = np.flatnonzero(same != np.arange(len(edges)))
    return np.stack([middles[same[others]], middles[others]], axis=1)
