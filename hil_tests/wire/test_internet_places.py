"""Addresses and ports as numbers, and back."""

import ipaddress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.wire.internet import host_and_port, number_of, place_of

PORTS = st.integers(1, 0xFFFF)


@given(st.ip_addresses(), PORTS)
def test_a_number_reports_its_place(
    address: ipaddress.IPv4Address | ipaddress.IPv6Address, port: int
) -> None:
    assert host_and_port(number_of(str(address), port)) == (str(address), port)


@given(st.tuples(st.ip_addresses(), PORTS), st.tuples(st.ip_addresses(), PORTS))
def test_two_places_have_two_numbers_and_none_is_0(
    one: tuple[object, int], other: tuple[object, int]
) -> None:
    first, second = (number_of(str(address), port) for address, port in (one, other))
    assert (first == second) is (one == other)
    assert 0 not in (first, second)


@pytest.mark.parametrize(
    ("number", "place"),
    [
        (0, ""),
        (number_of("192.168.1.10", 14550), "192.168.1.10:14550"),
        (number_of("1.0.0.0", 1), "1.0.0.0:1"),
        (number_of("::1", 65535), "[::1]:65535"),
        (number_of("fe80::1%eth0", 14550), "[fe80::1]:14550"),
    ],
)
def test_a_place_in_words(number: int, place: str) -> None:
    assert place_of(number) == place


@pytest.mark.parametrize(("host", "port"), [("10.0.0.1", 0), ("10.0.0.1", 65536), ("robot", 14550), ("", 1)])
def test_what_is_no_place_is_refused(host: str, port: int) -> None:
    with pytest.raises(ValueError, match=r"port|appear"):
        number_of(host, port)
