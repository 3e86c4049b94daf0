"""The recording's own body: AMASS poses on SMPL or SMPL-X, when the user has the `smplx` package and the model files.

Both are under licences of their own (https://smpl.is.tue.mpg.de, https://smpl-x.is.tue.mpg.de), so neither comes with
us.
"""

from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.motions.amass import ARRAYS, amass_motion
from garmentbench.progress import track
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.npz import read_arrays

_SMPLX_POSES = 165  # 55 joints; fewer are SMPL's or SMPL-H's, of which SMPL's body joints are taken
_BATCH = 64  # frames
_GENDERS = ("male", "female", "neutral")


def write_own_body(file: Path, models: Path, fps: float, out: Path) -> str:
    """Write the moving body of an AMASS file as an npz that `garmentbench import` reads as a body.

    Args:
        file: The recording. All its frames are taken, at the rate nearest to `fps` that keeps every n-th frame.
        models: Folder with smpl/SMPL_MALE.pkl ... or smplx/SMPLX_MALE.npz ..., as the `smplx` package wants it.
        fps: Frames a second that are wanted.
        out: The file: positions [m], z up, faces, fps.

    Returns:
        What was done, a line.

    Raises:
        UserError: The package or the model file is missing, or the recording is malformed.
    """
    arrays = read_arrays(file, "an AMASS recording", "copy or make it again", (*ARRAYS, "betas"))
    poses, trans, rate = amass_motion(arrays, file)
    kind = "smplx" if poses.shape[1] >= _SMPLX_POSES else "smpl"
    model = _model(arrays, kind, models, file)
    step = max(1, round(rate / fps))
    poses, trans = poses[::step], trans[::step]
    betas = arrays.get("betas", np.zeros(10))[: model.num_betas]
    if betas.ndim != 1 or len(betas) != model.num_betas or not np.isfinite(betas).all():
        raise UserError(
            f"{file}: its array 'betas' has shape {betas.shape}; wanted at least {model.num_betas} finite numbers"
        )
    positions = _vertices(model, kind, poses, trans, betas)
    with written_whole(out) as partial, partial.open("wb") as stream:
        np.savez(
            stream,
            positions=positions,
            faces=np.asarray(model.faces, np.int32),
            fps=np.array(rate / step),
            up=np.array("z"),
            metres_per_unit=np.array(1.0),
        )
    return f"{len(positions)} frames of {positions.shape[1]} vertices at {rate / step:g} a second, {kind} model"


def _gender(file: Path) -> str:
    """What the file says; neutral where it says nothing, or only in a Python object, which is not read."""
    try:
        said = read_arrays(file, "an AMASS recording", "copy or make it again", ("gender",)).get("gender", "")
    except UserError:
        return "neutral"
    gender = str(said).strip("b'\"").lower()
    return gender if gender in _GENDERS else "neutral"


def _model(arrays: dict[str, np.ndarray], kind: str, models: Path, file: Path):
    try:
        import smplx
    except ModuleNotFoundError as e:
        raise UserError(
            f"{file}: its own body needs the package smplx, which is not installed: pip install smplx, and get the "
            "model files from https://smpl.is.tue.mpg.de; without --smplx-models the motion is retargeted to our body"
        ) from e
    gender = _gender(file)
    wanted = models / kind / f"{kind.upper()}_{gender.upper()}.{'npz' if kind == 'smplx' else 'pkl'}"
    if not wanted.is_file():
        raise UserError(
            f"{wanted}: no such file; wanted the {kind} model files in {models / kind}, from "
            f"https://{'smpl-x' if kind == 'smplx' else 'smpl'}.is.tue.mpg.de"
        )
    hands = {"use_pca": False, "flat_hand_mean": True} if kind == "smplx" else {}
    return smplx.create(str(models), model_type=kind, gender=gender, **hands)


def _vertices(model, kind: str, poses: np.ndarray, trans: np.ndarray, betas: np.ndarray) -> np.ndarray:
    """Vertices [m], shape (T, V, 3), float32."""
    import torch

    def tensor(array: np.ndarray) -> torch.Tensor:
        return torch.from_numpy(np.ascontiguousarray(array, np.float32))

    out = []
    with torch.no_grad(), track(-(-len(poses) // _BATCH), "body") as done:
        for start in range(0, len(poses), _BATCH):
            pose, path = poses[start : start + _BATCH], trans[start : start + _BATCH]
            parts = {name: tensor(value) for name, value in _split(pose, kind).items()}
            shape = tensor(np.broadcast_to(betas, (len(pose), len(betas))))
            out.append(model(betas=shape, transl=tensor(path), **parts).vertices.numpy())
            done()
    return np.concatenate(out)


def _split(pose: np.ndarray, kind: str) -> dict[str, np.ndarray]:
    """The parts of a pose, shape (N, P), by the names of the model's arguments."""
    if kind == "smplx":
        edges = {
            "global_orient": 3,
            "body_pose": 66,
            "jaw_pose": 69,
            "leye_pose": 72,
            "reye_pose": 75,
            "left_hand_pose": 120,
            "right_hand_pose": 165,
        }
        starts = [0, *list(edges.values())[:-1]]
        parts = {name: pose[:, start:stop] for start, (name, stop) in zip(starts, edges.items(), strict=True)}
        return parts | {"expression": np.zeros((len(pose), 10))}
    hands = pose[:, 66:72] if pose.shape[1] == 72 else np.zeros((len(pose), 6))  # SMPL's two hands; SMPL-H has fingers
    return {"global_orient": pose[:, :3], "body_pose": np.concatenate([pose[:, 3:66], hands], axis=1)}
