"""Launches that are recorded once and replayed: a frame has some 160, and to put each of them together in Python takes
longer than many of them run."""

from collections.abc import Callable
from typing import Any

import warp as wp


class Recorded:
    """A stretch of launches, the same whenever it is run: on the same arrays, with the same numbers."""

    def __init__(self, device: str) -> None:
        """device: Warp device."""
        self.device = device
        self._loaded, self._graph = False, None

    def run(self, launches: Callable[..., None], *arguments: Any) -> None:
        """Run them.

        Args:
            launches: Launches them. A mesh must not be refitted among them: on a CPU that is not recorded.
            arguments: Of that call.
        """
        if not self._loaded:  # the first time, which loads the modules: that can't be done while recording
            launches(*arguments)
            self._loaded = True
            return
        if self._graph is None:
            with wp.ScopedCapture(self.device) as capture:
                launches(*arguments)
            self._graph = capture.graph
        wp.capture_launch(self._graph)
