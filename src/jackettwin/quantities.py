"""One table of measured quantities: name → SI unit, long name, symbol. A missing name raises."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.constants import GRAVITY_M_S2
from jackettwin.errors import InputError, did_you_mean


@dataclass(frozen=True)
class Quantity:
    """A physical quantity: its SI unit, the name to print and the symbol to plot."""

    unit: str
    long_name: str
    symbol: str
    scales: tuple[tuple[str, float], ...] = ()
    """Other units accepted at the border, each with the factor that brings it to SI."""


DEGREE = 0.017453292519943295
"""π/180 [rad]."""

QUANTITIES: dict[str, Quantity] = {
    "acceleration": Quantity(
        "m/s^2",
        "acceleration",
        "a",
        (
            ("g", GRAVITY_M_S2),
            ("mg", 1e-3 * GRAVITY_M_S2),
            ("m/s2", 1.0),
            ("m/s/s", 1.0),
            ("m s-2", 1.0),
            ("m s^-2", 1.0),
            ("mm/s^2", 1e-3),
            ("mm/s2", 1e-3),
            ("cm/s^2", 1e-2),
            ("Gal", 1e-2),
            ("gal", 1e-2),
        ),
    ),
    "velocity": Quantity("m/s", "velocity", "v", (("m s-1", 1.0), ("mm/s", 1e-3), ("cm/s", 1e-2))),
    "displacement": Quantity(
        "m", "displacement", "u", (("mm", 1e-3), ("cm", 1e-2), ("um", 1e-6), ("µm", 1e-6))
    ),
    "strain": Quantity(
        "-",
        "strain",
        "ε",
        (
            *(("1", 1.0), ("m/m", 1.0), ("strain", 1.0), ("mm/m", 1e-3)),
            *((unit, 1e-6) for unit in ("ustrain", "µstrain", "microstrain", "um/m", "µm/m", "µε", "ue")),
        ),
    ),
    "inclination": Quantity(
        "rad",
        "inclination",
        "θ",
        (
            *(("deg", DEGREE), ("°", DEGREE), ("mdeg", 1e-3 * DEGREE)),
            *(("mrad", 1e-3), ("urad", 1e-6), ("µrad", 1e-6)),
        ),
    ),
    "wind speed": Quantity("m/s", "wind speed", "U", (("m s-1", 1.0),)),
    "yaw": Quantity("rad", "nacelle yaw", "ψ", (("deg", DEGREE), ("°", DEGREE))),
    "rotor speed": Quantity(
        "rad/s", "rotor speed", "Ω", (("rpm", 0.10471975511965977), ("1/min", 0.10471975511965977))
    ),
    "pitch": Quantity("rad", "blade pitch", "β", (("deg", DEGREE), ("°", DEGREE))),
    "power": Quantity("W", "power", "P", (("kW", 1e3), ("MW", 1e6))),
    "wave elevation": Quantity("m", "wave elevation", "η"),
    "temperature": Quantity("degC", "temperature", "T", (("°C", 1.0), ("C", 1.0))),
    "wind direction": Quantity("rad", "wind direction", "θ_w", (("deg", DEGREE), ("°", DEGREE))),
    "azimuth": Quantity("rad", "rotor azimuth", "φ", (("deg", DEGREE), ("°", DEGREE))),
    "angular velocity": Quantity("rad/s", "angular velocity", "ω", (("deg/s", DEGREE), ("°/s", DEGREE))),
    "force": Quantity("N", "force", "F", (("kN", 1e3), ("MN", 1e6))),
    "moment": Quantity(
        "N m", "moment", "M", (("N-m", 1.0), ("Nm", 1.0), ("kN-m", 1e3), ("kNm", 1e3), ("MNm", 1e6))
    ),
    "stress": Quantity("Pa", "stress", "σ", (("MPa", 1e6), ("N/mm^2", 1e6))),
    "pressure": Quantity("Pa", "pressure", "p", (("hPa", 1e2), ("mbar", 1e2), ("kPa", 1e3), ("bar", 1e5))),
    "water level": Quantity("m", "water level", "h", (("mm", 1e-3), ("cm", 1e-2))),
    "current speed": Quantity("m/s", "current speed", "U_c", (("m s-1", 1.0), ("cm/s", 1e-2))),
    "other": Quantity("-", "other", "?"),
}

SILENT = ("velocity",)
"""Vibrations that a unit alone tells although wind and current share it, if the name names neither."""
VIBRATIONS = ("acceleration", "velocity", "displacement", "strain", "inclination")
"""Quantities of a structure's motion; the others describe its surroundings and operation."""


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
    known = known_units(name)
    raise InputError(
        f"wrong unit for {name}",
        field="unit",
        value=unit,
        allowed=", ".join(known),
        remedy=did_you_mean(unit, known) or "state the unit of the stored numbers",
    )


def known_units(name: str) -> tuple[str, ...]:
    """Return the units that a quantity is read in, the SI unit first."""
    q = quantity(name)
    return (q.unit, *(other for other, _ in q.scales))


def plain_unit(unit: str) -> str:
    """Return a unit as the table writes it: no brackets around it, one sign for powers, seconds as s.

    >>> plain_unit(" (m/s**2) "), plain_unit("mm/sec²")
    ('m/s^2', 'mm/s^2')
    """
    text = unit.strip()
    while len(text) > 1 and (text[0], text[-1]) in (("(", ")"), ("[", "]")):
        text = text[1:-1].strip()
    # The micro sign and the Greek letter mu look the same.
    text = text.replace("**", "^").replace("\N{GREEK SMALL LETTER MU}", "\N{MICRO SIGN}")
    return text.replace("\N{SUPERSCRIPT TWO}", "^2").replace("/sec", "/s")


_WORDS = (
    ("yaw", ("yaw",)),
    ("rotor speed", ("rotspeed", "rotor_speed", "rotorspeed", "rotor speed")),
    ("pitch", ("bldpitch", "blpitch", "blade_pitch", "blade pitch")),
    ("wind direction", ("wind_dir", "winddir", "wind dir")),
    ("wind speed", ("wind", "anemo", "gust")),
    ("water level", ("level", "tide")),
    ("current speed", ("current",)),
    ("azimuth", ("azimuth",)),
    ("wave elevation", ("wave",)),
    ("power", ("power", "genpwr")),
    ("inclination", ("incl", "tilt")),
    ("velocity", ("vel",)),
    ("displacement", ("disp", "ttdsp")),
    ("acceleration", ("acc",)),
    ("strain", ("strain",)),
    ("temperature", ("temp",)),
)


def guess_quantity(name: str, unit: str) -> str:
    """Return the quantity that a channel's name and unit both allow, else ``"other"``.

    A unit that only one quantity has is enough; an unstated unit leaves vibrations to the name, and
    so does a wrong one behind a name in ``acc…``, lest a typo hide an accelerometer. A speed is that of the
    structure unless the name says otherwise.

    >>> guess_quantity("YawBrTAxp", "m/s^2"), guess_quantity("Wind1VelX", "m/s")
    ('acceleration', 'wind speed')
    >>> guess_quantity("tower_top_x_m/s2", ""), guess_quantity("hub_m/s", "")
    ('acceleration', 'other')
    """
    allowed = [kind for kind, q in QUANTITIES.items() if kind != "other" and _has_unit(q, unit)]
    lower = name.lower()
    named = [kind for kind, words in _WORDS if any(word in lower for word in words)]
    if not unit or (not allowed and lower.startswith("acc")):
        if not named and "/" in unit_in_name(name, "acceleration"):
            return "acceleration"
        return named[0] if named and named[0] in VIBRATIONS else "other"
    both = [kind for kind in named if kind in allowed]
    if both:
        return both[0]
    if unit == "1":
        return "other"
    if len(allowed) == 1:
        return allowed[0]
    moving = [kind for kind in allowed if kind in SILENT]
    return moving[0] if moving and not named else "other"


_WITHOUT_STROKE = {"mps": "m/s", "mps2": "m/s2", "ms2": "m/s2", "ms-2": "m/s2", "mmps": "mm/s"}
"""Units as names of columns spell them."""


def unit_in_name(name: str, kind: str) -> str:
    """Return the unit of a kind of vibration that a channel's name ends with, "" if it ends with none.

    >>> unit_in_name("disp_x_mm", "displacement"), unit_in_name("acc top m_s2", "acceleration")
    ('mm', 'm/s2')
    >>> unit_in_name("vel_x_mps", "velocity"), unit_in_name("acc_tp_ms2", "acceleration")
    ('m/s', 'm/s2')
    """
    words = name.replace(" ", "_").split("_")
    for n in (2, 1):
        unit = "/".join(words[-n:])
        unit = _WITHOUT_STROKE.get(unit.lower(), unit)
        if len(words) > n and _has_unit(QUANTITIES[kind], unit) and unit != "1":
            return unit
    return ""


def names_other(name: str) -> bool:
    """Tell whether a channel's name is that of something else than a vibration.

    >>> names_other("WindSpeed"), names_other("ch1")
    (True, False)
    """
    named = [kind for kind, words in _WORDS if any(word in name.lower() for word in words)]
    return bool(named) and named[0] not in VIBRATIONS


def vibration_of(unit: str, *, field: str = "unit") -> str:
    """Return the kind of vibration that is measured in a unit.

    Raises
    ------
    InputError
        If none is, or several are.

    Examples
    --------
    >>> vibration_of("g"), vibration_of("mm/s")
    ('acceleration', 'velocity')
    """
    kinds = [kind for kind in QUANTITIES if kind in VIBRATIONS and _has_unit(QUANTITIES[kind], unit)]
    if len(kinds) != 1:
        raise InputError(
            "is not the unit of one kind of vibration",
            field=field,
            value=unit,
            allowed="e.g. m/s^2, g, mg, mm/s, mm",
            remedy="state the quantity of each channel in the JSON beside the file",
        )
    return kinds[0]


def _has_unit(q: Quantity, unit: str) -> bool:
    return unit == q.unit != "-" or any(unit == other for other, _ in q.scales)
