#!/usr/bin/env python3
"""Makes the packed data that the reader of glTF is tested with, by the reference encoders: meshoptimizer (wheel
`meshoptimizer`), Draco (wheel `DracoPy`) and WebP (`pillow`). Usage: packed_gltf.py FOLDER"""
import ctypes
import io
import json
import struct
import sys

import DracoPy
import numpy as np
from PIL import Image
from meshoptimizer import encoder
from meshoptimizer._loader import lib

folder = sys.argv[1]
rng = np.random.default_rng(7)


def pointer(a):
    return a.ctypes.data_as(ctypes.c_void_p)


def vertices(data, version, level=3):
    encoder.encode_vertex_version(version)
    count, size = data.shape[0], data.strides[0]
    lib.meshopt_encodeVertexBufferLevel.restype = ctypes.c_size_t
    bound = lib.meshopt_encodeVertexBufferBound(ctypes.c_size_t(count), ctypes.c_size_t(size))
    out = np.zeros(bound, np.uint8)
    n = lib.meshopt_encodeVertexBufferLevel(
        pointer(out), ctypes.c_size_t(bound), pointer(data), ctypes.c_size_t(count), ctypes.c_size_t(size), level, version
    )
    assert n > 0 and out[0] == 0xA0 + version
    return out[:n].tobytes()


def filtered(name, data, count, stride, bits, *mode):
    """The input of a filter, and what the reference decoder makes of it."""
    inside = np.zeros(count * stride, np.uint8)
    getattr(lib, f"meshopt_encodeFilter{name}")(
        pointer(inside), ctypes.c_size_t(count), ctypes.c_size_t(stride), bits, pointer(data), *mode
    )
    out = inside.copy()
    getattr(lib, f"meshopt_decodeFilter{name}")(pointer(out), ctypes.c_size_t(count), ctypes.c_size_t(stride))
    return inside.reshape(count, stride), out.tobytes()


def torus(nu=20, nv=10):
    """A bumpy torus with a seam in its texture coordinates."""
    u, v = np.meshgrid(np.arange(nu + 1) / nu, np.arange(nv + 1) / nv, indexing="ij")
    a, b = 2 * np.pi * u, 2 * np.pi * v
    r = 0.4 + 0.05 * np.cos(5 * a) * np.cos(3 * b)
    p = np.stack([(1 + r * np.cos(b)) * np.cos(a), r * np.sin(b), (1 + r * np.cos(b)) * np.sin(a)], -1)
    n = np.stack([np.cos(b) * np.cos(a), np.sin(b), np.cos(b) * np.sin(a)], -1)
    index = np.arange((nu + 1) * (nv + 1)).reshape(nu + 1, nv + 1)
    q = [index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]]
    tri = np.stack([np.stack([q[0], q[1], q[2]], -1), np.stack([q[0], q[2], q[3]], -1)], 2)
    flat = lambda x, k: np.ascontiguousarray(x.reshape(-1, k).astype(np.float32))
    return flat(p, 3), flat(n, 3), flat(np.stack([u, v], -1), 2), tri.reshape(-1).astype(np.uint32)


def triangles_of(order):
    """What the reference decoder makes of packed triangles: the encoder may turn them."""
    packed = encoder.encode_index_buffer(order)
    out = np.zeros(len(order), np.uint32)
    data = np.frombuffer(packed, np.uint8)
    assert lib.meshopt_decodeIndexBuffer(pointer(out), ctypes.c_size_t(len(order)), ctypes.c_size_t(4), data.ctypes.data_as(ctypes.POINTER(ctypes.c_ubyte)), ctypes.c_size_t(len(data))) == 0
    return packed, out


def streams():
    """One stream a line: mode, filter, count, stride, packed, unpacked."""
    lines = []
    line = lambda mode, name, count, stride, packed, plain: lines.append(
        f"{mode} {name} {count} {stride} {bytes(packed).hex()} {bytes(plain).hex()}"
    )
    for version in (0, 1):
        # Small and large steps, constants and noise in all bytes; numbers of elements around 16 and the size of a block.
        for stride, count in [(4, 1), (8, 16), (12, 37), (8, 260)] + [(256, 33)] * version:
            steps = rng.integers(0, 2 ** rng.integers(0, 9, (1, stride)), (count, stride))
            data = np.cumsum(steps, 0).astype(np.uint8)
            line("ATTRIBUTES", "NONE", count, stride, vertices(data, version), data.tobytes())
        halves = np.cumsum(rng.integers(-300, 300, (64, 4)), 0).astype(np.int16).view(np.uint8).reshape(64, 8)
        line("ATTRIBUTES", "NONE", 64, 8, vertices(halves, version), halves.tobytes())
        # Sparse ones, which version 1 packs by single bits.
        bits = np.cumsum(rng.integers(0, 9, (64, 4)) == 0, 0).astype(np.uint8)
        line("ATTRIBUTES", "NONE", 64, 4, vertices(bits, version), bits.tobytes())
        floats = (1 + np.arange(40) / 16).astype(np.float32).view(np.uint8).reshape(40, 4)
        line("ATTRIBUTES", "NONE", 40, 4, vertices(floats, version), floats.tobytes())
    lib.meshopt_encodeFilterExp.restype = None
    units = rng.normal(size=(20, 4)).astype(np.float32)
    units /= np.linalg.norm(units[:, :3], axis=1, keepdims=True)
    units[:, 3] = np.sign(units[:, 3])
    for stride, bits in ((4, 8), (8, 12), (8, 16)):
        inside, out = filtered("Oct", units, 20, stride, bits)
        line("ATTRIBUTES", "OCTAHEDRAL", 20, stride, vertices(inside, 0), out)
    quats = rng.normal(size=(20, 4)).astype(np.float32)
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    for bits in (8, 16):
        inside, out = filtered("Quat", quats, 20, 8, bits)
        line("ATTRIBUTES", "QUATERNION", 20, 8, vertices(inside, 1), out)
    numbers = (rng.normal(size=(20, 3)) * 10.0 ** rng.integers(-9, 9, (20, 1))).astype(np.float32)
    for bits in (10, 23):
        inside, out = filtered("Exp", numbers, 20, 12, bits, 0)
        line("ATTRIBUTES", "EXPONENTIAL", 20, 12, vertices(inside, 0), out)
    triangles = torus(9, 5)[3]
    soup = rng.integers(0, 70_000, 90).astype(np.uint32)
    twice = np.concatenate([triangles, triangles[:60] + 200, triangles[:30]]).astype(np.uint32)
    encoder.encode_index_version(1)
    for order, dtype in ((triangles, np.uint32), (soup, np.uint32), (twice, np.uint32), (triangles, np.uint16)):
        packed, turned = triangles_of(order)
        size = np.dtype(dtype).itemsize
        line("TRIANGLES", "NONE", len(order), size, packed, turned.astype(dtype).tobytes())
        line("INDICES", "NONE", len(order), size, encoder.encode_index_sequence(order), order.astype(dtype).tobytes())
    with open(f"{folder}/streams.txt", "w") as file:
        file.write("\n".join(lines) + "\n")


class Document:
    """A .glb of one mesh, seen from a given place."""

    def __init__(self, *extensions):
        self.data, self.views, self.accessors = b"", [], []
        self.extensions, self.materials, self.more = list(extensions), None, {}

    def bytes(self, data):
        self.data += b"\0" * (-len(self.data) % 4)
        place = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        self.data += data
        return place

    def view(self, view):
        self.views.append(view)
        return len(self.views) - 1

    def accessor(self, array, kind, view, component, **more):
        bounds = {"min": array.min(0).tolist(), "max": array.max(0).tolist()} if kind == "VEC3" else {}
        accessor = {"componentType": component, "count": len(array), "type": kind, **bounds, **more}
        if view is not None:
            accessor["bufferView"] = view
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def write(self, name, primitive, node={}, fallback=0):
        root = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0, 1]}],
            "nodes": [
                {"mesh": 0, "name": "torus", **node},
                {"camera": 0, "translation": [0, 1.76, 2.4], "rotation": [-0.30901699, 0, 0, 0.95105652]},
            ],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}],
            "meshes": [{"primitives": [{**primitive, "material": 0}]}],
            "materials": [self.materials or {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.3, 0.1, 1], "metallicFactor": 0}}],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.data)}] + ([{"byteLength": fallback}] if fallback else []),
            **self.more,
        }
        if self.extensions:
            root["extensionsUsed"] = root["extensionsRequired"] = self.extensions
        text = json.dumps(root, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        data = self.data + b"\0" * (-len(self.data) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
        with open(f"{folder}/{name}.glb", "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


POSITION, NORMAL, UV, ORDER = torus()
encoder.encode_index_version(1)
ORDER = triangles_of(ORDER)[1]
assert (triangles_of(ORDER)[1] == ORDER).all()


def plain(name, position, normal, uv, order, document=None):
    d = document or Document()
    part = lambda array: d.view(d.bytes(array.tobytes()))
    attributes = {
        "POSITION": d.accessor(position, "VEC3", part(position), 5126),
        "NORMAL": d.accessor(normal, "VEC3", part(normal), 5126),
        "TEXCOORD_0": d.accessor(uv, "VEC2", part(uv), 5126),
    }
    indices = d.accessor(order, "SCALAR", part(order.astype(np.uint16)), 5123)
    d.write(name, {"attributes": attributes, "indices": indices})


def meshopt(name, extension, version):
    d = Document(extension)
    fallback = 0

    def part(array, mode, packed):
        nonlocal fallback
        stride = array.strides[0]
        length = array.nbytes
        packing = {**d.bytes(packed), "byteStride": stride, "count": len(array), "mode": mode}
        view = {"buffer": 1, "byteOffset": fallback, "byteLength": length, "extensions": {extension: packing}}
        if mode == "ATTRIBUTES":
            view["byteStride"] = stride
        fallback += length + -length % 4
        return d.view(view)

    packed = lambda array: part(array, "ATTRIBUTES", vertices(array.view(np.uint8).reshape(len(array), -1), version))
    attributes = {
        "POSITION": d.accessor(POSITION, "VEC3", packed(POSITION), 5126),
        "NORMAL": d.accessor(NORMAL, "VEC3", packed(NORMAL), 5126),
        "TEXCOORD_0": d.accessor(UV, "VEC2", packed(UV), 5126),
    }
    encoder.encode_index_version(1)
    small = ORDER.astype(np.uint16)
    view = part(small, "TRIANGLES", encoder.encode_index_buffer(ORDER))
    indices = d.accessor(small, "SCALAR", view, 5123)
    d.write(name, {"attributes": attributes, "indices": indices}, fallback=fallback)


def quantized(name, packs):
    """Positions of 16 bits, normals of 8, texture coordinates of 16 (KHR_mesh_quantization), also packed."""
    extension = "EXT_meshopt_compression"
    d = Document("KHR_mesh_quantization", *([extension] if packs else []))
    low, size = POSITION.min(0), float((POSITION.max(0) - POSITION.min(0)).max())
    position = np.zeros((len(POSITION), 4), np.uint16)
    position[:, :3] = np.round((POSITION - low) / size * 16383)
    uv = np.round(UV * 65535).astype(np.uint16)
    units = np.concatenate([NORMAL, np.zeros((len(NORMAL), 1))], 1).astype(np.float32)
    inside, out = filtered("Oct", units, len(NORMAL), 4, 8)
    normal = np.frombuffer(out, np.int8).reshape(-1, 4)
    fallback = 0

    def part(array, packed, name="NONE"):
        nonlocal fallback
        if not packs:
            return d.view({**d.bytes(array.tobytes()), "byteStride": array.strides[0]})
        packing = {"byteStride": array.strides[0], "count": len(array), "mode": "ATTRIBUTES", "filter": name}
        packing = {**d.bytes(vertices(packed.view(np.uint8).reshape(len(array), -1), 0)), **packing}
        view = {"buffer": 1, "byteOffset": fallback, "byteLength": array.nbytes, "byteStride": array.strides[0]}
        fallback += array.nbytes
        return d.view({**view, "extensions": {extension: packing}})

    attributes = {
        "POSITION": d.accessor(position[:, :3], "VEC3", part(position, position), 5123),
        "NORMAL": d.accessor(normal[:, :3], "VEC3", part(normal, inside, "OCTAHEDRAL"), 5120, normalized=True),
        "TEXCOORD_0": d.accessor(uv, "VEC2", part(uv, uv), 5123, normalized=True),
    }
    small = ORDER.astype(np.uint16)
    indices = d.accessor(small, "SCALAR", d.view(d.bytes(small.tobytes())), 5123)
    node = {"translation": low.tolist(), "scale": [size / 16383] * 3}
    d.write(name, {"attributes": attributes, "indices": indices}, node, fallback)


def draco(name, level):
    """By its two methods (level 0 is the sequential one), and what the reference decoder makes of it."""
    packed = DracoPy.encode(
        POSITION, ORDER.reshape(-1, 3), normals=NORMAL.astype(np.float64), tex_coord=UV.astype(np.float64), compression_level=level, quantization_bits=14,
        tex_coord_quantization_bits=12, normal_quantization_bits=10
    )
    mesh = DracoPy.decode(packed)
    arrays = {a["attribute_type"]: a for a in mesh.attributes}
    position, normal, uv = (arrays[k]["data"].astype(np.float32) for k in (0, 1, 3))
    order = mesh.faces.reshape(-1).astype(np.uint32)
    plain(f"{name}-plain", position, normal, uv, order)
    extension = "KHR_draco_mesh_compression"
    d = Document(extension)
    attributes = {
        "POSITION": d.accessor(position, "VEC3", None, 5126),
        "NORMAL": d.accessor(normal, "VEC3", None, 5126),
        "TEXCOORD_0": d.accessor(uv, "VEC2", None, 5126),
    }
    indices = d.accessor(order, "SCALAR", None, 5123)
    ids = {"POSITION": arrays[0]["unique_id"], "NORMAL": arrays[1]["unique_id"], "TEXCOORD_0": arrays[3]["unique_id"]}
    packing = {"bufferView": d.view(d.bytes(packed)), "attributes": ids}
    d.write(name, {"attributes": attributes, "indices": indices, "mode": 4, "extensions": {extension: packing}})


streams()
plain("torus", POSITION, NORMAL, UV, ORDER)
meshopt("meshopt-v0", "EXT_meshopt_compression", 0)
meshopt("meshopt-v1", "KHR_meshopt_compression", 1)
quantized("quantized", False)
quantized("quantized-meshopt", True)
draco("draco", 7)
draco("draco-sequential", 0)
