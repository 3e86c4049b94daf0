"""Which scenes are the headline: those of a seen kind of motion where the pose alone won't do, and dynamics can.

A scene of new phrases, 400 frames or more of a kind of motion and a body that were trained on, qualifies if

    static ridge >= 1.15 x best dynamic baseline   (the garment's state pays)
    best dynamic baseline >= 2 x PCA floor         (there is something left to win)
    spread <= half of the best dynamic baseline    (what is left can be foretold)

If fewer than three qualify, the three that come nearest are the headline, and are called so.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

NEW_PHRASE = "new phrase"
FRAMES = 400  # a headline scene has, at least
COUNT = 3  # headline scenes, at least
PAYS, LEFT, FORETOLD = 1.15, 2.0, 0.5


@dataclass(frozen=True)
class Demand:
    """What was measured of a scene; errors of free roll-outs over all of it [cm], NaN where there is none.

    Attributes:
        scene: Its name.
        what_is_new: To what was trained on: "new phrase", "new kind", "new body" or "new kind and body".
        frames: Its length.
        static: Error of the static ridge.
        dynamic: Of the best baseline that has a garment state.
        floor: Of the best codes.
        spread: What another run of the simulator errs by.
    """

    scene: str
    what_is_new: str
    frames: int
    static: float
    dynamic: float
    floor: float
    spread: float

    @property
    def ratios(self) -> tuple[float, float, float]:
        """What the rule is about: static over dynamic, dynamic over floor, spread over dynamic; NaN where that isn't
        known."""
        return (
            _ratio(self.static, self.dynamic),
            _ratio(self.dynamic, self.floor),
            _ratio(self.spread, self.dynamic),
        )

    @property
    def margins(self) -> dict[str, float]:
        """By what fails where it is below 1: how far each condition is met; NaN where that isn't known."""
        return {
            "the pose alone does it": _ratio(self.static, PAYS * self.dynamic),
            "at the floor": _ratio(self.dynamic, LEFT * self.floor),
            "the spread is too large": _ratio(FORETOLD * self.dynamic, self.spread),
        }

    @property
    def nearness(self) -> float:
        """The least of its margins: 1 or more qualifies. One that isn't known counts as 0."""
        return min(0.0 if math.isnan(margin) else margin for margin in self.margins.values())


def _ratio(one: float, other: float) -> float:
    if math.isnan(one) or math.isnan(other):
        return math.nan
    return math.inf if other == 0 else one / other


def headline(demands: Sequence[Demand]) -> tuple[list[str], int]:
    """The headline scenes, best first, and how many of them meet the rule."""
    candidates = [d for d in demands if d.what_is_new == NEW_PHRASE and d.frames >= FRAMES]
    ranked = sorted(candidates, key=lambda d: (-d.nearness, d.scene))
    qualify = sum(d.nearness >= 1 for d in ranked)
    return [d.scene for d in ranked[: max(qualify, COUNT)]], qualify


def verdict(demand: Demand, chosen: Sequence[str]) -> str:
    """What a scene is good for, in the table's words. chosen: the headline scenes."""
    if demand.what_is_new != NEW_PHRASE:
        return "generalisation"
    if demand.frames < FRAMES:
        return f"shorter than {FRAMES} frames"
    failing = [
        f"not known whether {what}" if math.isnan(margin) else what
        for what, margin in demand.margins.items()
        if not margin >= 1
    ]
    if demand.scene in chosen:
        return f"headline, for want of a better one: {', '.join(failing)}" if failing else "headline"
    return ", ".join(failing)
