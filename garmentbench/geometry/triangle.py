"""The nearest point of a triangle, in Warp."""

import warp as wp


@wp.func
def nearest_weights(p: wp.vec3, a: wp.vec3, b: wp.vec3, c: wp.vec3) -> wp.vec3:
    """Barycentric weights of the point of a triangle that is nearest to p (Ericson 2004, section 5.1.5)."""
    ab, ac, ap, bp, cp = b - a, c - a, p - a, p - b, p - c
    d1, d2 = wp.dot(ab, ap), wp.dot(ac, ap)
    d3, d4 = wp.dot(ab, bp), wp.dot(ac, bp)
    d5, d6 = wp.dot(ab, cp), wp.dot(ac, cp)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    out = wp.vec3(va, vb, vc) / wp.max(va + vb + vc, 1.0e-30)
    if d1 <= 0.0 and d2 <= 0.0:
        out = wp.vec3(1.0, 0.0, 0.0)
    elif d3 >= 0.0 and d4 <= d3:
        out = wp.vec3(0.0, 1.0, 0.0)
    elif d6 >= 0.0 and d5 <= d6:
        out = wp.vec3(0.0, 0.0, 1.0)
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        out = wp.vec3(-d3, d1, 0.0) / (d1 - d3)
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        out = wp.vec3(-d6, 0.0, d2) / (d2 - d6)
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        out = wp.vec3(0.0, d5 - d6, d4 - d3) / (d4 - d3 + d5 - d6)
    return out


@wp.func
def distance_to_face(mesh: wp.uint64, face: int, p: wp.vec3) -> float:
    """Distance of a point to one face of a mesh."""
    a = wp.mesh_get_point(mesh, 3 * face)
    b = wp.mesh_get_point(mesh, 3 * face + 1)
    c = wp.mesh_get_point(mesh, 3 * face + 2)
    w = nearest_weights(p, a, b, c)
    return wp.length(p - w[0] * a - w[1] * b - w[2] * c)
