"""Login by OpenID Connect with authorisation code and PKCE; rights are those of the local user."""

from __future__ import annotations

import base64
import hashlib
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from urllib.parse import quote, urlencode

from jackettwin.errors import InputError, require
from jackettwin.service.credentials import secret_of
from jackettwin.service.settings import ServiceSettings, checked_url
from jackettwin.service.web import auth
from jackettwin.service.web.problems import ApiError
from jackettwin.store import people, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Service

COOKIE = "jackettwin_oidc"
COOKIE_S = 600
"""Time limit for the login at the provider."""
CALLBACK = "/api/v1/oidc/callback"
_SIGNED_BY = ["RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA"]
"""Allowed signature algorithms: only those with a private key of the provider."""
_WAIT_S = 10.0
_LEEWAY_S = 60
"""Allowed difference between the provider's clock and this server's."""


@dataclass(frozen=True)
class LoginUnderWay:
    """A pending login, which the browser stores and must return."""

    state: str
    nonce: str
    verifier: str

    @classmethod
    def new(cls) -> LoginUnderWay:
        """Return one with random secrets."""
        return cls(secrets.token_urlsafe(32), secrets.token_urlsafe(32), secrets.token_urlsafe(48))

    @classmethod
    def read(cls, cookie: str) -> LoginUnderWay | None:
        """Return the pending login in a cookie, or None."""
        parts = cookie.split(".")
        return cls(*parts) if len(parts) == 3 and all(parts) else None

    @property
    def cookie(self) -> str:
        """The cookie for the browser."""
        return ".".join((self.state, self.nonce, self.verifier))


def begin(settings: ServiceSettings) -> tuple[str, LoginUnderWay]:
    """Return the address of the provider for the browser, and the pending login.

    Raises
    ------
    ApiError
        404 without an OpenID provider, 503 if it does not answer.
    """
    begun = LoginUnderWay.new()
    hashed = hashlib.sha256(begun.verifier.encode()).digest()
    asked = {
        "response_type": "code",
        "scope": "openid profile email",
        "client_id": str(settings.oidc_client),
        "redirect_uri": _callback(settings),
        "state": begun.state,
        "nonce": begun.nonce,
        "code_challenge": base64.urlsafe_b64encode(hashed).rstrip(b"=").decode(),
        "code_challenge_method": "S256",  # RFC 7636, section 4.2
    }
    return f"{_places(settings)['authorization_endpoint']}?{urlencode(asked)}", begun


def finish(service: Service, answer: Mapping[str, str], cookie: str, place: str) -> str:
    """Return the secret of a session for the user named by the provider; the attempt is logged.

    Parameters
    ----------
    answer : query parameters of the provider's redirect: ``code`` and ``state``, or ``error``
    cookie : of the pending login, from :func:`begin`
    place : address of the browser

    Raises
    ------
    ApiError
        403 if the answer is not from the provider for this browser and server, or names no local user; 429
        after too many tries; 503 if the provider does not answer.
    """
    limits = auth.counted(service.login_attempts, "", place)
    begun, now, name, outcome = LoginUnderWay.read(cookie), service.now(), "", "refused"
    try:
        if begun is None or not secrets.compare_digest(
            begun.state.encode(), answer.get("state", "").encode()
        ):
            raise _refused("this browser did not begin this login, or it took too long")
        if "error" in answer:
            raise _refused(f"the provider reports {answer['error'][:64]!r}")
        name = _named(service.settings, answer, begun)
        with writing(service.database) as connection:
            user = people.find_user(connection, name)
            if user is None or not user.may_enter(now):
                raise _refused("no user of this name may log in here")
            secret, _ = auth.new_grant(connection, name, "session", "browser", now, auth.SESSION)
        outcome = "ok"
    finally:
        with writing(service.database) as connection:
            people.note_down(connection, name or "?", "login", f"{place} by OIDC", outcome, now)
    service.login_attempts.succeeded(limits)
    return secret


def _named(settings: ServiceSettings, answer: Mapping[str, str], begun: LoginUnderWay) -> str:
    """Return the user's name in the provider's signed token for this login."""
    places = _places(settings)
    if answer.get("iss", settings.oidc_issuer) != settings.oidc_issuer:  # RFC 9207
        raise _refused("this is another provider's answer")
    form = {
        "grant_type": "authorization_code",
        "code": answer.get("code", ""),
        "redirect_uri": _callback(settings),
        "code_verifier": begun.verifier,
    }
    client, secret = str(settings.oidc_client), _secret(settings)
    known = (quote(client, safe=""), quote(secret, safe="")) if secret else None  # RFC 6749, section 2.3.1
    status, given = _asked(
        settings,
        "POST",
        places["token_endpoint"],
        auth=known,
        data=form | ({} if secret else {"client_id": client}),
    )
    if status != 200:
        raise _refused(f"the provider reports {str(given.get('error'))[:64]!r}")
    _, keys = _asked(settings, "GET", places["jwks_uri"])
    claims = _claims(settings, str(given.get("id_token", "")), keys, begun.nonce)
    claim = settings.oidc_claim
    if claim == "email" and claims.get("email_verified") is not True:
        raise _refused("the provider has not verified the e-mail address")
    name = claims.get(claim)
    if not isinstance(name, str) or not name:
        raise _refused(f"the provider's token has no claim {claim!r}")
    return name


def _claims(settings: ServiceSettings, token: str, keys: Any, nonce: str) -> dict[str, Any]:
    """Return the claims of a token after checking signature, time, audience and nonce."""
    from joserfc import jwk, jwt
    from joserfc.errors import JoseError

    said = jwt.JWTClaimsRegistry(
        leeway=_LEEWAY_S,
        iss={"essential": True, "value": str(settings.oidc_issuer)},
        aud={"essential": True, "value": str(settings.oidc_client)},
        sub={"essential": True},
        exp={"essential": True},
        iat={"essential": True},
        nonce={"essential": True, "value": nonce},
    )
    try:
        read = jwt.decode(token, jwk.KeySet.import_key_set(keys), algorithms=_SIGNED_BY)
        said.validate(read.claims)
    except (JoseError, ValueError, TypeError, KeyError) as error:
        raise _refused(f"the provider's token is not valid ({type(error).__name__})") from None
    several = isinstance(read.claims["aud"], list) and len(read.claims["aud"]) > 1
    if read.claims.get("azp", None if several else settings.oidc_client) != settings.oidc_client:
        raise _refused("the provider's token is for another client")
    return dict(read.claims)


def _callback(settings: ServiceSettings) -> str:
    return f"{str(settings.public_url).rstrip('/')}{CALLBACK}"


def _places(settings: ServiceSettings) -> dict[str, str]:
    """Return the provider's endpoints."""
    if settings.oidc_issuer is None:
        raise ApiError(404, "no OpenID provider is configured", remedy="serve with --oidc-issuer")
    url = f"{settings.oidc_issuer.rstrip('/')}/.well-known/openid-configuration"
    _, found = _asked(settings, "GET", url)
    places = {name: str(found.get(name)) for name in ("authorization_endpoint", "token_endpoint", "jwks_uri")}
    try:
        for place in places.values():
            checked_url(place, "oidc-issuer")
    except InputError as error:
        raise _unanswered(settings, error) from None
    if found.get("issuer") != settings.oidc_issuer:
        raise _unanswered(settings, ValueError("its issuer differs"))
    return places


def _asked(settings: ServiceSettings, method: str, url: str, **more: Any) -> tuple[int, dict[str, Any]]:
    """Return status and JSON object of a response of the provider."""
    import httpx

    try:
        answer = httpx.request(method, url, timeout=_WAIT_S, **more)
        found = answer.json()
    except (httpx.HTTPError, httpx.InvalidURL, ValueError) as error:
        raise _unanswered(settings, error) from None
    if not isinstance(found, dict) or answer.status_code >= 500:
        raise _unanswered(settings, ValueError(f"it answers {answer.status_code}"))
    return answer.status_code, found


def check_settings(settings: ServiceSettings) -> None:
    """Raise an error on incomplete or unsafe settings of the OpenID provider.

    Raises
    ------
    InputError
        If one is missing, or an address is neither https nor of this machine.
    """
    if settings.oidc_issuer is None:
        return
    for name in ("oidc_client", "public_url"):
        require(getattr(settings, name), "is needed with --oidc-issuer", field=name.replace("_", "-"))
    checked_url(settings.oidc_issuer, "oidc-issuer")
    checked_url(str(settings.public_url), "public-url")
    _secret(settings)


def _secret(settings: ServiceSettings) -> str:
    """Return the client secret."""
    return secret_of(settings.oidc_secret_file, settings.oidc_secret, what="secret file")


def _refused(why: str) -> ApiError:
    return ApiError(403, f"not logged in: {why}", remedy="start again at /login")


def _unanswered(settings: ServiceSettings, error: Exception) -> ApiError:
    said = (
        f"the provider {settings.oidc_issuer} does not answer as an OpenID provider ({type(error).__name__})"
    )
    return ApiError(503, said, headers={"Retry-After": "30"})
