"""Where things lie in the folder that the authors of the motion-guided model released.

FOLDER/                     one training walk, e.g. walk_75
    uv_body/                body_geo.obj, body_*_sample.txt (seed points), *_sdf_*.ckp
    uv_<garment>/           garment_geo.obj, garment_uv.obj, garment_canc_{tangents,basements,normals}.txt,
                            garment_uvMap_*.txt, garment_*_vertPixel.txt, ind_B2O_*.txt
    <garment>_pnva/         %06d.npy: position, normal, velocity, acceleration
    body_n/                 %06d.obj: vertices and normals
    body_RTVN_*/            %06d.npy: rotation, translation, position and normal of the seeds
    unseen_test/<case>/     the last three again, of another motion
"""

from dataclasses import dataclass
from pathlib import Path

from garmentbench.errors import UserError

BODY = "uv_body"


@dataclass(frozen=True)
class Release:
    """A folder of the authors' data.

    Attributes:
        folder: The folder that holds `uv_body`.
        garment: Name of a garment, as in `uv_<garment>`.
    """

    folder: Path
    garment: str

    def body(self, pattern: str) -> Path:
        """The file in `uv_body` of that name or pattern. Raises `UserError` unless there is exactly one."""
        return only(self.folder / BODY, pattern)

    def cloth(self, pattern: str) -> Path:
        """The file in `uv_<garment>`, likewise."""
        return only(self.folder / f"uv_{self.garment}", pattern)

    def garment_frames(self, case: str) -> dict[int, Path]:
        """The garment's file of each frame of a case, a folder below the release's ("" for the release's own motion).

        Raises `UserError` where there are none, or of several garments of which none bears the name.
        """
        inside = self.folder / case
        found = sorted(p for p in inside.glob("*_pnva") if p.is_dir())
        named = [p for p in found if p.name.lower().startswith(self.garment.lower())]
        if len(named) != 1 and len(found) != 1:
            names = ", ".join(p.name for p in found) or "none"
            raise UserError(
                f"{inside}: wanted one folder *_pnva of '{self.garment}', found {names}; name --case and --garment"
            )
        return _frames(named[0] if named else found[0], ".npy")

    def body_frames(self, case: str) -> dict[int, Path]:
        """The body's file of each frame. Raises `UserError` where there are none."""
        return _frames(self.folder / case / "body_n", ".obj")

    def seed_frames(self, case: str) -> dict[int, Path]:
        """The seeds' file of each frame. Raises `UserError` where there are none."""
        return _frames(only(self.folder / case, "body_RTVN_*"), ".npy")


def open_release(folder: Path, garment: str = "") -> Release:
    """The release in a folder. Raises `UserError` unless it has a body and the garment, or exactly one garment."""
    found = sorted(p.name.removeprefix("uv_") for p in folder.glob("uv_*") if p.is_dir() and p.name != BODY)
    if not (folder / BODY).is_dir() or not found:
        raise UserError(
            f"{folder}: wanted the folders {BODY} and uv_<garment>; give the folder of the authors' data with them"
        )
    if (garment and garment not in found) or (not garment and len(found) > 1):
        raise UserError(f"{folder}: holds the garments {', '.join(found)}; choose one of them with --garment")
    return Release(folder, garment or found[0])


def only(folder: Path, pattern: str) -> Path:
    """What matches a name or pattern in a folder. Raises `UserError` unless exactly one does."""
    found = sorted(folder.glob(pattern))
    if len(found) != 1:
        names = ", ".join(p.name for p in found) or "none"
        raise UserError(
            f"{folder}: wanted one {pattern}, found {names}; lay the authors' files out as they were released"
        )
    return found[0]


def _frames(folder: Path, suffix: str) -> dict[int, Path]:
    found = {int(p.stem): p for p in folder.glob(f"*{suffix}") if p.stem.isdigit()}
    if not found:
        raise UserError(f"{folder}: wanted frames 000001{suffix}, 000002{suffix} ..., found none; name another --case")
    return dict(sorted(found.items()))
