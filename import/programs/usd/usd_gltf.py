"""A glTF document that grows."""

import json
import struct

import numpy

FLOAT, UINT = 5126, 5125


class Gltf:
    def __init__(self):
        self.root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}
        self.binary = bytearray()

    def add(self, kind, value):
        values = self.root.setdefault(kind, [])
        values.append(value)
        return len(values) - 1

    def view(self, data):
        self.binary += b"\0" * (-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        self.binary += data
        return self.add("bufferViews", view)

    def accessor(self, array, kind, with_limits=False):
        made = {
            "bufferView": self.view(array.tobytes()),
            "componentType": UINT if array.dtype == numpy.uint32 else FLOAT,
            "count": len(array),
            "type": kind,
        }
        if with_limits:
            made["min"] = [float(x) for x in array.min(axis=0)]
            made["max"] = [float(x) for x in array.max(axis=0)]
        return self.add("accessors", made)

    def use(self, extension):
        used = self.root.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def bytes(self, model, visuals):
        if self.binary:
            self.root["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps({"gltf": self.root, "model": model, "visuals": visuals}, separators=(",", ":"), allow_nan=False)
        text = text.encode()
        return struct.pack("<Q", len(text)) + text + bytes(self.binary)
