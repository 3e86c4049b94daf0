"""On which side of a surface a point is, in Warp, for surfaces that may be open."""

import warp as wp

BESIDE = wp.constant(0.7)  # an offset from a border whose share along the normal is less leads beyond the border
_ON = wp.constant(1.0e-4)  # a barycentric coordinate below this is 0


@wp.func
def at_border(mesh: wp.uint64, border: wp.array[int], q: wp.MeshQueryPoint) -> bool:
    """Is the nearest point where the surface ends? `border`: 1 for a vertex there (`geometry.mesh.border_vertices`)."""
    w = 1.0 - q.u - q.v
    on = wp.min(wp.min(q.u, q.v), w) < _ON
    for k in range(3):
        if wp.vec3(q.u, q.v, w)[k] >= _ON and border[wp.mesh_get_index(mesh, 3 * q.face + k)] == 0:
            on = False
    return on


@wp.func
def side(mesh: wp.uint64, border: wp.array[int], q: wp.MeshQueryPoint, offset: wp.vec3) -> float:
    """1 outside, -1 inside, of a point `offset` from its nearest. Beyond the border of an open surface is no inside."""
    along = wp.abs(wp.dot(offset, wp.mesh_eval_face_normal(mesh, q.face)))
    beside = at_border(mesh, border, q) and along < BESIDE * wp.length(offset)
    return wp.where(beside, 1.0, q.sign)
