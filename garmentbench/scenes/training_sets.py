"""Training sets by name: "dress@varied" is what the wardrobe calls varied, worn by the dress."""

from collections.abc import Sequence

from garmentbench.errors import UsageError, unknown_name
from garmentbench.scenes.wardrobe import scene_name, wardrobe

MARK = "@"


def training_set(word: str) -> dict[str, int]:
    """How many frames of each scene a garment's training set takes, by the scenes' names.

    >>> training_set("dress@walk")
    {'dress-armspace-75': 300}

    Raises `UsageError` for a garment, set or scene that isn't in the wardrobe.
    """
    known = wardrobe()
    garment, _, name = word.partition(MARK)
    if garment not in known.garments:
        raise unknown_name("garment", garment, list(known.garments), f"{word}: ")
    if name not in known.training_sets:
        raise unknown_name("training set", name, list(known.training_sets), f"{word}: ")
    chosen, scenes = known.training_sets[name], known.scenes()
    frames = {scene_name(garment, m, body): count for body in chosen.bodies for m, count in chosen.frames.items()}
    for scene, count in frames.items():
        if scene not in scenes:
            raise unknown_name("scene", scene, list(scenes), f"training set {name}: ")
        length = known.scene(*scenes[scene]).frames
        if count > length:
            raise UsageError(f"training set {name}: {count} frames of {scene}, which has {length}; wanted at most that")
    return frames


def expanded(words: Sequence[str]) -> tuple[tuple[str, ...], dict[str, int]]:
    """The scenes that words stand for, and how many frames of those that a training set names.

    Words are names of scenes, files, and training sets of a garment. Raises as `training_set`.
    """
    names: dict[str, None] = {}
    frames: dict[str, int] = {}
    for word in words:
        found = training_set(word) if MARK in word else {}
        frames |= found
        names |= dict.fromkeys(found or (word,))
    return tuple(names), frames


def title(names: Sequence[str]) -> str:
    """What tables call training scenes: the set that they are, if they are one, else their names."""
    for garment in dict.fromkeys(name.split("-")[0] for name in names):
        for chosen in wardrobe().training_sets if garment in wardrobe().garments else ():
            word = f"{garment}{MARK}{chosen}"
            if len(names) > 1 and list(training_set(word)) == list(names):
                return word
    return "+".join(names)


def is_seen(motion: str, body: str, chosen: str) -> tuple[bool, bool]:
    """Does a training set have a motion's kind, and a body? motion: of the grid."""
    known = wardrobe()
    kinds = {kind(name) for name in known.training_sets[chosen].frames}
    return kind(motion) in kinds, body in known.training_sets[chosen].bodies


def what_is_new(scene: str, chosen: str) -> str:
    """What a scene has that a training set has not: "new phrase", "new kind", "new body" or "new kind and body"."""
    _, motion, body = wardrobe().scenes()[scene]
    kind_seen, body_seen = is_seen(motion, body, chosen)
    if kind_seen:
        return "new phrase" if body_seen else "new body"
    return "new kind" if body_seen else "new kind and body"


def kind(motion: str) -> str:
    """What kind of motion one of the grid is."""
    entry = wardrobe().motions[motion]
    return entry.kind or entry.motion or motion
