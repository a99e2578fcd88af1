#!/usr/bin/env python3
"""Values and densities of scattering models against Mitsuba 3's.

    python3 scripts/compare_mitsuba.py path/to/steradian [--pairs 1000] [--seed 1] [--only NAME]

needs the package `mitsuba` from PyPI (3.9 or later); it is no part of the gate. Each model is written as a Mitsuba scene, which both
programs read; both evaluate f·|cos θ_i| and the density of sampling at the same random pairs of directions in the shading frame. Half of
the pairs are uniform over the sphere, half are drawn from the model (by Mitsuba), so that narrow lobes are looked at where they are.

The relative difference of a pair is |a − b| / max(|a|, |b|, 1e-3 · the largest value of the model). Printed are its median, its 99th
percentile and its maximum over pairs, for value and density. The exit status is 1 where a 99th percentile exceeds the model's limit;
limits above 1e-3 carry their reason.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ERF = "Mitsuba's masking of Beckmann is a rational fit, within 0.35 %; ours is exact"
PLASTIC_TABLE = "transmittances of rough coats are tables in both programs; inner reflection is integrated, not fitted"
PLASTIC_PDF = "the lobes are chosen by other probabilities"
HAIR = "Mitsuba's lobe probabilities are luminances, ours means of three channels; the values do not depend on them"


def rough(kind, alpha, distribution, more=""):
    return (f'<bsdf type="{kind}"><float name="alpha" value="{alpha}"/>'
            f'<string name="distribution" value="{distribution}"/>{more}</bsdf>')


BASE = '<rgb name="base_color" value="0.7, 0.3, 0.1"/>'


def principled(kind="principled", **values):
    floats = "".join(f'<float name="{n}" value="{v}"/>' for n, v in values.items())
    return f'<bsdf type="{kind}">{BASE}{floats}</bsdf>'


# Name, BSDF, limits of value and density (None: not compared), reason.
MODELS = [
    ("diffuse", '<bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.8"/></bsdf>', 1e-3, 1e-3, ""),
    ("roughconductor ggx", rough("roughconductor", 0.3, "ggx", '<float name="eta" value="0.37"/><float name="k" value="2.82"/>'), 1e-3, 1e-3, ""),
    ("roughconductor beckmann", rough("roughconductor", 0.2, "beckmann", '<float name="eta" value="0.37"/><float name="k" value="2.82"/>'), 7e-3, 7e-3, ERF),
    ("roughdielectric ggx", rough("roughdielectric", 0.3, "ggx"), 1e-3, 1e-3, ""),
    ("roughdielectric beckmann", rough("roughdielectric", 0.2, "beckmann"), 7e-3, 7e-3, ERF),
    ("plastic", '<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.2, 0.5, 0.8"/></bsdf>', 1e-3, None, PLASTIC_PDF),
    ("roughplastic ggx", rough("roughplastic", 0.3, "ggx", '<rgb name="diffuse_reflectance" value="0.2, 0.5, 0.8"/>'), 1e-2, None, PLASTIC_TABLE + "; " + PLASTIC_PDF),
    ("principled plain", principled(roughness=0.4), 1e-3, 1e-3, ""),
    ("principled metal", principled(roughness=0.3, metallic=1.0, anisotropic=0.6), 1e-3, 1e-3, ""),
    ("principled cloth", principled(roughness=0.8, sheen=0.8, sheen_tint=0.5, flatness=0.7), 1e-3, 1e-3, ""),
    ("principled glass", principled(roughness=0.3, spec_trans=0.9, eta=1.4), 1e-3, 1e-3, ""),
    ("principled coat", principled(roughness=0.5, clearcoat=0.9, clearcoat_gloss=0.4, spec_tint=0.6), 1e-3, 1e-3, ""),
    ("principledthin", principled("principledthin", roughness=0.4, spec_trans=0.5, diff_trans=0.7, spec_tint=0.3, sheen=0.4, eta=1.4), 1e-3, 1e-3, ""),
    ("hair", '<bsdf type="hair"><float name="eumelanin" value="0.5"/><float name="pheomelanin" value="0.2"/></bsdf>', 1e-3, None, HAIR),
    ("hair smooth", '<bsdf type="hair"><rgb name="sigma_a" value="0.2, 0.25, 0.7"/><float name="longitudinal_roughness" value="0.15"/><float name="azimuthal_roughness" value="0.2"/></bsdf>', 1e-3, None, HAIR),
]


def scene(bsdf):
    named = bsdf.replace("<bsdf ", '<bsdf id="it" ', 1)
    return (f'<scene version="3.0.0">{named}<emitter type="constant"/><sensor type="perspective"/>'
            f'<shape type="sphere"><ref id="it"/></shape></scene>')


def directions(rng, n):
    z, phi = rng.uniform(-1, 1, n), rng.uniform(0, 2 * math.pi, n)
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], 1)


def theirs(mi, text, n, rng):
    """Pairs, values and densities."""
    bsdf = mi.load_string(text).shapes()[0].bsdf()
    context = mi.BSDFContext()
    wo, wi = directions(rng, n), directions(rng, n)
    values, pdfs = np.zeros((n, 3)), np.zeros(n)
    for k in range(n):
        si = mi.SurfaceInteraction3f()
        # Mitsuba calls the direction to the viewer wi.
        si.wi = mi.Vector3f(*wo[k])
        if k % 2:
            s, _ = bsdf.sample(context, si, float(rng.random()), mi.Point2f(*rng.random(2)))
            if s.pdf > 0 and not mi.has_flag(s.sampled_type, mi.BSDFFlags.Delta):
                wi[k] = np.array(s.wo)
        wi[k] /= np.linalg.norm(wi[k])
        # What is handed over in JSON is what is evaluated, in single precision.
        wo[k], wi[k] = np.float32(wo[k]), np.float32(wi[k])
        si.wi = mi.Vector3f(*wo[k])
        direction = mi.Vector3f(*wi[k])
        values[k] = np.array(bsdf.eval(context, si, direction))
        pdfs[k] = bsdf.pdf(context, si, direction)
    return wo, wi, values, pdfs


def ours(program, text, wo, wi, folder):
    path, pairs = folder / "scene.xml", folder / "pairs.json"
    path.write_text(text)
    pairs.write_text(json.dumps([{"wo": o.tolist(), "wi": i.tolist()} for o, i in zip(wo, wi)]))
    command = [program, "material", f"{path}:it", "--eval", str(pairs), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    read = json.loads(done.stdout)["eval"]
    return np.array([e["value"][:3] for e in read]), np.array([e["pdf"] for e in read])


def spread(a, b):
    """Relative differences; near zero those of the model's scale."""
    floor = 1e-3 * max(np.abs(a).max(), 1e-30)
    d = np.abs(a - b) / np.maximum(np.maximum(np.abs(a), np.abs(b)), floor)
    return float(np.median(d)), float(np.quantile(d, 0.99)), float(d.max())


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("program")
    p.add_argument("--pairs", type=int, default=1000)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--only", default="")
    args = p.parse_args()
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    failed = False
    print(f"Mitsuba {mi.__version__}, {args.pairs} pairs; relative differences: median, 99 %, maximum")
    print(f"{'model':26} {'value':>30} {'density':>30}")
    with tempfile.TemporaryDirectory() as folder:
        for name, bsdf, limit_value, limit_pdf, why in MODELS:
            if args.only not in name:
                continue
            rng = np.random.default_rng(args.seed)
            text = scene(bsdf)
            wo, wi, values, pdfs = theirs(mi, text, args.pairs, rng)
            our_values, our_pdfs = ours(args.program, text, wo, wi, Path(folder))
            v, d = spread(values, our_values), spread(pdfs, our_pdfs)
            bad = v[1] > limit_value or (limit_pdf is not None and d[1] > limit_pdf)
            failed |= bad
            show = lambda s: " ".join(f"{x:9.1e}" for x in s)
            print(f"{name:26} {show(v):>30} {show(d):>30} {'FAILED' if bad else 'ok'}{'  (' + why + ')' if why else ''}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
