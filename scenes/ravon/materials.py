"""The materials of the outdoor scene. Leaves and grass stand twice, once for each side, so that both sides keep the
normals that make a crown look round; so their materials are single-sided."""
import pictures
from gltf_writer import MaskedMaterial, Material

# Below one half, because the smaller pictures of a texture with fine gaps are less opaque than the largest.
CUTOFF = 0.36

TURF = Material("turf", texture=pictures.turf())
FRINGE = MaskedMaterial("turf's edge", texture=TURF.texture)
EARTH = Material("earth", texture=pictures.earth())
STONE = Material("stone", texture=pictures.stone())
BARK = Material("bark", texture=pictures.bark())
BIRCH_BARK = Material("birch bark", texture=pictures.birch_bark())
SPRUCE_BARK = Material("spruce bark", texture=pictures.spruce_bark())

BEECH = MaskedMaterial("beech leaves", cutoff=CUTOFF, texture=pictures.twig(
    "beech leaves", 21, pictures.BEECH,
    (["#16240d", "#2f4a18", "#4d6f26", "#74953a", "#a3bd5c"], ["#26300f", "#4f5f1c", "#7d8a30", "#a9ad4d", "#c8c873"]),
    66, 0.60, 620, "#4a6826"))
BIRCH = MaskedMaterial("birch leaves", cutoff=CUTOFF, texture=pictures.twig(
    "birch leaves", 22, pictures.BIRCH,
    (["#1c2b10", "#3a561c", "#5f812c", "#8ba845", "#b9cd6d"], ["#333a12", "#686f22", "#9b9c3b", "#c4be5c", "#ddd889"]),
    54, 0.68, 700, "#5f7f31"))
HAZEL = MaskedMaterial("hazel leaves", cutoff=CUTOFF, texture=pictures.twig(
    "hazel leaves", 24, pictures.OVAL,
    (["#13220f", "#28431c", "#42652a", "#658a40", "#95b264"], ["#1f2c12", "#405020", "#66773a", "#8f9c58", "#b9c17d"]),
    70, 0.74, 560, "#3f5f2a"))
NEEDLES = MaskedMaterial("needles", cutoff=CUTOFF, texture=pictures.needles())
GRASS = MaskedMaterial("grass", cutoff=CUTOFF, texture=pictures.green_grass())
DRY_GRASS = MaskedMaterial("dry grass", cutoff=CUTOFF, texture=pictures.dry_grass())
FLOWERS = MaskedMaterial("flowers", cutoff=CUTOFF, texture=pictures.flowers())
FOREST = MaskedMaterial("far forest", cutoff=CUTOFF, texture=pictures.forest())
CLOUD = Material("cloud", texture=pictures.cloud(), blend=True, unlit=True)
