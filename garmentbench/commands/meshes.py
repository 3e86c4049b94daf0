"""Commands that bring mesh sequences in and out."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tyro.conf import Positional

from garmentbench.errors import UsageError


@dataclass(frozen=True)
class Import:
    """Make a sequence of a garment's and a body's moving meshes, from OBJ, PC2, MDD, npz, HDF5, USD or Alembic.

    Units, up axis and frame rate are as given, else as the files say, else inferred from the body; what was assumed is
    printed, and what stays unclear is asked for. The file that is made can be used wherever a scene's name is taken.

    Arrays in npz and HDF5: positions (frames, vertices, 3), faces (n, 3) from 0, and where there are: uv (vertices, 2)
    or (faces, 3, 2), rest (vertices, 3), pins, fps, metres_per_unit, up.

    Example: garmentbench import shirt.pc2 --template shirt.obj --body body.pc2 --body-template body.obj --out my.h5
    Example: garmentbench import 'frames/shirt_*.obj' --body frames/body --units cm --up y --fps 30 --out my.h5

    Attributes:
        garment: Its file; for OBJ the folder of one file a frame, or a quoted pattern.
        out: The sequence to write (HDF5).
        template: OBJ file with the garment's faces, UV and rest shape (needed for PC2 and MDD).
        body: The body's file, as for the garment; without it the garment moves alone.
        body_template: OBJ file with the body's faces and rest shape.
        mesh: Which mesh of a USD or Alembic file is the garment: its path, or the end of it; or which object of an
            OBJ file.
        body_mesh: Which is the body.
        kind: The body is a human, an object such as a stick, or the garment beneath.
        units: m, cm, mm, in or ft.
        up: The axis that points up: x, y, z, or the other way round, e.g. --up=-y.
        body_units: The body's unit, where it is another than the garment's.
        body_up: The body's axis that points up, where it is another than the garment's.
        fps: Frames a second; of files that number their frames, of these numbers: a file with every other one has half
            of it.
        frames: How many frames, from the first that garment and body both have.
        same_start: Garment and body begin at the same moment, whatever times or frame numbers their files state.
        other_template: The template is meant to differ from the frames, as a flat pattern does.
        split: train or test.
        name: Name of the garment in tables; by default the file's.
        body_name: Name of the body in tables.
        make_uv: Make a UV map with xatlas, in place of the file's.
    """

    garment: Positional[str]
    out: Path
    template: Path | None = None
    body: str = ""
    body_template: Path | None = None
    mesh: str = ""
    body_mesh: str = ""
    kind: Literal["human", "object", "garment"] = "human"
    units: str | None = None
    up: str | None = None
    body_units: str | None = None
    body_up: str | None = None
    fps: float | None = None
    frames: int | None = None
    split: Literal["train", "test"] = "train"
    name: str = ""
    body_name: str = ""
    make_uv: bool = False
    same_start: bool = False
    other_template: bool = False

    def run(self) -> None:
        from garmentbench.device import one_thread, quiet_warp
        from garmentbench.importing.meshes.conventions import Given
        from garmentbench.importing.meshes.reading import HDF5
        from garmentbench.importing.sequences import Wanted, import_files

        if self.out.suffix.lower() not in HDF5:
            raise UsageError(f"--out is {self.out}; wanted a name that ends in .h5")
        one_thread()
        quiet_warp()
        given = Given(self.units, self.up, self.fps, self.body_units, self.body_up)
        wanted = Wanted(
            self.out.stem,
            given,
            self.split,
            self.name,
            self.body_name,
            self.kind,
            self.frames,
            self.make_uv,
            self.same_start,
            self.other_template,
        )
        notes = import_files(
            (self.garment, self.template, self.mesh), (self.body, self.body_template, self.body_mesh), wanted, self.out
        )
        print("\n".join(notes))
        print(f"{self.out}: use it as a scene, e.g. garmentbench train skinning --scene {self.out}")


@dataclass(frozen=True)
class Export:
    """Write a sequence or a roll-out as mesh files, in metres, z up.

    obj: folders garment and body with a file a frame. pc2, mdd: a cache and an OBJ template each. npz: arrays. usd: one
    file with both meshes and their UV. Only obj rounds, to half a micrometre.

    Example: garmentbench export tshirt-armspace-90 --to usd --out exported
    Example: garmentbench export evaluate-1f00c0ffee12 --to pc2 --out exported

    Attributes:
        source: A scene, a sequence file (.h5), or the run of an evaluation: its id or the beginning of it.
        to: Format.
        out: Folder to write to.
        preset: Size of a scene: smoke, laptop, desktop or paper.
        sequence: The sequence file of a run on an imported one.
        frames: How many frames, from the first on.
    """

    source: Positional[str]
    to: Literal["obj", "pc2", "mdd", "npz", "usd"]
    out: Path
    preset: str = "laptop"
    sequence: Path | None = None
    frames: int | None = None

    def run(self) -> None:
        from garmentbench.importing.meshes.exporting import export, select
        from garmentbench.scenes.presets import preset

        taken, notes = select(self.source, preset(self.preset), self.sequence, self.frames)
        print("\n".join([*notes, *(str(path) for path in export(taken, self.to, self.out))]))
