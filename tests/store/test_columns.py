"""Documents in columns: nothing is lost of what is rounded, and what older versions kept is read."""

import hashlib
import json
from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st
from tests.store.old_stores import documents

from jackettwin.store import columns

numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers() | st.floats(-1.0, 1.0)
words = st.text(max_size=8) | st.sampled_from(["\x02", "\u2028", '"', "0.25", "Hölle"])
values = st.recursive(
    st.none() | st.booleans() | numbers | words,
    lambda inner: st.lists(inner, max_size=6) | st.dictionaries(words, inner, max_size=5),
)


@settings(max_examples=40)
@given(st.dictionaries(words, values, max_size=6))
def test_what_is_rounded_is_packed_without_loss(document: dict) -> None:
    once = columns.rounded(json.dumps(document))
    assert columns.rounded(once) == once
    assert json.loads(columns.unpack(columns.pack(once))) == json.loads(once)


@settings(max_examples=40)
@given(st.dictionaries(words, values, max_size=6))
def test_what_is_not_rounded_is_not_packed_with_loss(document: dict) -> None:
    text = json.dumps(document)
    assert json.loads(columns.unpack(columns.pack(text))) == json.loads(text)


@given(st.floats(1e-29, 1e29) | st.floats(-1e29, -1e-29))
def test_rounding_changes_less_than_half_a_step_of_18_binary_digits(value: float) -> None:
    """2⁻¹⁸ of the number, and 2⁻²³ for the steps of 32 bits and the shortest decimal of what is left."""
    once = json.loads(columns.rounded(json.dumps([value])))[0]
    assert abs(once - value) <= (2.0**-18 + 2.0**-23) * abs(value)


def test_an_observation_of_eight_channels_takes_at_most_four_kilobytes() -> None:
    """Of the shipped records, which give seven modes and forty rejected poles each."""
    for document in documents("0100"):
        packed = columns.pack(columns.rounded(document))
        assert len(document) > 27_000
        assert len(packed) <= 3_300


def test_what_older_versions_kept_is_read_and_what_newer_ones_will_keep_is_refused() -> None:
    assert columns.unpack(b'{"a": 1.123456789012}') == '{"a": 1.123456789012}'
    first_words = "0173676060a8c635d100b207c7301f7afcd7c6d66acff6b6b50ab0b30100"
    text = '{"schema":"observation","modes":[{"frequency_hz":0.18192737,"damping_ratio":0.01271}]}'
    assert columns.unpack(bytes.fromhex(first_words)) == text
    with pytest.raises(ValueError, match="newer"):
        columns.unpack(b"\x07abc")


@pytest.mark.parametrize(
    ("number", "digest"),
    [
        (1, "c3519882b3b1ab475890849ec4af137a137e43b5409d438eb8abd867855a3624"),
        (2, "b664e72fb26283c40422d5d71fb5067775280ecdd4b1ae1d8248509c9b667598"),
    ],
)
def test_the_words_are_never_edited(number: int, digest: str) -> None:
    """Whatever is stored is unreadable with other words: new ones are another file and another first byte."""
    found = Path(columns.__file__).with_name(f"words_{number}.txt").read_bytes()
    assert hashlib.sha256(found).hexdigest() == digest
