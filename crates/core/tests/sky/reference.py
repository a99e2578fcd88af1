#!/usr/bin/env python3
"""Writes mitsuba.txt: radiances of the emitter sunsky of Mitsuba 3.9.1, which main.rs compares with.

    python3 -m venv venv && venv/bin/pip install mitsuba==3.9.1 numpy
    venv/bin/python reference.py

A line has what (sky, even sun, or darkened sun), the colour mode, turbidity, albedo, the sun's height in degrees, the
direction's height and azimuth from the sun's in degrees, and the radiances: of red, green and blue, or at the
wavelengths in LAMBDA in nm. Where the sun is even, its heights are those of Mitsuba's table of irradiances.
"""

import itertools
import pathlib

import mitsuba as mi
import numpy as np

LAMBDA = [330.0, 400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0]
TURBIDITIES = [1.0, 2.0, 3.5, 6.0, 10.0]
VIEWS = [(0.5, 5.0), (8.0, 170.0), (25.0, 20.0), (45.0, 90.0), (60.0, 180.0), (89.0, 0.0)]


def toward(height, azimuth):
    h, a = np.radians([height, azimuth])
    return [np.cos(h) * np.cos(a), np.cos(h) * np.sin(a), np.sin(h)]


def radiances(emitter, direction):
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f([-v for v in direction])
    if "rgb" in mi.variant():
        return list(emitter.eval(si))
    out = []
    for four in (LAMBDA[:4], LAMBDA[4:]):
        si.wavelengths = four
        out += list(emitter.eval(si))
    return out


def line(what, turbidity, albedo, sun, view, **more):
    settings = {"type": "sunsky", "turbidity": turbidity, "sun_direction": toward(sun, 0.0)}
    emitter = mi.load_dict({**settings, "albedo": albedo, **more})
    numbers = radiances(emitter, toward(*view))
    assert np.all(np.isfinite(numbers)), (what, turbidity, albedo, sun, view)
    mode = "rgb" if "rgb" in mi.variant() else "spectral"
    return " ".join([what, mode, *(f"{v:g}" for v in (turbidity, albedo, sun, *view)), *(f"{v:.5g}" for v in numbers)])


lines = []
for variant in ("scalar_rgb", "scalar_spectral"):
    mi.set_variant(variant)
    for t, albedo, sun, view in itertools.product(TURBIDITIES, [0.0, 0.6], [2.0, 12.0, 35.0, 80.0], VIEWS):
        lines.append(line("sky", t, albedo, sun, view, sun_scale=0.0))
    for t, sun in itertools.product(TURBIDITIES, [5.0, 20.0, 50.0, 80.0]):
        lines.append(line("even", t, 0.3, sun, (sun + 0.1, 0.0), sky_scale=0.0, complex_sun=False))
        for view in [(sun, 0.0), (sun - 0.2, 0.0), (sun + 0.25, 0.0)]:
            lines.append(line("darkened", t, 0.3, sun, view, sky_scale=0.0, complex_sun=True))
(pathlib.Path(__file__).parent / "mitsuba.txt").write_text("\n".join(lines) + "\n")
