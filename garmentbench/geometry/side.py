"""On which side of a surface a point is, in Warp, for surfaces that may be open or pass through themselves."""

import warp as wp

BESIDE = wp.constant(0.7)  # an offset from a border whose share along the normal is less leads beyond the border
_ON = wp.constant(1.0e-4)  # a barycentric coordinate below this is 0
_LAYERS = wp.constant(32)  # of a surface that a ray may meet
_PAST = wp.constant(1.0e-6)  # [m] beyond a layer the ray goes on


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


@wp.func
def winding(mesh: wp.uint64, point: wp.vec3) -> int:
    """How often a closed surface goes round a point: layers through which a ray leaves less those that it enters by."""
    around = int(0)
    start = point
    direction = wp.normalize(wp.vec3(0.36, 0.29, 0.89))  # along no axis, so that it hardly meets an edge
    going = bool(True)
    for _ in range(_LAYERS):
        if going:
            hit = wp.mesh_query_ray(mesh, start, direction, 1.0e3)
            going = hit.result
            if going:
                around += wp.where(wp.dot(wp.mesh_eval_face_normal(mesh, hit.face), direction) > 0.0, 1, -1)
                start = start + (hit.t + _PAST) * direction
    return around
