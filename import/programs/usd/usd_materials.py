"""Materials of UsdPreviewSurface as those of glTF."""

import os

from pxr import Ar, Gf, UsdShade

WRAPS = {"repeat": 10497, "clamp": 33071, "mirror": 33648, "black": 33071}


class Materials:
    def __init__(self, gltf, absent, warn):
        self.gltf, self.absent, self.warn = gltf, absent, warn
        self.known, self.pictures, self.textures = {}, {}, {}
        self.files = set()  # of the pictures

    @staticmethod
    def is_bound(prim):
        return bool(UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0])

    def of(self, prim, color, opacity, double_sided):
        """The number of the material of a prim, with its displayColor where it has none; and the name of its uv set."""
        material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        key = (material.GetPath() if material else None, None if material else color, opacity, double_sided)
        if key not in self.known:
            self.known[key] = self.read(material, color, opacity, double_sided)
        return self.known[key]

    def read(self, material, color, opacity, double_sided):
        made, uv = {"pbrMetallicRoughness": {"metallicFactor": 0.0}}, None
        if double_sided:
            made["doubleSided"] = True
        shader = None
        if material:
            made["name"] = material.GetPrim().GetName()
            shader = self.preview_surface(material)
        if shader:
            uv = self.read_surface(shader, made)
        else:
            made["pbrMetallicRoughness"]["baseColorFactor"] = [*color, opacity]
            if opacity < 1:
                made["alphaMode"] = "BLEND"
        return self.gltf.add("materials", made), uv

    def preview_surface(self, material):
        for context in (UsdShade.Tokens.universalRenderContext, "preview"):
            found = material.ComputeSurfaceSource(context)
            shader = found[0] if isinstance(found, tuple) else found
            if shader and shader.GetIdAttr().Get() == "UsdPreviewSurface":
                return shader
        self.warn("material", material.GetPath(), "has no UsdPreviewSurface; its prims have their displayColor")
        return None

    def read_surface(self, shader, made):
        pbr = made["pbrMetallicRoughness"]
        uvs = []
        value = lambda name, default: self.value_of(shader, name, default)
        texture = lambda name: self.texture_of(shader, name, uvs)
        diffuse, opacity, cutoff = texture("diffuseColor"), texture("opacity"), value("opacityThreshold", 0.0)
        rgb = value("diffuseColor", Gf.Vec3f(0.18)) if diffuse is None else diffuse.scale
        alpha = value("opacity", 1.0) if opacity is None else 1.0
        pbr["baseColorFactor"] = [*[max(0.0, min(1.0, float(c))) for c in rgb[:3]], max(0.0, min(1.0, float(alpha)))]
        if diffuse is not None:
            pbr["baseColorTexture"] = {"index": diffuse.number}
        if opacity is not None and (diffuse is None or opacity.number != diffuse.number):
            what = "has a picture of its opacity that is not that of its colour; it is opaque"
            self.warn("material", shader.GetPath(), what)
            opacity = None
        if cutoff > 0 and (opacity is not None or alpha < 1):
            made["alphaMode"], made["alphaCutoff"] = "MASK", float(cutoff)
        elif opacity is not None or alpha < 1:
            made["alphaMode"] = "BLEND"
        self.read_roughness(shader, texture("metallic"), texture("roughness"), pbr)
        emission, normal = texture("emissiveColor"), texture("normal")
        factor = value("emissiveColor", Gf.Vec3f(0)) if emission is None else emission.scale
        made["emissiveFactor"] = [max(0.0, min(1.0, float(c))) for c in factor[:3]]
        if emission is not None:
            made["emissiveTexture"] = {"index": emission.number}
        if normal is not None:
            made["normalTexture"] = {"index": normal.number}
        if value("useSpecularWorkflow", 0):
            self.warn("material", shader.GetPath(), "is shown without its specular colour")
        if value("clearcoat", 0.0) > 0:
            self.warn("material", shader.GetPath(), "is shown without its clear coat")
        if len(set(uvs)) > 1:
            self.warn("material", shader.GetPath(), "has pictures in several uv sets; all have that of the first")
        return uvs[0] if uvs else None

    def read_roughness(self, shader, metallic, roughness, pbr):
        pbr["metallicFactor"] = 1.0 if metallic else float(self.value_of(shader, "metallic", 0.0))
        pbr["roughnessFactor"] = 1.0 if roughness else float(self.value_of(shader, "roughness", 0.5))
        if metallic is None and roughness is None:
            return
        fits = all(t is None or t.channel == c for t, c in ((metallic, "b"), (roughness, "g")))
        if fits and metallic is not None and roughness is not None and metallic.number == roughness.number:
            pbr["metallicRoughnessTexture"] = {"index": metallic.number}
            return
        what = "has pictures of metalness or roughness that are not in one file; they are left out"
        self.warn("material", shader.GetPath(), what)
        pbr["metallicFactor"] = 0.0 if metallic else pbr["metallicFactor"]
        pbr["roughnessFactor"] = 0.5 if roughness else pbr["roughnessFactor"]

    def value_of(self, shader, name, default):
        attributes = shader.GetInput(name).GetValueProducingAttributes() if shader.GetInput(name) else []
        value = attributes[0].Get() if attributes else None
        return default if value is None else value

    def texture_of(self, shader, name, uvs):
        """The texture that feeds an input; None: there is none."""
        input = shader.GetInput(name)
        attributes = input.GetValueProducingAttributes() if input else []
        if not attributes:
            return None
        source = UsdShade.Shader(attributes[0].GetPrim())
        if not source or source.GetIdAttr().Get() != "UsdUVTexture":
            return None
        number = self.texture(source, uvs)
        if number is None:
            return None
        scale = self.value_of(source, "scale", Gf.Vec4f(1))
        return Texture(number, attributes[0].GetBaseName(), [scale[i] for i in range(4)])

    def texture(self, source, uvs):
        file = self.value_of(source, "file", None)
        path = file.resolvedPath if file else ""
        image = self.picture(path, file.path if file else "", source)
        if image is None:
            return None
        reader = self.source_of(source, "st")
        if reader and reader.GetIdAttr().Get() == "UsdTransform2d":
            self.warn("material", source.GetPath(), "is shown without the transform of its picture")
            reader = self.source_of(reader, "in")
        if reader and str(reader.GetIdAttr().Get()).startswith("UsdPrimvarReader"):
            uvs.append(str(self.value_of(reader, "varname", "st")))
        else:
            uvs.append("st")
        wraps = tuple(WRAPS.get(str(self.value_of(source, name, "black")), 10497) for name in ("wrapS", "wrapT"))
        key = (image, wraps)
        if key not in self.textures:
            sampler = self.gltf.add("samplers", {"wrapS": wraps[0], "wrapT": wraps[1]})
            self.textures[key] = self.gltf.add("textures", {"source": image, "sampler": sampler})
        return self.textures[key]

    def source_of(self, shader, name):
        input = shader.GetInput(name)
        attributes = input.GetValueProducingAttributes() if input else []
        return UsdShade.Shader(attributes[0].GetPrim()) if attributes else None

    def picture(self, path, written, source):
        if path not in self.pictures:
            self.pictures[path] = self.read_picture(path, written, source)
        return self.pictures[path]

    def read_picture(self, path, written, source):
        if not path:
            self.warn("picture", written, "is not there; the material's colour replaces it")
            return None
        file = os.path.realpath(Ar.SplitPackageRelativePathOuter(path)[0])
        if self.absent.is_outside(file):
            self.absent.pictures.add(file)
            return None
        # Opening a pipe would wait for its writer.
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path)) if os.path.isfile(file) else None
        if not asset:
            self.warn("picture", written, "cannot be opened; the material's colour replaces it")
            return None
        with asset:
            data = bytes(asset.GetBuffer()) if asset.GetSize() > 0 else b""
            if not data:
                self.warn("picture", written, "is empty; the material's colour replaces it")
                return None
            self.files.add(file)
        kind = "image/jpeg" if data[:2] == b"\xff\xd8" else "image/png"
        image = {"bufferView": self.gltf.view(data), "mimeType": kind, "name": os.path.basename(written)}
        return self.gltf.add("images", image)


class Texture:
    def __init__(self, number, channel, scale):
        self.number, self.channel, self.scale = number, channel, scale
