"""Tables as TOML text: `tomllib` reads back what was written."""

import tomllib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.bench.toml_text import as_toml

words = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
scalars = st.one_of(
    st.booleans(),
    st.integers(-(2**63), 2**63 - 1),
    st.floats(allow_nan=False),
    words,
    st.lists(st.integers()),
)


def tables(depth: int) -> st.SearchStrategy[dict[str, Any]]:
    values: st.SearchStrategy[Any] = scalars
    if depth:
        below = tables(depth - 1)
        values = st.one_of(scalars, below, st.lists(below, min_size=1, max_size=3))
    return st.dictionaries(words, values, max_size=4)


@given(tables(3))
def test_what_is_written_is_read(table: dict[str, Any]) -> None:
    assert tomllib.loads(as_toml(table)) == table


def test_what_has_no_word_is_refused() -> None:
    with pytest.raises(TypeError, match="no word for None"):
        as_toml({"key": None})
