"""Limits and progress of long computations."""

from __future__ import annotations

import _thread
import inspect
import signal
import sys
import time
from functools import cache
from threading import Timer
from typing import Unpack

import pytest
from conftest import ROOT

import pas
from pas import solid
from pas.cli import main
from pas.elsewhere import elsewhere
from pas.limits import WorkLimits, checkpoint, in_parts, limit, limited, note, part


class Clock:
    def __init__(self, step=0.0):
        self.now, self.step = 100.0, step

    def monotonic(self):
        self.now += self.step
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr("pas.limits.time", clock)
    return clock


@pytest.fixture
def ticking(monkeypatch):
    """A clock that moves on by a second whenever it is looked at."""
    monkeypatch.setattr("pas.limits.time", Clock(1.0))


def given_up(call, folder, least=1):
    """What was being done at each look from the `least` on at which the call gives up; it leaves nothing, then works.

    At a deadline of n + 1/2 s, the clock moving on by one at each look, the call gives up at the n-th of them.
    """
    tasks = []
    while True:
        with limit(seconds=least + len(tasks) + 0.5):
            try:
                call()
                return tasks
            except pas.LimitError as error:
                tasks.append(str(error).partition(" s while ")[2].partition(";")[0])
        assert not list(folder.rglob("*.*"))


def test_past_the_deadline_it_gives_up_in_words(clock):
    with limit(seconds=10):
        checkpoint("eliminating")
        clock.now += 10.5
        with pytest.raises(pas.LimitError, match="gave up after 10 s while eliminating 3 x 4; allow more seconds"):
            checkpoint("eliminating 3 x 4")
    checkpoint("afterwards there is no limit")


def test_an_inner_limit_cannot_outlast_an_outer_one(clock):
    with limit(seconds=10):
        clock.now += 4
        with limit(seconds=60):
            clock.now += 7
            with pytest.raises(pas.LimitError, match="gave up after 10 s"):
                checkpoint("waiting")


def test_progress_is_reported_now_and_then(clock):
    lines = []
    with limit(progress=lines.append):
        for i in range(40):
            clock.now += 0.1
            with limit():
                pass
            checkpoint("counting", i / 40)
    assert lines[0].startswith("counting (3%), 1 s")
    assert 5 <= len(lines) <= 7


def test_a_limit_inside_reports_to_the_listener_around_it(clock):
    lines = []
    with limit(progress=lines.append), limit(seconds=60):
        note("quick work is not told of")
        assert not lines
        clock.now += 1.5
        checkpoint("counting")
        note("done")
    assert lines == ["counting, 2 s", "done"]


def test_a_loop_far_below_says_the_task_that_was_said_last(clock):
    with limit(seconds=10):
        checkpoint("eliminating 3 x 4")
        clock.now += 10.5
        with pytest.raises(pas.LimitError, match="while eliminating 3 x 4"):
            checkpoint()


def test_bad_limits():
    with pytest.raises(ValueError, match="seconds must be a positive number"), limit(seconds=0):
        pass


def test_groebner_bases_look_at_the_clock_and_go_on(monkeypatch):
    """With little room the basis is the same, found in several steps."""
    from pas.algebra import ideal
    from pas.algebra.ideal import Ideal

    generators = ["x^2 + y*z - 1", "y^2 - z", "z^2 - x*y"]
    whole = Ideal(*generators).groebner_basis("lex")
    monkeypatch.setattr(ideal, "FIRST_ROOM", (2, 2, 2))
    assert Ideal(*generators).groebner_basis("lex") == whole
    with limit(seconds=1e-9), pytest.raises(pas.LimitError, match="computing a Groebner basis"):
        Ideal(*generators).groebner_basis("lex")


def test_what_is_stopped_ends_at_its_next_look_and_inner_limits_are_stopped_too():
    asked = []
    with limit(stopped=lambda: len(asked) > 1), limit(seconds=100):
        checkpoint("eliminating")
        asked += [1, 2]
        with pytest.raises(pas.LimitError, match="stopped while eliminating"):
            checkpoint()
    checkpoint("afterwards nothing is stopped")
    with pytest.raises(TypeError, match="stopped must be a function without arguments"), limit(stopped=True):
        pass


@cache
def two_parts():
    """Two bodies, and their meshes."""
    bodies = {"ball": solid.ball((0, 0, 0), 1), "box": solid.box((2, 0, 0), (3, 1, 1)) - solid.ball((2, 0, 0), "1/2")}
    return solid.assembly(**bodies), {name: body.mesh(0.2) for name, body in bodies.items()}


def test_pictures_look_at_the_clock_between_their_parts(tmp_path, ticking):
    from pyvista.plotting import plotter

    assembly, meshes = two_parts()
    open_before = len(plotter._ALL_PLOTTERS)
    options = {"mesh": meshes, "size": (60, 45), "four_views": True, "cut": True}
    tasks = given_up(lambda: assembly.draw(tmp_path / "x.png", **options), tmp_path)
    assert sum("loading the graphics library" in task for task in tasks) == 3
    for mesh in meshes.values():  # in each of the four views
        assert sum(f"drawing {len(mesh.triangles)} triangles" in task for task in tasks) == 4
    assert "rendering a picture" in tasks[-1]
    assert len(plotter._ALL_PLOTTERS) == open_before  # what was given up is closed


LOOKS = {".stl": 1, ".obj": 14, ".ply": 1, ".glb": 4, ".vtp": 4, ".3mf": 4}
"""How often the clock is looked at while two bodies of eight faces are written: often where that takes long."""


@pytest.mark.parametrize("suffix", LOOKS)
def test_files_look_at_the_clock_while_they_are_written(suffix, tmp_path, ticking):
    if suffix == ".3mf":
        pytest.importorskip("lib3mf")
    meshes = list(two_parts()[1].values())
    tasks = given_up(lambda: pas.write(meshes, tmp_path / f"x{suffix}"), tmp_path)
    assert sum(f"writing x{suffix}" in task for task in tasks) == LOOKS[suffix]


@pytest.mark.parametrize("command", ["blend", "teapot"])
@pytest.mark.sampled(2)
def test_a_command_that_draws_gives_up_before_any_file_is_in_its_place(command, tmp_path, monkeypatch, capsys):
    """However late: once the files are there nothing looks at the clock any more."""
    from pas.designs.teapot import Teapot

    body, clock = two_parts()[0]["box"].shape, Clock(1.0)
    monkeypatch.setattr(sys.modules[Teapot.__module__], "teapot", lambda *_, **__: Teapot("paper", body, body, body))
    small, made = tmp_path / "small.toml", tmp_path / "made"
    text = (ROOT / "examples/corners/published_proved.toml").read_text()
    made.mkdir()
    small.write_text(f"{text}\n[picture]\nsize = [40, 30]\n")
    problem = [str(small)] if command == "blend" else []

    def run(seconds):
        """How many files there are then, and what was said."""
        main([command, *problem, "-o", str(made), "--tolerance", "0.5", "--seconds", str(seconds)])
        files = list(made.iterdir())
        for file in files:
            file.unlink()
        return len(files), (capsys.readouterr().err.splitlines() or [""])[-1]

    run(1e9)  # the first one in a process fills tables that are kept
    monkeypatch.setattr("pas.limits.time", clock)
    assert run(1e9)[0] == 3
    looks, late = int(clock.now) - 100, set()
    for before_the_end in range(1, 5):
        files, said = run(looks - before_the_end)
        assert files == (0 if "pas: gave up after" in said else 3)
        late |= {said.partition(" s while ")[2].partition(";")[0]} if not files else set()
    assert "drawing (rendering a picture)" in late


def test_limited_functions_show_their_two_keywords_and_take_no_others():
    @limited("counting", "less")
    def count(number: int, **limits: Unpack[WorkLimits]) -> int:
        return number

    assert str(inspect.signature(count)).startswith("(number: 'int', *, seconds: 'float | None' = None, progress:")
    assert count(3, seconds=60, progress=print) == 3
    with pytest.raises(TypeError, match=r"count\(\) got an unexpected keyword argument 'second'"):
        count(3, second=60)
    with pytest.raises(TypeError, match="must take the keywords seconds and progress to be limited"):
        limited("counting", "less")(lambda number: number)


def test_progress_with_fractions(clock):
    """A function of a fraction and a text is told both; one of a text, or of any number of things, gets a line."""
    told, lines = [], []
    with limit(progress=lambda fraction, words: told.append((fraction, words))):
        clock.now += 2
        checkpoint("eliminating", 0.25)
        clock.now += 2
        checkpoint("waiting")
        note("done")
    eighth, next_one = 1 / 8, 7 / 64
    assert told == [(eighth / 4, "eliminating"), (eighth, "waiting"), (eighth, "done"), (1, "waiting")]
    with limit(progress=lambda *words: lines.append(words)), part(0.5):
        clock.now += 2
        checkpoint("substituting")
        clock.now += 2
        checkpoint("eliminating", 0.25)
    assert lines == [("substituting, 2 s",), (f"eliminating ({(eighth + next_one / 4) / 2:.0%}), 4 s",)]
    for wrong in (lambda: None, lambda a, b, c: None, 3, "print"):
        with pytest.raises(
            TypeError, match=r"progress must be a function of one line of text, .* or of a fraction and"
        ):
            limit(progress=wrong).__enter__()


def test_parts_of_parts_and_tasks_in_them(clock):
    """A part ends where its share does, whatever was said in it; tasks that begin anew never take a fraction back."""
    told = []

    def look(task, share=None):
        clock.now += 1
        checkpoint(task, share)
        return told[-1][0]

    with limit(progress=lambda fraction, words: told.append((fraction, words))):
        clock.now += 1
        with part(0.5):
            with part(0.2):
                assert [look(f"round {n}", 0.5) for n in range(3)] == pytest.approx([0.1 / 16] * 3)
                assert look("round", 0.1) > 0.1 / 8  # begun anew
            assert look("next") == pytest.approx(0.1)
        assert look("after") == pytest.approx(0.5)
        for number, _ in enumerate(in_parts(range(4), "counting")):
            assert look(f"inside of {number}") == pytest.approx(0.5 + number * 7 / 64)
            clock.now += 1
        counted = [words for _, words in told if words.startswith("counting:")]
        assert counted == [f"counting: {n} of 4, some {2 * (4 - n)} s left" for n in (1, 2, 3)]
        assert look("end") == pytest.approx(15 / 16)
        with pytest.raises(ValueError, match="within"), part(0.5):
            raise ValueError("within")
        assert look("after an error") == pytest.approx(31 / 32)
    fractions = [fraction for fraction, _ in told]
    assert fractions == sorted(fractions)


def test_what_gives_up_never_says_that_all_is_done(clock):
    told = []
    with pytest.raises(pas.LimitError), limit(seconds=5, progress=lambda fraction, _: told.append(fraction)):
        for _ in range(9):
            clock.now += 1
            checkpoint("counting")
    assert told and max(told) < 1


def test_what_nothing_else_stops_ends_with_the_limit_and_with_interrupts():
    assert elsewhere("dividing", "builtins:divmod", 7, 2) == (3, 1)
    began = time.monotonic()
    with pytest.raises(pas.LimitError, match=r"^gave up after 0.5 s while sleeping"), limit(seconds=0.5):
        elsewhere("sleeping", "time:sleep", 60)
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background ignores it
    timer = Timer(0.5, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        elsewhere("sleeping", "time:sleep", 60)
    signal.signal(signal.SIGINT, handler)
    assert time.monotonic() - began < 10


def test_tables_tell_their_share(ticking):
    told = []
    blends = {name: pas.blend([pas.Pipe(a, "1/3", 1) for a in ((1, 0, 0), (0, 1, 0), (0, 0, 1))], 1) for name in "ab"}
    table = pas.table(blends, progress=lambda fraction, words: told.append((fraction, words)))
    said = "comparing blends: measuring blends: 1 of 2, some"
    assert any(words.startswith(said) and share == pytest.approx(0.4375) for share, words in told)
    assert told[-1][0] == 1
    rows = table if isinstance(table, list) else table.to_dict("records")
    assert [row["verdict"] for row in rows] == ["proved"] * 2 and rows[0]["degree"] == blends["a"].surface.degree
    assert rows[0]["sharpness"] == blends["a"].fairness.sharpness and rows[0]["fair"] is True
    assert isinstance(table, list) or list(table.index) == ["a", "b"]
    with pytest.raises(TypeError, match=r"blends\[0\] must be a pas\.Blend, not"):
        pas.table([blends["a"].surface])
