"""The gate: own pages pass, foreign hosts and origins do not, a token is asked for when set."""

from __future__ import annotations

import json

import pytest

from ui.guard import COOKIE, POLICY, Gate

OWN = {"Host": "127.0.0.1:8080"}


@pytest.mark.parametrize("host", ["127.0.0.1:8080", "localhost:1", "[::1]:8080", "LOCALHOST:8080"])
def test_own_hosts_pass(host: str) -> None:
    """Loopback names with any port are left to viser."""
    assert Gate(port=8080).decide("/", {"Host": host, "Origin": f"http://{host}"}) is None


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Host": "evil.example"},
        {"Host": "127.0.0.1.evil.example:8080"},
        {"Host": "localhost.:8080"},
        {**OWN, "Origin": "http://evil.example"},
        {**OWN, "Origin": "null"},
        {**OWN, "Origin": "http://127.0.0.1.evil.example"},
        {**OWN, "Origin": "http://127.0.0.1:8080@evil.example"},
        {**OWN, "Origin": "http://127.0.0.1:3000"},
        {**OWN, "Origin": "http://localhost:8080"},
        {"Host": "192.168.1.5:8080"},
    ],
)
def test_foreign_pages_are_refused(headers: dict[str, str]) -> None:
    """Status 403 for every foreign Host or Origin."""
    answer = Gate(port=8080).decide("/", headers)
    assert answer is not None
    assert answer[0] == 403


def test_health_is_plain_json() -> None:
    """/healthz answers 200 with ok true, to own hosts only."""
    answer = Gate(port=8080).decide("/healthz", OWN)
    assert answer is not None
    assert json.loads(answer[2]) == {"ok": True}
    refused = Gate(port=8080).decide("/healthz", {"Host": "evil.example"})
    assert refused is not None
    assert refused[0] == 403


def test_token_link_sets_a_cookie_that_opens_the_door() -> None:
    """No token 401, wrong token 401, right token 302 with a cookie, cookie passes."""
    gate = Gate(port=8080, token="secret")
    for path in ("/", "/?token=", "/?token=wrong", "/?x=token=secret"):
        answer = gate.decide(path, OWN)
        assert answer is not None
        assert answer[0] == 401
    answer = gate.decide("/?token=secret", OWN)
    assert answer is not None
    assert answer[0] == 302
    assert "HttpOnly" in answer[1]["Set-Cookie"]
    assert gate.decide("/", {**OWN, "Cookie": f"a=b; {COOKIE}_8080=secret"}) is None
    assert gate.decide("/", {**OWN, "Cookie": f"{COOKIE}_8080=other"}) is not None


def test_addresses_pass_behind_a_token_but_foreign_names_do_not() -> None:
    """With a token any IP address of the machine is a Host; `evil.example` is still refused."""
    gate = Gate(port=8080, hosts=("Lab-PC",), token="secret")
    cookie = {"Cookie": f"{COOKIE}_8080=secret"}
    for host in ("192.168.1.5:8080", "[fe80::1]:8080", "lab-pc:8080"):
        assert gate.decide("/", {"Host": host, **cookie}) is None
    refused = gate.decide("/", {"Host": "evil.example", **cookie})
    assert refused is not None
    assert refused[0] == 403


@pytest.mark.parametrize("path", ["//[", "/?token=\udc80"])
def test_a_path_that_is_no_address_is_answered(path: str) -> None:
    """Status 400 instead of a traceback."""
    answer = Gate(port=8080, token="secret").decide(path, OWN)
    assert answer is not None
    assert answer[0] == 400


def test_an_origin_that_is_no_address_is_foreign() -> None:
    """Status 403: a bracket that is never closed names no page."""
    answer = Gate(port=8080).decide("/", {**OWN, "Origin": "http://["})
    assert answer is not None
    assert answer[0] == 403


@pytest.mark.parametrize(
    "others", ['x={"a":1}', "a=b; x={[<>]}; é=1", "=; ;;", 'q="unfinished', "a=b=c"]
)
def test_cookies_of_other_programs_do_no_harm(others: str) -> None:
    """Whatever stands beside ours, before or after it."""
    gate = Gate(port=8080, token="secret")
    for text in (f"{others}; {COOKIE}_8080=secret", f"{COOKIE}_8080=secret; {others}"):
        assert gate.decide("/", {**OWN, "Cookie": text}) is None


def test_two_servers_of_a_machine_have_cookies_of_their_own() -> None:
    """Browsers send cookies to all ports: each server finds its own."""
    both = {**OWN, "Cookie": f"{COOKIE}_8080=first; {COOKIE}_8081=second"}
    assert Gate(port=8080, token="first").decide("/", both) is None
    assert Gate(port=8081, token="second").decide("/", both) is None
    crossed = Gate(port=8080, token="second").decide("/", both)
    assert crossed is not None
    assert crossed[0] == 401


def test_health_says_no_more_than_ok_without_the_token() -> None:
    """A probe learns that somebody answers; version and work are for who may look in."""
    gate = Gate(port=8080, token="secret", health=lambda: {"ok": True, "version": "1"})
    for headers, known in (({}, False), ({"Cookie": f"{COOKIE}_8080=secret"}, True)):
        answer = gate.decide("/healthz", {**OWN, **headers})
        assert answer is not None
        assert ("version" in json.loads(answer[2])) is known
    answer = gate.decide("/healthz?token=secret", OWN)
    assert answer is not None and "version" in json.loads(answer[2])


def test_the_page_may_reach_nothing_but_its_server() -> None:
    """No address, no wildcard and no scheme of the network in the policy."""
    assert "default-src 'none'" in POLICY
    assert not any(word in POLICY for word in ("http", "ws:", "*"))
