"""The command that brings recorded motions in."""

from dataclasses import dataclass
from pathlib import Path

from tyro.conf import Positional

from garmentbench.errors import UsageError, UserError


@dataclass(frozen=True)
class ImportMotion:
    """Retarget a recording (BVH, ASF/AMC, AMASS) to a body, say what was found, and write it as a clip for scenes.

    Joint names are guessed (CMU's conversions, Mixamo, SMPL) unless --map names them. In a scene:
    [motion] with name = "clip" and file = "walk.npz".

    Example: garmentbench import-motion walk.bvh --out walk.npz --picture walk.png

    Attributes:
        file: The recording: .bvh, .amc (with its .asf beside it), or .npz as in AMASS.
        out: The clip to write (.npz).
        picture: Also draw a contact sheet into this PNG file.
        body: Whose body.
        fps: Frames a second of the clip.
        recording_fps: Frames a second of the recording, where its file says none, or a wrong one.
        start: From this time of the recording on [s].
        stop: Up to this time [s]; by default its end.
        arm_space: Turn hanging arms outward by this angle [degrees].
        map: Joints by name, theirs=ours, e.g. Hips=pelvis, or a TOML file of such lines.
        smplx_models: Folder of SMPL or SMPL-X model files: write the recording's own body as moving vertices instead.
    """

    file: Positional[Path]
    out: Path | None = None
    picture: Path | None = None
    body: str = "base"
    fps: float = 30.0
    recording_fps: float | None = None
    start: float = 0.0
    stop: float | None = None
    arm_space: float = 0.0
    map: tuple[str, ...] = ()
    smplx_models: Path | None = None

    def run(self) -> None:
        if not 1 <= self.fps <= 1000:
            raise UsageError(f"--fps is {self.fps:g}; wanted 1 to 1000")
        if self.recording_fps is not None and not 1 <= self.recording_fps <= 1000:
            raise UsageError(f"--recording-fps is {self.recording_fps:g}; wanted 1 to 1000")
        if self.out is not None and self.out.suffix != ".npz":
            raise UsageError(f"--out is {self.out}; wanted a name that ends in .npz")
        if self.smplx_models is not None:
            self._write_own_body()
        else:
            self._retarget()

    def _retarget(self) -> None:
        from garmentbench.device import one_thread, quiet_warp
        from garmentbench.importing.motions.findings import findings
        from garmentbench.importing.motions.load import Choices, import_clip
        from garmentbench.motion.clip import save_clip
        from garmentbench.scenes.bodies import load_body

        one_thread()
        quiet_warp()
        baked = load_body(self.body, "small")
        choices = Choices(self.start, self.stop, self.arm_space, _name_map(self.map), self.recording_fps)
        imported = import_clip(self.file, baked, self.fps, choices)
        for line in findings(imported, baked):
            print(line)
        if self.out is not None:
            stop = "its end" if self.stop is None else f"{self.stop:g} s"
            notes = f"{self.file.name}, {self.start:g} s to {stop}, on {self.body}"
            save_clip(imported.clip, baked.joint_names, notes, self.out)
            print(self.out)
        if self.picture is not None:
            from garmentbench.importing.motions.findings import contact_sheet

            contact_sheet(imported.clip, baked, self.picture)
            print(self.picture)

    def _write_own_body(self) -> None:
        from garmentbench.importing.motions.smplx_body import write_own_body

        if self.out is None or self.smplx_models is None:
            raise UsageError("--smplx-models: where to? Wanted --out body.npz too")
        print(write_own_body(self.file, self.smplx_models, self.fps, self.out))
        print(self.out)


def _name_map(given: tuple[str, ...]) -> dict[str, str]:
    """Their joint -> ours, of words "theirs=ours" and of TOML files."""
    import tomllib

    out = {}
    for word in given:
        if word.endswith(".toml"):
            try:
                table = tomllib.loads(Path(word).read_text())
            except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
                raise UserError(f'{word}: can\'t be read as TOML ({e}); wanted lines such as Hips = "pelvis"') from e
            if not all(isinstance(ours, str) for ours in table.values()):
                raise UserError(f'{word}: wanted lines such as Hips = "pelvis" only')
            out |= table
        elif word.count("=") == 1:
            theirs, ours = word.split("=")
            out[theirs] = ours
        else:
            raise UsageError(f"--map: '{word}' is no pair; wanted theirs=ours, e.g. Hips=pelvis, or a TOML file")
    return out
