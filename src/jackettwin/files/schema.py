"""Check data from a file against a schema and say in one sentence what is wrong."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from functools import cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_args, get_type_hints

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)
from pydantic_core import PydanticCustomError

from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.files.limits import in_words

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path


class Schema(BaseModel):
    """Base of every file schema: unknown keys, NaN and infinity are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, populate_by_name=True)


def _refusing_in_place(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
    try:
        return handler(value)
    except InputError as error:
        raise PydanticCustomError(_REFUSED, "{error}", {"error": error}) from None


S = TypeVar("S", bound=Schema)
T = TypeVar("T")
Placed = Annotated[T, WrapValidator(_refusing_in_place)]
"""A frozen dataclass that a file gives as it is; what it refuses is reported at its place in the file."""
_REFUSED = "refused"
_UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")
"""Pydantic's error types for an unknown key of a model and of a dataclass."""


def one_of(known: Callable[[], Iterable[str]]) -> AfterValidator:
    """Check that a text is one of the names of a registry when a file is read, as a Literal would be."""

    def check(value: str) -> str:
        names = tuple(known())
        if value not in names:
            expected = " or ".join(filter(None, (", ".join(map(repr, names[:-1])), repr(names[-1]))))
            raise PydanticCustomError("literal_error", "is none of {expected}", {"expected": expected})
        return value

    return AfterValidator(check)


_BOUNDS = ("gt", "ge", "lt", "le")
_NO_MAPPING = ("dict_type", "model_type", "model_attributes_type", "dataclass_type")
_PLAIN = {
    "string_type": ("not a text", "write a name; in quotes if it looks like a number"),
    **dict.fromkeys(("too_short", "string_too_short"), ("empty, or too few", "add what is missing")),
    **dict.fromkeys(("too_long", "string_too_long"), ("too many, or too long", "leave out what is too much")),
    "int_parsing_size": ("a number too large", "write a smaller one"),
    **dict.fromkeys(("int_parsing", "int_type", "int_from_float"), ("not a whole number", "write e.g. 4")),
    **dict.fromkeys(("float_parsing", "float_type"), ("not a number", "write it without a unit, e.g. 1.5e9")),
    "finite_number": ("not a finite number", "give its value, or leave the key out"),
    **dict.fromkeys(("bool_parsing", "bool_type"), ("not a yes or no", "write true or false")),
    **dict.fromkeys(("list_type", "tuple_type"), ("not a list", "write [a, b, …]")),
    **dict.fromkeys(_NO_MAPPING, ("not a mapping", "write keys")),
}
"""Pydantic's error type → our message and remedy."""
_KINDS = ("str", "int", "float", "bool", "constrained-float", "constrained-int", "constrained-str")
_OF_ANOTHER_KIND = (
    "literal_error",
    "string_type",
    *(f"{kind}_{what}" for kind in ("int", "float", "bool") for what in ("parsing", "type")),
    *("list_type", "tuple_type", *_NO_MAPPING),
)
"""Mistakes that say no more than that a value is not of one of the kinds it may be."""


def validate(schema: type[S], data: Any, *, file: Path | str | None = None, field: str | None = None) -> S:
    """Return ``data`` as a ``schema``.

    Raises
    ------
    InputError
        Names the first offending field, its value and what is allowed.
    """
    try:
        with located(file=file, field=field):  # what a model itself finds wrong with its fields
            valid = schema.model_validate(data)
    except ValidationError as error:
        errors = [{**e, "loc": _place(e, schema)} for e in error.errors()]
        first = _most_telling(errors)
        others = [e for e in errors if e["loc"] == first["loc"] and e is not first]
        found = _as_input_error(first, schema)
        if others and first["type"] in _OF_ANOTHER_KIND:
            found = _with_alternatives(found, [_as_input_error(e, schema) for e in others])
        raise found.at(file=file, field=field) from None
    for place, value in _yes_for_a_number(data, valid):
        problem, remedy = _PLAIN["float_type"]
        refusal = InputError(problem, field=place, value=value, remedy=remedy)
        raise refusal.at(file=file, field=field)
    return valid


def _yes_for_a_number(data: Any, valid: Any, place: str = "") -> Iterator[tuple[str, bool]]:
    """Yield the places where pydantic took true or false for 1 or 0."""
    if isinstance(data, bool) and isinstance(valid, (int, float)) and not isinstance(valid, bool):
        yield place, data
    if isinstance(data, dict):
        if isinstance(valid, Schema) or is_dataclass(valid):
            names = {f.alias or name: name for name, f in _own(type(valid)).items()}
            valid = {key: getattr(valid, names.get(key, str(key)), None) for key in data}
        parts = [(key, data[key], valid[key]) for key in data if isinstance(valid, dict) and key in valid]
    elif isinstance(data, (list, tuple)) and isinstance(valid, (list, tuple)):
        parts = list(zip(range(len(data)), data, valid, strict=False))
    else:
        return
    for key, given, taken in parts:
        yield from _yes_for_a_number(given, taken, f"{place}.{key}" if place else str(key))


def _place(error: Any, schema: type[BaseModel]) -> tuple[Any, ...]:
    """Return a mistake's location without what pydantic puts in for each alternative of a union."""
    location = error["loc"]
    unknown = error["type"] in _UNKNOWN
    names = {model.__name__ for model in _all_models(schema)}
    last = len(location) - 1  # an unknown key itself is said whatever it looks like
    return tuple(
        part
        for k, part in enumerate(location)
        if not isinstance(part, str)
        or not (part in names or part in _KINDS or part.endswith("]"))
        or (k == last and unknown)
    )


def _all_models(schema: type[Any]) -> set[type[Any]]:
    found, stack = {schema}, [schema]
    while stack:
        for info in _own(stack.pop()).values():
            new = set(_models_inside(info.annotation)) - found
            found |= new
            stack += new
    return found


def _most_telling(errors: list[Any]) -> Any:
    """Return the unknown key if there is one: a typo also makes its right name missing.

    Else the first; where a value may be of several kinds, what is wrong with it as the kind that it is.
    """
    unknown = next((e for e in errors if e["type"] in _UNKNOWN), None)
    if unknown is not None:
        return unknown
    first = errors[0]
    base = first["loc"]
    alternatives = [e for e in errors if e["loc"][: len(base)] == base]
    return next((e for e in alternatives if e["type"] not in _OF_ANOTHER_KIND), first)


def _with_alternatives(error: InputError, others: list[InputError]) -> InputError:
    """Return an error that allows what every alternative of a union does."""

    def joined(texts: list[str | None]) -> str | None:
        return ", or ".join(dict.fromkeys(text for text in texts if text is not None)) or None

    return InputError(
        error.problem,
        field=error.field,
        value=error.value,
        allowed=joined([error.allowed, *(other.allowed for other in others)]),
        remedy=joined([error.remedy, *(other.remedy for other in others)]),
    )


def _as_input_error(error: Any, schema: type[BaseModel]) -> InputError:
    location = error["loc"]
    field = ".".join(
        str(part) for k, part in enumerate(location) if not _is_silent(schema, location[:k], part)
    )
    kind, context = error["type"], error.get("ctx", {})
    if kind == _REFUSED:
        refusal: InputError = context["error"]
        return refusal.at(field=field)
    if kind in _UNKNOWN:
        known = _keys_at(schema, location[:-1])
        return InputError(
            "unknown key",
            field=field,
            value=location[-1],
            allowed=", ".join(known) or None,
            remedy=did_you_mean(str(location[-1]), known) or "take it out, or use one of these",
        )
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        key = context["discriminator"].strip("'")
        return InputError(
            f"unknown {key}" if "tag" in context else "required key is missing",
            field=f"{field}.{key}",
            value=context.get("tag"),
            allowed=context.get("expected_tags"),
            remedy="take one of these" if "tag" in context else f"add {key!r}",
        )
    if kind == "missing":
        return InputError("required key is missing", field=field, remedy=f"add {location[-1]!r}")
    broken = {key: context[key] for key in _BOUNDS if key in context}
    allowed = _range(schema, location, broken) if broken else context.get("expected")
    problem, remedy = _PLAIN.get(kind, (error["msg"][0].lower() + error["msg"][1:], None))
    if error["input"] is None and kind in _OF_ANOTHER_KIND:
        problem, remedy = "has no value", f"give it one below it or beside it, or take {location[-1]!r} out"
    if broken and remedy is None:
        remedy = _out_of_bounds(field, error["input"])
    if kind == "literal_error":
        problem = "not one of the choices"
        remedy = did_you_mean(str(error["input"]), str(allowed).split("'")[1::2]) or "take one of them"
    return InputError(problem, field=field, value=error["input"], allowed=allowed, remedy=remedy)


def _out_of_bounds(field: str, value: Any) -> str:
    if "ratio" in field.rpartition(".")[2].split("_") and isinstance(value, (int, float)) and value >= 1.0:
        return f"a ratio: {value:g} % is {value / 100.0:g}"
    return "check the number and its unit"


def _range(schema: type[BaseModel], location: tuple[Any, ...], broken: dict[str, float]) -> str | None:
    """Return the range of the field whose bound is broken."""
    names = [k for k, part in enumerate(location) if _fields(_models_at(schema, location[:k]), part)]
    if not names:
        return None
    last = names[-1]
    fields = _fields(_models_at(schema, location[:last]), location[last])
    found = (in_words(f.annotation, f.metadata, **broken) for f in fields)
    return next((words for words in found if words is not None), None)


def _keys_at(schema: type[BaseModel], location: tuple[Any, ...]) -> list[str]:
    """Return the keys allowed at a place of the schema, as far as they can be followed."""
    models = _models_at(schema, location)
    return [f.alias or name for model in models for name, f in _own(model).items()]


def _models_at(schema: type[BaseModel], location: tuple[Any, ...]) -> list[type[Any]]:
    current: list[type[Any]] = [schema]
    for part in location:
        inside = [model for info in _fields(current, part) for model in _models_inside(info.annotation)]
        # what is no field is an index, the key of a free mapping, or the tag of one model of a union
        current = inside or [model for model in current if part in _tags(model)] or current
    return current


_hints: Callable[..., dict[str, Any]] = cache(get_type_hints)


def _own(model: type[Any]) -> dict[str, Any]:
    """Return the fields of a model or a dataclass by name, each with annotation, metadata and alias."""
    if issubclass(model, BaseModel):
        return dict(model.model_fields)
    hints = _hints(model, include_extras=True)
    return {f.name: _field(hints[f.name]) for f in fields(model)}


def _field(hint: Any) -> SimpleNamespace:
    return SimpleNamespace(annotation=hint, metadata=getattr(hint, "__metadata__", ()), alias=None)


def _fields(models: list[type[Any]], key: Any) -> list[Any]:
    return [f for model in models for name, f in _own(model).items() if key in (name, f.alias)]


_TAGGED_BY = ("type", "shape")
"""Fields that tell the models of a union apart."""


def _tags(model: type[Any]) -> tuple[Any, ...]:
    fields = (info for name, info in _own(model).items() if name in _TAGGED_BY)
    return tuple(tag for info in fields for tag in get_args(info.annotation))


def _is_silent(schema: type[BaseModel], before: tuple[Any, ...], part: Any) -> bool:
    """Return whether a part of a location is the tag of a model of a union that need not be written."""
    models = _models_at(schema, before)
    return not _fields(models, part) and any(
        part == getattr(_own(model).get(name), "default", None) for model in models for name in _TAGGED_BY
    )


def _models_inside(annotation: Any) -> list[type[Any]]:
    if isinstance(annotation, type) and (issubclass(annotation, BaseModel) or is_dataclass(annotation)):
        return [annotation]
    return [model for argument in get_args(annotation) for model in _models_inside(argument)]
