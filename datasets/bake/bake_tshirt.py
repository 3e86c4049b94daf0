"""Bake the T-shirt into datasets/garments/tshirt-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: `pip install -e .[bake]`, bake the bodies, then `python datasets/bake/bake_tshirt.py`.
"""

import charts
import gpytoolbox
import numpy as np
import panels
from cutting import Pattern, cut, frontness, loosen
from fitting import CLEARANCE, body_skin, relax, thinnest
from garment_file import save
from sizes import VERTICES
from surface import Skin, push_out
from tights import SOURCE, fine_tights

HEM_BELOW_HIPS = 0.03  # [m], against the hip joints


def fine_tshirt(skin: Skin) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The T-shirt's shape, finely meshed: points [m], faces, and which side of the seam (positive: front)."""
    points, faces, arm, joints = fine_tights()
    pattern = Pattern(
        sleeve=("upper_arm.L", "fore_arm.L", 0.55),
        hem=joints["thigh.L"][2] - HEM_BELOW_HIPS,
        ease_top=0.007,
        ease_hem=0.035,
        ease_sleeve=0.020,
        ease_armpit=0.10,
    )
    points, faces, arm = cut(points, faces, arm, joints, pattern)
    points = loosen(points, faces, arm, joints, pattern, skin)
    points, faces = gpytoolbox.subdivide(points, faces, method="loop")[:2]
    return points, faces, frontness(points, joints)


def mesh_tshirt(fine: tuple, skin: Skin, edge: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The T-shirt at one edge length [m], not yet split at the seam: points [m], faces, and each face's panel."""
    points, faces, panel_of = panels.sew(*fine, edge)
    for _ in range(3):
        points = push_out(relax(points, faces, panel_of), faces, skin, CLEARANCE)
    return points, faces, panel_of


def best_mesh(fine: tuple, skin: Skin, wanted: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Among a few edge lengths for about `wanted` vertices, the mesh without thin triangles; remeshing is erratic."""
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
    for mine, chart in zip(used, charts.side_by_side(flat), strict=True):
        uv[mine] = chart
    return {"rest": points, "faces": faces, "uv": uv, "seams": seams, "pins": np.zeros(0, int)}


def main() -> None:
    skin = body_skin()
    fine = fine_tshirt(skin)
    for size, wanted in VERTICES["tshirt"].items():
        save(
            f"tshirt-{size}",
            with_charts(*best_mesh(fine, skin, wanted)),
            f"{SOURCE}; made by datasets/bake/bake_tshirt.py",
        )


if __name__ == "__main__":
    main()
