"""Progress is shown where it is of use, and passed on where others show it."""

from garmentbench import progress


def steps(count: int, label: str = "train", done: int = 0) -> None:
    with progress.track(count, label, done) as step:
        for _ in range(count - done):
            step()


def test_short_work_shows_nothing(capsys):
    steps(5)
    assert capsys.readouterr() == ("", "")


def test_long_work_without_a_terminal_prints_a_line_now_and_then(capsys, monkeypatch):
    clock = iter(range(0, 10_000, 10))  # every look at the clock is 10 s later
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    steps(10, done=2)
    err = capsys.readouterr().err.splitlines()
    assert err[0] == "train: 5 of 10, about 50 s left" and err[-1].startswith("train: 10 of 10 in ")
    assert len(err) == 3


def test_a_listener_hears_the_beginning_and_the_end():
    heard = []
    with progress.listening(lambda *report: heard.append(report)):
        steps(100, done=40)
    assert heard[0] == ("train", 40, 100) and heard[-1] == ("train", 100, 100)
    steps(5)
    assert heard[-1] == ("train", 100, 100)
