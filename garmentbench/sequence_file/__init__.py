"""Sequences on disk: `layout` says what lies where, `checks` what must hold, `read_write` does it."""

from garmentbench.sequence_file.read_write import content_hash, load, read, save

__all__ = ["content_hash", "load", "read", "save"]
