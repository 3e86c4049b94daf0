"""The tube that sways, the published configuration at its size, and what that was trained to in a few steps."""

import pytest
from swaying_tube import make_sequence, tiny_config

from garmentbench.methods.motion_guided import MotionGuided
from garmentbench.methods.motion_guided.config import VARIANTS, Config
from garmentbench.sequence import Sequence
from garmentbench.storage.runs import RunStore


@pytest.fixture(scope="session")
def sequence() -> Sequence:
    return make_sequence(16)


@pytest.fixture(scope="session")
def object_sequence() -> Sequence:
    """The same beside an object that is no human body."""
    return make_sequence(16, kind="object")


@pytest.fixture(scope="session")
def config() -> Config:
    return tiny_config()


@pytest.fixture(scope="session")
def linear_config(config) -> Config:
    return VARIANTS["linear_paths"](config)


@pytest.fixture(scope="session")
def store(tmp_path_factory) -> RunStore:
    return RunStore(tmp_path_factory.mktemp("runs"))


@pytest.fixture(scope="session")
def trained(sequence, config, store) -> MotionGuided:
    with store.open("train", {"seed": 0}) as run:
        return MotionGuided.fit((sequence,), config, run)
