"""Assets visible to users: all, or those listed by name or group."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from sqlalchemy import ColumnElement, Connection, delete, insert, select, true

from jackettwin.errors import InputError
from jackettwin.store.assets import asset_names, check_name
from jackettwin.store.tables import asset_groups

GROUP = "@"
"""Prefix of a group's name in lists of assets."""

Assets = frozenset[str] | None
"""Visible assets; None for all."""


def visible(connection: Connection, scope: Collection[str] | None) -> Assets:
    """Return the assets of a scope, with the present members of groups."""
    if scope is None:
        return None
    named = {name for name in scope if not name.startswith(GROUP)}
    grouped = {name.removeprefix(GROUP) for name in scope if name.startswith(GROUP)}
    members = select(asset_groups.c.asset).where(asset_groups.c.name.in_(grouped))
    return frozenset(named | set(connection.scalars(members)))


def among(column: ColumnElement[str], seen: Assets) -> ColumnElement[bool]:
    """Return the condition that a row belongs to a visible asset."""
    return true() if seen is None else column.in_(sorted(seen))


def checked_scope(connection: Connection, scope: Iterable[str]) -> list[str]:
    """Return a scope without repetitions, after checking that its assets and groups exist.

    Raises
    ------
    InputError
        If it is empty, or an asset or group does not exist.
    """
    known = {*asset_names(connection), *(GROUP + name for name in groups(connection))}
    given = sorted(set(scope))
    missing = next((name for name in given if name not in known), None)
    if missing is not None or not given:
        raise InputError(
            "there is no such asset or group",
            field="assets",
            value=missing,
            allowed=", ".join(sorted(known)[:20]) or "none yet",
            remedy="name assets, or groups as @NAME",
        )
    return given


def put_group(connection: Connection, name: str, members: Iterable[str]) -> list[str]:
    """Define the assets of a group; without assets the group is deleted, with the rights that it gave.

    Raises
    ------
    InputError
        If the name is not allowed, or an asset does not exist.
    """
    check_name(name)
    given, known = sorted(set(members)), asset_names(connection)
    missing = next((asset for asset in given if asset not in known), None)
    if missing is not None:
        allowed = ", ".join(known[:20]) or "none yet"
        raise InputError("there is no such asset", field="assets", value=missing, allowed=allowed)
    connection.execute(delete(asset_groups).where(asset_groups.c.name == name))
    if given:
        connection.execute(insert(asset_groups), [{"name": name, "asset": asset} for asset in given])
    return given


def groups(connection: Connection) -> dict[str, list[str]]:
    """Return the assets of every group, {name: assets}."""
    found: dict[str, list[str]] = {}
    order = (asset_groups.c.name, asset_groups.c.asset)
    for name, asset in connection.execute(select(*order).order_by(*order)):
        found.setdefault(name, []).append(asset)
    return found
