"""One table of measured quantities: name → SI unit, long name, symbol. A missing name raises."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.errors import InputError, did_you_mean


@dataclass(frozen=True)
class Quantity:
    """A physical quantity: its SI unit, the name to print and the symbol to plot."""

    unit: str
    long_name: str
    symbol: str
    scales: tuple[tuple[str, float], ...] = ()
    """Other units accepted at the border, each with the factor that brings it to SI."""


G0 = 9.80665

QUANTITIES: dict[str, Quantity] = {
    "acceleration": Quantity(
        "m/s^2",
        "acceleration",
        "a",
        (("m/s2", 1.0), ("m/s²", 1.0), ("m s-2", 1.0), ("g", G0), ("mg", 1e-3 * G0), ("mm/s^2", 1e-3)),
    ),
    "velocity": Quantity("m/s", "velocity", "v", (("m s-1", 1.0), ("mm/s", 1e-3))),
    "displacement": Quantity("m", "displacement", "u", (("mm", 1e-3), ("cm", 1e-2))),
    "strain": Quantity("-", "strain", "ε", (("1", 1.0), ("m/m", 1.0), ("ustrain", 1e-6), ("µm/m", 1e-6))),
    "inclination": Quantity("rad", "inclination", "θ", (("deg", 0.017453292519943295),)),
    "wind speed": Quantity("m/s", "wind speed", "U", (("m s-1", 1.0),)),
    "yaw": Quantity("rad", "nacelle yaw", "ψ", (("deg", 0.017453292519943295),)),
    "rotor speed": Quantity("rad/s", "rotor speed", "Ω", (("rpm", 0.10471975511965977),)),
    "pitch": Quantity("rad", "blade pitch", "β", (("deg", 0.017453292519943295),)),
    "power": Quantity("W", "power", "P", (("kW", 1e3), ("MW", 1e6))),
    "wave elevation": Quantity("m", "wave elevation", "η"),
    "temperature": Quantity("degC", "temperature", "T", (("°C", 1.0), ("C", 1.0))),
    "other": Quantity("-", "other", "?"),
}


def quantity(name: str) -> Quantity:
    """Look a quantity up.

    Raises
    ------
    InputError
        If the name is not in the table.
    """
    try:
        return QUANTITIES[name]
    except KeyError:
        raise InputError(
            "unknown quantity",
            field="quantity",
            value=name,
            allowed=", ".join(QUANTITIES),
            remedy=did_you_mean(name, QUANTITIES),
        ) from None


def to_si(name: str, unit: str) -> float:
    """Return the factor that brings a value of ``unit`` to the SI unit of quantity ``name``.

    >>> to_si("acceleration", "g")
    9.80665

    Raises
    ------
    InputError
        If the quantity or the unit is not known.
    """
    q = quantity(name)
    if unit == q.unit:
        return 1.0
    for other, factor in q.scales:
        if unit == other:
            return factor
    known = (q.unit, *(other for other, _ in q.scales))
    raise InputError(
        f"wrong unit for {name}",
        field="unit",
        value=unit,
        allowed=", ".join(known),
        remedy=did_you_mean(unit, known) or "state the unit of the stored numbers",
    )
