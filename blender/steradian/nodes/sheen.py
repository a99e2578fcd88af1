"""Cycles' microfiber sheen (Zeltner, Burley, Chiang 2022) by Charlie's, whose roughness is chosen to reflect as much.

Both albedos, means over the hemisphere by the cosine, were measured, Charlie's by `openpbr` with its own parameters. It
ends at 0.30: what is lacking above is added to the diffuse reflection below.
"""

from __future__ import annotations

import numpy as np

from . import values as v

ROUGHNESS = np.linspace(0.0, 1.0, 11)
CYCLES = np.array([0.0002, 0.0022, 0.0131, 0.0352, 0.0705, 0.1186, 0.1774, 0.2437, 0.3133, 0.3822, 0.4472])
CHARLIE = np.array([0.0327, 0.0327, 0.0467, 0.0739, 0.1063, 0.1436, 0.1833, 0.2226, 0.2578, 0.2850, 0.3003])


def _roughness(r: float) -> float:
    """Charlie's roughness of the same albedo."""
    wanted = np.interp(r, ROUGHNESS, CYCLES)
    return float(np.interp(wanted, CHARLIE[1:], ROUGHNESS[1:]))


def _weight(r: float) -> float:
    """Factor where Charlie's sheen is too strong at every roughness."""
    return float(min(np.interp(r, ROUGHNESS, CYCLES) / CHARLIE[0], 1.0))


def _lacking(r: float) -> float:
    """Share of the diffuse reflection that takes the sheen's colour, so that as much is reflected in all."""
    lack = np.interp(r, ROUGHNESS, CYCLES) - CHARLIE[-1]
    return float(max(lack, 0.0) / (1.0 - CHARLIE[-1]))


def fuzz(weight, tint, roughness) -> dict:
    """Parameters of the sheen of `openpbr`."""
    return {
        "fuzz_weight": v.scene(v.multiply(weight, v.apply(_weight, roughness))),
        "fuzz_color": v.scene(v.clamp(tint)),
        "fuzz_roughness": v.scene(v.apply(_roughness, roughness)),
    }


def below(base, weight, tint, roughness):
    """The base colour with what Charlie's sheen lacks."""
    return v.mix(base, v.clamp(tint), v.multiply(weight, v.apply(_lacking, roughness)))
