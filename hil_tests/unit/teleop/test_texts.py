"""STATUSTEXT: cut, numbered, and put together again."""

from hypothesis import example, given
from hypothesis import strategies as st

from firmware_bridge.mavlink.frames import Codec
from firmware_bridge.mavlink.texts import Received, Speaker, TextCollector, chunks
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.teleop.texts import InterlockTexts
from firmware_bridge.units import SECOND

PLAIN = st.text(st.characters(min_codepoint=32, max_codepoint=126), min_size=1, max_size=400)


def test_up_to_fifty_characters_are_one_message_without_a_number() -> None:
    for length in (1, 49, 50):
        [message] = Speaker().say(Severity.WARNING, "x" * length)
        assert (message.severity, message.id, message.chunk_seq) == (4, 0, 0)
        assert message.text == "x" * length


def test_fifty_one_characters_are_two_messages_with_one_number() -> None:
    first, second = Speaker().say(Severity.CRITICAL, "x" * 51)
    assert (first.id, first.chunk_seq, len(first.text)) == (1, 0, 50)
    assert (second.id, second.chunk_seq, second.text) == (1, 1, "x")


def test_each_long_text_has_another_number_that_is_never_zero() -> None:
    speaker = Speaker()
    numbers = [speaker.say(Severity.INFO, "x" * 60)[0].id for _ in range(0x10001)]
    assert numbers[:2] == [1, 2]
    assert numbers[-3:] == [0xFFFF, 1, 2]


@given(st.text(max_size=400))
@example("x" * 50)
@example("x" * 100)
@example("")
def test_only_the_last_chunk_is_short_and_none_is_empty(text: str) -> None:
    cuts = chunks(text)
    assert all(len(cut) == 50 for cut in cuts[:-1])
    assert 1 <= len(cuts[-1]) <= 50
    assert len(cuts) == 1 or len(cuts[-1]) < 50
    assert b"\0" not in b"".join(cuts)


def test_degrees_and_minus_signs_are_written_in_ascii() -> None:
    assert chunks("60\u00b0 \u2212 1 m/s\u00b2 \u4e00") == [b"60 deg - 1 m/s2 ?"]


@given(st.lists(PLAIN, min_size=1, max_size=4))
def test_what_is_stated_is_received(texts: list[str]) -> None:
    speaker, listener = Speaker(), TextCollector()
    robot, station = Codec(1, 1), Codec(255, 190)
    received: list[Received] = []
    for text in texts:
        for message in speaker.say(Severity.NOTICE, text):
            for arrived in station.decode(robot.encode(message)):
                received += listener.receive(arrived)
    assert received == [Received(5, text.rstrip() if len(text) > 50 else text) for text in texts]


def test_a_lost_chunk_shows() -> None:
    speaker, listener = Speaker(), TextCollector()
    first, _, third = speaker.say(Severity.NOTICE, "a" * 50 + "b" * 50 + "c")
    assert listener.receive(first) == []
    assert listener.receive(third) == [Received(5, "a" * 50 + "..."), Received(5, "c")]


def test_the_same_refusal_is_stated_every_two_seconds() -> None:
    speaker = Speaker()
    stated = [bool(speaker.say_sometimes("stick", "no", now)) for now in range(0, 5 * SECOND, SECOND // 2)]
    assert stated == [True, False, False, False, True, False, False, False, True, False]
    assert speaker.say_sometimes("frame", "no", 4 * SECOND)


def test_what_a_stream_deserves_again_and_again_is_stated_more_and_more_seldom() -> None:
    speaker = Speaker()
    every = range(0, 200 * SECOND, SECOND // 20)
    stated = [now / SECOND for now in every if speaker.say_sometimes("mask", "no", now)]
    assert stated == [0.0, 2.0, 6.0, 14.0, 30.0, 62.0, 94.0, 126.0, 158.0, 190.0]


def test_after_a_pause_it_is_stated_at_once_and_a_hand_is_answered_each_time() -> None:
    speaker = Speaker()
    for now in range(0, 20 * SECOND, SECOND // 20):
        speaker.say_sometimes("mask", "no", now)
    pause = 120 * SECOND
    assert speaker.say_sometimes("mask", "no", pause)
    stated = [bool(speaker.say_sometimes("mask", "no", pause + 3 * SECOND * turn)) for turn in range(1, 9)]
    assert all(stated)


def test_kinds_of_texts_are_not_remembered_without_end() -> None:
    speaker = Speaker()
    for turn in range(1000):
        assert speaker.say_sometimes(f"command {turn}", "no", 0)
    assert len(speaker._repeats) <= Speaker.MOST  # noqa: SLF001 - what it keeps is what is tested


HOLD = ActiveInterlock("lift extended", "it is out", InterlockBase("lift extended", "lower it"), 0)


def test_a_hold_that_comes_and_goes_is_reported_three_times_in_two_seconds_and_as_it_is_at_the_end() -> None:
    reported = InterlockTexts(Speaker())
    texts: list[tuple[float, str]] = []
    for cycle in range(200):
        events = (HOLD,) if cycle % 2 == 0 or cycle >= 100 else ()
        now = cycle * SECOND // 20
        texts += [(now / SECOND, one.text) for one in reported.due(events, now)]
    begun = [at for at, text in texts if text.startswith("it is out")]
    assert all(sum(1 for other in begun if at <= other < at + 2.0) <= 3 for at in begun)
    assert len(begun) == 3 * 3 + 1
    assert texts[-1][1] == "it is out; lower it"
    assert texts[-1][0] <= 6.1


def test_a_hold_that_lets_go_while_it_is_kept_back_is_not_reported_at_all() -> None:
    reported = InterlockTexts(Speaker())
    for cycle in range(8):
        reported.due((HOLD,) if cycle % 2 == 0 else (), cycle)
    assert reported.due((), 10 * SECOND) == []


def test_each_stop_stage_has_a_text_and_the_last_one_clears_the_event() -> None:
    reported, row = InterlockTexts(Speaker()), InterlockBase("stop not acknowledged", "keep clear")
    texts = []
    for now, stage in enumerate(["ramp", "quick stop", "quick stop", "power off", "silence", "reset"]):
        failed = ActiveInterlock(f"{row.name}: left", f"{stage} not acknowledged", row, now, stage=stage)
        texts += [one.text for one in reported.due((failed,), now)]
    texts += [one.text for one in reported.due((), 9)]
    stages = ("ramp", "quick stop", "power off", "silence", "reset")
    expected = [f"{stage} not acknowledged; keep clear" for stage in stages]
    assert texts == [*expected, "cleared: stop not acknowledged: left"]


def test_information_is_reported_once_and_what_lets_go_of_it_not_at_all() -> None:
    """Every ordinary move of a stick passes the acceleration limit."""
    reported = InterlockTexts(Speaker())
    ramps = ActiveInterlock(
        "acceleration limit",
        "too fast",
        InterlockBase("acceleration limit", "slowly", severity=Severity.INFO),
        0,
    )
    texts = []
    for cycle in range(200):
        events = ((ramps,) if cycle % 20 < 10 else ()) + ((HOLD,) if cycle % 100 < 50 else ())
        texts += [one.text for one in reported.due(events, cycle * SECOND // 20)]
    assert texts.count("too fast; slowly") == 1
    assert [text for text in texts if text.startswith("cleared")] == ["cleared: lift extended"] * 2
