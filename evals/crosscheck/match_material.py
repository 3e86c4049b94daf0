"""Two strips of cloth that tell how stiff an engine really is: one hangs by its own weight, one droops from a clamp.

They are simulated in both engines until they rest, on triangles as large as the garment's: what an implicit solver that
stops early adds to a cloth's softness depends on the mesh. The other engine's membrane and hinge stiffness are scaled
until its strips end where the reference's do; what is left of the difference is the error of the match.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from garmentbench.evals.crosscheck.model import VbdSettings
from garmentbench.evals.crosscheck.vbd import drive_vbd
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment

FPS = 30.0
CLOSE = 3e-3  # of 1: nearer is not sought
FRAMES = 61
STILL = {"drag": 0.0, "drag_along": 0.0}
SETTLING = 40.0  # [1/s] comes to rest quickly; this does not change where
ROUNDS = 4
HANGING_LENGTH = 0.4  # [m]


@dataclass(frozen=True)
class Match:
    """The other engine's settings after fitting, and how far its strips then are from the reference's.

    Attributes:
        settings: With fitted `membrane` and `bending`.
        hanging: Extension of the hanging strip over the reference's, less 1.
        cantilever: Droop of the clamped strip over the reference's, less 1.
    """

    settings: VbdSettings
    hanging: float
    cantilever: float


@dataclass(frozen=True)
class Strip:
    """A strip of equilateral triangles, clamped at its first columns.

    Attributes:
        columns, rows: Edges along and across.
        edge: Their length [m].
        clamped: Columns of vertices that are held.
        hangs: It starts hanging down, else level.
    """

    columns: int
    rows: int
    edge: float
    clamped: int
    hangs: bool

    def garment(self) -> Garment:
        """The strip at rest in the plane z = 0, along x."""
        pins = [j * (self.columns + 1) + i for j in range(self.rows + 1) for i in range(self.clamped)]
        return equilateral(self.columns, self.rows, self.edge, pins)

    def start(self, rest: np.ndarray) -> np.ndarray:
        """First positions [m], shape (V, 3)."""
        x, y, z = rest.astype(np.float64).T
        return np.stack([z, y, -x] if self.hangs else [x, y, z], axis=1)

    def fall(self, positions: np.ndarray) -> float:
        """How far the free end is below where it was [m], of positions, shape (T, V, 3)."""
        end = [j * (self.columns + 1) + self.columns for j in range(self.rows + 1)]
        return float((positions[0, end, 2] - positions[-1, end, 2]).mean())


def hanging(edge: float) -> Strip:
    """A strip as long as a garment, of triangles with that edge [m]."""
    return Strip(columns=max(round(HANGING_LENGTH / edge), 2), rows=4, edge=edge, clamped=1, hangs=True)


def cantilever(material: Material, gravity: float, edge: float) -> Strip:
    """A strip that droops by about half its length: twice (rigidity / weight an area)^(1/3), or two edges [m]."""
    length = 2 * (material.bending / (material.density * gravity)) ** (1 / 3)
    return Strip(columns=2 + max(round(length / edge), 2), rows=3, edge=edge, clamped=3, hangs=False)


def match(material: Material, settings: Settings, vbd: VbdSettings, edge: float) -> Match:
    """Scale the other engine's stiffness until both strips, of triangles with that edge [m], end where the reference's
    do.

    Raises as `drive_vbd`.
    """
    slow, settings = replace(material, **STILL), replace(settings, settling=SETTLING)
    left = []
    for name, strip in (("membrane", hanging(edge)), ("bending", cantilever(slow, settings.gravity, edge))):
        wanted = reference_fall(strip, slow, settings)

        def ratio_of(v: VbdSettings, strip=strip, wanted=wanted) -> float:
            return vbd_fall(strip, slow, settings, v) / wanted

        vbd, ratio = fitted(name, vbd, ratio_of)
        left.append(ratio - 1)
    return Match(vbd, *left)


def reference_fall(strip: Strip, material: Material, settings: Settings) -> float:
    """How far a strip's end falls in the reference solver [m]."""
    from garmentbench.simulation.drive import drive  # Warp is slow to load

    garment = strip.garment()
    return strip.fall(drive(garment, strip.start(garment.rest), None, FRAMES, FPS, material, settings).positions)


def vbd_fall(strip: Strip, material: Material, settings: Settings, vbd: VbdSettings) -> float:
    """How far a strip's end falls in VBD [m]."""
    garment = strip.garment()
    return strip.fall(
        drive_vbd(garment, strip.start(garment.rest), None, FRAMES, FPS, material, settings, vbd).positions
    )


def fitted(name: str, vbd: VbdSettings, ratio: Callable[[VbdSettings], float]) -> tuple[VbdSettings, float]:
    """The settings with one stiffness scaled so that `ratio` (their fall over the wanted one) is 1, and what it is
    then.

    The secant method on the logarithms of both, begun with a fall in inverse proportion to stiffness.
    """
    points: list[tuple[float, float]] = []
    scale = np.log(getattr(vbd, name))
    for _ in range(ROUNDS):
        points.append((scale, float(np.log(ratio(replace(vbd, **{name: float(np.exp(scale))}))))))
        slope = -1.0
        if len(points) > 1 and points[-1][0] != points[-2][0]:
            slope = min(
                (points[-1][1] - points[-2][1]) / (points[-1][0] - points[-2][0]), -0.1
            )  # stiffer always falls less
        scale = scale - points[-1][1] / slope
        if abs(points[-1][1]) < CLOSE:
            break
    best, left = min(points, key=lambda p: abs(p[1]))
    return replace(vbd, **{name: float(np.exp(best))}), float(np.exp(left))


def equilateral(columns: int, rows: int, edge: float, pins: Sequence[int] = ()) -> Garment:
    """A flat strip of equilateral triangles, every second row shifted by half an edge, row by row."""
    i, j = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    points = np.stack([edge * (i + 0.5 * (j % 2)), edge * np.sqrt(0.75) * j, 0.0 * i], axis=-1).reshape(-1, 3)
    return sheet(points, columns, rows, pins)


def sheet(points: np.ndarray, columns: int, rows: int, pins: Sequence[int]) -> Garment:
    """A flat sheet of (columns + 1) x (rows + 1) points [m], row by row; the diagonals turn about from row to row."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows)))
    a = j * (columns + 1) + i
    b, c, d = a + 1, a + columns + 1, a + columns + 2
    even = (j % 2 == 0)[:, None]
    first = np.where(even, np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    second = np.where(even, np.column_stack([b, d, c]), np.column_stack([a, d, c]))
    faces = np.concatenate([first, second]).astype(np.int32)
    rest = points.astype(np.float32)
    return Garment("sheet", rest, faces, rest[:, :2], np.zeros((0, 2), np.int32), np.array(pins, np.int32))
