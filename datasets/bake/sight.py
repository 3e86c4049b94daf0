"""How much of what is around a point of a surface can be seen from it."""

import numpy as np
import warp as wp

from garmentbench.device import quiet_warp
from garmentbench.geometry.mesh import vertex_normals

_RAYS = 400
_OFF = 2e-4  # rays start this far above the surface [m]
_FAR = 10.0  # [m]


def sky(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Share of the rays from each vertex, outward and weighted by their cosine, that don't hit the surface; (V,)."""
    quiet_warp()
    k = np.arange(_RAYS) + 0.5
    height, turn = 1 - 2 * k / _RAYS, np.pi * (1 + np.sqrt(5)) * k  # a Fibonacci sphere
    level = np.sqrt(1 - height**2)
    ways = np.column_stack([level * np.cos(turn), level * np.sin(turn), height])
    with wp.ScopedDevice("cpu"):
        points, normals, rays = (
            wp.array(a.astype(np.float32), dtype=wp.vec3) for a in (vertices, vertex_normals(vertices, faces), ways)
        )
        mesh = wp.Mesh(points, wp.array(faces.astype(np.int32).ravel(), dtype=wp.int32))
        share = wp.zeros(len(vertices), dtype=wp.float32)
        wp.launch(_look, dim=len(vertices), inputs=[mesh.id, points, normals, rays, _OFF, _FAR], outputs=[share])
    return share.numpy()


@wp.kernel
def _look(
    mesh: wp.uint64,
    points: wp.array[wp.vec3],
    normals: wp.array[wp.vec3],
    ways: wp.array[wp.vec3],
    off: float,
    far: float,
    share: wp.array[float],
):
    i = wp.tid()
    free = wp.float32(0.0)
    total = wp.float32(0.0)
    for k in range(ways.shape[0]):
        cosine = wp.dot(ways[k], normals[i])
        if cosine > 0.0:
            total += cosine
            hit = wp.mesh_query_ray(mesh, points[i] + normals[i] * off, ways[k], far)
            if not hit.result:
                free += cosine
    share[i] = free / total
