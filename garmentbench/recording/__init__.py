"""Rerun recordings of roll-outs: body, reference and prediction side by side, errors as colours, numbers per frame."""

from garmentbench.recording.viewer import check_recording, open_viewer
from garmentbench.recording.writing import ROUNDING, recorded_frames, write_recording

__all__ = ["ROUNDING", "check_recording", "open_viewer", "recorded_frames", "write_recording"]
