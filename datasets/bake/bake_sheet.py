"""Make the two sheets of cloth on the stick: datasets/garments/{sheet,laid_sheet}-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: `python datasets/bake/bake_sheet.py` (see garmentbench/motion/stick.py). `sheet` hangs
down from the front of the stick like a curtain: held at seven points of its upper edge, a little nearer to each other
than on the cloth, so that it falls in soft folds. `laid_sheet` is laid over the stick, one end in front and the longer
one behind, wider than the stick, and held by nothing. Both are cut square.
"""

import numpy as np
from garment_file import save
from pleats import even_ring
from tube import grid_faces

from garmentbench.motion.stick import HEIGHT, RADIUS

SIDE, LAID_SIDE = 0.6, 0.9  # [m]
GAP = 0.006  # [m] off the stick: the thickness in contact, and what straight edges cut into the round
EASE = 0.08  # of the cloth between two points that are held
HELD = 7
FRONT = 0.33  # [m] of the laid sheet, below the stick's axis
MARGIN = 0.03  # of the UV square
COLUMNS = {"smoke": 18, "laptop": 36, "desktop": 72, "paper": 72}  # of faces; a multiple of HELD - 1
ROWS = {"smoke": 21, "laptop": 41, "desktop": 69, "paper": 69}  # of vertices


def hanging(columns: int, rows: int) -> dict[str, np.ndarray]:
    """The arrays of the sheet that is held by points of its upper edge: put on in even waves, which touch the stick
    where it is held."""
    square, faces = grid(columns, rows)
    turn = np.linspace(0, 2 * np.pi * (HELD - 1), 50 * columns + 1)
    # A sine of slope s at its steepest is longer than its base line by s^2 / 4, nearly.
    wave = even_ring(np.column_stack([turn, 2 * np.sqrt(EASE) * (1 - np.cos(turn))]), columns, closed=False)
    wave *= SIDE / np.linalg.norm(np.diff(wave, axis=0), axis=1).sum()
    across, out = np.tile(wave - [wave[-1, 0] / 2, 0], (rows, 1)).T
    rest = np.column_stack([across, -RADIUS - GAP - out, HEIGHT - SIDE * square[:, 1]])
    return arrays(rest, faces, square, SIDE) | {"pins": np.arange(0, columns + 1, columns // (HELD - 1))}


def laid(columns: int, rows: int) -> dict[str, np.ndarray]:
    """The arrays of the sheet that is laid over the stick."""
    square, faces = grid(columns, rows)
    radius, along = RADIUS + GAP, LAID_SIDE * (1 - square[:, 1]) - FRONT  # upwards in front, from the axis' height on
    turned = np.clip(along / radius, 0, np.pi)
    below = np.maximum(-along, 0) + np.maximum(along - np.pi * radius, 0)
    rest = np.column_stack(
        [LAID_SIDE * (square[:, 0] - 0.5), -radius * np.cos(turned), HEIGHT + radius * np.sin(turned) - below]
    )
    return arrays(rest, faces, square, LAID_SIDE)


def grid(columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """A square from 0 to 1, shape (V, 2), its second coordinate down, and its faces, whose diagonals alternate like a
    chequerboard, so that no direction is the stiffer one."""
    across, down = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows))
    number = np.arange(rows * (columns + 1)).reshape(rows, columns + 1)
    return np.column_stack([across.ravel(), down.ravel()]), grid_faces(number)


def arrays(rest: np.ndarray, faces: np.ndarray, square: np.ndarray, side: float) -> dict[str, np.ndarray]:
    """What both have in their files; the pattern is a square, its side in metres."""
    flat = np.column_stack([square[:, 0], 1 - square[:, 1]])
    return {
        "rest": rest,
        "faces": faces,
        "uv": MARGIN + (1 - 2 * MARGIN) * flat,
        "seams": np.zeros((0, 2), int),
        "pins": np.zeros(0, int),
        "cut": side * flat,
    }


def main() -> None:
    for size, columns in COLUMNS.items():
        source = "a square grid, made by datasets/bake/bake_sheet.py"
        save(f"sheet-{size}", hanging(columns, ROWS[size]), source)
        save(f"laid_sheet-{size}", laid(columns, ROWS[size]), source)


if __name__ == "__main__":
    main()
