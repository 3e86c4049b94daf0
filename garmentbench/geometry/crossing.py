"""Which faces of a garment cross others.

Two triangles cross where an edge of one goes through the inside of the other (a segment has its ends on both sides of
the plane and passes all three edges on the same side; signs of 3 x 3 determinants, in float64). The two sides of a seam
are one point of cloth.
"""

import numpy as np
import warp as wp
from jaxtyping import Bool, Float, Int


def crossing_faces(
    garment: Float[np.ndarray, "frames vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    seams: Int[np.ndarray, "seams 2"],
) -> Bool[np.ndarray, "frames faces"]:
    """Which faces cross another one that shares no point of cloth with them.

    Args:
        garment: [m], shape (T, V, 3), finite.
        faces: Shape (F, 3).
        seams: Pairs of vertices that are the same point of cloth, shape (S, 2).

    Returns:
        bool, shape (T, F).
    """
    garment = garment - garment.mean(axis=1, keepdims=True)  # float32 has most digits near 0
    out = np.zeros((len(garment), len(faces)), bool)
    with wp.ScopedDevice("cpu"):
        points, cloth = (
            wp.array(garment[0], dtype=wp.vec3),
            wp.array(_cloth(garment.shape[1], faces, seams), dtype=wp.vec3i),
        )
        mesh = wp.Mesh(points, wp.array(faces.astype(np.int32).ravel(), dtype=int))
        for t, frame in enumerate(garment):
            points.assign(frame)
            mesh.refit()
            crossing = wp.zeros(len(faces), dtype=wp.int32)
            wp.launch(_cross, len(faces), [mesh.id, cloth], [crossing])
            out[t] = crossing.numpy()
    return out


def _cloth(vertices: int, faces: np.ndarray, seams: np.ndarray) -> np.ndarray:
    """The faces, each vertex replaced by its point of cloth, shape (F, 3), int32."""
    import scipy.sparse as sp
    from scipy.sparse.csgraph import connected_components

    joined = sp.coo_matrix((np.ones(len(seams)), np.reshape(seams, (-1, 2)).T), shape=(vertices, vertices))
    return connected_components(joined, directed=False)[1].astype(np.int32)[faces]


@wp.func
def _volume(a: wp.vec3d, b: wp.vec3d, c: wp.vec3d, d: wp.vec3d) -> wp.float64:
    """Six times the signed volume of a tetrahedron."""
    return wp.dot(wp.cross(b - a, c - a), d - a)


@wp.func
def _pierces(p: wp.vec3d, q: wp.vec3d, a: wp.vec3d, b: wp.vec3d, c: wp.vec3d) -> bool:
    """Does the segment pq go through the inside of the triangle abc?"""
    zero = wp.float64(0.0)
    found = bool(False)
    if _volume(a, b, c, p) * _volume(a, b, c, q) < zero:
        u, v, w = _volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)
        found = (u > zero and v > zero and w > zero) or (u < zero and v < zero and w < zero)
    return found


@wp.func
def _corner(mesh: wp.uint64, face: int, k: int) -> wp.vec3d:
    return wp.vec3d(wp.mesh_get_point(mesh, 3 * face + k))


@wp.func
def _share(one: wp.vec3i, other: wp.vec3i) -> bool:
    """Do two faces have a point of cloth in common?"""
    found = bool(False)
    for k in range(3):
        if one[k] == other[0] or one[k] == other[1] or one[k] == other[2]:
            found = True
    return found


@wp.kernel(enable_backward=False)
def _cross(mesh: wp.uint64, cloth: wp.array[wp.vec3i], crossing: wp.array[wp.int32]):
    """Each pair once, from its first face: dim = F."""
    i = wp.tid()
    a0, b0, c0 = wp.mesh_get_point(mesh, 3 * i), wp.mesh_get_point(mesh, 3 * i + 1), wp.mesh_get_point(mesh, 3 * i + 2)
    query = wp.mesh_query_aabb(mesh, wp.min(wp.min(a0, b0), c0), wp.max(wp.max(a0, b0), c0))
    j = int(0)
    while wp.mesh_query_aabb_next(query, j):
        if j > i and not _share(cloth[i], cloth[j]):
            a, b, c = wp.vec3d(a0), wp.vec3d(b0), wp.vec3d(c0)
            d, e, f = _corner(mesh, j, 0), _corner(mesh, j, 1), _corner(mesh, j, 2)
            here = _pierces(a, b, d, e, f) or _pierces(b, c, d, e, f) or _pierces(c, a, d, e, f)
            if here or _pierces(d, e, a, b, c) or _pierces(e, f, a, b, c) or _pierces(f, d, a, b, c):
                crossing[i] = 1
                crossing[j] = 1
