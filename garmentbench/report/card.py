"""What the data card of a sequence is made from: names and measured numbers. Its text is `datacard_text`'s.

Nothing else goes in, so that the report makes the same card from results.csv as `garmentbench card` from the file.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import Any

from garmentbench import sequence_file
from garmentbench.errors import UserError
from garmentbench.metrics import metric
from garmentbench.sequence import Sequence
from garmentbench.sequence_file.layout import KIND, REMAKE, SCHEMA
from garmentbench.storage import hdf5

YES_NO = "yes or no"


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


def _score(name: str, section: str, label: str) -> Fact:
    """One of the reference's own scores, under the metric's name."""
    return Fact(name, section, label, metric(name).unit, lambda s: s.scores.get(name))


def _body_count(what: str) -> Callable[[Sequence], float | None]:
    return lambda s: 0.0 if s.template.body is None else float(len(getattr(s.template.body, what)))


def _broken(sequence: Sequence) -> float | None:
    """How many of the further runs are not finite or no cloth any more; None where there are none."""
    runs = sequence.info.get("runs")
    return None if runs is None else float(sum(run["status"] != "ok" for run in runs))


COUNTS, COST, SPREAD, PENETRATION, SELF, STRAIN = SECTIONS = (
    "Counts",
    "Cost to make",
    "Spread",
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
    _score("ms_per_frame", COST, "simulator, a frame"),
    Fact("substeps", COST, "substeps a frame", "", _noted("simulation", "substeps")),
    Fact("runs", SPREAD, "runs", "", lambda s: 1 + len(s.info.get("runs", ()))),
    Fact("runs_broken", SPREAD, "further runs that broke", "", _broken),
    Fact("spread", SPREAD, "two runs are apart", "cm", lambda s: s.spread_cm),
    Fact("pushed_cm", SPREAD, "pushed by 1 mm, from the first", "cm", _noted("ensemble", "pushed_cm")),
    Fact("finer_cm", SPREAD, "twice the substeps and queries, from the first", "cm", _noted("ensemble", "finer_cm")),
    Fact("push_growth", SPREAD, "growth of the push, last fifth", "1", _noted("ensemble", "push_growth")),
    Fact(
        "has_inside",
        PENETRATION,
        "there is a body to be inside of",
        YES_NO,
        lambda s: s.template.needs.interpenetration,
    ),
    _score("interpenetration", PENETRATION, "behind the nearest body vertex's plane"),
    _score("interpenetration_strict", PENETRATION, "strict, by signed distance"),
    _score("depth_p95", PENETRATION, "depth of those, 95th percentile"),
    _score("faces_inside", PENETRATION, "of the middles of edges and faces"),
    _score("skin_frames", PENETRATION, "frames with skin more than 0.5 mm through"),
    _score("self_intersection", SELF, "faces that cross another"),
    _score("crossing_faces_max", SELF, "most in one frame"),
    Fact("self_contact", SELF, "self-contact is simulated", YES_NO, _noted("simulation", "settings", "self_contact")),
    _score("strain_mean", STRAIN, "mean"),
    _score("strain_p99_max", STRAIN, "largest 99th percentile"),
    Fact("first_bad_frame", STRAIN, "first unstable frame", "", _noted("simulation", "first_bad_frame")),
)
NEEDS_INSIDE = frozenset({"interpenetration", "interpenetration_strict", "depth_p95", "faces_inside", "skin_frames"})


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
        numbers={name: float(value) for name, value in values.items() if value is not None and isfinite(value)},
        status=str(info.get("simulation", {}).get("status", "")),
        notes=tuple(map(str, info.get("imported", {}).get("said", ()))),
    )


def frame_count(path: Path) -> int:
    """How many frames a sequence file has. Raises `UserError` for a file that is no sequence."""
    with hdf5.opened(path, KIND, SCHEMA, REMAKE) as file:
        frames = hdf5.dataset(file, "garment/frames")
        if frames is None:
            raise UserError(f"{path}: lacks garment/frames; {REMAKE}")
        return int(frames.shape[0])


def read_card(path: Path) -> Card:
    """The card of a sequence file, of which one frame is read. Raises `UserError` as `sequence_file.load`."""
    card = card_of(sequence_file.load(path, frames=1))
    numbers = card.numbers | {"frames": float(frame_count(path))}
    return replace(card, scene=card.scene or path.stem, numbers=numbers)
