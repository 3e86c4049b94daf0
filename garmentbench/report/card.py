"""What the data card of a sequence is made from: names and measured numbers. Its text is `datacard_text`'s.

Nothing else goes in, so that the report makes the same card from results.csv as `garmentbench card` from the file.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from garmentbench import sequence_file
from garmentbench.sequence import Sequence
from garmentbench.sequence_file.layout import KIND, REMAKE, SCHEMA
from garmentbench.storage import hdf5

YES_NO = "yes or no"
INSIDE = "interpenetration"  # key of a sequence's info


@dataclass(frozen=True)
class Fact:
    """One line of a card.

    Attributes:
        name: Its name among the numbers, and in results.csv.
        section: The part of the card that it stands in.
        label: What it is, for people.
        unit: Its unit; "" for a count, `YES_NO` for 1 or 0.
        read: Its value of a sequence; None where it was not measured.
    """

    name: str
    section: str
    label: str
    unit: str
    read: Callable[[Sequence], float | None]


@dataclass(frozen=True)
class Card:
    """What a card is made from.

    Attributes:
        scene, preset, split, garment, motion, body: As in results.csv; "" where it is not known.
        numbers: Values of the facts that were measured.
        status: "ok", "unstable", or "" where it was not simulated.
        notes: What was settled when it was imported.
    """

    scene: str
    preset: str
    split: str
    garment: str
    motion: str
    body: str
    numbers: dict[str, float]
    status: str = ""
    notes: tuple[str, ...] = ()


def _noted(*keys: str) -> Callable[[Sequence], float | None]:
    """Reads a number from a sequence's info."""

    def read(sequence: Sequence) -> float | None:
        value: Any = sequence.info
        for key in keys:
            value = value.get(key) if isinstance(value, dict) else None
        return float(value) if isinstance(value, int | float) else None

    return read


def _body_count(what: str) -> Callable[[Sequence], float | None]:
    return lambda s: 0.0 if s.template.body is None else float(len(getattr(s.template.body, what)))


COUNTS, COST, UNCERTAINTY, PENETRATION, SELF, STRAIN = SECTIONS = (
    "Counts",
    "Cost to make",
    "Uncertainty",
    "Penetration",
    "Self-intersection",
    "Strain",
)
FACTS = (
    Fact("frames", COUNTS, "frames", "", len),
    Fact("fps", COUNTS, "frames a second", "1/s", lambda s: s.template.fps),
    Fact("garment_vertices", COUNTS, "garment vertices", "", lambda s: len(s.template.garment.rest)),
    Fact("garment_faces", COUNTS, "garment faces", "", lambda s: len(s.template.garment.faces)),
    Fact("seam_pairs", COUNTS, "seam pairs", "", lambda s: len(s.template.garment.seams)),
    Fact("pinned_vertices", COUNTS, "vertices held by the body", "", lambda s: len(s.template.garment.pins)),
    Fact("body_vertices", COUNTS, "body vertices", "", _body_count("rest")),
    Fact("body_faces", COUNTS, "body faces", "", _body_count("faces")),
    Fact("ms_per_frame", COST, "simulator, a frame", "ms", _noted("simulation", "ms_per_frame")),
    Fact("substeps", COST, "substeps a frame", "", _noted("simulation", "substeps")),
    Fact("uncertainty_cm", UNCERTAINTY, "the larger of the next two", "cm", _noted("uncertainty", "cm")),
    Fact("doubling_cm", UNCERTAINTY, "twice the substeps", "cm", _noted("uncertainty", "doubling_cm")),
    Fact("perturbed_cm", UNCERTAINTY, "start pushed by 1 mm", "cm", _noted("uncertainty", "perturbed_cm")),
    Fact("uncertainty_frames", UNCERTAINTY, "frames compared", "", _noted("uncertainty", "frames")),
    Fact(
        "has_inside",
        PENETRATION,
        "there is a body to be inside of",
        YES_NO,
        lambda s: s.template.needs.interpenetration,
    ),
    Fact(
        "vertex_percent", PENETRATION, "behind the nearest body vertex's plane", "%", _noted(INSIDE, "vertex_percent")
    ),
    Fact("strict_percent", PENETRATION, "strict, by signed distance", "%", _noted(INSIDE, "strict_percent")),
    Fact("depth_p95_mm", PENETRATION, "depth of those, 95th percentile", "mm", _noted(INSIDE, "depth_p95_mm")),
    Fact("self_percent", SELF, "faces that cross another", "%", _noted("self_intersection", "percent")),
    Fact("self_most_faces", SELF, "most in one frame", "", _noted("self_intersection", "most_faces")),
    Fact("self_contact", SELF, "self-contact is simulated", YES_NO, _noted("simulation", "settings", "self_contact")),
    Fact("mean_strain", STRAIN, "mean", "%", _noted("simulation", "mean_strain_percent")),
    Fact("p99_strain", STRAIN, "largest 99th percentile", "%", _noted("simulation", "p99_strain_percent")),
    Fact("first_bad_frame", STRAIN, "first unstable frame", "", _noted("simulation", "first_bad_frame")),
)
NEEDS_INSIDE = frozenset({"vertex_percent", "strict_percent", "depth_p95_mm"})


def card_of(sequence: Sequence) -> Card:
    """The card of a sequence."""
    info, template = sequence.info, sequence.template
    motion = info.get("motion", "")
    values = {fact.name: fact.read(sequence) for fact in FACTS}
    return Card(
        scene=str(info.get("scene", "")),
        preset=str(info.get("preset", "")),
        split=str(info.get("split", "")),
        garment=template.garment.name,
        motion=motion.get("name", "") if isinstance(motion, dict) else str(motion),
        body="" if template.body is None else template.body.name,
        numbers={name: float(value) for name, value in values.items() if value is not None},
        status=str(info.get("simulation", {}).get("status", "")),
        notes=tuple(map(str, info.get("imported", {}).get("said", ()))),
    )


def read_card(path: Path) -> Card:
    """The card of a sequence file, of which one frame is read. Raises `UserError` as `sequence_file.load`."""
    card = card_of(sequence_file.load(path, frames=1))
    with hdf5.opened(path, KIND, SCHEMA, REMAKE) as file:
        frames = hdf5.dataset(file, "garment/frames").shape[0]
    return Card(**{**vars(card), "scene": card.scene or path.stem, "numbers": card.numbers | {"frames": float(frames)}})
