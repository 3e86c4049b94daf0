"""The motions that are written as scores: dances, run, jump, stand-still."""

from collections.abc import Callable
from functools import partial

from garmentbench.motion.dances.bounce import BOUNCE
from garmentbench.motion.dances.dance import dance_score
from garmentbench.motion.dances.latin import LATIN
from garmentbench.motion.dances.spin import SPIN
from garmentbench.motion.jog import run_score
from garmentbench.motion.jump import jump_score
from garmentbench.motion.notation import Score
from garmentbench.motion.still import still_score
from garmentbench.scenes.bodies import BakedBody

# What writes a motion's score: for a body, to last at least a number of seconds.
SCORES: dict[str, Callable[[BakedBody, float], Score]] = {
    "dance-latin": partial(dance_score, LATIN),
    "dance-spin": partial(dance_score, SPIN),
    "dance-bounce": partial(dance_score, BOUNCE),
    "run": run_score,
    "jump": jump_score,
    "still": still_score,
}
