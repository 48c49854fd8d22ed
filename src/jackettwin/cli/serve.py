"""``jackettwin serve``: the server of living twins."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from jackettwin.cli.console import FiniteFloat, messages, print_json
from jackettwin.cli.store_options import needs_service

FILE = click.Path(path_type=Path, exists=True, dir_okay=False)


@click.command("serve")
@click.argument("store", type=click.Path(path_type=Path, file_okay=False))
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen at.")
@click.option("--port", default=8470, show_default=True, type=click.IntRange(1, 65535))
@click.option("--database", envvar="JACKETTWIN_DATABASE", help="URL of PostgreSQL; default: SQLite in STORE.")
@click.option("--scheduler", help="tls://HOST:PORT of a Dask scheduler; default: local workers.")
@click.option("--scheduler-ca", type=FILE, help="CA certificate that verifies the scheduler.")
@click.option("--scheduler-certificate", type=FILE, help="Certificate of this server for the scheduler.")
@click.option("--scheduler-key", type=FILE)
@click.option("--workers", default=2, show_default=True, type=click.IntRange(1, 256), help="Of its own.")
@click.option("--mqtt", help="mqtt[s]://[USER@]HOST[:PORT] of a broker to subscribe to.")
@click.option("--mqtt-password-file", type=FILE, help="Its first line is the broker's password.")
@click.option("--mqtt-ca", type=FILE, help="CA certificate that verifies the broker; default: the system's.")
@click.option("--mqtt-certificate", type=FILE, help="Certificate of this server for the broker.")
@click.option("--mqtt-key", type=FILE)
@click.option("--opcua", type=FILE, help="YAML file that says which nodes of OPC UA are channels.")
@click.option("--alerts", type=FILE, help="YAML file with the rules and channels of alerts.")
@click.option("--tls-certificate", type=FILE)
@click.option("--tls-key", type=FILE)
@click.option("--behind-proxy", is_flag=True, help="A reverse proxy terminates TLS.")
@click.option(
    "--trusted-proxy",
    "trusted_proxies",
    multiple=True,
    help="Address or network of that proxy; may be repeated; default: this machine.",
)
@click.option("--trusted-header", help="Header in which the proxy names the user it authenticated.")
@click.option("--oidc-issuer", help="URL of the OpenID provider (issuer) for logging in.")
@click.option("--oidc-client", help="Client identifier of this server at the provider.")
@click.option("--oidc-secret-file", type=FILE, help="Its first line is the client secret.")
@click.option("--oidc-claim", help="Claim of the provider used as the user name here; default: sub.")
@click.option("--public-url", help="Address at which browsers find this server; needed for OIDC.")
@click.option(
    "--raw-days",
    type=FiniteFloat(0.0),
    help="Days for which samples of observed records are stored, from now on; 0 (default): without limit.",
)
@click.option(
    "--log-level",
    default="warning",
    show_default=True,
    type=click.Choice(["debug", "info", "warning", "error"]),
    help="Level of messages on the standard error stream.",
)
@click.option("--log-json", is_flag=True, help="Write each of these messages as a line of JSON.")
@click.option("--demo", is_flag=True, help="Feed the records of a demonstration asset at high speed.")
@click.option("--json", "as_json", is_flag=True, help="Print the address as JSON when the server is ready.")
def serve_command(
    store: Path, demo: bool, as_json: bool, log_level: str, log_json: bool, **options: Any
) -> None:
    """Serve the living twin in STORE: records in, answers out.

    STORE is created if it does not exist. Open the printed address in a browser; no further set-up is needed.
    """
    needs_service()
    scheduler = options["scheduler"]
    workers = f"{options['workers']} workers" if scheduler is None else f"work at {scheduler}"
    messages.print(f"starting {workers} and the server …")
    from jackettwin.service import Service, read_settings, serve, start_logging

    start_logging(log_level, as_json=log_json)

    def ready(service: Service) -> None:
        service.laying_out = demo
        scheme = "https" if service.settings.tls_certificate else "http"
        messages.print(f"jackettwin serves {store} at {scheme}://{options['host']}:{options['port']}/")
        messages.print(
            f"records: {store}/inbox/ASSET/, POST /api/v1/assets/ASSET/records, Ctrl-C ends", soft_wrap=True
        )
        if as_json:
            print_json({"store": str(store), "url": f"{scheme}://{options['host']}:{options['port']}/"})
            sys.stdout.flush()
        if demo:  # it loads numerics, which compile: not before the service has said where to keep that
            from jackettwin.service import demonstrate

            demonstrate(service)

    given = {name: value for name, value in options.items() if value not in (None, (), False)}
    serve(read_settings(store=store, **given), ready)
    messages.print("stopped; unfinished work continues at the next start")
