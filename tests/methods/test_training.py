import numpy as np
import pytest
import torch
from torch import nn

from garmentbench.methods import training
from garmentbench.methods.training import (
    CHECKPOINT,
    WEIGHTS,
    Training,
    batch_at,
    generator,
    learning_rate,
    load,
    train,
)


class Folder:
    """As much of a run as training needs; `kill_after` steps it is interrupted."""

    def __init__(self, folder, kill_after=None):
        self.folder, self.seed, self.kill_after, self.lines = folder, 3, kill_after, []
        folder.mkdir(exist_ok=True)

    def log(self, step, **values):
        self.lines.append((step, values))

    def track(self, total, label, done=0):
        steps = iter(range(self.kill_after or total))

        class Bar:
            def __enter__(self):
                return self

            def __call__(self):
                if next(steps, None) is None:
                    raise KeyboardInterrupt

            def __exit__(self, *_):
                pass

        return Bar()


def _fit(run, steps=30, amsgrad=False):
    torch.manual_seed(run.seed)
    net = nn.Sequential(nn.Linear(3, 8), nn.Tanh(), nn.Linear(8, 1))

    def loss(step):
        x = torch.randn(4, 3, generator=generator(run.seed, step))
        return {"total": (net(x)[:, 0] - x.prod(dim=1)).square().mean()}

    train(net, loss, Training(steps=steps, learning_rate=1e-2, schedule="one_cycle", amsgrad=amsgrad), run, "test")
    return load(run.folder / WEIGHTS, torch.device("cpu"))


@pytest.mark.parametrize("amsgrad", [False, True])
def test_a_killed_training_goes_on_to_the_same_bits(tmp_path, monkeypatch, amsgrad):
    whole = _fit(Folder(tmp_path / "whole"), amsgrad=amsgrad)
    monkeypatch.setattr(training, "CHECKPOINT_SECONDS", -1.0)  # at every step
    for kill_after in (7, 11):
        with pytest.raises(KeyboardInterrupt):
            _fit(Folder(tmp_path / "killed", kill_after), amsgrad=amsgrad)
        assert (tmp_path / "killed" / CHECKPOINT).is_file()
    resumed = _fit(Folder(tmp_path / "killed"), amsgrad=amsgrad)
    assert all(torch.equal(whole[name], resumed[name]) for name in whole)
    assert not (tmp_path / "killed" / CHECKPOINT).exists()


def test_every_frame_once_an_epoch_in_an_order_that_follows_from_seed_and_step():
    epochs = torch.cat([batch_at(step, 3, 10, seed=1) for step in range(10)]).reshape(3, 10)
    assert [sorted(e.tolist()) for e in epochs] == [list(range(10))] * 3
    assert not torch.equal(epochs[0], epochs[1])
    assert torch.equal(batch_at(7, 3, 10, seed=1), batch_at(7, 3, 10, seed=1))
    assert not torch.equal(torch.cat([batch_at(s, 3, 10, seed=2) for s in range(10)]), epochs.flatten())


def test_learning_rates():
    halving = Training(steps=100, learning_rate=8.0, schedule="halving", halve_every=10)
    assert [learning_rate(halving, s) for s in (0, 9, 10, 29)] == [8, 8, 4, 2]
    cycle = [learning_rate(Training(steps=100, learning_rate=1.0, schedule="one_cycle"), s) for s in range(100)]
    assert np.argmax(cycle) == 10 and cycle[10] == pytest.approx(1) and cycle[55] == pytest.approx(0.5)
    assert 0 < cycle[-1] < 0.01 and cycle[0] < 0.1


def test_denormal_numbers_are_there_again_after_a_training(tmp_path):
    _fit(Folder(tmp_path / "run"), steps=1)
    assert np.nextafter(0.0, 1.0) * np.ones(1) > 0
    with pytest.raises(KeyboardInterrupt):
        _fit(Folder(tmp_path / "killed", kill_after=1), steps=3)
    assert np.nextafter(0.0, 1.0) * np.ones(1) > 0
