"""Values of sockets: numbers, colours, and fields that vary over a surface, with their arithmetic.

Constants are folded exactly. A field is a texture of the scene language; one that is known by a formula of coordinates
stays a formula for as long as what is done to it can be written as one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, Optional

import numpy as np

CURVE = 65
LUMINANCE = (0.2126, 0.7152, 0.0722)
LONGEST = 3500


@dataclass(frozen=True)
class Place:
    """Coordinates: an affine map (3 x 4) of `base`, which names a space that the reader knows."""

    base: str
    matrix: tuple

    @property
    def array(self):
        return np.array(self.matrix, dtype=float).reshape(3, 4)

    def then(self, matrix) -> "Place":
        """These coordinates under a further affine map (4 x 4)."""
        full = np.vstack([self.array, [0, 0, 0, 1]])
        return Place(self.base, tuple((np.asarray(matrix, float) @ full)[:3].ravel()))


@dataclass(frozen=True)
class Field:
    """A number or colour that varies. `low` and `high` bound each of its components."""

    width: int = 1
    low: float = 0.0
    high: float = 1.0
    node: Any = None
    formulas: Optional[tuple] = None
    space: tuple = ()
    place: Optional[Place] = None

    def texture(self) -> dict:
        """The field as a texture of the scene language."""
        if self.node is not None:
            return self.node
        space = {k: {"matrix": list(x)} if isinstance(x, tuple) else x for k, x in self.space}
        if self.width == 1:
            return {"texture": "expression", "expression": self.formulas[0], **space}
        return {"texture": "expression", **dict(zip(("red", "green", "blue"), self.formulas)), **space}

    def component(self, i: int) -> "Field":
        if self.width == 1:
            return self
        if self.formulas:
            return Field(1, self.low, self.high, None, (self.formulas[i],), self.space)
        return Field(1, self.low, self.high, {"texture": "channel", "input": self.texture(), "channel": "rgb"[i]})

    @property
    def middle(self) -> float:
        return 0.5 * (self.low + self.high)


def is_constant(v) -> bool:
    return not isinstance(v, Field)


def floats(numbers) -> dict:
    """A list of numbers, which is no colour even where it has three."""
    return {"floats": [float(x) for x in numbers]}


def product(a, b) -> Any:
    """The product of two values, of which one varies.

    Dictionaries have no room for the kind `scale`, a parameter of which is called as its family, so that a mix stands in:
    its amount is one number. Colours are multiplied by a diagonal matrix, or component by component.
    """
    for x, y in ((a, b), (b, a)):
        if width(x) == 1:
            return {"texture": "mix", "a": 0.0, "b": scene(y), "amount": scene(x)}
    for x, y in ((a, b), (b, a)):
        if is_constant(x):
            rows = [c if i == j else 0.0 for i, c in enumerate(x) for j in range(3)]
            return {"texture": "color_space", "input": scene(y), "matrix": floats(rows)}
    parts = [Field(1, node=product(x, y)) for x, y in zip(components(a), components(b))]
    return combine_colour(*parts).texture()


def width(v) -> int:
    return v.width if isinstance(v, Field) else len(v) if isinstance(v, tuple) else 1


def scene(v):
    """A value as the scene language has it."""
    if isinstance(v, Field):
        return v.texture()
    return [float(c) for c in v] if isinstance(v, tuple) else float(v)


def components(v) -> list:
    """Three components of any value."""
    if isinstance(v, Field):
        return [v.component(i) for i in range(3)]
    return list(v) if isinstance(v, tuple) else [v, v, v]


def bounds(v) -> tuple[float, float]:
    if isinstance(v, Field):
        return v.low, v.high
    return (min(v), max(v)) if isinstance(v, tuple) else (v, v)


def _text(v: float) -> str:
    return f"({v!r})" if v < 0 else repr(float(v)) if "e" not in repr(float(v)) else f"({float(v):.12f})"


def as_colour(v):
    """A number as a colour."""
    if isinstance(v, Field):
        return v if v.width == 3 else Field(3, v.low, v.high, v.node, v.formulas and v.formulas * 3, v.space)
    return v if isinstance(v, tuple) else (v, v, v)


def as_number(v, is_colour: bool = True):
    """A colour by its luminance, or a vector by its mean, as Blender converts them."""
    weights = LUMINANCE if is_colour else (1 / 3, 1 / 3, 1 / 3)
    if isinstance(v, Field):
        if v.width == 1:
            return v
        if v.formulas:
            text = "+".join(f"{w:.9g}*({f})" for w, f in zip(weights, v.formulas))
            return Field(1, v.low, v.high, None, (f"({text})",), v.space)
        channel = "luminance" if is_colour else "mean"
        return Field(1, v.low, v.high, {"texture": "channel", "input": v.texture(), "channel": channel})
    return sum(w * c for w, c in zip(weights, v)) if isinstance(v, tuple) else v


def combine_colour(r, g, b):
    """A colour of three numbers."""
    parts = (r, g, b)
    if all(is_constant(p) for p in parts):
        return tuple(float(p) for p in parts)
    low, high = min(bounds(p)[0] for p in parts), max(bounds(p)[1] for p in parts)
    fields = [p for p in parts if not is_constant(p)]
    if all(p.formulas and p.space == fields[0].space for p in fields):
        text = tuple(_text(p) if is_constant(p) else p.formulas[0] for p in parts)
        return Field(3, low, high, None, text, fields[0].space)
    out = None
    for i, p in enumerate(parts):
        unit = [float(i == k) for k in range(3)]
        term = product(p, tuple(unit)) if not is_constant(p) else [c * p for c in unit]
        out = term if out is None else {"texture": "add", "a": out, "b": term}
    return Field(3, low, high, out)


def _safe(function: Callable, *args) -> float:
    try:
        v = function(*args)
        return float(v) if math.isfinite(v) else 0.0
    except (ValueError, ZeroDivisionError, OverflowError):
        return 0.0


def _places(low: float, high: float):
    """Numbers from low to high, closer near 0 where there is much above 1."""
    even = np.linspace(0.0, 1.0, CURVE)
    return high * even**2 if low == 0.0 and high > 2.0 else low + (high - low) * even


def apply(function: Callable[[float], float], v, template: Optional[str] = None):
    """A function of each component: exact of constants and formulas (`template` has {a}), else a curve."""
    if not isinstance(v, Field):
        return tuple(_safe(function, c) for c in v) if isinstance(v, tuple) else _safe(function, v)
    places = _places(v.low, v.high)
    values = [_safe(function, float(x)) for x in places]
    low, high = min(values), max(values)
    if v.formulas and template:
        text = tuple(template.format(a=f"({f})") for f in v.formulas)
        if sum(map(len, text)) < LONGEST:
            return Field(v.width, low, high, None, text, v.space)
    if v.high <= v.low:
        return values[0]
    curve = {"texture": "curve", "input": v.texture(), "places": floats(places), "values": floats(values)}
    return Field(v.width, low, high, curve)


def _combined_bounds(function, a, b):
    xs, ys = np.linspace(*bounds(a), 9), np.linspace(*bounds(b), 9)
    values = [_safe(function, float(x), float(y)) for x in xs for y in ys]
    return min(values), max(values)


def _linear(kind: str, a, b):
    """Sums, differences and products as textures."""
    if kind == "add":
        return {"texture": "add", "a": scene(a), "b": scene(b)}
    if kind == "subtract":
        return {"texture": "add", "a": scene(a), "b": product(b, -1.0)}
    if kind == "multiply":
        return product(a, b)
    return None


def combine(function, a, b, template: Optional[str] = None, linear: Optional[str] = None, tell=None):
    """A function of two values, by components. Two fields need a formula or a sum, difference or product; else the
    second counts by its middle, which `tell` hears."""
    wide = max(width(a), width(b))
    if is_constant(a) and is_constant(b):
        if wide == 1:
            return _safe(function, a, b)
        return tuple(_safe(function, x, y) for x, y in zip(components(a), components(b)))
    low, high = _combined_bounds(function, a, b)
    spaces = [v.space for v in (a, b) if isinstance(v, Field)]
    if template and all(v.formulas for v in (a, b) if isinstance(v, Field)) and len(set(spaces)) == 1:
        text = []
        for i in range(wide):
            pair = [
                _text(components(v)[i]) if is_constant(v) else f"({v.formulas[i if v.width == 3 else 0]})"
                for v in (a, b)
            ]
            text.append(template.format(a=pair[0], b=pair[1]))
        if sum(map(len, text)) < LONGEST:
            return Field(wide, low, high, None, tuple(text), spaces[0])
    node = _linear(linear, a, b) if linear else None
    if node is not None:
        return Field(wide, low, high, node)
    if not isinstance(a, Field) and width(a) == 1:
        return apply(lambda y: function(a, y), b)
    if not isinstance(b, Field) and width(b) == 1:
        return apply(lambda x: function(x, b), a)
    if is_constant(a) or is_constant(b):
        return combine_colour(*(combine(function, x, y, template, linear, tell) for x, y in zip(components(a), components(b))))
    if tell:
        tell("an operation of two textures that is no sum, difference or product: the second counts by its middle")
    return combine(function, a, b.middle, template, linear, tell)


def add(a, b):
    return combine(lambda x, y: x + y, a, b, "({a}+{b})", "add")


def subtract(a, b):
    return combine(lambda x, y: x - y, a, b, "({a}-{b})", "subtract")


def multiply(a, b):
    for x, y in ((a, b), (b, a)):
        if x == 1.0 or x == (1.0, 1.0, 1.0):
            return as_colour(y) if width(x) == 3 else y
        if x == 0.0 or x == (0.0, 0.0, 0.0):
            return (0.0, 0.0, 0.0) if max(width(a), width(b)) == 3 else 0.0
    return combine(lambda x, y: x * y, a, b, "({a}*{b})", "multiply")


def mix(a, b, t):
    """a(1 − t) + b t."""
    if is_constant(t) and width(t) == 1 and t in (0.0, 1.0):
        return b if t else a
    if all(is_constant(v) or v.formulas for v in (a, b, t)) or width(t) == 3:
        return add(a, multiply(t, subtract(b, a)))
    if all(is_constant(v) for v in (a, b, t)):
        return add(a, multiply(t, subtract(b, a)))
    low = min(bounds(a)[0], bounds(b)[0])
    high = max(bounds(a)[1], bounds(b)[1])
    wide = max(width(a), width(b), width(t))
    return Field(wide, low, high, {"texture": "mix", "a": scene(a), "b": scene(b), "amount": scene(t)})


def clamp(v, low=0.0, high=1.0):
    """Held between two numbers; what is there already is left alone."""
    if isinstance(v, Field) and v.low >= low and v.high <= high:
        return v
    if isinstance(v, Field) and not v.formulas:
        places = sorted({v.low, min(max(low, v.low), v.high), min(max(high, v.low), v.high), v.high})
        curve = {"texture": "curve", "input": v.texture(), "places": floats(places),
                 "values": floats(min(max(p, low), high) for p in places)}
        return Field(v.width, max(low, min(v.low, high)), min(high, max(v.high, low)), curve)
    return apply(lambda x: min(max(x, low), high), v, f"min(max({{a}},{_text(low)}),{_text(high)})")


def middle(v):
    """One value for the whole surface."""
    if not isinstance(v, Field):
        return v
    return v.middle if v.width == 1 else (v.middle,) * 3
