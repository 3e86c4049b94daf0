"""What the report needs of a roll-out, kept in its run's folder: the error of every frame, and a few frames to draw.

With it the report is made from the runs alone, without the sequences.
"""

from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from jaxtyping import Float, Int

from garmentbench.errors import UserError
from garmentbench.evaluation.rollout import RollOut
from garmentbench.metrics.l2 import frame_l2
from garmentbench.sequence import Sequence
from garmentbench.storage.atomic import written_whole

FILE = "report.npz"
FRAMES_DRAWN = 6


@dataclass(frozen=True)
class Excerpt:
    """A roll-out, as far as the report shows it.

    Attributes:
        start: The first predicted frame.
        error_cm: Mean error of each frame from `start` on [cm], shape (T,); NaN from the first bad frame on.
        frames: The frames that are drawn, shape (K,).
        reference: Reference positions [m] in these frames, shape (K, V, 3).
        prediction: Predicted positions [m], shape (K, V, 3); NaN where there are none.
        garment_faces: Shape (F, 3).
        body: Body positions [m], shape (K, B, 3); no vertices where there is no body.
        body_faces: Shape (K, 3).
    """

    start: Int[np.ndarray, ""]
    error_cm: Float[np.ndarray, " predicted"]
    frames: Int[np.ndarray, " drawn"]
    reference: Float[np.ndarray, "drawn vertices 3"]
    prediction: Float[np.ndarray, "drawn vertices 3"]
    garment_faces: Int[np.ndarray, "faces 3"]
    body: Float[np.ndarray, "drawn body_vertices 3"]
    body_faces: Int[np.ndarray, "body_faces 3"]


def write_excerpt(folder: Path, sequence: Sequence, roll_out: RollOut) -> None:
    """Write a roll-out's excerpt into its run's folder, whole or not at all. Raises `UserError` if it can't be."""
    frames = frames_drawn(roll_out.start, len(sequence))
    template = sequence.template
    nothing = np.zeros((len(frames), 0, 3), np.float32)
    excerpt = Excerpt(
        start=np.array(roll_out.start),
        error_cm=frame_l2(roll_out.garment, sequence.garment)[roll_out.start :].astype(np.float32),
        frames=frames,
        reference=sequence.garment[frames],
        prediction=roll_out.garment[frames],
        garment_faces=template.garment.faces,
        body=nothing if sequence.body is None else sequence.body[frames],
        body_faces=np.zeros((0, 3), np.int32) if template.body is None else template.body.faces,
    )
    with written_whole(folder / FILE) as partial, partial.open("wb") as file:
        np.savez_compressed(file, **vars(excerpt))


def frames_drawn(start: int, stop: int) -> Int[np.ndarray, " drawn"]:
    """Up to `FRAMES_DRAWN` frames, evenly over those from `start` to before `stop`; the last one is among them."""
    return np.unique(np.linspace(start, stop - 1, FRAMES_DRAWN + 1).round().astype(int)[1:])


def read_excerpt(folder: Path) -> Excerpt:
    """Read it back, as data only. Raises `UserError` if the file is damaged."""
    try:
        with np.load(folder / FILE) as file:
            return Excerpt(**{name: file[name] for name in Excerpt.__dataclass_fields__})
    except (BadZipFile, KeyError, ValueError, EOFError) as e:
        raise UserError(f"{folder / FILE}: damaged ({e}); delete {folder} and run the same `make evals` again") from e
