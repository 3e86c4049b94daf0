"""From the coordinates of the authors' files, which say neither unit nor axes, to ours.

Told by their canonical body.
"""

from dataclasses import dataclass

import numpy as np

from garmentbench.errors import UsageError, UserError
from garmentbench.geometry.nearest import nearest_vertices

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
SHORTEST, TALLEST = 1.0, 2.5  # of a person [m]
_FOOT, _SHIN = (0.0, 0.03), (0.08, 0.2)  # of the height
_TOES = 0.02  # how far a foot lies before its shin at least, of the height
_NAMES = "xyz"


@dataclass(frozen=True)
class Placement:
    """How a file's coordinates become ours.

    Attributes:
        turn: Its rows are our axes in the file's, each along one of them, shape (3, 3), a rotation.
        unit: "m", "cm" or "mm".
    """

    turn: np.ndarray
    unit: str

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Points, shape (..., 3), in metres and our axes, float32."""
        return (UNITS[self.unit] * points @ self.turn.T).astype(np.float32)

    def directions(self, vectors: np.ndarray) -> np.ndarray:
        """Unit vectors, shape (..., 3), in our axes, float32."""
        return (vectors @ self.turn.T).astype(np.float32)

    @property
    def axes(self) -> str:
        """Which of the file's axes ours are, e.g. "x,-z,y" for a file with y up whose body faces +z."""
        return ",".join(("-" if row.sum() < 0 else "") + _NAMES[int(np.argmax(np.abs(row)))] for row in self.turn)


def placement(body: np.ndarray, unit: str = "auto", axes: str = "auto") -> Placement:
    """The placement of files whose canonical body is `body`, shape (B, 3), standing upright.

    Args:
        body: Vertices as in the file.
        unit: "m", "cm", "mm", or "auto": the one in which the body is as tall as a person.
        axes: Which of the file's axes are ours (x to the body's left, y to its back, z up), e.g. "x,-z,y"; or "auto":
            left and right mirror each other, up is the longer of the other two, and toes point forward.

    Raises:
        UsageError: An unknown unit, or axes that are no rotation.
        UserError: The body does not tell; name the option then.
    """
    if unit != "auto" and unit not in UNITS:
        raise UsageError(f"units is '{unit}'; wanted one of auto, {', '.join(UNITS)}")
    turn = _turn_of_body(body) if axes == "auto" else _turn_of_text(axes)
    if unit == "auto":
        unit = _unit_of_height(float(np.ptp(body @ turn[2])))
    return Placement(turn, unit)


def _turn_of_text(axes: str) -> np.ndarray:
    rows = []
    for name in axes.split(","):
        letter = name.strip().removeprefix("-")
        if letter not in ("x", "y", "z"):
            raise UsageError(f"axes is '{axes}'; wanted three of x, y, z, -x, -y, -z, e.g. x,-z,y")
        rows.append((-1.0 if name.strip().startswith("-") else 1.0) * np.eye(3)[_NAMES.index(letter)])
    if len(rows) != 3 or round(np.linalg.det(np.array(rows))) != 1:
        raise UsageError(f"axes is '{axes}', which is no rotation; wanted e.g. x,-z,y (y up, the body facing +z)")
    return np.array(rows)


def _turn_of_body(body: np.ndarray) -> np.ndarray:
    size, centred = np.ptp(body, axis=0), body - (body.min(axis=0) + body.max(axis=0)) / 2
    mirrored = [nearest_vertices(centred * (1 - 2 * np.eye(3)[k]), centred)[0].mean() for k in range(3)]
    lateral = int(np.argmin(mirrored))
    depth, up = sorted((k for k in range(3) if k != lateral), key=lambda k: size[k])
    height = (body[:, up] - body[:, up].min()) / size[up]
    foot, shin = (body[(height >= low) & (height <= high), depth].mean() for low, high in (_FOOT, _SHIN))
    toes = (foot - shin) / size[up]
    if size[up] < 2 * size[depth] or not abs(toes) > _TOES:
        raise UserError(
            "uv_body/body_geo.obj: can't tell which way the body stands and faces; say which of its axes are "
            "left, back and up, e.g. --axes x,-z,y (y up, facing +z) or --axes x,y,z (z up, facing -y)"
        )
    upward, back = np.eye(3)[up], -np.sign(toes) * np.eye(3)[depth]
    return np.stack([np.cross(back, upward), back, upward])


def _unit_of_height(height: float) -> str:
    for unit, metres in UNITS.items():
        if SHORTEST <= metres * height <= TALLEST:
            return unit
    known = ", ".join(UNITS)
    raise UserError(
        f"uv_body/body_geo.obj: the body is {height:.4g} tall, in no known unit; give --units, one of {known}"
    )
