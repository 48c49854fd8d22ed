"""Supports from the command line (``kelvin-voigt:k=2.5e9,c=7.6e8``) and from YAML: springs, or piles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field

from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.files import Schema, read_yaml, validate
from jackettwin.soil.foundation import build_foundation, read_foundation, shipped_foundations
from jackettwin.soil.laws.families import FAMILIES, Family
from jackettwin.soil.laws.files import ElasticLaw, LawSchema
from jackettwin.soil.laws.viscoelastic import Law, Prony, require_positive
from jackettwin.soil.support import Spring, Support, clamped, on_translations, own_support, pinned
from jackettwin.structure import Structure


class SpringSchema(Schema):
    """One entry of ``supports``."""

    nodes: Literal["reaction"] | list[str]
    stiffness: list[float] | list[list[float]]
    law: LawSchema = ElasticLaw(type="elastic")


class SpringsSchema(Schema):
    """A support file."""

    supports: list[SpringSchema] = Field(min_length=1)


def _unknown_frequency() -> float:
    raise InputError("reference frequency is missing", field="f0", remedy="give f0=… [Hz]")


def read_support(
    text: str | Path | None,
    structure: Structure,
    *,
    first_frequency_hz: Callable[[], float] = _unknown_frequency,
    folder: Path | None = None,
) -> Support:
    """Return the support a user asked for.

    Parameters
    ----------
    text : str or Path or None
        ``pinned``, ``clamped``, a short form, a shipped foundation, or a YAML file of springs or of a pile
        foundation; None is the structure's own.
    structure : Structure
    first_frequency_hz : callable
        Gives the first pinned frequency, the default reference frequency of ``springpot`` and ``maxwell-3``;
        without it these need ``f0``.
    folder : Path, optional
        What a relative path is relative to.

    Raises
    ------
    InputError
        If the text is none of these, or a value is out of range.
    """
    if text is None:
        return own_support(structure)
    word = str(text)
    if not structure.reactions:
        raise InputError(
            "the structure has no reaction nodes to support",
            field="reaction_nodes",
            value=[],
            remedy="name them in the structure file",
        )
    if word in ("pinned", "clamped"):
        return pinned(structure) if word == "pinned" else clamped(structure)
    name, colon, arguments = word.partition(":")
    if colon and name in SHORT_FORMS:
        return on_translations(structure, parse_law(name, arguments, first_frequency_hz))
    if word in shipped_foundations():
        return read_foundation(word).heads(structure)
    path = Path(word) if folder is None else folder / word
    if path.suffix.lower() in (".yaml", ".yml"):
        return _read_support_file(path, structure)
    known = ["pinned", "clamped", *shipped_foundations(), *SHORT_FORMS]
    raise InputError(
        "unknown support or law",
        field="support",
        value=word,
        allowed=", ".join(f"{k}:{SHORT_FORMS[k]}" if k in SHORT_FORMS else k for k in known)
        + ", or a .yaml file",
        remedy=did_you_mean(name, known) or "take one of these, or give the path of a file",
    )


def _short_form(law: Family) -> str:
    return ",".join(f"{name}=" for name in (*law.names, *(["f0"] if law.needs_frequency else [])))


SHORT_FORMS: Mapping[str, str] = {
    "elastic": "k=",
    "maxwell": "k0=,branches=k/tau;k/tau",
    **{name: _short_form(law) for name, law in FAMILIES.items()},
}


def parse_law(name: str, arguments: str, first_frequency_hz: Callable[[], float]) -> Law:
    """Return the law of a short form ``name:arguments``.

    Raises
    ------
    InputError
        If an argument is missing, unknown, given twice, not a number or out of range.
    """
    number, branches = _arguments(name, arguments)
    with located(field=f"support.{name}"):
        if name == "elastic":
            return Prony(k0=number["k"])
        if name == "maxwell":
            return Prony(number["k0"], 0.0, *_branches(branches))
        law, f0 = FAMILIES[name], 1.0
        if law.needs_frequency:
            f0 = number["f0"] if "f0" in number else first_frequency_hz()
            require_positive("f0", f0)
        return law.build(np.array([number[p] for p in law.names]), f0)


def _arguments(name: str, text: str) -> tuple[dict[str, float], str]:
    """Return the numbers of a short form, and the text of its branches."""
    known = [part.rstrip("=").split("=")[0] for part in SHORT_FORMS[name].split(",")]
    values: dict[str, str] = {}
    for part in filter(None, text.split(",")):
        key, _, value = part.partition("=")
        if key not in known:
            raise InputError(
                "unknown argument",
                field=f"support.{name}",
                value=part,
                allowed=SHORT_FORMS[name],
                remedy=did_you_mean(key, known) or "take one of these",
            )
        if key in values:
            raise InputError("argument is given twice", field=f"support.{name}.{key}", value=part)
        values[key] = value
    for key in known:
        if key not in values and key != "f0":
            raise InputError("argument is missing", field=f"support.{name}.{key}", allowed=SHORT_FORMS[name])
    branches = values.pop("branches", "")
    return {key: _number(name, key, value) for key, value in values.items()}, branches


def _number(name: str, key: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise InputError(
            "not a finite number", field=f"support.{name}.{key}", value=text, remedy="write e.g. 2.5e9"
        )
    return value


def _branches(text: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    pairs = [pair.split("/") for pair in text.split(";") if pair]
    if not pairs or any(len(pair) != 2 for pair in pairs):
        raise InputError(
            "branches are pairs k/tau joined by ;", field="branches", value=text, allowed="k/tau;k/tau"
        )
    k = tuple(_number("maxwell", "branches", pair[0]) for pair in pairs)
    tau = tuple(_number("maxwell", "branches", pair[1]) for pair in pairs)
    for value in tau:
        require_positive("tau", value)
    return k, tau


def _read_support_file(path: Path, structure: Structure) -> Support:
    content = read_yaml(path, what="support file")
    if isinstance(content, dict) and "pile" in content:
        return build_foundation(content, path).heads(structure)
    return _springs(content, path, structure)


def _springs(content: Any, path: Path, structure: Structure) -> Support:
    schema = validate(SpringsSchema, content, file=path)
    springs = []
    for index, entry in enumerate(schema.supports):
        place = f"supports.{index}"
        nodes = structure.reaction_nodes if entry.nodes == "reaction" else tuple(entry.nodes)
        for node in nodes:
            if node not in structure.nodes:
                raise InputError(
                    "no such node",
                    file=path,
                    field=f"{place}.nodes",
                    value=node,
                    remedy=did_you_mean(node, structure.nodes) or "name a node of the structure",
                )
        with located(file=path, field=place):
            matrix, law = _matrix(entry.stiffness), entry.law.build()
        springs += [Spring(node, matrix, law) for node in nodes]
    return Support(springs=tuple(springs))


def _matrix(values: list[float] | list[list[float]]) -> np.ndarray:
    """Return the 6×6 matrix of 3 or 6 diagonal values, or of a full symmetric matrix."""
    allowed = "3 or 6 numbers, or a symmetric 6×6 matrix that stores energy"
    if all(isinstance(value, (int, float)) for value in values) and len(values) in (3, 6):
        matrix = np.diag(np.concatenate([np.asarray(values, dtype=float), np.zeros(6 - len(values))]))
    else:
        try:
            matrix = np.array(values, dtype=float)
        except ValueError:
            raise InputError("stiffness rows differ in length", field="stiffness", allowed=allowed) from None
        if matrix.shape != (6, 6):
            raise InputError(
                "stiffness has the wrong shape", field="stiffness", value=matrix.shape, allowed=allowed
            )
    scale = np.sqrt(np.maximum(np.abs(np.diag(matrix)), 1e-300))
    scaled = matrix / np.outer(scale, scale)
    if np.abs(scaled - scaled.T).max() > 1e-6:
        raise InputError("stiffness is not symmetric", field="stiffness", allowed=allowed)
    if np.linalg.eigvalsh(scaled).min() < -1e-9:
        raise InputError(
            "stiffness gives energy out",
            field="stiffness",
            value=float(np.diag(matrix).min()),
            allowed=allowed,
        )
    return np.asarray(0.5 * (matrix + matrix.T))
