"""Make the sheet of cloth that winds round the stick: datasets/garments/sheet-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: `python datasets/bake/bake_sheet.py`. It hangs straight down from the front of the
stick at rest (see garmentbench/motion/stick.py), held by its upper row of vertices.
"""

import numpy as np
from sizes import VERTICES

from garmentbench.motion.stick import HEIGHT, RADIUS
from garmentbench.paths import GARMENTS

SIDE = 0.6  # [m]
GAP = 0.004  # [m] off the stick, more than the cloth's thickness in the simulation
MARGIN = 0.03  # of the UV square


def sheet(rows: int) -> dict[str, np.ndarray]:
    """A flat square grid whose diagonals alternate like a chequerboard, so that no direction is the stiffer one."""
    across, down = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, rows))
    uv = np.column_stack([across.ravel(), 1 - down.ravel()])
    rest = np.column_stack([SIDE * (uv[:, 0] - 0.5), np.full(len(uv), -RADIUS - GAP), HEIGHT - SIDE * (1 - uv[:, 1])])
    number = np.arange(rows * rows).reshape(rows, rows)
    a, b, c, d = (corner.ravel() for corner in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    falling = (np.add.outer(np.arange(rows - 1), np.arange(rows - 1)) % 2 == 0).ravel()[:, None]
    first = np.where(falling, np.stack([a, b, c], 1), np.stack([a, b, d], 1))
    second = np.where(falling, np.stack([a, c, d], 1), np.stack([b, c, d], 1))
    return {
        "rest": rest.astype(np.float32),
        "faces": np.concatenate([first, second]).astype(np.int32),
        "uv": (MARGIN + (1 - 2 * MARGIN) * uv).astype(np.float32),
        "seams": np.zeros((0, 2), np.int32),
        "pins": number[0].astype(np.int32),
    }


def main() -> None:
    for size, wanted in VERTICES["sheet"].items():
        rows = round(np.sqrt(wanted))
        np.savez_compressed(
            GARMENTS / f"sheet-{size}.npz",
            **sheet(rows),
            licence=np.array("CC0-1.0"),
            provenance=np.array("a flat grid, made by datasets/bake/bake_sheet.py"),
        )
        print(f"sheet-{size}: {rows * rows} vertices")


if __name__ == "__main__":
    main()
