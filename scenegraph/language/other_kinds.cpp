#include "scenegraph/language/other_kinds.h"

#include <strings.h>

#include <string_view>

namespace simvis {
namespace {

struct OtherKind {
  const char* ending;
  std::string_view name, converter;
};
constexpr OtherKind kOtherKinds[] = {
    {".fbx", "FBX", "Blender converts {} to .glb"},
    {".blend", "Blender's own files", "Blender exports {} as .glb"},
    {".3ds", "3DS", "the program assimp converts {} to .obj: assimp export IN OUT"},
    {".x3d", "X3D", "Blender converts {} to .glb"},
    {".off", "OFF", "MeshLab converts {} to .ply"},
    {".laz", "LAZ", "the program laszip decompresses {} to .las"},
    {".e57", "E57", "CloudCompare converts {} to .pcd"},
    {".splat", "splats in .splat", "the program splat-transform of PlayCanvas converts {} to .ply"},
    {".ksplat", "splats in .ksplat", "the program splat-transform of PlayCanvas converts {} to .ply"},
    {".sog", "splats in .sog", "the program splat-transform of PlayCanvas converts {} to .ply"},
    {".3mf", "3MF", "the program assimp converts {} to .obj: assimp export IN OUT"},
    {".drc", "Draco", "the program draco_decoder converts {} to .ply: draco_decoder -i IN -o OUT"},
    {".xyz", "points in .xyz", "CloudCompare converts {} to .pcd"},
    {".pts", "points in .pts", "CloudCompare converts {} to .pcd"},
    {".step", "STEP", "FreeCAD converts {} to .stl or .glb"},
    {".stp", "STEP", "FreeCAD converts {} to .stl or .glb"},
    {".iges", "IGES", "FreeCAD converts {} to .stl or .glb"},
    {".igs", "IGES", "FreeCAD converts {} to .stl or .glb"},
    {".ifc", "IFC", "the program IfcConvert converts {} to .glb"},
    {".wbt", "worlds of Webots", "Webots exports {} as VRML 97, a .wrl"},
    {".proto", "PROTO files of Webots", "Webots exports worlds that have {} as VRML 97, a .wrl"},
};

}  // namespace

std::string converter_of(const std::filesystem::path& file) {
  for (const OtherKind& kind : kOtherKinds) {
    if (::strcasecmp(file.extension().c_str(), kind.ending) != 0) continue;
    std::string text(kind.converter);
    return "; " + text.replace(text.find("{}"), 2, kind.name);
  }
  return "";
}

}  // namespace simvis
