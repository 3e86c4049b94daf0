"""A garment of set-in sleeves taken apart along its seams: front, back and two sleeves, each a disk to be laid flat.

Seams are where linear functions of the fine surface are zero. Pieces that meet there have the very same points.
"""

import numpy as np
from lattice import FlatPanel, laid_flat
from scipy.spatial import cKDTree
from surface import border_loop, border_loops, clip, largest_part

LEFT, RIGHT = 1, -1
BORDER, ARMHOLE, SIDE = 6, 7, 8  # columns of a table: is a point on the garment's border, on that seam?
LEVEL = 9  # column: positive before the side seams


def shirt(
    points: np.ndarray, faces: np.ndarray, loose: np.ndarray, level: np.ndarray, sleeve: np.ndarray
) -> list[FlatPanel]:
    """Front, back, left and right sleeve.

    Args:
        points: The fine shirt as it is put on [m], shape (V, 3); faces: shape (F, 3).
        loose: The same in the size in which it is cut [m], shape (V, 3).
        level: Positive before the seams at shoulders and sides, shape (V,).
        sleeve: Positive beyond the armholes, shape (V,).
    """
    flags = np.zeros((len(points), 3))
    flags[np.concatenate(border_loops(faces)), 0] = 1
    table = np.column_stack([points, loose, flags, level, sleeve])
    torso, torso_faces = cut(table, faces, -table[:, -1], ARMHOLE)
    torso, torso_faces = largest_part(torso, torso_faces)
    arms, arm_faces = cut(table, faces, table[:, -1], ARMHOLE)
    panels = []
    for sign, right in ((1, [1, 0, 0]), (-1, [-1, 0, 0])):
        panels.append(panel(*cut(torso, torso_faces, sign * torso[:, LEVEL], SIDE), right))
    for side in (LEFT, RIGHT):
        mine = arm_faces[(side * arms[arm_faces, 0] > 0).all(axis=1)]
        used, mine = np.unique(mine, return_inverse=True)
        panels.append(panel(*opened(arms[used], mine.reshape(-1, 3)), [0, side, 0]))
    return panels


def cut(table: np.ndarray, faces: np.ndarray, level: np.ndarray, seam: int) -> tuple[np.ndarray, np.ndarray]:
    """What is positive; the points on the cut are marked in column `seam`. A mark between marks is kept."""
    table, faces, on_cut = clip(table, faces, level)
    flags = slice(BORDER, SIDE + 1)
    table[:, flags] = table[:, flags] > 1 - 1e-6
    table[on_cut, seam] = 1
    return table, faces


def opened(table: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A sleeve opened along the lower one of its two lines where `LEVEL` is zero, the upper one left whole.

    The upper line's inner end stays marked: there the armhole meets the shoulder seam.
    """
    front, front_faces = cut(table, faces, table[:, LEVEL], SIDE)
    back, back_faces = cut(table, faces, -table[:, LEVEL], SIDE)
    upper = upper_line(front, front_faces)
    apart, twin = cKDTree(front[upper, :3]).query(back[:, :3])
    number = len(front) + np.arange(len(back))
    number[apart < 1e-9] = upper[twin[apart < 1e-9]]
    both = np.concatenate([front, back])
    both[upper[front[upper, ARMHOLE] == 0], SIDE] = 0
    used, joined = np.unique(np.concatenate([front_faces, number[back_faces]]), return_inverse=True)
    return both[used], joined.reshape(-1, 3)


def upper_line(half: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The points of the upper one of a half sleeve's two seams, shape (N,)."""
    border = border_loop(faces)
    seam = half[border, SIDE] > 0.5
    start = np.flatnonzero(~seam)[0]
    border, seam = np.roll(border, -start), np.roll(seam, -start)
    runs = [run for run in np.split(border, np.flatnonzero(np.diff(seam)) + 1) if half[run[0], SIDE] > 0.5]
    return max(runs, key=lambda run: half[run, 2].mean())


def panel(table: np.ndarray, faces: np.ndarray, right: list[int]) -> FlatPanel:
    """A piece laid flat in the size in which it is cut; corners are where two of its seams or borders meet."""
    corner = table[:, BORDER : SIDE + 1].sum(axis=1) > 1.5
    size = table[:, 3:6]
    return laid_flat(table[:, :3], faces, corner, size, np.array(right, float), size)
