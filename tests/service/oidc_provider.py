"""An OpenID provider on loopback: it logs everybody in as whom it is told, and keeps to the book."""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import secrets
import time
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, unquote, urlencode, urlsplit

from joserfc import jwk, jwt

CLIENT, SECRET = "twin", "between us"


@dataclass
class Provider:
    """What it says of who logs in, and what it was asked."""

    claims: dict[str, Any] = field(default_factory=lambda: {"sub": "viewer"})
    key: jwk.ECKey = field(default_factory=lambda: jwk.ECKey.generate_key("P-256", {"kid": "1"}))
    signs_with: Any = None
    algorithm: str = "ES256"
    discovery: dict[str, str] = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)
    codes: dict[str, dict[str, str]] = field(default_factory=dict)

    def __enter__(self) -> Provider:
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), type("Handler", (_Handler,), {"provider": self}))
        Thread(target=self._server.serve_forever, args=(0.02,), daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()

    @property
    def issuer(self) -> str:
        return f"http://127.0.0.1:{self._server.server_port}/realm"

    def token(self, nonce: str) -> str:
        """Return what is said of who logged in, signed."""
        now = int(time.time())
        said = {"iss": self.issuer, "aud": CLIENT, "iat": now, "exp": now + 60, "nonce": nonce, **self.claims}
        header = {"alg": self.algorithm, "kid": "1"}
        said = {name: value for name, value in said.items() if value is not None}
        if self.algorithm in ("none", "HS256"):  # which a library for those who mean well does not make
            signed = b".".join(_in_64(json.dumps(part).encode()) for part in (header, said))
            by = hmac.digest(self.key.as_pem(private=False), signed, "sha256")
            return f"{signed.decode()}.{'' if self.algorithm == 'none' else _in_64(by).decode()}"
        return jwt.encode(header, said, self.signs_with or self.key, algorithms=["ES256"])


def _in_64(content: bytes) -> bytes:
    return base64.urlsafe_b64encode(content).rstrip(b"=")


class _Handler(BaseHTTPRequestHandler):
    provider: Provider

    def do_GET(self) -> None:
        url, own = urlsplit(self.path), self.provider
        own.asked.append(url.path)
        query = {name: values[0] for name, values in parse_qs(url.query).items()}
        if url.path == "/realm/.well-known/openid-configuration":
            places = {"authorization_endpoint": "auth", "token_endpoint": "token", "jwks_uri": "keys"}
            found = {name: f"{own.issuer}/{path}" for name, path in places.items()}
            self._answer(200, {"issuer": own.issuer, **found, **own.discovery})
        elif url.path == "/realm/keys":
            self._answer(200, {"keys": [own.key.as_dict(private=False)]})
        elif url.path == "/realm/auth" and query["response_type"] == "code" and query["client_id"] == CLIENT:
            code = secrets.token_urlsafe()
            own.codes[code] = query
            self.send_response(302)
            back = urlencode({"code": code, "state": query["state"], "session_state": "theirs"})
            self.send_header("Location", f"{query['redirect_uri']}?{back}")
            self.end_headers()
        else:
            self._answer(404, {})

    def do_POST(self) -> None:
        own, body = self.provider, self.rfile.read(int(self.headers["Content-Length"])).decode()
        own.asked.append(self.path)
        form = {name: values[0] for name, values in parse_qs(body).items()}
        begun = own.codes.pop(form.get("code", ""), None)
        scheme, _, known = self.headers.get("Authorization", "").partition(" ")
        who = [unquote(part) for part in base64.b64decode(known).decode().split(":")]
        hashed = hashlib.sha256(form.get("code_verifier", "").encode()).digest()
        challenge = _in_64(hashed).decode()
        if (scheme, who) != ("Basic", [CLIENT, SECRET]):
            return self._answer(401, {"error": "invalid_client"})
        if (
            begun is None
            or begun["code_challenge_method"] != "S256"
            or begun["code_challenge"] != challenge
            or begun["redirect_uri"] != form["redirect_uri"]
        ):
            return self._answer(400, {"error": "invalid_grant"})
        said = {"access_token": secrets.token_urlsafe(), "token_type": "Bearer", "expires_in": 60}
        return self._answer(200, {**said, "id_token": own.token(begun["nonce"])})

    def _answer(self, status: int, document: dict[str, Any]) -> None:
        content = json.dumps(document).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: object) -> None:
        """Say nothing."""
