"""Bytes of a binary file, taken from the front."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError


class Source:
    """A cursor over bytes; asking for more than there are is an error, not a short array."""

    def __init__(self, raw: bytes, at: int = 0) -> None:
        self.raw, self.at = raw, at

    def skip(self, size: int) -> bytes:
        """Return the next ``size`` bytes.

        Raises
        ------
        InputError
            If the file ends before them.
        """
        end = self.at + size
        if size < 0 or end > len(self.raw):
            raise InputError(
                "ends before the data it announces",
                field=f"byte {self.at}",
                value=len(self.raw),
                allowed=f"at least {max(end, 0)} bytes",
                remedy="the file is cut off or damaged",
            )
        taken, self.at = self.raw[self.at : end], end
        return taken

    def take(self, dtype: str, count: int) -> npt.NDArray[Any]:
        """Return the next ``count`` numbers of a NumPy type."""
        return np.frombuffer(self.skip(np.dtype(dtype).itemsize * count), dtype=dtype)

    def text(self, length: int) -> str:
        """Return the next ``length`` bytes as text, without padding."""
        return self.skip(length).decode("utf-8", errors="replace").strip("\0 ")
