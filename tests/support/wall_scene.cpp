#include "tests/support/wall_scene.h"

#include <cstring>
#include <vector>

#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/temporary_folder.h"

namespace simvis {

std::string wall_gltf() {
  const float corners[] = {4, -10, -10, 4, -10, 10, 4, 10, 10, 4, 10, -10};
  const unsigned short indices[] = {0, 1, 2, 0, 2, 3};
  std::vector<unsigned char> bytes(sizeof corners + sizeof indices);
  std::memcpy(bytes.data(), corners, sizeof corners);
  std::memcpy(bytes.data() + sizeof corners, indices, sizeof indices);
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
    "materials": [{"doubleSided": true, "extensions": {"KHR_materials_unlit": {}},
                   "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1]}}],
    "extensionsUsed": ["KHR_materials_unlit"],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                   "min": [4, -10, -10], "max": [4, 10, 10]},
                  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64,)" +
         test::base64(bytes) + R"("}]})";
}

std::filesystem::path write_wall_scene(const std::filesystem::path& folder, std::string_view commands) {
  write_text(folder / "wall.gltf", wall_gltf());
  write_text(folder / "scene.xml",
             "<scene>\n" + std::string(kWallPart) + "\n" + std::string(commands) + "\n</scene>\n");
  return folder / "scene.xml";
}

}  // namespace simvis
