"""Log in at an OpenID provider: one that keeps to the book, and what is said in its name by others."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import delete
from tests.service.conftest import HERE, make_service

pytest.importorskip("joserfc")
from joserfc import jwk
from tests.service.oidc_provider import CLIENT, SECRET, Provider

from jackettwin.errors import InputError
from jackettwin.service.context import Service
from jackettwin.service.login_attempts import LoginAttempts
from jackettwin.service.settings import read_settings
from jackettwin.service.web import auth, oidc
from jackettwin.service.web.app import create_app
from jackettwin.store import people, reading, tables, writing

PUBLIC = "http://127.0.0.1:8470"
Browser = TestClient


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A server, and a provider that it sends people to; who has an address as a name logs in there, too."""
    patch = pytest.MonkeyPatch()
    with Provider() as running:
        given = {"oidc_issuer": running.issuer, "oidc_client": CLIENT, "oidc_secret": SECRET}
        for made in make_service(
            tmp_path_factory.mktemp("standing"), None, patch, public_url=PUBLIC + "/", **given
        ):
            made.provider = running  # type: ignore[attr-defined]
            yield made
    patch.undo()


@pytest.fixture
def service(standing: Service) -> Service:
    standing.login_attempts = LoginAttempts()
    with writing(standing.database) as connection:
        connection.execute(delete(tables.audit))
        for name, role in (("boss", "admin"), ("viewer", "viewer"), ("a@b.example", "viewer")):
            people.add_user(connection, people.User(name, role, "", standing.now()))
    return standing


@pytest.fixture
def provider(service: Service) -> Provider:
    own: Provider = service.provider  # type: ignore[attr-defined]
    own.claims, own.discovery, own.signs_with, own.algorithm = {"sub": "viewer"}, {}, None, "ES256"
    return own


@pytest.fixture
def browser(service: Service) -> Browser:
    return new_browser(service)


def new_browser(service: Service) -> Browser:
    return TestClient(create_app(service), base_url=PUBLIC, client=HERE, follow_redirects=False)


def with_other(service: Service, **changes: Any) -> Service:
    return replace(service, settings=service.settings.model_copy(update=changes))


def sent_back(browser: Browser, provider: Provider) -> str:
    """Return the address at which the provider sends a browser back, of a login that it began."""
    away = browser.get("/api/v1/oidc/login")
    assert away.status_code == 302
    assert away.headers["location"].startswith(f"{provider.issuer}/auth?")
    back = httpx.get(away.headers["location"]).headers["location"]
    assert back.startswith(f"{PUBLIC}/api/v1/oidc/callback?")
    return back.removeprefix(PUBLIC)


def audited(service: Service) -> list[tuple[str, str]]:
    with reading(service.database) as connection:
        return [
            (line.who, line.outcome) for line in people.read_audit(connection, 10) if line.action == "login"
        ]


def test_whom_the_provider_names_is_logged_in(browser: Browser, provider: Provider, service: Service) -> None:
    answer = browser.get(sent_back(browser, provider))
    assert answer.status_code == 200
    assert 'content="0;url=/"' in answer.text
    cookies = answer.headers.get_list("set-cookie")
    (session,) = [cookie for cookie in cookies if cookie.startswith(f"{auth.COOKIE}=")]
    assert {"httponly", "samesite=strict"} <= {part.strip().lower() for part in session.split(";")}
    me = browser.get("/api/v1/me").json()
    assert (me["name"], me["role"]) == ("viewer", "viewer")
    assert browser.get("/api/v1/users").status_code == 403
    assert browser.post("/api/v1/logout").status_code == 403  # a session needs its CSRF token here, too
    assert audited(service) == [("viewer", "ok")]


def test_without_a_provider_there_is_nothing_to_log_in_at(service: Service) -> None:
    browser = new_browser(with_other(service, oidc_issuer=None))
    assert browser.get("/api/v1/oidc/login").status_code == 404
    assert browser.get("/api/v1/oidc/callback?code=1&state=2").status_code == 403


ANOTHER = jwk.ECKey.generate_key("P-256", {"kid": "1"})
NOW = int(time.time())
FORGED: dict[str, Callable[[Provider], Any]] = {
    "another key": lambda p: setattr(p, "signs_with", ANOTHER),
    "no signature": lambda p: setattr(p, "algorithm", "none"),
    "the public key as a secret": lambda p: setattr(p, "algorithm", "HS256"),
    "another audience": lambda p: p.claims.update(aud="other"),
    "several audiences, for another": lambda p: p.claims.update(aud=[CLIENT, "other"], azp="other"),
    "several audiences, for nobody": lambda p: p.claims.update(aud=[CLIENT, "other"]),
    "another issuer": lambda p: p.claims.update(iss="http://127.0.0.1:1/realm"),
    "another login": lambda p: p.claims.update(nonce="of another login"),
    "no login": lambda p: p.claims.update(nonce=None),
    "expired": lambda p: p.claims.update(exp=NOW - 3600),
    "for ever": lambda p: p.claims.update(exp=None),
    "of tomorrow": lambda p: p.claims.update(nbf=NOW + 86_400),
    "nobody": lambda p: p.claims.update(sub=None),
    "no name": lambda p: p.claims.update(sub=["viewer"]),
    "a stranger": lambda p: p.claims.update(sub="stranger"),
    "an empty name": lambda p: p.claims.update(sub=""),
}


@pytest.mark.parametrize("what", FORGED)
def test_a_token_that_does_not_hold_opens_nothing(
    browser: Browser, provider: Provider, service: Service, what: str
) -> None:
    FORGED[what](provider)
    answer = browser.get(sent_back(browser, provider))
    assert (answer.status_code, answer.headers["content-type"]) == (403, "application/problem+json")
    assert auth.COOKIE not in browser.cookies
    assert [outcome for _, outcome in audited(service)] == ["refused"]


def test_an_answer_counts_once_and_in_the_browser_that_asked(
    browser: Browser, provider: Provider, service: Service
) -> None:
    """Another's answer would log somebody in as another, who then sees what he sends."""
    back, victim = sent_back(browser, provider), new_browser(service)
    assert victim.get(back).status_code == 403  # it began no login
    sent_back(victim, provider)
    assert victim.get(back).status_code == 403  # it began another one
    kept = browser.cookies[oidc.COOKIE]
    assert browser.get(back).status_code == 200
    browser.cookies.set(oidc.COOKIE, kept, path=oidc.CALLBACK)
    assert browser.get(back).status_code == 403  # the code was used
    denied = browser.get(f"{oidc.CALLBACK}?error=denied&state={kept.split('.')[0]}")
    assert "denied" in denied.json()["detail"]


def test_a_user_who_may_not_enter_does_not(browser: Browser, provider: Provider, service: Service) -> None:
    with writing(service.database) as connection:
        gone = service.now() - timedelta(days=1)
        people.add_user(connection, people.User("viewer", "viewer", "", service.now(), expires_utc=gone))
    assert browser.get(sent_back(browser, provider)).status_code == 403
    login = {"name": "viewer", "password": ""}
    assert browser.post("/api/v1/login", json=login).status_code == 401  # and an empty hash is no password's


def test_an_address_counts_once_it_is_verified(service: Service, provider: Provider) -> None:
    """Whoever may write any address into a profile would be anybody."""
    browser = new_browser(with_other(service, oidc_claim="email"))
    for verified, status in ((False, 403), (None, 403), ("true", 403), (True, 200)):
        provider.claims = {"sub": "1", "email": "a@b.example", "email_verified": verified}
        assert browser.get(sent_back(browser, provider)).status_code == status


def test_a_provider_that_is_away_or_another_is_said(
    browser: Browser, provider: Provider, service: Service
) -> None:
    back = sent_back(browser, provider)
    for wrong in ({"issuer": "https://evil.example"}, {"token_endpoint": "http://evil.example/token"}):
        provider.discovery = wrong
        assert browser.get("/api/v1/oidc/login").status_code == 503
    gone = "http://127.0.0.1:9/realm"
    kept = browser.cookies
    browser = new_browser(with_other(service, oidc_issuer=gone))
    browser.cookies = kept
    for path in ("/api/v1/oidc/login", back):
        answer = browser.get(path)
        assert answer.status_code == 503
        assert gone in answer.json()["detail"]


def test_tries_are_counted(browser: Browser, service: Service) -> None:
    answers = [browser.get(f"{oidc.CALLBACK}?code=1&state=2") for _ in range(auth.ATTEMPTS_FROM + 1)]
    assert [a.status_code for a in answers] == [403] * auth.ATTEMPTS_FROM + [429]


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"oidc_client": None}, "oidc-client"),
        ({"public_url": None}, "public-url"),
        ({"public_url": "http://twin.example.org"}, "public-url"),
        ({"oidc_issuer": "http://login.example.org"}, "oidc-issuer"),
        ({"oidc_issuer": "ftp://127.0.0.1"}, "oidc-issuer"),
        ({"oidc_issuer": "https://user:word@login.example.org"}, "oidc-issuer"),
    ],
)
def test_settings_that_are_not_safe_are_refused(
    tmp_path: Path, changes: dict[str, str | None], field: str
) -> None:
    good = {"oidc_issuer": "https://login.example.org/realm", "oidc_client": CLIENT, "public_url": PUBLIC}
    oidc.check_settings(read_settings(store=tmp_path, **good))
    with pytest.raises(InputError) as caught:
        oidc.check_settings(read_settings(store=tmp_path, **{**good, **changes}))
    assert caught.value.field == field
