"""Where particles, faces and edges of a cloth are near each other, in Warp."""

import warp as wp

from garmentbench.geometry.triangle import nearest_weights


@wp.func
def has(face: wp.vec3i, i: int) -> bool:
    """Is i a corner of the face?"""
    return face[0] == i or face[1] == i or face[2] == i


@wp.func
def at(values: wp.array[wp.vec3], face: wp.vec3i, weights: wp.vec3) -> wp.vec3:
    """What a point of a face has of its corners' values."""
    return weights[0] * values[face[0]] + weights[1] * values[face[1]] + weights[2] * values[face[2]]


@wp.func
def between(values: wp.array[wp.vec3], edge: wp.vec2i, s: float) -> wp.vec3:
    """What a point of an edge has of its ends' values."""
    return (1.0 - s) * values[edge[0]] + s * values[edge[1]]


@wp.func
def over_face(values: wp.array[wp.vec3], i: int, f: wp.vec3i, w: wp.vec3) -> wp.vec3:
    """Particle i's value less that of a point of face f."""
    return values[i] - at(values, f, w)


@wp.func
def over_edge(values: wp.array[wp.vec3], a: wp.vec2i, b: wp.vec2i, s: float, t: float) -> wp.vec3:
    """The value of a point of edge a less that of a point of edge b."""
    return between(values, a, s) - between(values, b, t)


@wp.func
def nearest_on_face(values: wp.array[wp.vec3], i: int, f: wp.vec3i) -> wp.vec3:
    """Weights of the point of face f that is nearest to particle i."""
    return nearest_weights(values[i], values[f[0]], values[f[1]], values[f[2]])


@wp.func
def nearest_on_edges(values: wp.array[wp.vec3], a: wp.vec2i, b: wp.vec2i) -> wp.vec3:
    """Where two edges are nearest: from 0 to 1 along a and along b, and their distance [m]."""
    return wp.closest_point_edge_edge(values[a[0]], values[a[1]], values[b[0]], values[b[1]], 1.0e-12)


@wp.func
def face_normal(x: wp.array[wp.vec3], f: wp.vec3i) -> wp.vec3:
    """Unit normal of a face."""
    return wp.normalize(wp.cross(x[f[1]] - x[f[0]], x[f[2]] - x[f[0]]))


@wp.func
def across(x: wp.array[wp.vec3], a: wp.vec2i, b: wp.vec2i) -> wp.vec3:
    """Across both edges; its length is the sine of the angle between them."""
    return wp.cross(wp.normalize(x[a[1]] - x[a[0]]), wp.normalize(x[b[1]] - x[b[0]]))
