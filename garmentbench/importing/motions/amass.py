"""AMASS-style npz files: SMPL or SMPL-X poses. Read as a skeleton, which needs neither SMPL's code nor its model files.

`poses` (or root_orient beside pose_body, or AIST++'s smpl_poses) holds, a frame, the axis-angle rotations of the joints
below, the root's first (more joints follow: hands, face); `trans` the path of the root [m]; z is up. A rotation of zero
is the T-pose that looks along +y of SMPL's own y-up axes. How long the person's bones are is in SMPL's shape space,
which only its model files tell: here the bones are an adult's, to the centimetre, and `betas` are not used.
"""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.errors import UserError
from garmentbench.importing.motions.recording import Recording

# Joint, parent, place in the parent's frame of the T-pose [cm]: x to the left, y up, z ahead.
_SKELETON = (
    ("pelvis", None, (0, 0, 0)),
    ("left_hip", "pelvis", (6, -9, -1)),
    ("right_hip", "pelvis", (-6, -9, -1)),
    ("spine1", "pelvis", (0, 11, -3)),
    ("left_knee", "left_hip", (4, -38, 0)),
    ("right_knee", "right_hip", (-4, -38, 0)),
    ("spine2", "spine1", (0, 14, 2)),
    ("left_ankle", "left_knee", (-1, -41, -4)),
    ("right_ankle", "right_knee", (1, -41, -4)),
    ("spine3", "spine2", (0, 5, 0)),
    ("left_foot", "left_ankle", (3, -6, 12)),
    ("right_foot", "right_ankle", (-3, -6, 12)),
    ("neck", "spine3", (0, 21, -4)),
    ("left_collar", "spine3", (7, 12, -3)),
    ("right_collar", "spine3", (-7, 12, -3)),
    ("head", "neck", (0, 9, 5)),
    ("left_shoulder", "left_collar", (12, 4, -1)),
    ("right_shoulder", "right_collar", (-12, 4, -1)),
    ("left_elbow", "left_shoulder", (26, -1, -2)),
    ("right_elbow", "right_shoulder", (-26, -1, -2)),
    ("left_wrist", "left_elbow", (25, 0, 0)),
    ("right_wrist", "right_elbow", (-25, 0, 0)),
)
_LARGEST_TURN = 2 * np.pi + 0.1  # [rad] of a joint against its parent
_UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # takes y, which is up in the T-pose, to z
_RATES = ("mocap_framerate", "mocap_frame_rate", "fps")
_POSES = {  # what is called what in which data; parts are put side by side
    "poses": ("poses",),
    "root_orient": ("root_orient", "pose_body"),  # AMASS, split
    "smpl_poses": ("smpl_poses",),  # AIST++
    "global_orient": ("global_orient", "body_pose"),  # the smplx package's own names
}
_PATHS = ("trans", "smpl_trans", "transl")
ARRAYS = (
    *(part for parts in _POSES.values() for part in parts),
    *_PATHS,
    *_RATES,
    "smpl_scaling",
)  # that a motion needs
_ADVICE = (
    "wanted poses (T, 66 or more), or root_orient and pose_body; trans (T, 3); and mocap_framerate, or --recording-fps"
)


def is_amass(arrays: dict[str, np.ndarray]) -> bool:
    """Do the arrays of an npz file look like AMASS's?"""
    return any(key in arrays for key in (*_POSES, *_PATHS))


def amass_recording(arrays: dict[str, np.ndarray], path: Path, fps: float | None = None) -> Recording:
    """The recording in the arrays of an AMASS file [m]; `fps` counts before the file's. Raises `UserError` where one is
    missing or wrong."""
    poses, trans, fps = amass_motion(arrays, path, fps)
    names = [joint for joint, _, _ in _SKELETON]
    turns = (
        Rotation.from_rotvec(poses[:, : 3 * len(names)].reshape(-1, 3))
        .as_matrix()
        .reshape(len(poses), len(names), 3, 3)
    )
    turns = _UPRIGHT @ turns @ _UPRIGHT.T  # in the axes of a T-pose with z up, so that it stands in the file's axes
    turns[:, 0] = _UPRIGHT.T @ turns[:, 0]
    return Recording(
        names=tuple(names),
        parents=np.array([-1 if parent is None else names.index(parent) for _, parent, _ in _SKELETON]),
        offsets=0.01 * np.array([place for _, _, place in _SKELETON], np.float64) @ _UPRIGHT.T,
        rotations=turns,
        root=trans,
        fps=fps,
        own_rest=False,
    )


def amass_motion(
    arrays: dict[str, np.ndarray], path: Path, fps: float | None = None
) -> tuple[np.ndarray, np.ndarray, float]:
    """Poses (T, P) [rad], path (T, 3) [m] and the frame rate (`fps`, if it is given), checked. Raises `UserError`."""
    parts = next((parts for first, parts in _POSES.items() if first in arrays), ())
    way = next((key for key in _PATHS if key in arrays), None)
    if not parts or way is None:
        lacks = "poses" if not parts else "trans"
        raise UserError(
            f"{path}: its array '{lacks}' is missing (found: {', '.join(sorted(arrays)) or 'none of these'}); {_ADVICE}"
        )
    for key in (*parts, way):
        if (
            key not in arrays
            or arrays[key].ndim not in (2, 3)
            or (arrays[key].ndim == 3 and arrays[key].shape[2] != 3)
            or arrays[key].dtype.kind not in "fi"
        ):
            raise UserError(f"{path}: its array '{key}' is missing or wrong; {_ADVICE}")
        if not np.isfinite(arrays[key]).all():
            raise UserError(f"{path}: its array '{key}' is not finite; cut the recording before that frame")
    if len({len(arrays[key]) for key in parts}) > 1:
        raise UserError(f"{path}: {' and '.join(parts)} are not of one length; {_ADVICE}")
    poses = np.concatenate(
        [arrays[key].reshape(len(arrays[key]), int(np.prod(arrays[key].shape[1:]))) for key in parts], axis=1
    ).astype(np.float64)
    trans = arrays[way].astype(np.float64)
    if poses.shape[1] < 3 * len(_SKELETON) or trans.shape != (len(poses), 3) or not len(poses):
        raise UserError(f"{path}: {parts[0]} {poses.shape}, {way} {trans.shape}; {_ADVICE}")
    most = np.linalg.norm(poses[:, 3 : 3 * len(_SKELETON)].reshape(len(poses), -1, 3), axis=2).max()
    if most > _LARGEST_TURN:
        raise UserError(
            f"{path}: {parts[0]} turns a joint by {most:.0f}, wanted axis-angle in radians (half a turn is 3.14): "
            "degrees, or Euler angles? Convert them (of degrees, numpy.radians) and write the file again"
        )
    scaling = arrays.get("smpl_scaling")
    if scaling is not None and scaling.size == 1 and scaling.dtype.kind in "fi" and scaling.item() > 0:
        trans = trans / scaling.item()
    if fps is not None:
        return poses, trans, fps
    rate = next((arrays[key] for key in _RATES if key in arrays), None)
    if rate is None or rate.size != 1 or rate.dtype.kind not in "fi" or not 1 <= rate.item() <= 1000:
        raise UserError(f"{path}: its frame rate is {'missing' if rate is None else rate}; {_ADVICE}")
    return poses, trans, float(rate.item())
