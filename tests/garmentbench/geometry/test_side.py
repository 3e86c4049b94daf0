"""How often a surface goes round a point, where it passes through itself."""

import numpy as np
import trimesh
import warp as wp

from garmentbench.geometry.side import winding


@wp.kernel
def ask(mesh: wp.uint64, points: wp.array[wp.vec3], found: wp.array[int]):
    i = wp.tid()
    found[i] = winding(mesh, points[i])


def test_winding_of_two_boxes_that_overlap_and_of_one_that_is_inside_out():
    boxes = [trimesh.creation.box((1.0, 1.0, 1.0)).apply_translation((x, x / 10, x / 9)) for x in (0.0, 0.6, 3.0)]
    boxes[2].invert()
    joined = trimesh.util.concatenate(boxes)
    points = wp.array(np.float32(joined.vertices), dtype=wp.vec3, device="cpu")
    mesh = wp.Mesh(points, wp.array(joined.faces.astype(np.int32).ravel(), dtype=int, device="cpu"))
    where = np.float32([[0.3, 0.1, 0.1], [-0.2, 0.1, 0.1], [0.9, -0.3, -0.4], [0.3, 0.1, -0.9], [3.0, 0.3, 0.3]])
    found = wp.empty(len(where), dtype=int, device="cpu")
    asked = wp.array(where, dtype=wp.vec3, device="cpu")
    wp.launch(ask, len(where), [mesh.id, asked, found], device="cpu")
    assert found.numpy().tolist() == [2, 1, 1, 0, -1]
