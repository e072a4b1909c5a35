"""STATUSTEXT: cut, numbered, and put together again."""

from hypothesis import example, given
from hypothesis import strategies as st

from firmware_bridge.safety.row import Severity
from firmware_bridge.teleop.mavlink import Codec
from firmware_bridge.teleop.texts import Heard, Listener, Speaker, chunks
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
def test_what_is_said_is_heard(texts: list[str]) -> None:
    speaker, listener = Speaker(), Listener()
    robot, station = Codec(1, 1), Codec(255, 190)
    heard: list[Heard] = []
    for text in texts:
        for message in speaker.say(Severity.NOTICE, text):
            for arrived in station.decode(robot.encode(message)):
                heard += listener.hear(arrived)
    assert heard == [Heard(5, text.rstrip() if len(text) > 50 else text) for text in texts]


def test_a_lost_chunk_shows() -> None:
    speaker, listener = Speaker(), Listener()
    first, _, third = speaker.say(Severity.NOTICE, "a" * 50 + "b" * 50 + "c")
    assert listener.hear(first) == []
    assert listener.hear(third) == [Heard(5, "a" * 50 + "..."), Heard(5, "c")]


def test_the_same_refusal_is_said_every_two_seconds() -> None:
    speaker = Speaker()
    said = [bool(speaker.say_sometimes("stick", "no", now)) for now in range(0, 5 * SECOND, SECOND // 2)]
    assert said == [True, False, False, False, True, False, False, False, True, False]
    assert speaker.say_sometimes("frame", "no", 4 * SECOND)
