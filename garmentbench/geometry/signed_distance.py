"""Signed distance of points to a body's surface, negative inside.

The sign is that of the face's normal where the nearest point is inside a face, else of the angle-weighted normal there
(Baerentzen and Aanaes 2005); both are exact for closed surfaces. In float32 the second is wrong for about 3 vertices in
a million, where faces of a crease are almost equally near; so it is asked for with two tolerances, and where the two
disagree the winding number decides. A garment beneath is open: what is nearest to its border, and beside it rather than
behind it, is outside.
"""

import numpy as np
import warp as wp
from jaxtyping import Bool, Float, Int

from garmentbench.geometry.mesh import border_vertices, lengths, unique_edges
from garmentbench.geometry.side import side
from garmentbench.geometry.triangle import distance_to_face

_FARTHEST = 1e4  # [m] search radius: everything
_INSIDE = wp.constant(0.01)  # the least barycentric coordinate of what is inside a face beyond doubt


def signed_distances(
    garment: Float[np.ndarray, "frames vertices 3"],
    body: Float[np.ndarray, "frames body_vertices 3"],
    body_faces: Int[np.ndarray, "faces 3"],
    wanted: Bool[np.ndarray, "frames vertices"] | None = None,
) -> Float[np.ndarray, "frames vertices"]:
    """Signed distance of garment vertices to the body's surface, negative inside.

    Args:
        garment: [m], shape (T, V, 3), finite.
        body: [m], shape (T, B, 3).
        body_faces: Shape (K, 3), outward orientation.
        wanted: Which are asked for, shape (T, V); the others are +inf. None: all.

    Returns:
        [m], float32, shape (T, V).
    """
    centre = body.mean(axis=1, keepdims=True)  # float32 has most digits near 0
    garment, body = garment - centre, body - centre
    out = np.empty(garment.shape[:2], np.float32)
    border = np.zeros(body.shape[1], np.int32)
    border[border_vertices(body_faces)] = 1
    with wp.ScopedDevice("cpu"):
        points = wp.array(body[0], dtype=wp.vec3)
        mesh = wp.Mesh(points, wp.array(body_faces.ravel(), dtype=wp.int32))
        distances = wp.empty(garment.shape[1], dtype=float)
        near, asked = (wp.full(garment.shape[1], value, dtype=int) for value in (-1, 1))
        ends, closed = wp.array(border, dtype=int), not border.any()
        for t in range(len(out)):
            points.assign(body[t])
            mesh.refit()
            points_now = wp.array(garment[t], dtype=wp.vec3)
            asked.assign(np.ones(len(asked)) if wanted is None else wanted[t])
            inputs = [mesh.id, len(body_faces), ends, closed, points_now, asked, near]
            wp.launch(_query, len(distances), inputs, [distances])
            out[t] = distances.numpy()
    return out


def signed_distances_between(
    garment: Float[np.ndarray, "frames vertices 3"],
    faces: Int[np.ndarray, "garment_faces 3"],
    distances: Float[np.ndarray, "frames vertices"],
    body: Float[np.ndarray, "frames body_vertices 3"],
    body_faces: Int[np.ndarray, "faces 3"],
) -> Float[np.ndarray, "frames points"]:
    """Signed distance of the middles of a garment's edges, then of the centres of its faces, negative inside.

    A distance falls by no more than the way gone; where a corner is farther outside than from the point in question,
    that point is outside too, and its distance isn't asked for.

    Args:
        garment: [m], shape (T, V, 3), finite.
        faces: Its faces, shape (F, 3).
        distances: Of its vertices, as `signed_distances` gives them, shape (T, V).
        body, body_faces: As for `signed_distances`.

    Returns:
        [m], float32, shape (T, E + F); +inf where it isn't asked for.
    """
    points, wanted = [], []
    for corners in (unique_edges(faces).T, faces.T):
        at = sum(garment[:, corner] for corner in corners) / np.float32(len(corners))
        points.append(at)
        near = [distances[:, corner] <= lengths(garment[:, corner] - at) for corner in corners]
        wanted.append(np.logical_and.reduce(near))
    return signed_distances(np.concatenate(points, 1), body, body_faces, np.concatenate(wanted, 1))


@wp.func
def _winding_number(mesh: wp.uint64, face_count: int, point: wp.vec3) -> float:
    """How often the surface goes round a point.

    The sum of its faces' solid angles over 4 pi (van Oosterom and Strackee 1983).
    """
    angle = float(0.0)
    for face in range(face_count):
        a = wp.mesh_get_point(mesh, 3 * face) - point
        b = wp.mesh_get_point(mesh, 3 * face + 1) - point
        c = wp.mesh_get_point(mesh, 3 * face + 2) - point
        la, lb, lc = wp.length(a), wp.length(b), wp.length(c)
        below = la * lb * lc + wp.dot(a, b) * lc + wp.dot(b, c) * la + wp.dot(c, a) * lb
        angle += 2.0 * wp.atan2(wp.dot(a, wp.cross(b, c)), below)
    return angle / (4.0 * wp.pi)


@wp.kernel
def _query(
    mesh: wp.uint64,
    face_count: int,
    border: wp.array[int],
    closed: bool,
    points: wp.array[wp.vec3],
    asked: wp.array[int],
    near: wp.array[int],
    distances: wp.array[float],
):
    """asked: 0 where the distance isn't wanted.

    near: the nearest face in the frame before, which bounds the search; -1: not known."""
    i = wp.tid()
    if asked[i] == 0:
        near[i] = -1
        distances[i] = wp.inf
        return
    reach = float(_FARTHEST)
    if near[i] >= 0:
        reach = 1.01 * distance_to_face(mesh, near[i], points[i]) + 1.0e-3
    hit = wp.mesh_query_point_no_sign(mesh, points[i], reach)
    offset = points[i] - wp.mesh_eval_position(mesh, hit.face, hit.u, hit.v)
    sign = wp.where(wp.dot(offset, wp.mesh_eval_face_normal(mesh, hit.face)) > 0.0, 1.0, -1.0)
    if wp.min(wp.min(hit.u, hit.v), 1.0 - hit.u - hit.v) < _INSIDE:
        reach = 1.00001 * wp.length(offset) + 1.0e-4
        hit = wp.mesh_query_point_sign_normal(mesh, points[i], reach, 1.0e-3)
        again = wp.mesh_query_point_sign_normal(mesh, points[i], reach, 1.0e-5)
        offset = points[i] - wp.mesh_eval_position(mesh, hit.face, hit.u, hit.v)
        sign = side(mesh, border, hit, offset)
        if closed and hit.sign != again.sign:
            sign = 1.0 - 2.0 * wp.round(wp.min(wp.abs(_winding_number(mesh, face_count, points[i])), 1.0))
    near[i] = hit.face
    distances[i] = sign * wp.length(offset)
