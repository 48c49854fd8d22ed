"""``jackettwin serve``: the living twin."""

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
@click.option("--scheduler", help="tls://HOST:PORT of a Dask scheduler; default: workers of its own.")
@click.option("--scheduler-ca", type=FILE, help="By which the scheduler is known.")
@click.option("--scheduler-certificate", type=FILE, help="By which it knows us.")
@click.option("--scheduler-key", type=FILE)
@click.option("--workers", default=2, show_default=True, type=click.IntRange(1, 256), help="Of its own.")
@click.option("--mqtt", help="mqtt[s]://[USER@]HOST[:PORT] of a broker to listen to.")
@click.option("--mqtt-password-file", type=FILE, help="Its first line is the broker's password.")
@click.option("--mqtt-ca", type=FILE, help="By which the broker is known; default: what the system trusts.")
@click.option("--mqtt-certificate", type=FILE, help="By which the broker knows us.")
@click.option("--mqtt-key", type=FILE)
@click.option("--alerts", type=FILE, help="YAML file that says who is told what, and how.")
@click.option("--tls-certificate", type=FILE)
@click.option("--tls-key", type=FILE)
@click.option("--behind-proxy", is_flag=True, help="A proxy in front ends TLS.")
@click.option(
    "--trusted-proxy",
    "trusted_proxies",
    multiple=True,
    help="Address or network of that proxy, again for each; default: this machine.",
)
@click.option("--trusted-header", help="Header in which the proxy names the user it authenticated.")
@click.option("--oidc-issuer", help="OpenID provider at which people may log in, as it names itself.")
@click.option("--oidc-client", help="Name by which it knows this server.")
@click.option("--oidc-secret-file", type=FILE, help="Its first line is the secret by which it knows us.")
@click.option("--oidc-claim", help="What it says of somebody that is a user's name here; default: sub.")
@click.option("--public-url", help="Address at which browsers find this server; needed for OIDC.")
@click.option(
    "--raw-days",
    type=FiniteFloat(0.0),
    help="Days for which samples of observed records are kept, from now on; 0: for ever, the default.",
)
@click.option(
    "--log-level",
    default="warning",
    show_default=True,
    type=click.Choice(["debug", "info", "warning", "error"]),
    help="What is written to the standard error stream.",
)
@click.option(
    "--log-json", is_flag=True, help="One JSON object a line of it, for programs that collect them."
)
@click.option("--demo", is_flag=True, help="Let a demonstration asset's records arrive in fast motion.")
@click.option("--json", "as_json", is_flag=True, help="Print the address as JSON when it can be asked.")
def serve_command(
    store: Path, demo: bool, as_json: bool, log_level: str, log_json: bool, **options: Any
) -> None:
    """Serve the living twin in STORE: records in, answers out.

    STORE is made if it is not there. Open the address that is printed. Nothing else has to be set up.
    """
    needs_service()
    scheduler = options["scheduler"]
    workers = f"{options['workers']} workers" if scheduler is None else f"work at {scheduler}"
    messages.print(f"starting {workers} and the server …")
    from jackettwin.service import Service, demonstrate, read_settings, serve, start_logging

    start_logging(log_level, as_json=log_json)

    def ready(service: Service) -> None:
        scheme = "https" if service.settings.tls_certificate else "http"
        messages.print(f"jackettwin serves {store} at {scheme}://{options['host']}:{options['port']}/")
        messages.print(
            f"records: {store}/inbox/ASSET/, POST /api/v1/assets/ASSET/records, Ctrl-C ends", soft_wrap=True
        )
        if as_json:
            print_json({"store": str(store), "url": f"{scheme}://{options['host']}:{options['port']}/"})
            sys.stdout.flush()
        if demo:
            demonstrate(service)

    given = {name: value for name, value in options.items() if value not in (None, (), False)}
    serve(read_settings(store=store, **given), ready)
    messages.print("stopped; what was under way goes on at the next start")
