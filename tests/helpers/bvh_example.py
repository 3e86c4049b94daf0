"""BVH texts made in the tests: any skeleton in any motion, our own body in its walk, and a person in T-pose."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.motion.gait import GAITS
from garmentbench.motion.walk import walk
from garmentbench.scenes.bodies import BakedBody

MIXAMO = {
    "pelvis": "Hips",
    "chest": "Spine2",
    "waist": "Spine1",
    "spine": "Spine",
    "neck": "Neck",
    "head": "Head",
    "clavicle": "*Shoulder",
    "upper_arm": "*Arm",
    "fore_arm": "*ForeArm",
    "hand": "*Hand",
    "thigh": "*UpLeg",
    "calf": "*Leg",
    "foot": "*Foot",
    "toes": "*ToeBase",
}


@dataclass
class Moving:
    """A skeleton in motion: names, parents, rest places (J, 3), world rotations (T, J, 3, 3), root path (T, 3), fps."""

    names: list[str]
    parents: np.ndarray
    joints: np.ndarray
    rotations: np.ndarray
    root: np.ndarray
    fps: float = 30.0

    def text(self, order: str = "ZXY", prefix: str = "") -> str:
        """As BVH, positions before rotations, angles about the axes in this order."""
        local = self.rotations.copy()
        for j, parent in enumerate(self.parents[1:], start=1):
            local[:, j] = self.rotations[:, parent].swapaxes(1, 2) @ self.rotations[:, j]
        angles = Rotation.from_matrix(local.reshape(-1, 3, 3)).as_euler(order, degrees=True).reshape(len(self.root), -1)
        rows = np.concatenate([self.root, angles], axis=1)
        written: list[int] = []
        head = "HIERARCHY\n" + self._joint(0, order, prefix, written)
        columns = [0, 1, 2] + [3 + 3 * j + a for j in written for a in range(3)]
        body = "\n".join(" ".join(f"{x:.9g}" for x in row) for row in rows[:, columns])
        return f"{head}MOTION\nFrames: {len(rows)}\nFrame Time: {1 / self.fps:.9g}\n{body}\n"

    def _joint(self, j: int, order: str, prefix: str, written: list[int]) -> str:
        written.append(j)
        offset = self.joints[j] - self.joints[self.parents[j]] if j else np.zeros(3)
        channels = [f"{axis}position" for axis in "XYZ" if j == 0] + [f"{axis}rotation" for axis in order]
        lines = [
            f"{'JOINT' if j else 'ROOT'} {prefix}{self.names[j]}",
            "{",
            "OFFSET " + " ".join(f"{x:.9g}" for x in offset),
        ]
        lines.append(f"CHANNELS {len(channels)} " + " ".join(channels))
        text = "\n".join(lines) + "\n"
        children = [k for k in range(len(self.names)) if self.parents[k] == j and k != j]
        text += "".join(self._joint(k, order, prefix, written) for k in children)
        return text + ("End Site\n{\nOFFSET 0 0.01 0\n}\n" if not children else "") + "}\n"


def mixamo_names(joint_names: tuple[str, ...]) -> list[str]:
    """Our joints by Mixamo's names."""
    sides = {"L": "Left", "R": "Right", "": ""}
    return [MIXAMO[n.partition(".")[0]].replace("*", sides[n.partition(".")[2]]) for n in joint_names]


def own_walk(baked: BakedBody, frames: int = 60, speed: float = 1.0) -> Moving:
    """Our body in its own walk, z up, facing -y, in metres."""
    phase = 2 + np.arange(frames) * speed / (GAITS["armspace-75"].period * 30)
    steps = walk(baked, GAITS["armspace-75"], phase, np.ones(frames))
    return Moving(mixamo_names(baked.joint_names), baked.parents, baked.joints, steps.rotations, steps.root)


def y_up(moving: Moving, unit: float = 100.0) -> Moving:
    """The same as most BVH files are: y up, facing +z, in centimetres."""
    turn = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    rotations = turn @ moving.rotations @ turn.T
    return Moving(
        moving.names, moving.parents, unit * moving.joints @ turn.T, rotations, unit * moving.root @ turn.T, moving.fps
    )


def other_bone_frames(moving: Moving, seed: int = 0) -> Moving:
    """The same motion of a skeleton whose every bone has axes of its own, so that its zero pose is no person's."""
    axes = Rotation.random(len(moving.names), rng=seed).as_matrix()
    joints = np.zeros_like(moving.joints)
    for j, parent in enumerate(moving.parents[1:], start=1):
        joints[j] = joints[parent] + axes[parent].T @ (moving.joints[j] - moving.joints[parent])
    return Moving(moving.names, moving.parents, joints, moving.rotations @ axes, moving.root, moving.fps)


def t_pose(frames: int = 4, fps: float = 30.0) -> Moving:
    """A person of 1.7 m who stands in T-pose, y up, facing +z, in centimetres; all rotations are zero."""
    places = {
        "Hips": (None, 0, 92, 0),
        "Spine": ("Hips", 0, 103, 0),
        "Spine1": ("Spine", 0, 115, 0),
        "Spine2": ("Spine1", 0, 128, 0),
        "Neck": ("Spine2", 0, 145, 0),
        "Head": ("Neck", 0, 152, 2),
    }
    for side, x in (("Left", 1), ("Right", -1)):
        places |= {
            f"{side}Shoulder": ("Spine2", 3 * x, 141, 0),
            f"{side}Arm": (f"{side}Shoulder", 17 * x, 141, 0),
            f"{side}ForeArm": (f"{side}Arm", 44 * x, 141, 0),
            f"{side}Hand": (f"{side}ForeArm", 69 * x, 141, 0),
            f"{side}UpLeg": ("Hips", 9 * x, 88, 0),
            f"{side}Leg": (f"{side}UpLeg", 9 * x, 48, 0),
            f"{side}Foot": (f"{side}Leg", 9 * x, 8, 0),
            f"{side}ToeBase": (f"{side}Foot", 9 * x, 2, 13),
        }
    names = list(places)
    parents = np.array([-1 if p is None else names.index(p) for p, *_ in places.values()])
    joints = np.array([place for _, *place in places.values()], float)
    rotations = np.tile(np.eye(3), (frames, len(names), 1, 1))
    return Moving(names, parents, joints, rotations, np.tile(joints[0], (frames, 1)), fps)
