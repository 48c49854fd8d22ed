"""Exception tree.

::

    JackettwinError
    ├── InputError          what the user gave is wrong: exit code 2
    │   └── MissingExtra    an optional dependency is not installed
    └── NumericalError      the algorithm could not deliver a trustworthy number
"""

from __future__ import annotations

from contextlib import contextmanager
from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path
    from typing import TypeVar

    Value = TypeVar("Value")


class JackettwinError(Exception):
    """Base of every error raised on purpose by this package."""


class InputError(JackettwinError):
    """Bad input: says what was wrong, what was received, what is allowed and what to do.

    Parameters
    ----------
    problem : str
        One clause, lower case, no full stop: ``"wall is thicker than the radius"``.
    file : Path or str, optional
        Where the value was read.
    field : str, optional
        Dotted path of the value inside the file: ``"sections.leg.thickness_m"``.
    value : object, optional
        What was received.
    allowed : str, optional
        The allowed range or choices.
    remedy : str, optional
        What the user can do about it.
    """

    def __init__(
        self,
        problem: str,
        *,
        file: Path | str | None = None,
        field: str | None = None,
        value: object = None,
        allowed: str | None = None,
        remedy: str | None = None,
    ) -> None:
        super().__init__(problem)
        self.problem = problem
        self.file = file
        self.field = field
        self.value = value
        self.allowed = allowed
        self.remedy = remedy

    def __str__(self) -> str:
        place = ": ".join(str(part) for part in (self.file, self.field) if part is not None)
        text = f"{place}: {self.problem}" if place else self.problem
        if self.value is not None:
            text += f" (got {_short(self.value)})"
        if self.allowed is not None:
            text += f"; allowed: {self.allowed}"
        if self.remedy is not None:
            text += f"; {self.remedy}"
        return text

    def at(self, *, file: Path | str | None = None, field: str | None = None) -> InputError:
        """Return the same error with its place filled in; an inner field is put behind ``field``."""
        inner = ".".join(part for part in (field, self.field) if part)
        return type(self)(
            self.problem,
            file=self.file if self.file is not None else file,
            field=inner or None,
            value=self.value,
            allowed=self.allowed,
            remedy=self.remedy,
        )


class MissingExtra(InputError):
    """An optional dependency is needed for this input; the remedy names the pip extra."""


class NumericalError(JackettwinError):
    """A computation did not reach the accuracy it promises."""


@contextmanager
def located(*, file: Path | str | None = None, field: str | None = None) -> Iterator[None]:
    """Fill in the place of every input error raised inside."""
    try:
        yield
    except InputError as error:
        raise error.at(file=file, field=field) from None


def require(
    holds: object,
    problem: str,
    *,
    file: Path | str | None = None,
    field: str | None = None,
    value: object = None,
    allowed: str | None = None,
    remedy: str | None = None,
) -> None:
    """Refuse an input unless what is required of it holds; see :class:`InputError` for the other arguments.

    Raises
    ------
    InputError
        If ``holds`` is false.
    """
    if not holds:
        raise InputError(problem, file=file, field=field, value=value, allowed=allowed, remedy=remedy)


def look_up(
    table: Mapping[str, Value],
    name: str,
    what: str,
    *,
    file: Path | str | None = None,
    field: str | None = None,
    remedy: str | None = None,
) -> Value:
    """Return the entry of a table that has this name.

    Parameters
    ----------
    table : mapping of every known name to its entry
    name : str
    what : str
        What a name of the table names, in the singular: ``"support law"``.
    file, field, remedy : see :class:`InputError`; by default the remedy is the closest known name

    Raises
    ------
    InputError
        If the table has no such name: it lists those that it has.
    """
    if name not in table:
        raise InputError(
            f"no such {what}",
            file=file,
            field=field,
            value=name,
            allowed=", ".join(table) or None,
            remedy=did_you_mean(name, table) or remedy,
        )
    return table[name]


def require_between(field: str, value: float, low: float, high: float, unit: str = "") -> None:
    """Refuse a number outside a closed range, and one that is none.

    Raises
    ------
    InputError
        Names field, value, range and unit.
    """
    allowed = f"{low:g} to {high:g} {unit}".rstrip()
    remedy = "check the number and its unit"
    require(low <= value <= high, "out of range", field=field, value=value, allowed=allowed, remedy=remedy)


_SHORT_WORD = 6


def did_you_mean(word: str, known: Iterable[str]) -> str | None:
    """Return a remedy sentence naming the closest known word, or None.

    Half the letters of a short word are easily those of another, but for the first: `name` is no misspelt
    `frame`.
    """
    near = [one for one in known if len(word) >= _SHORT_WORD or one[:1] == word[:1]]
    match = get_close_matches(word, near, n=1, cutoff=0.6)
    return f"did you mean {match[0]!r}?" if match else None


def _short(value: object, limit: int = 80) -> str:
    text = repr(value)
    return text if len(text) <= limit else text[: limit - 1] + "…"
