"""Frozen dataclasses as plain JSON data and back, by their type hints: one codec for all that is kept.

Numbers keep every digit. Complex numbers are [real, imaginary], complex arrays two lists; what is None or
empty by default is left out, so that a field with a default can be added without a migration.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from datetime import date, datetime
from enum import Enum
from functools import cache
from math import isfinite
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError

T = TypeVar("T")


def encode(value: Any) -> Any:
    """Return a value made of dataclasses, mappings, sequences, arrays, numbers and dates as JSON data.

    Raises
    ------
    TypeError
        If a part of it is of another kind.

    Examples
    --------
    >>> encode({"shape": np.array([1.0 + 2.0j]), "at": date(2025, 1, 2)})
    {'shape': {'real': [1.0], 'imag': [2.0]}, 'at': '2025-01-02'}
    """
    if isinstance(value, np.ndarray):
        return _encoded_array(value)
    if isinstance(value, Mapping):
        return {str(key): encode(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [encode(item) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        own = ((f, getattr(value, f.name)) for f in fields(value) if f.init)
        return {f.name: encode(item) for f, item in own if not _left_out(f, item)}
    return _encoded_scalar(value)


def named(value: object, *names: str) -> dict[str, Any]:
    """Return some attributes of a value as JSON data, by their names.

    Examples
    --------
    >>> named(1.0 + 2.0j, "real", "imag")
    {'real': 1.0, 'imag': 2.0}
    """
    return {name: encode(getattr(value, name)) for name in names}


def decode(kind: type[T], plain: Any) -> T:
    """Return the value of a type from what :func:`encode` made of it.

    Raises
    ------
    InputError
        If the data are not of this type; names the field.
    """
    try:
        decoded: T = _decoded(kind, plain, "")
    except (TypeError, ValueError, AttributeError, KeyError, IndexError) as error:
        raise InputError("not what was stored here", value=str(error)) from None
    return decoded


def _encoded_scalar(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float):
        return value if isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, (datetime, date)):
        return value.isoformat()
    raise TypeError(f"cannot store a {type(value).__name__}")


def _encoded_array(value: npt.NDArray[Any]) -> Any:
    if np.iscomplexobj(value):
        return {"real": _encoded_array(value.real), "imag": _encoded_array(value.imag)}
    if not value.size:
        return {"shape": list(value.shape)}
    plain = value.tolist()
    kind = value.dtype.kind
    # JSON has these numbers; what it lacks is looked for one by one
    return plain if kind in "biu" or (kind == "f" and np.isfinite(value).all()) else encode(plain)


def _left_out(f: Field[Any], value: Any) -> bool:
    """Tell whether a field holds its default, and that says nothing."""
    if value is None:
        return f.default is None
    if isinstance(value, tuple) and (not value or hasattr(value, "_fields")):
        return f.default is not MISSING and value == f.default
    return isinstance(value, Mapping) and not value and f.default_factory is not MISSING


def _decoded(kind: Any, plain: Any, place: str) -> Any:
    origin, inner = get_origin(kind), get_args(kind)
    if kind is Any:
        return plain
    if origin in (Union, UnionType):
        return _optional(inner, plain, place)
    if origin is Literal:
        if plain not in inner:
            raise InputError("unknown choice", field=place, value=plain, allowed=", ".join(map(str, inner)))
        return plain
    if origin is np.ndarray or kind is np.ndarray:
        return _array(plain, inner)
    if origin in (tuple, list):
        return _sequence(origin, inner, plain, place)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        key, item = inner
        return {_key(key, k): _decoded(item, v, f"{place}.{k}") for k, v in plain.items()}
    if is_dataclass(kind):
        return _instance(kind, plain, place)
    if isinstance(kind, type) and issubclass(kind, tuple):
        return kind(*_sequence(tuple, tuple(_hints(kind).values()), plain, place))
    return _scalar(kind, plain, place)


def _optional(inner: tuple[Any, ...], plain: Any, place: str) -> Any:
    if plain is None and NoneType in inner:
        return None
    first, *others = [kind for kind in inner if kind is not NoneType]
    if not others:
        return _decoded(first, plain, place)
    # plain data tell numbers, texts and switches apart by themselves
    return plain


def _sequence(origin: type, inner: tuple[Any, ...], plain: Any, place: str) -> Any:
    if not isinstance(plain, list):
        raise InputError("not a list", field=place, value=plain)
    many = len(inner) == 2 and inner[1] is Ellipsis
    kinds = [inner[0]] * len(plain) if many or origin is list else list(inner)
    items = zip(kinds, plain, strict=True)
    return origin(_decoded(kind, item, f"{place}.{i}") for i, (kind, item) in enumerate(items))


def _instance(kind: Any, plain: Any, place: str) -> Any:
    if not isinstance(plain, dict):
        raise InputError("not a mapping", field=place or None, value=plain)
    hints, own = _hints(kind), {f.name: f for f in fields(kind) if f.init}
    for name in plain:
        if name not in own:
            where = ".".join(filter(None, (place, name)))
            raise InputError("unknown key", field=where, allowed=", ".join(own))
    values = {}
    for name, f in own.items():
        where = ".".join(filter(None, (place, name)))
        if name in plain:
            values[name] = _decoded(hints[name], plain[name], where)
        elif f.default is MISSING and f.default_factory is MISSING:
            raise InputError("required key is missing", field=where)
    return kind(**values)


@cache
def _hints(kind: Any) -> dict[str, Any]:
    return get_type_hints(kind)


def _array(plain: Any, inner: tuple[Any, ...]) -> npt.NDArray[Any]:
    kinds = get_args(inner[1]) if len(inner) > 1 else (np.float64,)
    dtype = kinds[0] if kinds and isinstance(kinds[0], type) else np.float64
    if isinstance(plain, dict) and "real" in plain:
        return _array(plain["real"], ()) + 1j * _array(plain["imag"], ())
    if isinstance(plain, dict):
        return np.empty(plain["shape"], dtype)
    return np.array(plain, dtype)


def _key(kind: Any, text: str) -> Any:
    return int(text) if kind is int else text


def _scalar(kind: Any, plain: Any, place: str) -> Any:
    if kind is float:
        if isinstance(plain, bool) or not (plain is None or isinstance(plain, (int, float))):
            raise InputError("not a number", field=place, value=plain)
        return float("nan") if plain is None else float(plain)
    if kind is complex:
        return complex(*plain)
    if issubclass(kind, Enum):
        return kind(plain)
    if kind in (datetime, date):
        return kind.fromisoformat(plain)
    if not isinstance(plain, kind) or (kind is int and isinstance(plain, bool)):
        raise InputError(f"not a {kind.__name__}", field=place, value=plain)
    return plain
