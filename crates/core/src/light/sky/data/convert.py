#!/usr/bin/env python3
"""Writes hosek_wilkie.bin from the tables that Mitsuba 3 ships.

    python3 -m venv venv && venv/bin/pip install mitsuba==3.9.1 numpy
    venv/bin/python convert.py

The file is a run of little-endian f32, the last index fastest:

    sky coefficients, spectral  [turbidity 10][albedo 2][Bezier point 6][wavelength 11][coefficient 9]
    sky radiance, spectral      [turbidity 10][albedo 2][Bezier point 6][wavelength 11]
    sky coefficients, RGB       [turbidity 10][albedo 2][Bezier point 6][channel 3][coefficient 9]
    sky radiance, RGB           [turbidity 10][albedo 2][Bezier point 6][channel 3]
    solar radiance              [turbidity 10][segment 45][wavelength 11][power 4]
    limb darkening              [wavelength 11][power 6]

Turbidities are 1 to 10, albedos 0 and 1, wavelengths 320 nm to 720 nm in steps of 40 nm. Radiances are in
W/(m² sr nm); those of RGB are such radiances summed over wavelength against the colour matching functions.
"""

import pathlib
import struct

import mitsuba
import numpy as np

ORDER = ["sky_params_spec", "sky_rad_spec", "sky_params_rgb", "sky_rad_rgb", "sun_rad_spec", "sun_ld_spec"]


def fields(data):
    """The tensors of a Mitsuba tensor file of version 1."""
    assert data[:12] == b"tensor_file\0" and data[12:14] == b"\1\0"
    (count,), at, found = struct.unpack_from("<I", data, 14), 18, {}
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2 : at + 2 + length].decode()
        at += 2 + length
        rank, kind, start = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{rank}Q", data, at + 11)
        at += 11 + 8 * rank
        assert kind == 11, "64-bit floats"
        found[name] = np.frombuffer(data, "<f8", int(np.prod(shape)), start).reshape(shape)
    return found


tables = pathlib.Path(mitsuba.__file__).parent / "data" / "sunsky" / "sunsky_datasets.bin"
tables = fields(tables.read_bytes())
out = b"".join(tables[name].astype("<f4").tobytes() for name in ORDER)
(pathlib.Path(__file__).parent / "hosek_wilkie.bin").write_bytes(out)
print(len(out), "bytes", [tables[name].shape for name in ORDER])
