"""Bake the dress into datasets/garments/dress-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: `pip install -e .[bake]`, bake the bodies, then `python datasets/bake/bake_dress.py`.
Its top, with short sleeves, is cut like the T-shirt; from the waist a skirt in wide pleats hangs to the knees. Front
and back are a panel each, sewn at sides, shoulders and sleeves.
"""

import charts
import gpytoolbox
import numpy as np
from cutting import Pattern, cut, frontness, loosen
from fitting import Cloth, body_skin
from garment_file import save
from lattice import size
from pleats import doubled, even_ring, opened, pleated_row, row_heights, strips
from scipy.ndimage import gaussian_filter
from sizes import VERTICES
from surface import Skin, border_loops
from tights import SOURCE, fine_tights
from tube import AXIS, WAIST, hull_radius, without_arms

HEM = 0.50  # [m] height, at the knees
CLEARANCE = 0.010  # [m] of the folds' inner edges off the hull
SLOPE = 0.16  # of the cone on which these lie: outwards over down
OPEN = WAIST - 0.05  # [m] height from which on the pleats are open
PLEATS = 12  # even, so that half of them are in front
DEPTH_WAIST, DEPTH_HEM = 0.022, 0.055  # [m] of the folds, if they began at the waist
ANGLES = 720
ROW = 0.9  # of an edge: from one row to the next


def bodice(skin: Skin) -> Cloth:
    """The dress above the waist, ready to be meshed at any size."""
    points, faces, arm, joints = fine_tights()
    pattern = Pattern(
        sleeve=("upper_arm.L", "fore_arm.L", 0.40),
        hem=WAIST,
        ease_top=0.008,
        ease_hem=0.014,
        ease_sleeve=0.024,
        ease_armpit=0.10,
    )
    points, faces, arm = cut(points, faces, arm, joints, pattern)
    points = loosen(points, faces, arm, joints, pattern, skin)
    points, faces = gpytoolbox.subdivide(points, faces, method="loop")[:2]
    return Cloth(points, faces, frontness(points, joints))


def waist_loop(top: dict[str, np.ndarray]) -> tuple[np.ndarray, int]:
    """Vertices of the top's lower border, one of each pair of copies, counterclockwise seen from above from the right
    side seam on, along the front; and the place of the left side seam's in it."""
    number = np.arange(len(top["rest"]))
    number[top["seams"][:, 1]] = top["seams"][:, 0]
    loop = min(border_loops(number[top["faces"]]), key=lambda loop: top["rest"][loop, 2].mean())
    right, left = sorted(np.flatnonzero(np.isin(loop, top["seams"][:, 0])), key=lambda at: top["rest"][loop[at], 0])
    return np.roll(loop, -right), (left - right) % len(loop)


def inner_rings(waist: np.ndarray, left: int, heights: np.ndarray) -> np.ndarray:
    """Where the folds' inner edges lie, shape (rows, ANGLES, 3) [m], half of the points from the right side seam along
    the front to the left one and half along the back: off the body's hull, on a cone that goes on from the waist."""
    offset = waist[:, :2] - AXIS
    around = np.unwrap(np.arctan2(*offset.T[::-1]))
    angles = around[0] + np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    start = np.interp(angles, around, np.linalg.norm(offset, axis=1), period=2 * np.pi)
    fine = np.arange(WAIST, HEM - 0.01, -0.01)
    cone = start + SLOPE * (WAIST - fine)[:, None]
    radius = np.maximum(cone, hull_radius(*without_arms(), fine, angles) + CLEARANCE)
    radius = gaussian_filter(radius, (1.5, 6), mode=("nearest", "wrap"))
    toward = np.column_stack([np.cos(angles), np.sin(angles)])
    half = np.searchsorted(angles, around[left])
    rings = []
    for z in heights:
        ring = AXIS + np.array([np.interp(-z, -fine, r) for r in radius.T])[:, None] * toward
        front, back = ring[: half + 1], np.concatenate([ring[half:], ring[:1]])
        even = np.concatenate([even_ring(side, ANGLES // 2, closed=False)[:-1] for side in (front, back)])
        rings.append(np.column_stack([even, np.full(len(even), z)]))
    return np.stack(rings)


def skirt_rows(waist: np.ndarray, left: int, edge: float) -> list[np.ndarray]:
    """The skirt's rows below the waist, shape (C + 1, 3) [m] each, the last point a copy of the first."""
    heights = row_heights([WAIST, HEM], ROW * edge)[1:]
    rings = inner_rings(waist, left, heights)
    depth = opened(heights, WAIST, OPEN) * np.interp(heights, [HEM, WAIST], [DEPTH_HEM, DEPTH_WAIST])
    along = np.linalg.norm(np.roll(rings, -1, axis=1) - rings, axis=-1).sum(axis=1) / (2 * PLEATS)
    side = np.hypot(along + np.pi * depth / (2 * PLEATS), depth)
    return [pleated_row(ring, d, PLEATS, doubled(wide, edge)) for ring, d, wide in zip(rings, depth, side, strict=True)]


def dress(top: dict[str, np.ndarray], edge: float) -> dict[str, np.ndarray]:
    """The arrays of the dress's file: the top and, joined to it, the skirt."""
    loop, left = waist_loop(top)
    rows = skirt_rows(top["rest"][loop], left, edge)
    back_copy = dict(top["seams"].tolist())
    front_end, back_end = loop[: left + 1], np.append(loop[left:], loop[0])
    back_end = np.array([back_copy.get(v, v) for v in back_end.tolist()])
    points, faces, seams = [top["rest"]], [top["faces"]], [top["seams"]]
    count, ends, panels = len(top["rest"]), [], [np.isin(top["faces"], panel_of(top)).all(axis=1)]
    in_front, behind = [r[: len(r) // 2 + 1] for r in rows], [r[len(r) // 2 :] for r in rows]
    for upper, halves in ((front_end, in_front), (back_end, behind)):
        strip = strips([np.linspace(0, 1, n) for n in (len(upper), *map(len, halves))])[0]
        number = np.concatenate([upper, count + np.arange(sum(map(len, halves)))])
        points.extend(halves)
        faces.append(number[strip])
        panels.append(np.full(len(strip), upper is front_end))
        last = count + np.cumsum([len(half) for half in halves]) - 1
        ends.append((last - [len(half) - 1 for half in halves], last))
        count = last[-1] + 1
    (front_first, front_last), (back_first, back_last) = ends
    seams += [np.column_stack([front_first, back_last]), np.column_stack([front_last, back_first])]
    rest, faces, front = np.concatenate(points), np.concatenate(faces), np.concatenate(panels)
    return {
        "rest": rest,
        "faces": faces,
        "uv": both_charts(rest, faces, front),
        "seams": np.concatenate(seams),
        "pins": np.zeros(0, int),
    }


def panel_of(top: dict[str, np.ndarray]) -> np.ndarray:
    """The vertices of the top's front panel, which come first."""
    return np.arange(top["seams"][:, 1].min())


def both_charts(rest: np.ndarray, faces: np.ndarray, front: np.ndarray) -> np.ndarray:
    """UV coordinates: both panels laid flat, upright beside each other, shape (V, 2)."""
    flat, used = [], []
    for side, sign in ((front, 1), (~front, -1)):
        mine, local = np.unique(faces[side], return_inverse=True)
        upright = np.column_stack([sign * rest[mine, 0], rest[mine, 2]])
        flat.append(charts.turn(charts.flatten(rest[mine], local.reshape(-1, 3)), upright))
        used.append(mine)
    uv = np.zeros((len(rest), 2))
    for mine, chart in zip(used, charts.side_by_side(flat), strict=True):
        uv[mine] = chart
    return uv


def best_edge(cloth: Cloth, waist: np.ndarray, left: int, wanted: int) -> float:
    """The edge length [m] that makes nearest to `wanted` vertices."""

    def count(edge: float) -> int:
        return sum(size(panel, edge) for panel in cloth.panels) + sum(len(r) + 1 for r in skirt_rows(waist, left, edge))

    edge = 1 / np.sqrt(wanted)
    for _ in range(4):
        edge *= np.sqrt(count(edge) / wanted)
    return min(edge * np.linspace(0.9, 1.1, 61), key=lambda e: abs(count(e) - wanted))


def main() -> None:
    skin = body_skin()
    cloth = bodice(skin)
    coarse = cloth.meshed(skin, 0.03)
    loop, left = waist_loop(coarse)
    for name, wanted in VERTICES["dress"].items():
        edge = best_edge(cloth, coarse["rest"][loop], left, wanted)
        save(f"dress-{name}", dress(cloth.meshed(skin, edge), edge), f"{SOURCE}; made by datasets/bake/bake_dress.py")


if __name__ == "__main__":
    main()
