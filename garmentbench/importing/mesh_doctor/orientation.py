"""Which side of a garment is outside: away from the body, or away from the volume that it encloses."""

import numpy as np

from garmentbench.geometry.mesh import vertex_normals
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.topology import Winding, borders, winding
from garmentbench.sequence import Body, Garment

FLAT = 1e-3  # a patch encloses nothing when volume < this times area^1.5 (a sphere's ratio: 0.094, a T-shirt's: 0.02)
NEAR = 0.25  # [m] faces farther from the body say nothing about which side it lies on
SURE = 0.1  # mean cosine between the normals of cloth and body below which the body does not tell


def faces_inward(garment: Garment, body: Body | None) -> bool:
    """Do most of a garment's faces point to its body, or into the volume that it encloses?"""
    count = np.arange(len(garment.rest))
    faces, seams = garment.faces.astype(np.int64), garment.seams.astype(np.int64)
    mesh = Mesh(garment.name, garment.rest.astype(np.float64), faces, None, count, seams=seams)
    way = winding(mesh.sides)
    return bool((np.isin(way.patch, inward_patches(mesh, way, body)) != way.turned).mean() > 0.5)


def inward_patches(mesh: Mesh, way: Winding, body: Body | None) -> np.ndarray:
    """Patches that are inside out once `way.turned` faces are turned, shape (K,). None of a flat or one-sided patch.

    The body decides, if there is one and the patch is near it; otherwise the enclosed volume.
    """
    corners = np.where(way.turned[:, None], mesh.corners[:, ::-1], mesh.corners)
    a, b, c = mesh.points[corners].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a) / 2
    count = int(way.patch.max(initial=-1)) + 1
    area = np.bincount(way.patch, np.linalg.norm(normal, axis=1), count)
    outward = _volumes(mesh, corners, way) / np.where(area > 0, area, 1.0) ** 1.5 / FLAT
    if body is not None:
        facing, weight = _facing_away((a + b + c) / 3, normal, body)
        told = np.bincount(way.patch, weight, count)
        mean = np.bincount(way.patch, facing, count) / np.where(told > 0, told, 1.0)
        outward = np.where((told > 0.5 * area) & (np.abs(mean) > SURE), mean / SURE, outward)
    return np.setdiff1d(np.flatnonzero(outward < -1), way.one_sided)


def _facing_away(centres: np.ndarray, normals: np.ndarray, body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Area times the cosine between face and body normal, and area, shape (F,) each; 0 for faces far from the body."""
    distance, nearest = nearest_vertices(centres, body.rest)
    near = distance < NEAR
    skin = vertex_normals(body.rest.astype(np.float64), body.faces)[nearest]
    return np.where(near, (normals * skin).sum(axis=1), 0), np.where(near, np.linalg.norm(normals, axis=1), 0)


def _volumes(mesh: Mesh, corners: np.ndarray, way: Winding) -> np.ndarray:
    """Volume that each patch encloses, its border loops closed by fans round their middles, shape (patches,)."""
    count = int(way.patch.max(initial=-1)) + 1
    middle = _means(mesh.points[corners].mean(axis=1), way.patch, count)
    a, b, c = (mesh.points[corners] - middle[way.patch][:, None]).transpose(1, 0, 2)
    volume = np.bincount(way.patch, np.einsum("fx,fx->f", a, np.cross(b, c)), count)
    edges, loop = borders(mesh.sides, len(mesh.vertex))
    if len(edges):
        at = np.flatnonzero(mesh.sides.border)
        at = at[np.argsort(mesh.sides.edge.ravel()[at])]  # the side that lies on each border edge
        patch = way.patch[at // 3]
        _, loop = np.unique(loop * count + patch, return_inverse=True)  # two patches may touch at a point of the border
        loop = loop.ravel()
        forward = mesh.sides.forward.ravel()[at] ^ way.turned[at // 3]
        start, end = np.where(forward[:, None], edges, edges[:, ::-1]).T
        hub = _means(mesh.points[edges].mean(axis=1), loop, loop.max() + 1)[loop] - middle[patch]
        p, q = mesh.points[start] - middle[patch], mesh.points[end] - middle[patch]
        volume += np.bincount(patch, np.einsum("bx,bx->b", q, np.cross(p, hub)), count)
    return volume / 6


def _means(values: np.ndarray, label: np.ndarray, count: int) -> np.ndarray:
    sums = np.stack([np.bincount(label, column, count) for column in values.T], axis=1)
    return sums / np.maximum(np.bincount(label, minlength=count), 1)[:, None]
