"""What a metric is, and what it is computed from."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from jaxtyping import Bool, Float

from garmentbench.sequence import Sequence, Template

T = TypeVar("T")
BLOCK = 32  # frames that are measured together: few enough to stay in the processor's cache


def blocks(frames: Float[np.ndarray, "frames ..."]) -> Iterator[Float[np.ndarray, "block ..."]]:
    """The frames, a few at a time, float64."""
    for start in range(0, len(frames), BLOCK):
        yield frames[start : start + BLOCK].astype(np.float64)


@dataclass(frozen=True)
class Motion:
    """What a metric is computed from. The reference is scored by putting it in the prediction's place.

    Attributes:
        predicted: [m], shape (T, V, 3).
        reference: [m], shape (T, V, 3).
        body: [m], shape (T, B, 3); None where there is no body.
        template: What does not change over time.
        before_collision: As `predicted`, before the method's collision stage; None where it has none.
        ms: Wall time of each frame's prepare, predict and collide [ms], shape (T, 3); None where nothing was timed.
        processor_ms: Processor time of each frame [ms], shape (T,); None where it was not taken.
        novelty: How far each frame is from what the method was trained on, shape (T,), NaN where it didn't say; None
            where it never does.
        runs: Further runs of the reference [m], shape (M, T, V, 3); None where there are none.
        kept: What `once` has measured; motions that come from one another by `replace` share it.
    """

    predicted: Float[np.ndarray, "frames vertices 3"]
    reference: Float[np.ndarray, "frames vertices 3"]
    body: Float[np.ndarray, "frames body_vertices 3"] | None
    template: Template
    before_collision: Float[np.ndarray, "frames vertices 3"] | None = None
    ms: Float[np.ndarray, "frames 3"] | None = None
    processor_ms: Float[np.ndarray, " frames"] | None = None
    novelty: Float[np.ndarray, " frames"] | None = None
    runs: Float[np.ndarray, "runs frames vertices 3"] | None = None
    kept: dict = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def of(cls, sequence: Sequence) -> "Motion":
        """A sequence as its own prediction."""
        return cls(sequence.garment, sequence.garment, sequence.body, sequence.template, runs=sequence.runs)

    @property
    def truth(self) -> "Motion":
        """The reference in the prediction's place; it has no collision stage and was not timed."""
        before = None if self.before_collision is None else self.reference
        return replace(
            self, predicted=self.reference, before_collision=before, ms=None, processor_ms=None, novelty=None
        )

    def once(self, measure: Callable[[Any, "Motion"], T], positions: Float[np.ndarray, "frames vertices 3"]) -> T:
        """`measure(positions, self)`, measured once, however many metrics ask and in whosever place the positions are:
        it may depend on them, on what goes with them (the body, the template), and on nothing else."""
        key = (measure, id(positions))
        if key not in self.kept:
            self.kept[key] = (positions, measure(positions, self))
        return self.kept[key][1]

    @property
    def ensemble(self) -> list[Float[np.ndarray, "frames vertices 3"]]:
        """All runs of the reference [m], each of shape (T, V, 3), the first one first."""
        return [self.reference, *([] if self.runs is None else self.runs)]

    @cached_property
    def distances(self) -> Float[np.ndarray, "frames vertices"]:
        """Signed distance of every vertex to the body [m], negative inside, shape (T, V). There must be a body."""
        from garmentbench.geometry.signed_distance import signed_distances  # it brings Warp

        body, template = self.body, self.template.body
        assert body is not None and template is not None
        return signed_distances(self.predicted, body, template.faces)

    @cached_property
    def distances_between(self) -> Float[np.ndarray, "frames points"]:
        """The same of the middles of the garment's edges and the centres of its faces, shape (T, E + F); +inf where the
        corners are so far outside that these can't be inside. There must be a body."""
        from garmentbench.geometry.signed_distance import signed_distances_between

        body, template = self.body, self.template.body
        assert body is not None and template is not None
        garment = self.template.garment
        return signed_distances_between(self.predicted, garment.faces, self.distances, body, template.faces)

    @cached_property
    def crossing(self) -> Bool[np.ndarray, "frames faces"]:
        """Which of the garment's faces cross another, shape (T, F)."""
        from garmentbench.geometry.crossing import crossing_faces

        garment = self.template.garment
        return crossing_faces(self.predicted, garment.faces, garment.seams)


@dataclass(frozen=True)
class Metric:
    """A metric: all that is stated of a number, once.

    Attributes:
        name: As in results.csv, and wherever else the number is kept.
        unit: Its unit.
        title: Its label in tables.
        compute: Its value, of a `Motion`; of a number that only a study has, of what `compute` itself says.
        applies: To which motions (by default to all); elsewhere it has no row.
        best: "low", "high", or "one" (the nearer to 1 the better).
        whole: It needs the shape of the whole roll-out: NaN where that ended early. The reference has a value of its
            own.
        compares: It compares with the reference's first run, and another run of the simulator in the prediction's place
            is shown beside it.
    """

    name: str
    unit: str
    title: str
    compute: Callable[..., float]
    applies: Callable[[Motion], bool] = lambda motion: True
    best: str = "low"
    whole: bool = True
    compares: bool = False


def has_inside(motion: Motion) -> bool:
    """Is the garment worn on a skin or on another garment, so that cloth can be on the wrong side?"""
    return motion.template.needs.interpenetration


def scores(motion: Motion, *metrics: Metric) -> dict[str, float]:
    """Values of those metrics that apply, by name."""
    return {metric.name: metric.compute(motion) for metric in metrics if metric.applies(motion)}
