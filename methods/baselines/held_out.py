"""What settings are chosen on: parts of the training that a fit leaves out."""

from collections.abc import Sequence as Several

from garmentbench.sequence import Sequence

_HELD_OUT = 0.25  # of the frames of one kind of motion, the last ones


def kind(sequence: Sequence) -> str:
    """What tells kinds of motion apart: the motion's name, and of a clip its file."""
    motion = sequence.info.get("motion", "")
    return f"{motion.get('name')} {motion.get('file') or ''}" if isinstance(motion, dict) else str(motion)


def folds(kinds: Several[str], lengths: Several[int]) -> list[list[int]]:
    """How settings are chosen: for each fold where each recording is cut. What is before is fitted to, the rest is
    held out.

    Of several kinds of motion each is held out once, whole: a setting that is chosen on the end of what it was fitted
    to is too bold for another motion. Of one kind the last quarter of each recording is held out.
    """
    if len(set(kinds)) > 1:
        return [[0 if k == out else n for k, n in zip(kinds, lengths, strict=True)] for out in dict.fromkeys(kinds)]
    return [[int(n * (1 - _HELD_OUT)) for n in lengths]]
