"""Names, values and times in words, with their units."""

import re

ENTRIES = 6  # of a list that are written out
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
UNIT = re.compile(r"[A-Za-zµ°%][\w/^*.()²³µ°% -]*$")
SHOWN = (("m2", "m²"), ("m3", "m³"), ("s2", "s²"), ("deg", "°"))  # how units are written
DAY = 86400.0  # [s]
TIMES = ((DAY, DAY, "d"), (3600, 3600, "h"), (120, 60, "min"))  # from so many seconds on
# of US practice: factor from SI, unit, and from which number on the next larger one is used
FOOT, POUND = 0.3048, 4.4482216152605
US = {"m": ((1 / FOOT, "ft"),), "m/s": ((1 / FOOT, "ft/s"),), "m/s²": ((1 / FOOT, "ft/s²"),), "m²": ((FOOT**-2, "ft²"),), "m³": ((FOOT**-3, "ft³"),),
      "m³/s": ((FOOT**-3, "ft³/s"),), "Pa": ((FOOT**2 / POUND, "psf"), (FOOT**2 / POUND / 1e3, "ksf")), "N": ((1 / POUND, "lbf"), (1e-3 / POUND, "kip")),
      "J": ((1 / (POUND * FOOT), "ft·lbf"), (1e-3 / (POUND * FOOT), "ft·kip")), "W": ((1 / (POUND * FOOT), "ft·lbf/s"),), "kg/m³": ((9.80665 * FOOT**3 / POUND, "pcf"),),
      "N/m³": ((FOOT**3 / POUND, "pcf"),), "kg": ((9.80665 / POUND, "lb"),), "t": ((9806.65 / POUND / 1e3, "kip"),), "kg m/s": ((1 / POUND, "lbf·s"),)}
COLUMN = re.compile("_(kg_m_s|m_s2|m3_s|m_s|m3|m2|m|J|Pa|N|kg|K|s|deg)$")  # by which names of columns end
_of_run = {"us": False}
SI = {"": 1, "Pa": 1, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/m2": 1, "kN/m2": 1e3, "MN/m2": 1e6, "N/m3": 1, "kN/m3": 1e3, "kg/m3": 1, "t/m3": 1e3, "g/cm3": 1e3,
      "psf": 47.88025898, "ksf": 47880.25898, "psi": 6894.757293, "bar": 1e5,
      "m": 1, "cm": 0.01, "mm": 1e-3, "ft": 0.3048, "s": 1, "min": 60, "h": 3600, "day": 86400, "d": 86400, "deg": 1, "m/s": 1, "mm/h": 1e-3 / 3600, "mm/day": 1e-3 / 86400}


def use(scene):
    """Lets all that is written from now on have the units that a scene asks for (output.units)."""
    _of_run["us"] = scene.get("output", {}).get("units") == "US"


def in_use(unit):
    """(factor, unit) in which charts and tables write all values of an SI unit: (3.28, "ft") for "m" where the scene asks for it."""
    unit = shown(unit)
    of, metre = (unit[:-2], "/m") if unit.endswith("/m") else (unit, "")  # of a metre of the slope
    if not _of_run["us"] or of not in US:
        return 1.0, unit
    factor, name = US[of][0]
    return (factor * FOOT, f"{name}/ft") if metre else (factor, name)


def length():
    """(factor, unit) of places."""
    return in_use("m")


def of_length(text):
    """The name of an axis of places: "elevation [m]"."""
    return with_unit(text, length()[1])


def of_column(name):
    """What the name of a column says: (words, SI unit), ("crest displacement", "m") of crest_displacement_m."""
    match = COLUMN.search(name)
    return words(COLUMN.sub("", name)), shown(match[1].replace("_s", "/s").replace("_", " ")) if match else ""


class Keys:
    """Units of the keys of a scene: {path of the table: {kind, or "" for all kinds: {key: {"unit": ..., "over_time": ...}}}}, as the program
    hands them over. Without them values are shown as they are written."""

    def __init__(self, keys=None):
        self._keys = keys or {}

    def text(self, path, kind, key, value):
        """The value of a key in words; `path` is that of its table, such as body.NAME, and `kind` names its law, kind or curve."""
        return text_of(value, *self._about(path, kind, key))

    def _about(self, path, kind, key):
        table = self._keys.get(path, {})
        about = table.get("", {}).get(key) or table.get(kind, {}).get(key) or {}
        return about.get("unit", ""), about.get("over_time", False)

    def about(self, path, table, key):
        """(unit, whether it may change over time) of a key of a table of the scene."""
        return self._about(path, table.get("kind", table.get("law", "")), key)

    def row(self, path, values, kind_key=""):
        """{key in words: value in words} of a table of the scene; a table inside it on one line."""
        kind = values.get(kind_key, "")
        row = {}
        for key, value in values.items():
            if isinstance(value, dict):
                inside = self.row(f"{path}.{key}", value, "curve")
                row[words(key)] = ", ".join(text if one == "curve" else f"{one} {text}" for one, text in inside.items())
            else:
                row[words(key)] = self.text(path, kind, key, value)
        return row


def number(value):
    """A number of a scene in SI. Raises ValueError where it is an expression, or has a unit that is not known here."""
    if isinstance(value, (int, float)):
        return float(value)
    match = re.fullmatch(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([A-Za-z/0-9]*)\s*", value) if isinstance(value, str) else None
    if not match or match[2] not in SI:
        raise ValueError(value)
    return float(match[1]) * SI[match[2]]


def text_of(value, unit="", over_time=False):
    """A value of a scene in words: 13000 in Pa as '13 kPa', [[0, 12], [150, 0]] of degrees over time as '12° at 0 s, 0° at 150 s'. Texts that
    are quantities stay as they are; expressions get the unit of their values in brackets."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return quantity(value, unit)
    if isinstance(value, list):
        return list_of(value, unit, over_time)
    if not unit or not isinstance(value, str):
        return str(value)
    match = NUMBER.match(value.strip())
    rest = value.strip()[match.end():].strip() if match else ""
    if match and not rest:
        return quantity(float(value), unit)
    if match and in_use(unit)[0] != 1 and rest in SI:
        return quantity(number(value), unit)
    return shown(value) if match and UNIT.match(rest) else f"{value} [{shown(unit)}]"


def list_of(values, unit, over_time):
    if any(isinstance(one, dict) for one in values):
        return f"{len(values)} entries"
    if not values or not isinstance(values[0], list):
        numbers = all(isinstance(one, (int, float)) for one in values)
        return with_shown(f"({', '.join(f'{one:g}' for one in values)})", unit) if numbers and unit else ", ".join(text_of(one, unit) for one in values)
    pairs = all(isinstance(one, list) and len(one) == 2 and not isinstance(one[0], list) for one in values)
    if over_time and not pairs:  # a list of functions
        return "; ".join(text_of(one, unit, over_time) for one in values)
    own = any(isinstance(x, str) for one in values for x in one)  # some values carry their unit, so each is written with one
    say = (lambda one: f"{text_of(one[1], unit)} at {text_of(one[0], 's')}") if over_time else (lambda one: f"({', '.join(text_of(x, unit) if own else str(x) for x in one)})")
    if in_use(unit)[0] != 1 and not own and not over_time:
        factor, unit = readable_unit(max(abs(x) for one in values for x in one), unit)
        values = [[f"{factor * x:.5g}" for x in one] for one in values]
    few = values if len(values) <= ENTRIES else [values[0], values[-1]]
    text = " to ".join(map(say, few)) + f" in {len(values)} points" if few is not values else ", ".join(map(say, few))
    return text if over_time or own else with_shown(text, unit)


def quantity(value, unit, digits=None):
    """A number in a unit in which it reads well, with six digits, or four of one that is converted from SI."""
    factor, named = readable_unit(abs(value), unit)
    rounded = float(f"{factor * value:{digits or ('.6g' if in_use(unit)[0] == 1 else '.4g')}}")
    return with_shown(f"{rounded:.6g}", named)


def span(low, high, unit):
    """'12°', or '0 to 12°' where the two differ."""
    factor, unit = readable_unit(max(abs(low), abs(high)), unit)
    low, high = f"{factor * low:.4g}", f"{factor * high:.4g}"
    return with_shown(high if low == high else f"{low} to {high}", unit)


def duration(seconds):
    """'40 s', '30 d'"""
    for least, size, name in TIMES:
        if seconds >= least:
            return f"{seconds / size:.4g} {name}"
    return f"{seconds:.4g} s"


def clock(last):
    """(size [s], name) of the unit in which the times of a run up to `last` [s] are written: days from one day on, else seconds."""
    return (DAY, "d") if last >= DAY else (1.0, "s")


def at_time(time, last, since=0.0):
    """'t = 12.5 s', with the digits that a run up to `last` [s] needs. In a run of days it is 't = 12.5 d'; a stage of less than a day, which
    began at `since` [s], adds its own seconds: 't = 90.0 d + 4.2 s'."""
    if last >= DAY:
        whole, rest = (since, time - since) if since > 0 else (time, 0.0)
        return f"t = {whole / DAY:.1f} d" + (f" + {rest:.1f} s" if rest > 0 else "")
    digits = 1 if last >= 10 else 2 if last >= 1 else 3
    return f"t = {time:.{digits}f} s"


def with_shown(number, unit):
    unit = shown(unit)
    return f"{number}{unit}" if unit == "°" else f"{number} {unit}".rstrip()


def shown(unit):
    """m/s2 as m/s²"""
    for plain, pretty in SHOWN:
        unit = re.sub(rf"(?<![A-Za-z]){plain}\b" if plain == "deg" else rf"{plain}\b", pretty, unit)
    return unit


def words(name):
    """'plastic_strain' -> 'plastic strain'."""
    return name.replace("_", " ")


def capital(text):
    return text[:1].upper() + text[1:]


def readable_unit(largest, unit):
    """Factor and unit in which numbers up to `largest` read well: 110000 Pa -> (1e-3, 'kPa')."""
    factor, name = in_use(unit)
    of, metre = (unit[:-2], "/m") if unit.endswith("/m") else (unit, "")
    if _of_run["us"] and shown(of) in US:
        every = US[shown(of)]
        larger = next((one for one in reversed(every) if largest * factor * one[0] >= every[0][0]), every[0])
        return factor * larger[0] / every[0][0], name.replace(every[0][1], larger[1])
    if of in ("Pa", "J", "N", "W"):
        for power, prefix in ((9, "G"), (6, "M"), (3, "k")):
            if largest >= 10**power:
                return 10.0**-power, prefix + unit
    if unit in ("m", "m/s") and 0 < largest < 0.1:
        return 1e3, "m" + unit
    return 1.0, "" if unit in ("-", "1") else unit


def brief(value, unit):
    """A number of three digits or, from 1000 on, without decimals, in a unit in which it reads well."""
    factor, unit = readable_unit(abs(value), unit)
    return with_shown(f"{factor * value:.3g}" if abs(factor * value) < 1000 else thousands(round(factor * value)), unit)


def thousands(number):
    return f"{number:,}".replace(",", "\u202f")


def with_unit(text, unit):
    return f"{text} [{unit}]" if unit else text
