"""A small software renderer: still pictures of bodies and garments from Warp's ray caster, the same bytes every time.

It runs on the CPU, needs neither a window nor a GPU driver, and draws what the report and `check` show.
"""

from dataclasses import dataclass

import numpy as np
import warp as wp

from garmentbench.device import quiet_warp
from garmentbench.viewing.shading import CREASE, SMOOTH, corner_normals

SKIN = (0.62, 0.62, 0.64)
CLOTH = (0.33, 0.55, 0.79)
BACKGROUND = (1.0, 1.0, 1.0)
ERROR_COLOURS = "YlOrRd"
ERROR_SCALE_CM = 5.0  # error colours run from 0 to this, in every picture and recording

# Camera's turn round the body [degrees]
VIEWS = {"front": 0.0, "three-quarter": 35.0, "side": 90.0, "back": 180.0, "other side": 270.0}
_ELEVATION = 8.0  # the camera looks down by this [degrees]
_HALF_FOV = np.tan(np.radians(11.0))  # of the picture's shorter side
_SAMPLES = 2  # 2 x 2 rays a pixel
_GAMMA = 2.2


@dataclass(frozen=True)
class RenderMesh:
    """A mesh to draw.

    Attributes:
        vertices: Positions [m], shape (V, 3).
        faces: Triangles, shape (F, 3).
        colour: sRGB colour in [0, 1], shape (3,), or one a vertex, shape (V, 3).
        cloth: Two-sided, its inner side drawn darker; pleats keep their edges.
    """

    vertices: np.ndarray
    faces: np.ndarray
    colour: tuple[float, float, float] | np.ndarray = SKIN
    cloth: bool = False


def error_colours(error_cm: np.ndarray) -> np.ndarray:
    """Colours of errors [cm], shape (...), on the fixed scale: pale yellow 0, dark red `ERROR_SCALE_CM` or more.

    Returns:
        sRGB in [0, 1], shape (..., 3).
    """
    from matplotlib import colormaps

    return colormaps[ERROR_COLOURS](np.clip(error_cm / ERROR_SCALE_CM, 0.0, 1.0))[..., :3]


def bounds(*clouds: np.ndarray, margin: float = 0.03) -> np.ndarray:
    """The box round point clouds [m], each shape (..., 3), widened by `margin` [m]; shape (2, 3): low, high corner."""
    low = np.min([c.reshape(-1, 3).min(axis=0) for c in clouds], axis=0) - margin
    high = np.max([c.reshape(-1, 3).max(axis=0) for c in clouds], axis=0) + margin
    return np.stack([low, high])


def render(
    meshes: list[RenderMesh],
    view: str = "three-quarter",
    size: tuple[int, int] = (300, 400),
    focus: np.ndarray | None = None,
) -> np.ndarray:
    """Draw meshes (z up, seen from round a body that faces -y).

    Args:
        meshes: What to draw; vertices must be finite.
        view: One of `VIEWS`.
        size: Width and height [pixels].
        focus: The box to fill the picture with [m], shape (2, 3); None for all that is drawn. Give the same box to
            every picture that is to be compared.

    Returns:
        The picture, uint8, shape (height, width, 3), sRGB.
    """
    quiet_warp()
    box = bounds(*[m.vertices for m in meshes]) if focus is None else focus
    origin, axes, tangents = _camera(box, VIEWS[view], size)
    vertices = np.concatenate([m.vertices for m in meshes]).astype(np.float32)
    starts = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    faces = np.concatenate([m.faces + s for m, s in zip(meshes, starts, strict=True)]).astype(np.int32)
    colours = np.concatenate([np.broadcast_to(np.asarray(m.colour), (len(m.vertices), 3)) for m in meshes])
    cloth = np.concatenate([np.full(len(m.faces), m.cloth, np.int32) for m in meshes])
    normals = np.concatenate(
        [corner_normals(m.vertices, m.faces, CREASE if m.cloth else SMOOTH) for m in meshes]
    ).astype(np.float32)
    centre = origin.astype(np.float32)  # rays start at 0: no loss of digits far from the world's origin
    image = wp.zeros((size[1], size[0]), dtype=wp.vec3, device="cpu")
    with wp.ScopedDevice("cpu"):
        mesh = wp.Mesh(wp.array(vertices - centre, dtype=wp.vec3), wp.array(faces.ravel(), dtype=wp.int32))
        arrays = [
            wp.array(normals, dtype=wp.vec3),
            wp.array(np.power(colours, _GAMMA).astype(np.float32), dtype=wp.vec3),
            wp.array(cloth, dtype=wp.int32),
        ]
        camera = [wp.vec3(*map(float, a)) for a in axes] + [float(t) for t in tangents]
        wp.launch(_draw, dim=image.shape, inputs=[mesh.id, *arrays, *camera, wp.vec3(*BACKGROUND)], outputs=[image])
    linear = np.clip(image.numpy(), 0.0, 1.0)
    return np.round(255.0 * linear ** (1.0 / _GAMMA)).astype(np.uint8)


def _camera(box: np.ndarray, azimuth: float, size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A perspective camera that just sees a box: origin (3,), axes right, up, forward (3, 3), tangents (2,)."""
    a, e = np.radians(azimuth), np.radians(_ELEVATION)
    forward = np.array([-np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), -np.sin(e)])
    right = np.array([np.cos(a), np.sin(a), 0.0])
    axes = np.stack([right, np.cross(right, forward), forward])
    tangents = _HALF_FOV * np.array(size) / min(size)
    centre = box.mean(axis=0)
    corners = np.array([[x, y, z] for x in box[:, 0] for y in box[:, 1] for z in box[:, 2]]) - centre
    r, u, f = axes @ corners.T
    distance = max((np.abs(r) / tangents[0] - f).max(), (np.abs(u) / tangents[1] - f).max())
    return centre - distance * forward, axes, tangents


@wp.func
def _shade(normal: wp.vec3, view: wp.vec3, right: wp.vec3, up: wp.vec3) -> float:
    """Lambert: a key light from the left, so that folds show, a fill from the right, and light from the sky."""
    key = wp.normalize(up * 0.6 - right - view * 0.45)
    fill = wp.normalize(right - view * 0.6)
    sky = 0.5 + 0.5 * normal[2]
    lit = 0.90 * wp.max(wp.dot(normal, key), 0.0) + 0.20 * wp.max(wp.dot(normal, fill), 0.0)
    return 0.11 + 0.15 * sky + lit


@wp.kernel
def _draw(
    mesh: wp.uint64,
    normals: wp.array2d[wp.vec3],
    colours: wp.array[wp.vec3],
    cloth: wp.array[wp.int32],
    right: wp.vec3,
    up: wp.vec3,
    forward: wp.vec3,
    tangent_x: float,
    tangent_y: float,
    background: wp.vec3,
    image: wp.array2d[wp.vec3],
):
    row, column = wp.tid()
    total = wp.vec3(0.0)
    for sample in range(wp.static(_SAMPLES * _SAMPLES)):
        x = (float(column) + (float(sample % _SAMPLES) + 0.5) / float(_SAMPLES)) / float(image.shape[1])
        y = (float(row) + (float(sample // _SAMPLES) + 0.5) / float(_SAMPLES)) / float(image.shape[0])
        ray = wp.normalize(forward + right * (tangent_x * (2.0 * x - 1.0)) + up * (tangent_y * (1.0 - 2.0 * y)))
        hit = wp.mesh_query_ray(mesh, wp.vec3(0.0), ray, 1.0e4)
        if hit.result:
            i = wp.mesh_get_index(mesh, 3 * hit.face)
            j = wp.mesh_get_index(mesh, 3 * hit.face + 1)
            k = wp.mesh_get_index(mesh, 3 * hit.face + 2)
            w = 1.0 - hit.u - hit.v
            f = hit.face
            normal = wp.normalize(normals[f, 0] * hit.u + normals[f, 1] * hit.v + normals[f, 2] * w)
            colour = colours[i] * hit.u + colours[j] * hit.v + colours[k] * w
            if wp.dot(hit.normal, ray) > 0.0:
                normal = -normal
                if cloth[hit.face] == 1:
                    colour = colour * 0.45
            total += colour * _shade(normal, forward, right, up)
        else:
            total += background
    image[row, column] = total / float(_SAMPLES * _SAMPLES)
