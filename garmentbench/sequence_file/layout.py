"""How a sequence lies in an HDF5 file.

    attributes              format, schema, units, content_hash, fps, info (JSON)
    garment                 attribute name
        rest faces uv seams pins cut   cut absent where there is no pattern
        frames              positions, shape (T, V, 3), float32
        runs                positions of further runs of the same scene, shape (M, T, V, 3), float32, NaN from the frame
                            on in which one broke; absent where there are none
    body                    attributes name, kind, part_names (JSON); absent where there is no body
        rest faces labels   labels absent where the body has no parts
        frames              positions, shape (T, B, 3), float32

Positions are stored as they are: nothing is rounded.
"""

import hashlib
import json
from dataclasses import dataclass

import numpy as np

from garmentbench.sequence import Body, Garment, Sequence, Template

KIND, SCHEMA, UNITS = "sequence", 2, "metres, seconds, z up"
REMAKE = "make it again (garmentbench simulate, or the import that made it)"

ARRAYS = {  # dtype and shape; the same letter stands for the same number everywhere
    "garment/rest": ("float32", ("V", 3)),
    "garment/faces": ("int32", ("F", 3)),
    "garment/uv": ("float32", ("V", 2)),
    "garment/seams": ("int32", ("S", 2)),
    "garment/pins": ("int32", ("P",)),
    "garment/cut": ("float32", ("V", 2)),
    "garment/frames": ("float32", ("T", "V", 3)),
    "garment/runs": ("float32", ("M", "T", "V", 3)),
    "body/rest": ("float32", ("B", 3)),
    "body/faces": ("int32", ("K", 3)),
    "body/labels": ("int8", ("B",)),
    "body/frames": ("float32", ("T", "B", 3)),
}
OPTIONAL = frozenset({"garment/cut", "garment/runs", "body/labels"})
COUNTED = {"V": "garment vertices", "B": "body vertices", "T": "frames"}


@dataclass(frozen=True)
class Names:
    """What things are called. body, kind and part_names are None, None and () where there is no body."""

    garment: str
    body: str | None = None
    kind: str | None = None
    part_names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Contents:
    """What a file holds, before any of it is trusted: arrays that are missing or can't be read are not in it."""

    arrays: dict[str, np.ndarray]
    names: Names
    fps: float
    info: dict
    noted_hash: str | None = None  # as the file says

    @property
    def has_body(self) -> bool:
        """Is there a body in the file?"""
        return self.names.body is not None

    def hash(self) -> str:
        """SHA-256 of arrays, names, rate and schema. Not of the info, which holds timings."""
        names = [self.names.garment, self.names.body, self.names.kind, *self.names.part_names]
        digest = hashlib.sha256(json.dumps([SCHEMA, self.fps, names]).encode())
        for name in sorted(self.arrays):
            array = np.ascontiguousarray(self.arrays[name])
            digest.update(f"{name} {array.dtype.str} {array.shape}".encode())
            digest.update(array.tobytes())
        return digest.hexdigest()


def contents_of(sequence: Sequence) -> Contents:
    """The arrays and names of a sequence."""
    garment, body = sequence.template.garment, sequence.template.body
    arrays = {f"garment/{k}": getattr(garment, k) for k in ("rest", "faces", "uv", "seams", "pins")}
    if garment.cut is not None:
        arrays["garment/cut"] = garment.cut
    arrays["garment/frames"] = sequence.garment
    if sequence.runs is not None:
        arrays["garment/runs"] = sequence.runs
    names = Names(garment.name)
    if body is not None:
        arrays |= {"body/rest": body.rest, "body/faces": body.faces, "body/frames": sequence.body}
        if body.labels is not None:
            arrays["body/labels"] = body.labels
        names = Names(garment.name, body.name, body.kind, tuple(body.part_names))
    return Contents(arrays, names, float(sequence.template.fps), sequence.info)


def sequence_of(contents: Contents) -> Sequence:
    """The sequence, from contents without errors."""
    a, names = contents.arrays, contents.names
    parts = (a[f"garment/{k}"] for k in ("rest", "faces", "uv", "seams", "pins"))
    garment = Garment(names.garment, *parts, cut=a.get("garment/cut"))
    body = None
    if names.body is not None and names.kind is not None:
        body = Body(names.body, a["body/rest"], a["body/faces"], a.get("body/labels"), names.part_names, names.kind)
    template, frames, moving = Template(garment, body, contents.fps), a["garment/frames"], a.get("body/frames")
    return Sequence(template, frames, moving, contents.info, a.get("garment/runs"))
