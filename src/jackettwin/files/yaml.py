"""YAML as engineers write it: ``2.5e9`` is a number, a key given twice is an error."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import yaml

from jackettwin.errors import InputError

try:
    from yaml import CSafeLoader as _SafeLoader
except ImportError:  # PyYAML was built without libyaml
    from yaml import SafeLoader as _SafeLoader  # type: ignore[assignment]

_DEEPEST = 100
"""Levels of nesting. Loading recurses, in libyaml down to the end of the stack; parsing does not."""
_MOST_REPEATED = 100_000
"""Values that aliases may stand for in all: nine lines of ten aliases each stand for a thousand million."""


class _Loader(_SafeLoader):
    """SafeLoader with YAML 1.2 numbers and unique keys."""


# YAML 1.1 reads 2.5e9 (no sign in the exponent) as text; 1.2 does not.
_FLOAT = re.compile(
    r"^[-+]?(\d[\d_]*(\.[\d_]*)?|\.\d[\d_]*)([eE][-+]?\d+)?$|^[-+]?\.(inf|Inf|INF)$|^\.(nan|NaN|NAN)$"
)
_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+0123456789."))


def _unique_mapping(loader: _Loader, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
    loader.flatten_mapping(node)
    mapping: dict[Any, Any] = {}
    for key_node, value_node in node.value:
        key = loader.construct_object(key_node, deep=True)
        if isinstance(key, (int, float)) and isinstance(value_node, yaml.ScalarNode) and not value_node.value:
            raise yaml.constructor.ConstructorError(
                None, None, "a number stands alone: a decimal comma? write 0.018", key_node.start_mark
            )
        if isinstance(key, (list, dict)):
            raise yaml.constructor.ConstructorError(None, None, "key is not a word", key_node.start_mark)
        if key in mapping:
            raise yaml.constructor.ConstructorError(
                None, None, f"key {key!r} is given twice", key_node.start_mark
            )
        mapping[key] = loader.construct_object(value_node, deep=True)
    return mapping


def _scalar(loader: _Loader, node: yaml.ScalarNode) -> Any:
    """Return a date, a whole number or the like; one that is none (month 13) is a mistake with a line."""
    try:
        return yaml.SafeLoader.yaml_constructors[node.tag](loader, node)
    except (ValueError, OverflowError) as error:
        raise yaml.constructor.ConstructorError(None, None, str(error), node.start_mark) from None


_Loader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _unique_mapping)
for _tag in ("timestamp", "int", "float", "binary"):
    _Loader.add_constructor(f"tag:yaml.org,2002:{_tag}", _scalar)


def read_text(path: Path | str, *, what: str = "file") -> str:
    """Read a text file.

    Raises
    ------
    InputError
        If it is missing, a directory, unreadable or not text.
    """
    target = Path(path)
    try:
        return target.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(
            f"no such {what}",
            file=path,
            remedy="check the path; relative paths are relative to the file that names them",
        ) from None
    except UnicodeDecodeError:
        raise InputError(f"{what} is not UTF-8 text", file=path, remedy="save it as UTF-8 text") from None
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot read the {what}: {getattr(error, 'strerror', None) or error}",
            file=path,
            remedy="check the path and its permissions",
        ) from None


def read_yaml(path: Path | str, *, what: str = "file", list_of: str | None = None) -> dict[str, Any]:
    """Read a YAML mapping, or a list that is the value of its key ``list_of``.

    Raises
    ------
    InputError
        If the file is missing, is not YAML, repeats a key, or is not a mapping.
    """
    return parse_yaml(read_text(path, what=what), path, what=what, list_of=list_of)


def parse_yaml(
    text: str, path: Path | str, *, what: str = "file", list_of: str | None = None
) -> dict[str, Any]:
    """Return the mapping that a text in YAML is; ``path`` is named in errors.

    A list alone is the value of the key ``list_of``, if there is one.

    Raises
    ------
    InputError
        If it is not YAML, repeats a key, or is not a mapping.
    """
    try:
        # _Loader derives from SafeLoader: it builds plain data only.
        _bounded(text)
        data = yaml.load(text, Loader=_Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f"line {mark.line + 1}, column {mark.column + 1}: " if mark is not None else ""
        problem = getattr(error, "problem", None) or str(error) or "is not valid YAML"
        raise InputError(f"{where}{problem}", file=path, remedy="mend the YAML at that place") from None
    except RecursionError:
        raise InputError(
            "is nested too deeply", file=path, remedy="a twin file has at most a few levels"
        ) from None
    if list_of is not None and isinstance(data, list):
        return {list_of: data}
    if not isinstance(data, dict):
        raise InputError(
            f"{what} is empty" if data is None else f"{what} must be a mapping of keys to values",
            file=path,
            value=data,
            remedy="start from an example in the documentation",
        )
    return {str(key): value for key, value in data.items()}


def _bounded(text: str) -> None:
    """Raise RecursionError where it is nested too deeply, YAMLError where aliases stand for too much."""
    open_: list[tuple[str | None, int]] = []
    sizes, size, repeated = dict[str | None, int](), 0, 0
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.CollectionEndEvent):
            anchor, before = open_.pop()
            sizes[anchor] = size - before
            continue
        if isinstance(event, yaml.AliasEvent):  # of something that is open still: it would hold itself
            repeated += sizes.get(event.anchor, _MOST_REPEATED)
            size += sizes.get(event.anchor, 0)
        elif isinstance(event, yaml.NodeEvent):
            size += 1
            sizes[event.anchor] = 1
        if isinstance(event, yaml.CollectionStartEvent):
            open_.append((event.anchor, size - 1))
            sizes.pop(event.anchor, None)
        if len(open_) > _DEEPEST:
            raise RecursionError
        if repeated >= _MOST_REPEATED:
            raise yaml.YAMLError("aliases stand for too much")


def read_mapping(path: Path | str, *, what: str = "file", list_of: str | None = None) -> dict[str, Any]:
    """Read a mapping, or a list that is the value of its key ``list_of``, from JSON or YAML by extension.

    Raises
    ------
    InputError
        If the file is missing, cannot be understood, or is not a mapping.
    """
    if Path(path).suffix.lower() != ".json":
        return read_yaml(path, what=what, list_of=list_of)
    try:
        data = json.loads(read_text(path, what=what))
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not JSON: {error}", file=path, remedy="mend it at that place") from None
    if list_of is not None and isinstance(data, list):
        return {list_of: data}
    if not isinstance(data, dict):
        raise InputError(f"{what} must be a mapping of keys to values", file=path, value=data)
    return data


def with_key(text: str, key: str, value: Any) -> str:
    r"""Return the text of a YAML mapping with one of its own keys set.

    Other lines stay as they are; comments inside the old value, and right behind it, go with it.

    Parameters
    ----------
    text : of a mapping that :func:`read_yaml` has read before

    Examples
    --------
    >>> with_key("a: 1   # one\nb:\n  c: 2\n", "b", {"c": 3, "d": True})
    'a: 1   # one\nb: {c: 3, d: true}\n'
    """
    line = yaml.safe_dump(value, default_flow_style=True, width=10_000, allow_unicode=True)
    line = line.removesuffix("...\n").strip()
    root = yaml.compose(text, Loader=_Loader)
    if not isinstance(root, yaml.MappingNode) or root.flow_style:
        changed = {**(yaml.load(text, Loader=_Loader) or {}), key: value}
        return yaml.safe_dump(changed, default_flow_style=False, sort_keys=False, allow_unicode=True)
    for name, old in root.value:
        if name.value == key:
            before, after = text[: name.start_mark.index], text[old.end_mark.index :].lstrip(" ")
            return f"{before}{key}: {line}{'' if after.startswith(chr(10)) else chr(10)}{after}"
    return f"{text.rstrip()}\n{key}: {line}\n"
