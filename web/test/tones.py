#!/usr/bin/env python3
"""Writes tones.json: what `steradian convert` makes of the test picture with each tone curve and in false colour.

    python3 web/test/tones.py PATH/TO/steradian
"""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

WIDTH, HEIGHT = 96, 64
TONES = [
    ("none", 0), ("none", -2.5), ("none", 3), ("clamp", 0), ("clamp:max=3", 0), ("equalize", 0), ("equalize", 1), ("gamma", -1),
    ("gamma:gamma=1.5", -2), ("clamp-gamma:max=4", 0), ("clamp-gamma:gamma=3,max=2", -0.5), ("equalize-gamma", 0),
    ("equalize-gamma:gamma=1.8", -1), ("reinhard", 0), ("reinhard:white=1.5", -1), ("reinhard:white=1e9", 6), ("aces-fit", 0),
    ("aces-fit", -3), ("agx", 0), ("agx", 4), ("agx", -6), ("pbr-neutral", 0), ("pbr-neutral", -2), ("pbr-neutral", 5), ("hable", 0),
    ("hable:white=4", -1), ("none", -20), ("aces-fit", 60),
]


def half(v):
    return struct.unpack("<e", struct.pack("<e", v))[0]


def pixel(x, y):
    """The pattern of mock.ts, as halves."""
    return [half(4 * x / (WIDTH - 1)), half(4 * y / (HEIGHT - 1)), half((x * 7 + y * 13) % 64 / 16)]


def png_rows(data):
    """Rows of an 8-bit RGB PNG."""
    at, packed, width, height = 8, b"", 0, 0
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        chunk = data[at + 8 : at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", chunk[:10])
            assert (depth, color) == (8, 2), (depth, color)
        if kind == b"IDAT":
            packed += chunk
        at += size + 12
    raw, stride, rows = zlib.decompress(packed), 3 * width, []
    before = bytearray(stride)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            a, b, c = (row[i - 3] if i >= 3 else 0), before[i], (before[i - 3] if i >= 3 else 0)
            pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
            paeth = a if pa <= pb and pa <= pc else b if pb <= pc else c
            row[i] = (row[i] + [0, a, b, (a + b) // 2, paeth][kind]) & 255
        rows.append(row)
        before = row
    return rows


def main():
    program = sys.argv[1]
    places = [(x, y) for y in range(1, HEIGHT, 9) for x in range(0, WIDTH, 5)]
    with tempfile.TemporaryDirectory() as folder:
        source, out = f"{folder}/in.pfm", f"{folder}/out.png"
        with open(source, "wb") as file:
            file.write(f"PF\n{WIDTH} {HEIGHT}\n-1.0\n".encode())
            for y in reversed(range(HEIGHT)):
                file.write(b"".join(struct.pack("<3f", *pixel(x, y)) for x in range(WIDTH)))

        def convert(*options):
            pathlib.Path(out).unlink(missing_ok=True)
            subprocess.run([program, "convert", source, out, *options], check=True, capture_output=True)
            rows = png_rows(pathlib.Path(out).read_bytes())
            return [v for x, y in places for v in rows[y][3 * x : 3 * x + 3]]

        cases = [{"tone": t, "exposure": e, "rgb": convert(f"--tonemap={t}", f"--exposure={e}")} for t, e in TONES]
        # Magenta legends and bars are beside the picture; its own pixels keep their places.
        false = convert("--false-color")
    lines = ",\n".join("  " + json.dumps(case, separators=(",", ":")) for case in cases)
    text = f'{{"places":{json.dumps(places, separators=(",", ":"))},\n"false":{json.dumps(false, separators=(",", ":"))},\n"cases":[\n{lines}\n]}}\n'
    pathlib.Path(__file__).with_name("tones.json").write_text(text)


main()
