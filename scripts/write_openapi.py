"""Write the API's OpenAPI document to a file, from which the window's client is generated."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

from jackettwin.service.web.app import create_app


def main(path: Path) -> None:
    """Write the document of an application that serves nothing."""
    described = create_app(cast(Any, SimpleNamespace())).openapi()
    path.write_text(json.dumps(described, indent=1, sort_keys=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
