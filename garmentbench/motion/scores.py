"""The motions that are written as scores: dances, run, jump, stand-still."""

from collections.abc import Callable
from functools import partial

from garmentbench.bodies import BakedBody
from garmentbench.motion.dance import dance_score
from garmentbench.motion.dances import DANCES
from garmentbench.motion.jump import jump_score
from garmentbench.motion.run import run_score
from garmentbench.motion.score import Score
from garmentbench.motion.still import still_score

# What writes a motion's score: for a body, to last at least so many seconds.
SCORES: dict[str, Callable[[BakedBody, float], Score]] = {
    **{name: partial(dance_score, dance) for name, dance in DANCES.items()},
    "run": run_score,
    "jump": jump_score,
    "still": still_score,
}
