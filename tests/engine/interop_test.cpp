#include "shaders/interop.h"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdio>
#include <map>
#include <regex>
#include <string>
#include <type_traits>

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

// Output of glslangValidator about the blocks of a shader: "block.member" -> offset, "block" -> size of one element.
std::map<std::string, std::size_t> reflect(const std::string& shader, const std::string& definitions = "") {
  const std::string source = SIMVIS_SOURCE_DIR;
  const std::string command = "glslangValidator -q --reflect-all-block-variables --target-env vulkan1.2 -o /dev/null " +
                              definitions + " '-I" + source + "' '" + source + "/shaders/" + shader + "'";
  std::map<std::string, std::size_t> found;
  std::FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  char line[512];
  const std::regex member(R"((\w+(?:\.\w+)?): offset (-?\d+),.* size (\d+),.*)");
  std::cmatch match;
  while (std::fgets(line, sizeof line, pipe)) {
    if (!std::regex_search(line, match, member)) continue;
    const bool is_member = match[1].str().find('.') != std::string::npos;
    const std::string value = is_member ? match[2] : match[3];
    found[match[1]] = static_cast<std::size_t>(std::stol(value));
  }
  REQUIRE(pclose(pipe) == 0);
  return found;
}

std::size_t members_of(const std::map<std::string, std::size_t>& found, const std::string& block) {
  std::size_t count = 0;
  for (const auto& [name, offset] : found) count += name.rfind(block + ".", 0) == 0;
  return count;
}

#define CHECK_OFFSET(found, block, Type, member)                    \
  do {                                                              \
    CAPTURE(block "." #member);                                     \
    REQUIRE((found).count(block "." #member) == 1);                 \
    CHECK((found).at(block "." #member) == offsetof(Type, member)); \
  } while (false)

}  // namespace

static_assert(std::is_trivially_copyable_v<shader::Instance> && std::is_trivially_copyable_v<shader::MaterialBlock> &&
              std::is_trivially_copyable_v<shader::LightBlock> && std::is_trivially_copyable_v<shader::ViewBlock>);

TEST_CASE("the memory layout of structs is that of the vertex shaders") {
  const auto found = reflect("mesh_color.vert");
  CHECK_OFFSET(found, "materials", shader::MaterialBlock, base_color);
  CHECK_OFFSET(found, "materials", shader::MaterialBlock, emissive_cutoff);
  CHECK_OFFSET(found, "materials", shader::MaterialBlock, uv_row_u);
  CHECK_OFFSET(found, "materials", shader::MaterialBlock, uv_row_v);
  CHECK_OFFSET(found, "materials", shader::MaterialBlock, finish);
  CHECK(found.at("Materials") == sizeof(shader::MaterialBlock));
  CHECK(members_of(found, "materials") == 5);
  const auto mapped = reflect("mesh_color.vert", "-DMAPPED");
  CHECK_OFFSET(mapped, "map_places", shader::MapPlacesBlock, row_u);
  CHECK_OFFSET(mapped, "map_places", shader::MapPlacesBlock, row_v);
  CHECK(mapped.at("MapPlaces") == sizeof(shader::MapPlacesBlock));
  CHECK(members_of(mapped, "map_places") == 2);
  CHECK_OFFSET(found, "view", shader::ViewBlock, projection);
  CHECK_OFFSET(found, "view", shader::ViewBlock, ambient);
  CHECK_OFFSET(found, "view", shader::ViewBlock, airlight);
  CHECK(found.at("View") == sizeof(shader::ViewBlock));
}

TEST_CASE("the rows of a light are the texels that shaders fetch") {
  constexpr std::size_t kTexel = sizeof(glm::vec4);
  CHECK(offsetof(shader::LightBlock, position) == SIMVIS_LIGHT_POSITION * kTexel);
  CHECK(offsetof(shader::LightBlock, direction) == SIMVIS_LIGHT_DIRECTION * kTexel);
  CHECK(offsetof(shader::LightBlock, intensity) == SIMVIS_LIGHT_INTENSITY * kTexel);
  CHECK(offsetof(shader::LightBlock, shadow) == SIMVIS_LIGHT_SHADOW * kTexel);
  CHECK(sizeof(shader::LightBlock) == SIMVIS_LIGHT_ROWS * kTexel);
}

TEST_CASE("the memory layout of transparent layers is that of the shaders") {
  const auto found = reflect("layers_resolve.frag");
  CHECK_OFFSET(found, "nodes", shader::LayerNode, color);
  CHECK_OFFSET(found, "nodes", shader::LayerNode, place);
  CHECK(found.at("LayerNodes") == sizeof(shader::LayerNode));
  CHECK_OFFSET(found, "band", shader::LayerBand, rows);
  CHECK(found.at("LayerLists") == sizeof(shader::LayerBand) + sizeof(std::uint32_t));
}

TEST_CASE("the memory layout of structs is that of the fragment shaders") {
  const auto found = reflect("mesh_color.frag");
  CHECK_OFFSET(found, "view", shader::ViewBlock, ambient);
  CHECK_OFFSET(found, "view", shader::ViewBlock, lights);
  CHECK(found.at("View") == sizeof(shader::ViewBlock));
}

TEST_CASE("the memory layout of structs is that of the ray casting shader") {
  const auto found = reflect("ray_cast.comp");
  CHECK_OFFSET(found, "top_nodes", shader::TreeNode, low_first);
  CHECK_OFFSET(found, "top_nodes", shader::TreeNode, high_count);
  CHECK(found.at("TopNodes") == sizeof(shader::TreeNode));
  CHECK_OFFSET(found, "items", shader::GpuRayInstance, row_x);
  CHECK_OFFSET(found, "items", shader::GpuRayInstance, row_y);
  CHECK_OFFSET(found, "items", shader::GpuRayInstance, row_z);
  CHECK_OFFSET(found, "items", shader::GpuRayInstance, centre_high);
  CHECK_OFFSET(found, "items", shader::GpuRayInstance, centre_low);
  CHECK_OFFSET(found, "items", shader::GpuRayInstance, tree);
  CHECK(found.at("Items") == sizeof(shader::GpuRayInstance));
  CHECK_OFFSET(found, "triangles", shader::RayTriangle, a_primitive);
  CHECK_OFFSET(found, "triangles", shader::RayTriangle, b);
  CHECK_OFFSET(found, "triangles", shader::RayTriangle, c);
  CHECK(found.at("Triangles") == sizeof(shader::RayTriangle));
  CHECK_OFFSET(found, "candidates", shader::RayCandidates, count);
  CHECK_OFFSET(found, "candidates", shader::RayCandidates, complete_to_m);
  CHECK(found.at("Candidates") == sizeof(shader::RayCandidates));
  CHECK_OFFSET(found, "view", shader::RayCastBlock, sensor_high);
  CHECK_OFFSET(found, "view", shader::RayCastBlock, sensor_low);
  CHECK_OFFSET(found, "view", shader::RayCastBlock, rays);
  CHECK(found.at("View") == sizeof(shader::RayCastBlock));
}

TEST_CASE("the rows of a shadow map are the texels that shaders fetch") {
  constexpr std::size_t kTexel = sizeof(glm::vec4);
  CHECK(offsetof(shader::ShadowBlock, row_x) == 0 * kTexel);
  CHECK(offsetof(shader::ShadowBlock, row_y) == 1 * kTexel);
  CHECK(offsetof(shader::ShadowBlock, row_z) == 2 * kTexel);
  CHECK(offsetof(shader::ShadowBlock, projection) == 3 * kTexel);
  CHECK(offsetof(shader::ShadowBlock, depth) == 4 * kTexel);
  CHECK(offsetof(shader::ShadowBlock, place) == 5 * kTexel);
  CHECK(sizeof(shader::ShadowBlock) == SIMVIS_SHADOW_ROWS * kTexel);
}

TEST_SUITE_END();
