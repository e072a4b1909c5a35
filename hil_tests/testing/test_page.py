"""The page of a session: it stands alone, hides nothing, and is not broken by what a test has printed."""

from html.parser import HTMLParser
from pathlib import Path

from emulators.testing.page import PICTURED, CaseOutcome, page

FAILED = CaseOutcome(
    "test_it.py::test_a<b>",
    "failed",
    1.5,
    "robot rars, seed 7",
    "assert 1 < 0 & more",
    (("Captured stdout call", "</pre><script>"),),
    again="pytest 'test_it.py::test_a<b>'",
)


class Seen(HTMLParser):
    """A browser's view of it: the elements that are open, and the text in them."""

    VOID = ("meta", "img")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.all: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.all.append(tag)
        self.open += [] if tag in self.VOID else [tag]
        for name, value in attrs:
            assert name not in {"href", "src"} or str(value).startswith(("#", "data:")), (
                "it needs another file"
            )

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def test_what_failed_is_there_whole_and_all_tests_are_in_the_table() -> None:
    skipped = CaseOutcome("test_it.py::test_b", "skipped", 0.0, "", "needs a SocketCAN bus")
    seen = Seen(page("2 tests", iter([FAILED, skipped])))
    assert seen.open == []
    assert "script" not in seen.all
    for text in ("1 failed, 1 skipped", "assert 1 < 0 & more", "</pre><script>", "needs a SocketCAN bus"):
        assert text in seen.text, text
    assert seen.text.count("test_it.py::test_a<b>") == 4, "contents, heading, line that runs it again, table"
    assert seen.all.count("tr") == 1 + 2


def test_the_first_failures_show_their_pictures_and_the_others_say_where_theirs_are(tmp_path: Path) -> None:
    (tmp_path / "path.png").write_bytes(b"\x89PNG")
    (tmp_path / "can.log").write_text("")
    one = CaseOutcome("test", "error", 0.0, "", kept=str(tmp_path))
    seen = Seen(page("many", [one] * (PICTURED + 1)))
    assert seen.all.count("img") == PICTURED
    assert seen.text.count(f"1 pictures are in {tmp_path}") == 1


def test_a_session_without_tests_has_a_page() -> None:
    assert "no tests" in Seen(page("0 tests", [])).text
