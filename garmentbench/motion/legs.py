"""Legs from where the hip and the ankle are: two-bone inverse kinematics, in closed form."""

from dataclasses import dataclass

import numpy as np

from garmentbench.scenes.bodies import BakedBody


@dataclass(frozen=True)
class Leg:
    """A leg's rest directions and lengths [m].

    Attributes:
        thigh, calf: Rest frames of the bones, columns: direction, hinge axis of the knee, and across both; (3, 3).
        lengths: Of thigh and calf [m].
        knee: Rest direction in which the knee points, across the line from hip to ankle, shape (3,).
    """

    thigh: np.ndarray
    calf: np.ndarray
    lengths: tuple[float, float]
    knee: np.ndarray

    @property
    def reach(self) -> float:
        """Length of the stretched leg [m]."""
        return sum(self.lengths)

    def span(self, bend: np.ndarray) -> np.ndarray:
        """Distance of hip and ankle [m] at bends of the knee [rad]; the shape of bend."""
        thigh, calf = self.lengths
        return np.sqrt(thigh**2 + calf**2 + 2 * thigh * calf * np.cos(bend))


def rest_leg(baked: BakedBody, side: str) -> Leg:
    """The leg of `side` ("L", "R") in the rest pose."""
    hip, knee, ankle = (baked.joints[baked.joint_names.index(f"{name}.{side}")] for name in ("thigh", "calf", "foot"))
    line = unit(ankle - hip)
    forward = unit(knee - hip - np.dot(knee - hip, line) * line)
    hinge = np.cross(forward, line)
    thigh, calf = (_frame(unit(end - start), hinge) for start, end in ((hip, knee), (knee, ankle)))
    lengths = float(np.linalg.norm(knee - hip)), float(np.linalg.norm(ankle - knee))
    return Leg(thigh, calf, lengths, forward)


def solve_leg(leg: Leg, hip: np.ndarray, ankle: np.ndarray, knee: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """World-oriented rotations of thigh and calf that take the ankle to its place.

    Args:
        leg: The leg at rest.
        hip: Hip [m], shape (T, 3).
        ankle: Ankle [m], shape (T, 3), no further than the leg's reach.
        knee: Direction in which the knee points, roughly, shape (T, 3).

    Returns:
        Two arrays of shape (T, 3, 3).
    """
    thigh_length, calf_length = leg.lengths
    distance = np.linalg.norm(ankle - hip, axis=-1, keepdims=True)
    line = (ankle - hip) / distance
    forward = unit(knee - np.sum(knee * line, axis=-1, keepdims=True) * line)
    along = (distance**2 + thigh_length**2 - calf_length**2) / (2 * distance)
    knee_point = along * line + np.sqrt(thigh_length**2 - along**2) * forward
    hinge = np.cross(forward, line)
    thigh = _frame(unit(knee_point), hinge) @ leg.thigh.T
    calf = _frame(unit(distance * line - knee_point), hinge) @ leg.calf.T
    return thigh, calf


def within(reach: float, hip: np.ndarray, ankle: np.ndarray) -> np.ndarray:
    """The ankle [m], shape (T, 3), brought nearer to the hip where it is further from it than `reach`."""
    line = ankle - hip
    return hip + line * np.minimum(1.0, reach / np.linalg.norm(line, axis=1))[:, None]


def unit(vector: np.ndarray) -> np.ndarray:
    """Vectors of length 1 along the last axis."""
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def _frame(direction: np.ndarray, hinge: np.ndarray) -> np.ndarray:
    return np.stack([direction, hinge, np.cross(direction, hinge)], axis=-1)
