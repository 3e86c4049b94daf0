"""Commands that read what the authors of the motion-guided model released."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tyro.conf import Positional


@dataclass(frozen=True)
class ImportAuthors:
    """Make a sequence of the data that the authors of the motion-guided model released.

    What the files don't say (unit, axes, frame rate) follows from their body, or is given; what was assumed is printed.

    Example: garmentbench import-authors data_walk/walk_75 --case unseen_test/rumba_swing --out rumba.h5

    Attributes:
        folder: The folder that holds uv_body and uv_<garment>.
        out: The sequence to write (HDF5).
        case: The motion's folder below it; the folder's own motion, if none is given.
        garment: Name of the garment, as in uv_<garment>; not needed where there is one.
        split: train or test.
        fps: Frames a second, which no file of theirs says.
        units: m, cm, mm, or auto: the one in which their body is as tall as a person.
        axes: Which of their axes are ours (left, back, up), e.g. x,-z,y; or auto: told by their body.
        frames: How many frames to read, from the first on.
    """

    folder: Positional[Path]
    out: Path
    case: str = ""
    garment: str = ""
    split: Literal["train", "test"] = "train"
    fps: float = 30.0
    units: str = "auto"
    axes: str = "auto"
    frames: int | None = None

    def run(self) -> None:
        from garmentbench import sequence_file
        from garmentbench.device import one_thread, quiet_warp
        from garmentbench.importing.wearing import measured
        from garmentbench.methods.motion_guided.authors.read import read_release
        from garmentbench.methods.motion_guided.authors.release import open_release

        one_thread()
        quiet_warp()
        release = open_release(self.folder, self.garment)
        sequence, told = read_release(
            release, self.out.stem, self.case, self.split, self.fps, self.units, self.axes, self.frames
        )
        sequence = measured(sequence)
        sequence_file.save(sequence, self.out)
        percent = sequence.scores["interpenetration_strict"]
        print("\n".join([*told, f"interpenetration: {percent:.3g} % of the garment's vertices lie inside the body"]))
        print(f"{self.out}: use it as a scene, e.g. garmentbench train skinning --scene {self.out}")


@dataclass(frozen=True)
class ImportAuthorsModel:
    """Make a trained method of the authors' checkpoints, to be evaluated like any other.

    Example: garmentbench import-authors-model data_walk/walk_75 it_50000_vae64.ckp it_50000_dyn.ckp

    Attributes:
        folder: Holds uv_body and uv_<garment>, whose tables and seed points the checkpoints were made with.
        static: Checkpoint of the generative model (Relative_encoder, Pred_encoder, Pre_decoder, skinRadius).
        dynamic: Checkpoint of the dynamic encoder (Dynamic_ForceEncoder, Dynamic_Encoder).
        garment: Name of the garment, as in uv_<garment>; not needed where there is one.
        axes: Which of their axes are ours (left, back, up), e.g. x,-z,y; or auto: told by their body.
    """

    folder: Positional[Path]
    static: Positional[Path]
    dynamic: Positional[Path]
    garment: str = ""
    axes: str = "auto"

    def run(self) -> None:
        from garmentbench.device import one_thread
        from garmentbench.methods.motion_guided.authors.model import read_model
        from garmentbench.methods.motion_guided.authors.release import open_release
        from garmentbench.pipeline.train import keep
        from garmentbench.storage.fingerprint import fingerprint
        from garmentbench.storage.runs import RunStore

        one_thread()
        release = open_release(self.folder, self.garment)
        method, told = read_model(release, self.static, self.dynamic, axes=self.axes)
        files = (release.folder / "uv_body", release.folder / f"uv_{release.garment}", self.static, self.dynamic)
        data = fingerprint("garmentbench.methods.motion_guided.authors.model", *files)
        run = keep(method, "authors", release.folder.resolve().name, data, RunStore())
        print("\n".join(told))
        print(f"{run.id}: {run.folder}")
        print(
            f"evaluate it on a sequence of garmentbench import-authors: garmentbench evaluate {run.id} --scene FILE.h5"
        )
