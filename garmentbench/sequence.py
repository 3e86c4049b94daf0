"""A sequence: one simulated or imported recording of a garment on a moving body (or other collider).

What it holds is written here; how it lies in a file is `sequence_file`'s matter.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

HUMAN, OBJECT, GARMENT = "human", "object", "garment"


@dataclass(frozen=True)
class Garment:
    """A garment's template.

    Attributes:
        name: Name, e.g. "tshirt".
        rest: The shape in which it is put on [m], shape (V, 3), float32. Vertices are split at UV seams.
        faces: Triangles, shape (F, 3), int32.
        uv: UV coordinates in [0, 1], shape (V, 2), float32.
        seams: Pairs of vertices that are the same point of cloth, shape (S, 2), int32.
        pins: Vertices held fast to the collider (empty for a worn garment), shape (P,), int32.
        cut: Where each vertex lies in the flat pattern [m], shape (V, 2), float32, panels apart from one another; None
            where there is no pattern. The cloth's lengths and areas without load are the pattern's, or else those of
            `rest` (see `geometry.cloth_rest`).
    """

    name: str
    rest: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "faces 3"]
    uv: Float[np.ndarray, "vertices 2"]
    seams: Int[np.ndarray, "seams 2"]
    pins: Int[np.ndarray, " pins"] = field(default_factory=lambda: np.zeros(0, np.int32))
    cut: Float[np.ndarray, "vertices 2"] | None = None


@dataclass(frozen=True)
class Body:
    """The template of what the garment is worn by or touches: a human body, a rigid object such as a stick, or the
    garment beneath, when it is worn over one.

    Attributes:
        name: Name, e.g. "base", "stick" or "dress".
        rest: Rest (canonical pose) positions [m], shape (B, 3), float32.
        faces: Triangles, shape (K, 3), int32, outward orientation. A garment is open: it has borders.
        labels: Body part of each vertex, shape (B,), int8, index into `part_names`; None where there are no parts.
        part_names: Names of the parts, e.g. ("upper_body", "fore_arm", "rear_arm", "thigh", "calf").
        kind: "human", "object" or "garment".
    """

    name: str
    rest: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "faces 3"]
    labels: Int[np.ndarray, " vertices"] | None = None
    part_names: tuple[str, ...] = ()
    kind: str = HUMAN


@dataclass(frozen=True)
class Needs:
    """What a scene needs; nothing else is built, computed, stored or reported for it.

    Attributes:
        body: There is a human body: it has a heading, and an inside with an SDF.
        interaction_force: There is something to touch.
        part_radii: The body has named parts, so that a kernel radius per part can be learnt (else one radius).
        interpenetration: What is touched has a side that cloth must not be on: a skin, or the garment beneath. How much
            is there is measured.
        collision_stage: ... and the garment is pushed back from there.
        pins: Some vertices are held by the collider.
    """

    body: bool
    interaction_force: bool
    part_radii: bool
    interpenetration: bool
    collision_stage: bool
    pins: bool


@dataclass(frozen=True)
class Template:
    """All of a sequence that does not change over time; what a method may know before the first frame."""

    garment: Garment
    body: Body | None
    fps: float

    @property
    def required_body(self) -> Body:
        """The body, for work that only makes sense with one. Raises `ValueError` where there is none."""
        if self.body is None:
            raise ValueError(f"{self.garment.name} has no body; ask `needs` first")
        return self.body

    @cached_property
    def needs(self) -> Needs:
        """What follows from the kind of body and from the pins."""
        kind = None if self.body is None else self.body.kind
        human, worn = kind == HUMAN, kind in (HUMAN, GARMENT)
        return Needs(
            body=human,
            interaction_force=kind is not None,
            part_radii=human and self.required_body.labels is not None,
            interpenetration=worn,
            collision_stage=worn,
            pins=len(self.garment.pins) > 0,
        )


_SIMULATED = ("ms_per_frame", "strain_mean", "strain_p99_max")  # scores that are noted while simulating


@dataclass(frozen=True)
class Sequence:
    """A recording. Positions are in metres, world axes (z up), float32.

    Attributes:
        template: What does not change.
        garment: Garment positions [m], shape (T, V, 3).
        body: Body positions [m], shape (T, B, 3); None where there is no body.
        info: Names and provenance, plain JSON values: scene, split, motion, preset, and where simulated `simulation`
            (settings, substeps, strain, ms_per_frame), `scores` (its own, under the metrics' names), `runs` (what each
            further run is: name, status, first_bad_frame, substeps, ms_per_frame) and `ensemble` (what the runs say:
            spread_cm, pushed_cm, finer_cm, push_growth, chaotic).
        runs: Further runs of the same scene ("another run" of the simulator), shape (M, T, V, 3), float32, not finite
            from the frame on in which one broke; None where there are none. Body and scores are the first run's.
    """

    template: Template
    garment: Float[np.ndarray, "frames vertices 3"]
    body: Float[np.ndarray, "frames body_vertices 3"] | None
    info: dict = field(default_factory=dict)
    runs: Float[np.ndarray, "runs frames vertices 3"] | None = None

    def __len__(self) -> int:
        return len(self.garment)

    def frames(self, start: int, stop: int) -> "Sequence":
        """The same recording, frames start to stop only."""
        body = None if self.body is None else self.body[start:stop]
        runs = None if self.runs is None else self.runs[:, start:stop]
        return replace(self, garment=self.garment[start:stop], body=body, runs=runs)

    @property
    def scores(self) -> dict[str, float]:
        """The reference's own scores that are kept with it, under the metrics' names; some are the simulator's."""
        simulated = self.info.get("simulation", {})
        return {k: simulated[k] for k in _SIMULATED if k in simulated} | self.info.get("scores", {})

    @property
    def body_positions(self) -> Float[np.ndarray, "frames body_vertices 3"]:
        """The body's positions [m], shape (T, B, 3). Raises `ValueError` where there is no body."""
        if self.body is None:
            raise ValueError(f"{self.template.garment.name} has no body; ask `template.needs` first")
        return self.body

    @property
    def spread_cm(self) -> float | None:
        """What another run of the simulator errs by over the whole recording [cm], or None where it is not known."""
        return self.info.get("ensemble", {}).get("spread_cm")

    @property
    def push_growth(self) -> float | None:
        """What became of a push of 1 mm: above 1 the cloth is chaotic [1]; None where it is not known."""
        return self.info.get("ensemble", {}).get("push_growth")
