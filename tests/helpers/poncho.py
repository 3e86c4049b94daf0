"""A poncho as an artist would export it: rings of quads over the shoulders of an exported body."""

from pathlib import Path

import numpy as np

AROUND, RINGS = 36, 14


def write_poncho(path: Path, body: Path, scale: float = 1.0) -> None:
    """Write an OBJ file without UV, its innermost faces in the group `collar`; `body`: an exported body."""
    top = max(float(line.split()[3]) for line in body.read_text().splitlines() if line.startswith("v "))
    across, angle = np.meshgrid(np.linspace(0, 1, RINGS), 2 * np.pi * np.arange(AROUND) / AROUND, indexing="ij")
    radius = 0.12 + 0.42 * across
    height = top - 0.235 - 0.02 * across - 0.28 * across**2
    points = np.stack([1.15 * radius * np.cos(angle), 0.03 + 0.9 * radius * np.sin(angle), height], axis=-1)
    lines = ["v {:.6f} {:.6f} {:.6f}".format(*(scale * point)) for point in points.reshape(-1, 3)]
    for ring in range(RINGS - 1):
        lines.append("g collar" if ring == 0 else "g cloth")
        for k in range(AROUND):
            a, b = 1 + ring * AROUND + k, 1 + ring * AROUND + (k + 1) % AROUND
            lines.append(f"f {a} {a + AROUND} {b + AROUND} {b}")
    path.write_text("\n".join(lines) + "\n")
