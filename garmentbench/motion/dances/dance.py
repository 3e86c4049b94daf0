"""Dances: phrases in a seeded order, each time a little different, dissolving into one another."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from garmentbench.motion.easing import smoothstep
from garmentbench.motion.legs import rest_leg
from garmentbench.motion.notation import NEUTRAL, Bearing, Hips, Score, filled, mirrored
from garmentbench.motion.steps import ALWAYS, Plant
from garmentbench.motion.variation import drift, hurry
from garmentbench.scenes.bodies import BakedBody

HOME = 0.10  # half the distance of the ankles' lines in a stand [m]
BEGIN = 0.7  # the first beat [s]
_LEG = 0.90215  # the base body's leg [m]: steps are as long as a body's legs allow
LOW = {"lift": 0.02, "push": 18.0, "tuck": 6.0, "strike": 2.0}  # how to step so that the foot hardly leaves the floor
_BAR = 4  # beats, over which the pace varies
_DRIFTS = ("space.L", "space.R", "swing.L", "swing.R", "elbow.L", "elbow.R", "bend", "twist")  # by 2 degrees or so


@dataclass(frozen=True)
class Step:
    """A step within a phrase.

    Attributes:
        side: "L" or "R".
        land: The beat on which it lands, from the phrase's start on.
        left, forward: Where to, from this foot's place in a stand [m].
        turn: The dancer has turned so far to the left by then [degrees].
        take: Length of the swing [beats].
        how: Further attributes of its `Plant`.
    """

    side: str
    land: float
    left: float = 0.0
    forward: float = 0.0
    turn: float = 0.0
    take: float = 0.55
    how: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Phrase:
    """A phrase, which begins and ends in a stand; the left foot begins. Its mirror image is danced as often.

    Attributes:
        beats: Its length.
        steps: In order.
        bearing: Of beats since its start: a smooth function, also a beat before and after the phrase.
        dips: Knots (beat, metres) of the pelvis' height against the dance's own, from after beat 0 on.
        end: The stand in which it ends: left [m], forward [m], turned to the left [degrees].
    """

    beats: int
    steps: tuple[Step, ...]
    bearing: Callable[[np.ndarray], Bearing]
    dips: tuple[tuple[float, float], ...] = ()
    end: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Dance:
    """A dance. seed: of the phrases' order. beat: its length [s]. height: of the pelvis against rest [m]."""

    seed: int
    beat: float
    height: float
    phrases: tuple[Phrase, ...]
    hips: Hips
    shift: float = 0.22
    smooth: float = 0.11


@dataclass(frozen=True)
class _Part:
    """A phrase as it is danced: from which beat and stand, mirrored or not, how large."""

    phrase: Phrase
    start: float
    place: np.ndarray
    heading: float
    mirror: bool
    size: float


def dance_score(dance: Dance, baked: BakedBody, seconds: float) -> Score:
    """The score of a dance that lasts at least so long, for a body."""
    scale = rest_leg(baked, "L").reach / _LEG
    parts = _order(dance, seconds, scale)
    paced = np.arange(0.0, seconds + 60.0, 0.01)

    def when(beat: float) -> float:
        return float(np.interp(beat, _beats(dance, paced), paced))

    level = scale * dance.height
    height = [(0.0, (0.0, 0.0, 0.0)), (BEGIN, (level, 0.0, 0.0))]
    for part in parts:
        dips = part.phrase.dips
        height += [(when(part.start + beat), (level + scale * part.size * dip, 0.0, 0.0)) for beat, dip in dips]
    return Score(
        *(_plants(baked, parts, side, when, scale) for side in "LR"),
        height=[*height, (height[-1][0] + 1.0, height[-1][1])],
        bearing=lambda t: _bearing(parts, _beats(dance, t)),
        hips=dance.hips,
        shift=dance.shift,
        smooth=dance.smooth,
    )


def _beats(dance: Dance, t: np.ndarray) -> np.ndarray:
    """The beat at each time [s]; the pace varies a little."""
    even = (t - BEGIN) / dance.beat
    return even + _BAR * hurry(np.maximum(even, 0.0) / _BAR)


def _order(dance: Dance, seconds: float, scale: float) -> list[_Part]:
    """Phrases until the end: round after round of all of them, none twice in succession."""
    chance = np.random.default_rng(dance.seed)
    parts, deck, last = [], [], -1
    start, place, heading = 0.0, np.zeros(2), 0.0
    while BEGIN + dance.beat * (start - 16) < seconds:
        if not deck:  # all of them, in another order
            deck = list(chance.permutation(len(dance.phrases)))
            deck = deck if deck[0] != last else deck[::-1]
        last = deck.pop(0)
        phrase, mirror, size = dance.phrases[last], bool(chance.integers(2)), float(chance.uniform(0.85, 1.08))
        parts.append(_Part(phrase, start, place, heading, mirror, size))
        left, forward, turned = phrase.end
        hand = -1.0 if mirror else 1.0
        place = place + _turned(scale * size * np.array([hand * left, -forward]), heading)
        start, heading = start + phrase.beats, heading + hand * turned
    return parts


def _plants(
    baked: BakedBody, parts: list[_Part], side: str, when: Callable[[float], float], scale: float
) -> list[Plant]:
    """A foot's plants, the first of them in the rest pose."""
    own = [(part, step) for part in parts for step in part.phrase.steps if (step.side == side) != part.mirror]
    leaves = [when(part.start + step.land - step.take) for part, step in own] + [ALWAYS]
    rest = baked.joints[baked.joint_names.index(f"foot.{side}")]
    out = scale * HOME * np.sign(rest[0])
    plants = [Plant(-ALWAYS, leaves[0], rest[0], rest[1])]
    for (part, step), leave in zip(own, leaves[1:], strict=True):
        hand = -1.0 if part.mirror else 1.0
        heading = part.heading + hand * step.turn
        to = scale * part.size * np.array([hand * step.left, -step.forward])
        how = dict(step.how)
        pivot, kick = hand * how.pop("pivot", 0.0), how.pop("kick", (0.0, 0.0))
        x, y = part.place + _turned(to + [out, 0.0], heading + 0.5 * pivot)
        how |= {"pivot": pivot, "kick": (scale * hand * kick[0], scale * kick[1])}
        plants.append(Plant(when(part.start + step.land), leave, x, y, heading, **how))
    return plants


def _bearing(parts: list[_Part], beats: np.ndarray) -> Bearing:
    """All channels at given beats.

    Phrases dissolve into one another over a beat, the first out of an easy stand over two.
    """
    total = {name: np.full(len(beats), rest) for name, rest in NEUTRAL.items()}
    for part in parts:
        b = beats - part.start
        share = smoothstep(b + 0.5 if part.start else (b + 1) / 2) * smoothstep(part.phrase.beats + 0.5 - b)
        on = share > 0
        own = part.phrase.bearing(b[on])
        own = filled(mirrored(own) if part.mirror else own, (on.sum(),))
        for name, rest in NEUTRAL.items():
            total[name][on] += share[on] * part.size * (own[name] - rest)
    for k, name in enumerate(_DRIFTS):
        total[name] += 2.0 * smoothstep(beats) * drift(beats / _BAR, k)
    return total


def _turned(offset: np.ndarray, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([c * offset[0] - s * offset[1], s * offset[0] + c * offset[1]])
