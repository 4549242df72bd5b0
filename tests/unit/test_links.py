"""Links that other machines can open."""

from __future__ import annotations

import socket
from typing import Any

import pytest

from ui.guard import Gate
from ui.links import ANY, links, reachable_names


@pytest.mark.parametrize("host", ["0.0.0.0", "::"])
def test_no_link_names_every_address(host: str) -> None:
    """What is printed can be opened: the machine's name, then its addresses."""
    names = reachable_names(host)
    assert names
    assert not set(names) & set(ANY)
    assert not any(name.startswith("127.") for name in names)


def test_a_named_address_is_printed_as_it_is() -> None:
    """Who names one address means it; IPv6 stands in brackets."""
    assert reachable_names("192.168.1.5") == ["192.168.1.5"]
    assert links(["192.168.1.5"], 8080, None) == ["http://192.168.1.5:8080/"]
    assert links(["fe80::1"], 80, "t") == ["http://[fe80::1]:80/?token=t"]


def test_every_printed_name_is_let_in() -> None:
    """With the token, as the Host that a browser would send."""
    names = reachable_names("0.0.0.0")
    gate = Gate(port=8080, hosts=("0.0.0.0", *names), token="t")
    for name in names:
        host = f"[{name}]:8080" if ":" in name else f"{name}:8080"
        answer = gate.decide("/?token=t", {"Host": host})
        assert answer is not None
        assert answer[0] == 302


def test_a_machine_without_a_network_has_its_own_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither name nor way: localhost."""

    def nowhere(*_: Any, **__: Any) -> Any:
        raise OSError("no network")

    monkeypatch.setattr(socket, "gethostname", lambda: "")
    monkeypatch.setattr(socket, "getaddrinfo", nowhere)
    monkeypatch.setattr(socket, "socket", nowhere)
    assert reachable_names("0.0.0.0") == ["localhost"]
