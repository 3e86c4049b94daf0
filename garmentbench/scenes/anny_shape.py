"""What Anny's rest shape lacks to be shown: eyes that belong to the skin, hands at ease.

Both move vertices only. Faces and vertex order stay, so that the skin remains one closed manifold.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from garmentbench.geometry.mesh import unique_edges, vertex_normals

_NEAR_EYE = 1.35  # the socket's skin is within so many radii of the eyeball's centre ...
_FACES_EYE = 0.4  # ... and faces it: cosine of its normal against the way there, at least
_SPREAD = 0.5  # an even drawing's distance from the middle, in parts of the whole, to this power
# Bend of a finger's three joints beyond the rest shape's [degrees], thumb first, and how much of its splay goes.
_CURL = {1: (0.0, 8.0, 12.0), 2: (9.0, 16.0, 10.0), 3: (13.0, 20.0, 12.0), 4: (16.0, 22.0, 12.0), 5: (18.0, 22.0, 12.0)}
_CLOSE = 0.6
_THUMB = 14.0  # the thumb comes nearer to the index finger by this [degrees]


@dataclass(frozen=True)
class Bones:
    """Anny's bones at rest.

    Attributes:
        names: Of the bones, B of them.
        heads: Where each begins [m], shape (B, 3).
        weights: Blend weights, rows sum to 1, shape (V, B).
    """

    names: list[str]
    heads: np.ndarray
    weights: np.ndarray


def relax_hands(vertices: np.ndarray, bones: Bones) -> np.ndarray:
    """The rest shape [m], shape (V, 3), with its fingers curled a little and closer together, as in hanging hands."""
    relaxed = vertices.copy()
    for side in "LR":
        for finger, curl in _CURL.items():
            relaxed += _moved(vertices, bones, *_finger(bones, side, finger, curl))
    return relaxed


def _finger(bones: Bones, side: str, finger: int, curl: tuple[float, float, float]) -> tuple[list[int], list[Rotation]]:
    """The bones of a finger, and how each is turned against its parent."""

    def head(name: str) -> np.ndarray:
        return bones.heads[bones.names.index(f"{name}.{side}")]

    chain = [bones.names.index(f"finger{finger}-{k}.{side}") for k in (1, 2, 3)]
    along = _unit(head("finger3-1") - head("wrist"))
    palm = _unit(np.cross(head("finger2-1") - head("finger5-1"), along)) * (1.0 if side == "L" else -1.0)
    first = _unit(bones.heads[chain[1]] - bones.heads[chain[0]])
    if finger == 1:
        index = _unit(head("finger2-2") - head("finger2-1"))
        nearer = Rotation.from_rotvec(np.radians(_THUMB) * _unit(np.cross(first, index)))
        hinge = _unit(np.cross(first, _unit(head("finger5-1") - head("finger1-2"))))
    else:
        middle = _unit(head("finger3-2") - head("finger3-1"))
        splay = np.arctan2(np.dot(np.cross(first, middle), palm), np.dot(first, middle))
        nearer = Rotation.from_rotvec(_CLOSE * splay * palm)
        hinge = _unit(np.cross(palm, first))
    bends = [Rotation.from_rotvec(np.radians(degrees) * hinge) for degrees in curl]
    return chain, [nearer * bends[0], *bends[1:]]


def _moved(vertices: np.ndarray, bones: Bones, chain: list[int], turns: list[Rotation]) -> np.ndarray:
    """By how much linear blend skinning moves each vertex, shape (V, 3)."""
    moved, turned, place = np.zeros_like(vertices), Rotation.identity(), bones.heads[chain[0]]
    for k, (bone, turn) in enumerate(zip(chain, turns, strict=True)):
        if k:
            place = place + turned.apply(bones.heads[bone] - bones.heads[chain[k - 1]])
        turned = turned * turn
        on = bones.weights[:, bone] > 0
        to = turned.apply(vertices[on] - bones.heads[bone]) + place
        moved[on] += bones.weights[on, bone, None] * (to - vertices[on])
    return moved


def close_over_eye(skin: np.ndarray, faces: np.ndarray, eyeball: np.ndarray) -> np.ndarray:
    """The skin [m], shape (S, 3), with the inside of a socket laid on the front of its eyeball, so that it is the eye.

    The socket is a disc round the back of the eyeball. Within the lids' rim it is spread out evenly (Tutte 1963, "How
    to draw a graph") on the eyeball's sphere.

    Args:
        skin: The closed skin, whose sockets are open [m].
        faces: Its triangles.
        eyeball: Vertices of the eyeball [m], shape (E, 3).
    """
    fitted = np.linalg.lstsq(np.column_stack([2 * eyeball, np.ones(len(eyeball))]), np.sum(eyeball**2, axis=1))[0]
    centre = fitted[:3]
    radius = np.sqrt(fitted[3] + centre @ centre)
    edges = unique_edges(faces)
    joined = sp.csr_matrix((np.ones(len(edges)), edges.T), (len(skin), len(skin)))
    joined = joined + joined.T
    socket = _socket(skin, faces, joined, centre, radius)
    rim = np.setdiff1d(np.flatnonzero(joined[socket].sum(axis=0)), socket)
    outward = _unit(skin[rim] - centre)
    axis = _unit(outward.mean(axis=0))
    right = _unit(np.cross(axis, [0.0, 0.0, 1.0]))
    across = np.stack([right, np.cross(right, axis)], axis=1)
    drawn = np.zeros((len(skin), 2))  # stereographic, seen from the eye's back
    drawn[rim] = outward @ across / (1 + outward @ axis)[:, None]
    even = sp.diags(np.asarray(joined.sum(axis=1)).ravel()) - joined
    evenly = spsolve(even[socket][:, socket].tocsc(), joined[socket][:, rim] @ drawn[rim])
    drawn[socket] = _apart(np.asarray(evenly), drawn[rim])
    square = np.sum(drawn[socket] ** 2, axis=1, keepdims=True)
    closed = skin.copy()
    closed[socket] = centre + radius * (2 * drawn[socket] @ across.T + (1 - square) * axis) / (1 + square)
    return closed


def _apart(points: np.ndarray, rim: np.ndarray) -> np.ndarray:
    """Points in a plane, shape (N, 2), moved outward: an even drawing of a deep bag crowds them in the middle."""
    middle = rim.mean(axis=0)
    angle, reach = np.arctan2(*(rim - middle).T), np.linalg.norm(rim - middle, axis=1)
    way = points - middle
    edge = np.interp(np.arctan2(*way.T), np.sort(angle), reach[np.argsort(angle)], period=2 * np.pi)
    share = np.maximum(np.linalg.norm(way, axis=1) / edge, 1e-9)
    return middle + way * (share ** (_SPREAD - 1))[:, None]


def _socket(
    skin: np.ndarray, faces: np.ndarray, joined: sp.csr_matrix, centre: np.ndarray, radius: float
) -> np.ndarray:
    """Vertices of the socket, sorted: what faces the eyeball from nearby and is one piece, without holes."""
    way = centre - skin
    distance = np.linalg.norm(way, axis=1)
    facing = np.sum(vertex_normals(skin, faces) * way, axis=1) > _FACES_EYE * distance
    near = np.flatnonzero(facing & (distance < _NEAR_EYE * radius))
    inside = np.zeros(len(skin), bool)
    inside[_largest(near, joined)] = True
    outside = np.flatnonzero(~inside)
    inside[np.setdiff1d(outside, _largest(outside, joined))] = True
    return np.flatnonzero(inside)


def _largest(vertices: np.ndarray, joined: sp.csr_matrix) -> np.ndarray:
    """Those of the vertices that are in their largest connected piece."""
    piece = connected_components(joined[vertices][:, vertices])[1]
    return vertices[piece == np.bincount(piece).argmax()]


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)
