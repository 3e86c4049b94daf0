"""What a scene needs of methods, simulator, metrics and recordings, and why: derived here and nowhere else.

It follows from the body, the garment, the motion and the material; nothing is measured. What follows from the template
alone is `Template.needs`, which all that runs asks; this is that, and what only a scene can say, in words.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.geometry.seeds import REACH
from garmentbench.geometry.uvmap import chart
from garmentbench.reference import scene_template
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.sequence import GARMENT, HUMAN, OBJECT, Template

TURNS = 10.0  # [degrees] A body that never turns by more has the same axes throughout, near enough.
_ON = {HUMAN: "a human body", OBJECT: "an object", GARMENT: "a garment beneath"}
MAP = 16  # pixels a side of the maps whose chart is counted, the small networks'


@dataclass(frozen=True)
class Part:
    """A part of what could be built for a scene.

    Attributes:
        name: Of the part, in lower case with underscores.
        needed: It is built. Otherwise it is absent: no parameter, no array, no column, no time.
        because: Why, in words.
        amount: The number that decides it, where there is one: a share, degrees or queries.
    """

    name: str
    needed: bool
    because: str
    amount: float | None = None


def scene_parts(scene: Scene, preset: Preset) -> tuple[Part, ...]:
    """All parts, needed or not, of a scene at a preset's mesh size. It makes the motion, which takes seconds.

    Raises `UsageError` for an unknown garment, body or motion.
    """
    template = scene_template(scene, preset.mesh)
    return (*of_template(template), *_of_simulation(scene, template, preset), *_of_motion(scene, template, preset))


def of_template(template: Template) -> tuple[Part, ...]:
    """What follows from what does not move."""
    needs, body = template.needs, template.body
    on = "nothing" if body is None else _ON[body.kind]
    wrong = (
        "has a side that cloth must not be on" if needs.interpenetration else "has no side that cloth must not be on"
    )
    what = f"what the garment is on ({on}) {wrong}"
    return (
        Part("interaction_force", needs.interaction_force, f"the garment is on {on}"),
        Part("velocity", True, "the garment has a past"),
        Part("collision_stage", needs.collision_stage, what),
        Part("interpenetration", needs.interpenetration, what),
        Part("sdf", needs.body, f"the garment is on {on}: an inside is learnt of a human body only"),
        Part("part_radii", needs.part_radii, "the body has named parts" if needs.part_radii else f"{on} has no parts"),
        Part("pins", needs.pins, f"{len(template.garment.pins)} vertices are held"),
        *([] if body is None else _near(template)),
        _chart(template),
    )


def _near(template: Template) -> list[Part]:
    """Seed points, and body vertices, that the garment can't touch or follow."""
    body, garment = template.required_body, template.garment
    distance, _ = nearest_vertices(body.rest, garment.rest)
    far = distance >= REACH
    if not far.any():
        return []
    where = _heights(body.rest[far], garment.rest)
    because = f"{100 * far.mean():.0f} % of its vertices are {100 * REACH:.0f} cm or more from the garment{where}"
    share, rigid = float(far.mean()), body.kind == OBJECT
    seeds = because + ("; but a rigid object moves as a whole" if rigid else "")
    return [Part("far_seeds", rigid, seeds, share), Part("far_body", False, because, share)]


def _heights(far: Float[np.ndarray, "far 3"], garment: Float[np.ndarray, "vertices 3"]) -> str:
    """Where these body vertices are [m]: above the garment, below it, or beside it."""
    above, below = far[:, 2] > garment[:, 2].max(), far[:, 2] < garment[:, 2].min()
    shares = {"above": above.mean(), "below": below.mean(), "beside": (~above & ~below).mean()}
    return " (" + ", ".join(f"{100 * share:.0f} % of them {word} it" for word, share in shares.items() if share) + ")"


def _chart(template: Template) -> Part:
    """Pixels of a map that no triangle covers: nothing is gathered there and nothing is read from there."""
    g = template.garment
    share = 1 - len(chart(g.uv, g.faces, MAP).pixels) / MAP**2
    because = f"{100 * share:.0f} % of the pixels of a map of {MAP} x {MAP} are covered by no cloth"
    return Part("pixels_without_chart", False, because, share)


def _of_simulation(scene: Scene, template: Template, preset: Preset) -> list[Part]:
    """Self-contact, rest angles and layers."""
    from garmentbench.simulation.assembly import assemble

    fabric = assemble(template.garment, scene.material, scene.simulation)
    creased, free = int(fabric.creased.sum()), int((~fabric.pinned).sum())
    return [
        Part("self_contact", free > 0, f"{free} of {len(fabric.pinned)} points of cloth are free to fold onto others"),
        Part("rest_angles", creased > 0, f"{creased} of {len(fabric.creased)} inner edges are bent at rest"),
        Part(
            "layers",
            scene.worn_over is not None,
            "one garment" if scene.worn_over is None else f"it is worn over {scene.worn_over.garment}",
        ),
    ]


def _of_motion(scene: Scene, template: Template, preset: Preset) -> list[Part]:
    """Queries a frame, and axes that turn with the body."""
    from garmentbench.motion import animate

    animation = animate(scene.worn_over or scene, preset)
    positions, skin = animation.positions[animation.warm_up :], animation.body
    distance, _ = nearest_vertices(skin.rest, template.garment.rest)
    near = positions[:, distance < REACH]
    step = max((float(np.linalg.norm(b - a, axis=1).max()) for a, b in pairwise(near)), default=0.0)
    queries = least_queries(step, scene.material.thickness)
    has = scene.simulation.queries
    turn = turned(skin.rest, positions)
    return [
        Part(
            "all_queries",
            queries >= has,
            f"the body near the garment moves {1e3 * step:.0f} mm a frame at most, and cloth is "
            f"{1e3 * scene.material.thickness:.0f} mm thick: to move less than that between two takes "
            f"{queries} queries, and there are {has}",
            queries,
        ),
        Part("heading_axes", turn > TURNS, f"what it is on heads within {turn:.0f} degrees", turn),
    ]


def least_queries(step: float, thickness: float) -> int:
    """So many queries a frame that a body which moves `step` [m] in it moves no more than the `thickness` of the cloth
    [m] from one to the next."""
    return max(1, math.ceil(step / thickness))


def turned(rest: Float[np.ndarray, "body 3"], positions: Float[np.ndarray, "frames body 3"]) -> float:
    """The range of headings over the frames [degrees]: of the turn about the vertical that fits the rest best."""
    flat = rest[:, :2] - rest[:, :2].mean(axis=0)
    moved = positions[..., :2] - positions[..., :2].mean(axis=1, keepdims=True)
    along = np.einsum("vx,tvx->t", flat, moved)
    across = np.einsum("v,tv->t", flat[:, 0], moved[..., 1]) - np.einsum("v,tv->t", flat[:, 1], moved[..., 0])
    return float(np.degrees(np.ptp(np.unwrap(np.arctan2(across, along)))))
