"""Contact: slopes, a cylinder, cloth that meets cloth, and what no run may do: pass through itself or blow up."""

import math
from dataclasses import replace

import numpy as np

from garmentbench.evals.crosscheck.match_material import equilateral
from garmentbench.evals.validation import exact
from garmentbench.evals.validation.case import Case
from garmentbench.evals.validation.strips import FPS, HEIGHT, strip, vacuum
from garmentbench.geometry.crossing import crossing_faces
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import OBJECT, Body, Garment
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.cloth import Solver
from garmentbench.simulation.drive import OK, drive
from garmentbench.simulation.time_step import substeps

TOUCHING, BODY_ONLY = Settings(self_contact=True), Settings(self_contact=False)
RADIUS, RUB = 0.1, 0.4  # of the cylinder [m], and friction on it
STARTS = 10


def floor(half: float = 5.0) -> Body:
    """A square floor at z = 0."""
    points = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], np.float32)
    return Body("floor", points, np.array([[0, 1, 2], [0, 2, 3]], np.int32), kind=OBJECT)


def tilt(points: np.ndarray, degrees: float) -> np.ndarray:
    """Points turned about the y axis: what lay on the floor then lies on a slope that falls towards +x."""
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return points.astype(np.float64) @ turn.T


def slide(degrees: float, friction: float, edges: float) -> float:
    """Acceleration of a sheet down a slope [m/s^2], over the second half of a second."""
    cloth = equilateral(round(edges), round(edges), 0.2 / edges)
    material = vacuum(1e-5, 100.0, friction=friction, stretch_damping=1e-4)
    body, angle = floor(), math.radians(degrees)
    start = tilt(cloth.rest + np.array([0, 0, material.thickness]), degrees)
    frames = np.tile(tilt(body.rest, degrees), (31, 1, 1))
    out = drive(cloth, start, body, frames, FPS, material, BODY_ONLY)
    way = (out.positions - start).mean(axis=1) @ [math.cos(angle), 0, -math.sin(angle)]
    return 2 * float(np.polyfit(np.arange(16) / FPS, way[15:], 2)[0])


def cylinder(segments: int = 180, width: float = 0.3) -> Body:
    """A level cylinder along y round the origin, open at its ends."""
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    ring = RADIUS * np.column_stack([np.cos(angle), 0 * angle, np.sin(angle)])
    points = np.concatenate([ring - [0, width / 2, 0], ring + [0, width / 2, 0]]).astype(np.float32)
    a = np.arange(segments)
    b = np.roll(a, -1)
    faces = np.concatenate([np.column_stack([a, a + segments, b]), np.column_stack([b, a + segments, b + segments])])
    return Body("cylinder", points, faces.astype(np.int32), kind=OBJECT)


def capstan(edges: float) -> float:
    """Tension over tension, at most, of the two ends of a strip that goes round a cylinder by half a turn, one end
    held, the other drawn; from how far both are stretched. It may slip by jerks, so no steady value is asked for."""
    material = vacuum(1e-6, 100.0, friction=RUB, stretch_damping=1e-3)
    radius, leg, taut = RADIUS + material.thickness, 0.12, 0.01
    arc = math.pi * radius
    length = (2 * leg + arc) / (1 + taut)
    cloth, along = strip(round(length * edges), length, clamped=(0, -1))
    s = (1 + taut) * along - leg
    angle = np.clip(s / radius, 0, math.pi)
    x = -radius * np.cos(angle)
    z = radius * np.sin(angle) + np.minimum(s, 0) - np.maximum(s - arc, 0)
    start = np.column_stack([x, cloth.rest[:, 1] - cloth.rest[:, 1].mean(), z])
    body, frames = _drawn_over(radius, leg)
    out = drive(cloth, start, body, frames, FPS, material, replace(BODY_ONLY, gravity=0.0, settling=30.0))
    a, b = out.fabric.edges.T
    first = np.unique(out.fabric.particle, return_index=True)[1]
    lies = out.fabric.rest[:, 0]
    level = np.abs(lies[a] - lies[b]) > 0.9 * length / round(length * edges)  # the edges along the strip
    middle = (lies[a] + lies[b]) / 2
    x = out.positions[:, first]
    strain = np.linalg.norm(x[:, b] - x[:, a], axis=-1) / out.fabric.length - 1
    inner = 0.8 * leg
    held, drawn = (level & (middle < inner)), (level & (middle > length - inner))
    return float((strain[:, drawn].mean(axis=1) / strain[:, held].mean(axis=1)).max())


def _drawn_over(radius: float, leg: float) -> tuple[Body, np.ndarray]:
    """The cylinder with a plate below each side, and positions (T, B, 3) in which one plate sinks."""
    body = cylinder()
    plate = 0.02 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    held, drawn = (plate + [side * radius, 0, -leg] for side in (-1, 1))
    rest = np.concatenate([body.rest, held, drawn]).astype(np.float32)
    square, count = np.array([[0, 1, 2], [0, 2, 3]]), len(body.rest)
    faces = np.concatenate([body.faces, square + count, square + count + 4]).astype(np.int32)
    frames = np.tile(rest.astype(np.float64), (46, 1, 1))
    frames[:, count + 4 :, 2] -= 0.012 * np.clip(np.arange(46) / 30, 0, 1.5)[:, None]
    return Body("cylinder", rest, faces, kind=OBJECT), frames


def two_sheets(gap: float, coarse: int, fine: int, width: float = 0.16) -> tuple[Garment, int]:
    """Two level sheets of one garment, the second `gap` [m] above the first; and how many vertices the first has."""
    lower, upper = (equilateral(n, round(n / HEIGHT), width / n) for n in (coarse, fine))
    count = len(lower.rest)
    rest = np.concatenate([lower.rest, upper.rest + [0, 0, gap]])
    faces = np.concatenate([lower.faces, upper.faces + count])
    nothing = np.zeros(0, np.int32)
    rest = rest.astype(np.float32)
    return Garment("sheets", rest, faces, rest[:, :2], nothing.reshape(0, 2), nothing), count


def momentum_lost(fine_above: bool) -> float:
    """What two sheets that meet at 1 m/s in free space lose of the momentum of the upper one [%]; one is twice as
    fine."""
    sizes = (6, 12) if fine_above else (12, 6)
    cloth, count = two_sheets(0.03, *sizes)
    material, settings = vacuum(1e-5, 100.0, stretch_damping=1e-4), replace(TOUCHING, gravity=0.0)
    fabric = assemble(cloth, material, settings)
    steps = substeps(fabric, material, settings, 1 / FPS)
    solver = Solver(fabric, fabric.rest, None, material, settings, steps, 1 / FPS)
    velocity = np.zeros_like(fabric.rest)
    velocity[fabric.particle[count:], 2] = -1.0
    solver.cloth.v.assign(velocity.astype(np.float32))
    for _ in range(8):
        solver.advance()
    before, after = (fabric.mass @ v.astype(np.float64) for v in (velocity, solver.velocities))
    return 100 * float(np.linalg.norm(after - before) / np.linalg.norm(before))


def twisted(edges: float) -> float:
    """Faces that cross others [a frame, at most], while the ends of a sheet are turned against each other once in 300
    frames, and brought nearer by a third so that it winds up. A second turn would make a rope thinner than these
    triangles."""
    width, length, frames, turns = 0.08, 0.3, 300, 1.0
    rows = round(edges * width / length / HEIGHT)
    count = round(edges) + 1
    pins = [j * count + i for j in range(rows + 1) for i in (0, 1, count - 2, count - 1)]
    cloth = equilateral(count - 1, rows, length / (count - 1), pins)
    middle = float(cloth.rest[:, 1].mean())
    size = 0.06
    plate = np.array([[0, -size, -size], [0, size, -size], [0, size, size], [0, -size, size]])
    rest = np.concatenate([plate + [0, middle, 0], plate + [length, middle, 0]])  # their faces look at the sheet
    body = Body(
        "plates", rest.astype(np.float32), np.array([[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]], np.int32), kind=OBJECT
    )
    part = np.clip(np.arange(frames + 1) / (0.9 * frames), 0, 1)
    angle = np.pi * turns * part
    moving = np.empty((frames + 1, 8, 3))
    for k, sign in ((0, 1.0), (4, -1.0)):
        c, s = np.cos(sign * angle), np.sin(sign * angle)
        y, z = rest[k : k + 4, 1] - middle, rest[k : k + 4, 2]
        moving[:, k : k + 4, 0] = rest[k : k + 4, 0] + sign * length / 6 * part[:, None]
        moving[:, k : k + 4, 1] = middle + c[:, None] * y - s[:, None] * z
        moving[:, k : k + 4, 2] = s[:, None] * y + c[:, None] * z
    material = Material(thickness=0.003)
    out = drive(
        cloth,
        cloth.rest.astype(np.float64),
        body,
        moving,
        FPS,
        material,
        replace(TOUCHING, gravity=0.0, start_noise=1e-4),
    )
    if out.status != OK:
        return math.nan
    return float(crossing_faces(out.positions[::10], cloth.faces, cloth.seams).sum(axis=1).max())


def ball(radius: float = 0.1) -> Body:
    """A ball round the origin."""
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    return Body("ball", mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32), kind=OBJECT)


def good_starts(edges: float) -> float:
    """Of ten sheets, each pushed by 1 mm in its own way, that fall over a ball: how many stay whole, outside of it, and
    outside of themselves."""
    cloth = equilateral(round(edges), round(edges / HEIGHT), 0.4 / edges)
    body = ball()
    start = cloth.rest + np.array([-0.2, -0.2, 0.12])
    frames = np.tile(body.rest.astype(np.float64), (46, 1, 1))
    good = 0
    for seed in range(STARTS):
        settings = replace(TOUCHING, start_noise=1e-3, noise_seed=seed)
        out = drive(cloth, start, body, frames, FPS, Material(), settings)
        last = out.positions[-1:]
        outside = np.linalg.norm(last, axis=-1).min() > 0.1 - 1e-3
        good += out.status == OK and outside and not crossing_faces(last, cloth.faces, cloth.seams).any()
    return float(good)


def _slide(friction: float) -> Case:
    return Case(
        name=f"slope_{friction:g}",
        title=f"sheet on a slope of 30 degrees, friction {friction:g}: acceleration",
        unit="m/s²",
        wanted=lambda: exact.sliding(30.0, friction),
        simulate=lambda edges: slide(30.0, friction, edges),
        sizes={"2.5 cm": 8.0},
        tolerance=0.01 * exact.sliding(30.0, friction) or 1e-3,
        source="Coulomb" if friction < math.tan(math.radians(30)) else "Coulomb: it sticks from 0.577 on",
        fast=friction != 0.2,
    )


def _momentum(fine_above: bool) -> Case:
    return Case(
        name=f"momentum_{'fine' if fine_above else 'coarse'}_above",
        title=f"two sheets that meet at 1 m/s in free space, {'upper' if fine_above else 'lower'} finer: momentum lost",
        unit="%",
        wanted=lambda: 0.0,
        simulate=lambda _: momentum_lost(fine_above),
        tolerance=1.0,
        source="momentum is kept",
    )


CASES = (
    *map(_slide, (0.2, 0.4, 0.6)),
    Case(
        name="capstan",
        title="strip drawn over a cylinder, half a turn, friction 0.4: tension over tension when it slips",
        unit="1",
        wanted=lambda: math.exp(RUB * math.pi),
        simulate=capstan,
        sizes={"4 cm": 25.0, "2 cm": 50.0, "1 cm": 100.0},
        tolerance=0.05,
        relative=True,
        source="exp(mu phi), Eytelwein 1808",
    ),
    *map(_momentum, (False, True)),
    Case(
        name="twist",
        title="sheet whose ends are turned against each other, one turn in 300 frames: faces that cross, at most",
        unit="1",
        wanted=lambda: 0.0,
        simulate=twisted,
        sizes={"1.2 cm": 25.0, "7.5 mm": 40.0},
        cost=25.0,
        source="cloth does not pass through itself",
        fast=False,
    ),
    Case(
        name="ten_starts",
        title="sheet that falls over a ball, ten starts pushed by 1 mm: runs that end whole and outside of both",
        unit="of 10",
        wanted=lambda: float(STARTS),
        simulate=good_starts,
        sizes={"2.5 cm": 16.0},
        source="no run may fail",
        fast=False,
    ),
)
