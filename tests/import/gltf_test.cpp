// Content of glTF parts: each expected value is written next to its bytes.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <simvis/error.h>
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_loader.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Values that were divided, multiplied or rotated in double and rounded once to float32: half a step relative to the
// largest value involved (all are at most 8 here).
constexpr float kFloatTolerance = 8 * 0x1p-24f;
// Products of a few matrices in double.
constexpr double kDoubleTolerance = 1e-14;

template <int N>
void check_near(const glm::vec<N, float>& seen, const glm::vec<N, float>& expected) {
  for (int i = 0; i < N; ++i) CHECK(std::abs(seen[i] - expected[i]) <= kFloatTolerance);
}

void check_near(const glm::dmat4& seen, const glm::dmat4& expected) {
  for (int i = 0; i < 16; ++i) CHECK(std::abs(seen[i / 4][i % 4] - expected[i / 4][i % 4]) <= kDoubleTolerance);
}

bool has_part(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

template <class T>
std::vector<std::uint32_t> indices_read(const std::vector<T>& indices) {
  GltfLoader loader;
  GltfBuilder builder;
  json& primitive = builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                                       {"NORMAL", builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1})}});
  primitive["indices"] = builder.accessor<T>("SCALAR", indices);
  return only_mesh(loader.load(builder)).indices;
}

template <class T>
glm::vec3 first_position(T x, bool normalized) {
  GltfLoader loader;
  GltfBuilder builder;
  builder.root["extensionsUsed"] = {"KHR_mesh_quantization"};
  const int plain = builder.accessor<T>("VEC3", {x, 1, 2, 0, 0, 0, 0, 0, 0}, normalized);
  builder.primitive({{"POSITION", plain}});
  return only_mesh(loader.load(builder)).positions[0];
}

}  // namespace

TEST_CASE("every index type is read, and meshes without indices") {
  const std::vector<std::uint32_t> expected{2, 0, 1};
  CHECK(indices_read<std::uint8_t>({2, 0, 1}) == expected);
  CHECK(indices_read<std::uint16_t>({2, 0, 1}) == expected);
  CHECK(indices_read<std::uint32_t>({2, 0, 1}) == expected);
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle();
  const LoadedPart part = loader.load(builder);
  CHECK(only_mesh(part).indices == std::vector<std::uint32_t>{0, 1, 2});
  CHECK(only_mesh(part).bounds_max == glm::vec3(1, 1, 0));
}

TEST_CASE("every component type of positions is read, normalised and not") {
  CHECK(first_position<float>(-2.5f, false).x == -2.5f);
  CHECK(first_position<std::int8_t>(-3, false) == glm::vec3(-3, 1, 2));
  CHECK(first_position<std::uint8_t>(200, false) == glm::vec3(200, 1, 2));
  CHECK(first_position<std::int16_t>(-300, false) == glm::vec3(-300, 1, 2));
  CHECK(first_position<std::uint16_t>(60000, false) == glm::vec3(60000, 1, 2));
  CHECK(first_position<std::int8_t>(-128, true).x == -1.0f);
  CHECK(first_position<std::int8_t>(127, true).x == 1.0f);
  CHECK(first_position<std::uint8_t>(51, true).x == static_cast<float>(51 / 255.0));
  CHECK(first_position<std::int16_t>(-32768, true).x == -1.0f);
  CHECK(first_position<std::int16_t>(100, true).x == static_cast<float>(100 / 32767.0));
  CHECK(first_position<std::uint16_t>(100, true).x == static_cast<float>(100 / 65535.0));
}

TEST_CASE("interleaved vertices are read by their stride") {
  GltfLoader loader;
  GltfBuilder builder;
  // Position and normal of three vertices, 24 bytes each.
  const std::vector<float> data{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0};
  const int view = builder.view(data.data(), data.size() * sizeof(float));
  builder.root["bufferViews"][view]["byteStride"] = 24;
  const auto accessor = [&](int offset) {
    return builder.append(
        "accessors",
        {{"bufferView", view}, {"byteOffset", offset}, {"componentType", kFloat}, {"count", 3}, {"type", "VEC3"}});
  };
  builder.primitive({{"POSITION", accessor(0)}, {"NORMAL", accessor(12)}});
  const LoadedPart part = loader.load(builder);
  CHECK(only_mesh(part).positions == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(only_mesh(part).attributes[0].normal == glm::vec3(0, 0, 1));
  CHECK(only_mesh(part).attributes[1].normal == glm::vec3(0, 1, 0));
  CHECK(only_mesh(part).attributes[2].normal == glm::vec3(1, 0, 0));
}

TEST_CASE("sparse accessors replace elements of a buffer view or of zeros") {
  for (const bool has_base : {true, false}) {
    CAPTURE(has_base);
    GltfLoader loader;
    GltfBuilder builder;
    json& primitive = builder.triangle();
    json& accessor = builder.root["accessors"][primitive["attributes"]["POSITION"].get<int>()];
    const std::vector<std::uint16_t> indices{0, 2};
    const std::vector<float> values{5, 6, 7, 8, 9, 10};
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", builder.view(indices.data(), 4)}, {"componentType", kUShort}}},
                          {"values", {{"bufferView", builder.view(values.data(), 24)}}}};
    if (!has_base) accessor.erase("bufferView");
    const LoadedPart part = loader.load(builder);
    const glm::vec3 kept = has_base ? glm::vec3(1, 0, 0) : glm::vec3(0);
    CHECK(only_mesh(part).positions == std::vector<glm::vec3>{{5, 6, 7}, kept, {8, 9, 10}});
  }
}

TEST_CASE("indices without a buffer view are zeros") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle()["indices"] =
      builder.append("accessors", {{"componentType", kUShort}, {"count", 3}, {"type", "SCALAR"}});
  const LoadedPart part = loader.load(builder);
  CHECK(only_mesh(part).positions == std::vector<glm::vec3>(3, glm::vec3(0)));
}

TEST_CASE("every mode becomes a list of triangles, lines or points") {
  struct Case {
    int mode;
    Topology topology;
    std::vector<std::uint32_t> expected;
  };
  // Five vertices; the orders are those of the glTF specification.
  const Case cases[] = {{0, Topology::points, {0, 1, 2, 3, 4}},
                        {1, Topology::lines, {0, 1, 2, 3}},
                        {2, Topology::lines, {0, 1, 1, 2, 2, 3, 3, 4, 4, 0}},
                        {3, Topology::lines, {0, 1, 1, 2, 2, 3, 3, 4}},
                        {4, Topology::triangles, {0, 1, 2}},
                        {5, Topology::triangles, {0, 1, 2, 1, 3, 2, 2, 3, 4}},
                        {6, Topology::triangles, {1, 2, 0, 2, 3, 0, 3, 4, 0}}};
  for (const Case& c : cases) {
    CAPTURE(c.mode);
    GltfLoader loader;
    GltfBuilder builder;
    const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
    const std::vector<float> normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    builder.primitive({{"POSITION", builder.accessor<float>("VEC3", positions)},
                       {"NORMAL", builder.accessor<float>("VEC3", normals)}})["mode"] = c.mode;
    const LoadedPart part = loader.load(builder);
    CHECK(only_mesh(part).topology == c.topology);
    CHECK(only_mesh(part).indices == c.expected);
    const bool is_cut = c.mode == 1 || c.mode == 4;
    CHECK(part.content.warnings.size() == (is_cut ? 1u : 0u));
  }
}

TEST_CASE("missing normals are flat: each triangle has its own vertices") {
  GltfLoader loader;
  GltfBuilder builder;
  // A fold: one triangle in the x-y plane, one in the x-z plane, along a shared edge.
  json& primitive =
      builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1})}});
  primitive["indices"] = builder.accessor<std::uint8_t>("SCALAR", {0, 1, 2, 0, 1, 3});
  const LoadedPart part = loader.load(builder);
  const Mesh& mesh = only_mesh(part);
  CHECK(mesh.positions.size() == 6);
  CHECK(mesh.indices == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  for (int i = 0; i < 3; ++i) CHECK(mesh.attributes[i].normal == glm::vec3(0, 0, 1));
  for (int i = 3; i < 6; ++i) CHECK(mesh.attributes[i].normal == glm::vec3(0, -1, 0));
}

TEST_CASE("normals are normalised, and those of length zero are reported") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                     {"NORMAL", builder.accessor<float>("VEC3", {0, 3, 4, 0, 0, 0, 0, 0, -2})}});
  const LoadedPart part = loader.load(builder);
  check_near<3>(only_mesh(part).attributes[0].normal, {0, 0.6f, 0.8f});
  CHECK(only_mesh(part).attributes[1].normal == glm::vec3(0, 0, 1));
  CHECK(only_mesh(part).attributes[2].normal == glm::vec3(0, 0, -1));
  REQUIRE(part.content.warnings.size() == 1);
  CHECK(has_part(part.content.warnings[0], "part.gltf: normals of length zero"));
}

TEST_CASE("points without a normal, or with one of length zero, have none") {
  for (const bool has_normals : {false, true}) {
    GltfLoader loader;
    GltfBuilder builder;
    json attributes = {{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0})}};
    if (has_normals) attributes["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 0, 0, 3, 4});
    builder.primitive(attributes)["mode"] = 0;
    const LoadedPart part = loader.load(builder);
    CHECK(only_mesh(part).attributes[0].normal == glm::vec3(0));
    const glm::vec3 expected = has_normals ? glm::vec3(0, 0.6f, 0.8f) : glm::vec3(0);
    CHECK(glm::distance(only_mesh(part).attributes[1].normal, expected) < 1e-7f);
    CHECK(part.content.warnings.empty());
  }
}

TEST_CASE("COLOR_0 comes in three types, with and without alpha") {
  const auto color = [](const std::function<int(GltfBuilder&)>& make) {
    GltfLoader loader;
    GltfBuilder builder;
    builder.triangle()["attributes"]["COLOR_0"] = make(builder);
    return only_mesh(loader.load(builder)).attributes[0].color;
  };
  CHECK(color([](GltfBuilder& b) {
          return b.accessor<float>("VEC3", {0.25f, 0.5f, 1, 0, 0, 0, 0, 0, 0});
        }) == glm::vec4(0.25f, 0.5f, 1, 1));
  CHECK(color([](GltfBuilder& b) {
          return b.accessor<float>("VEC4", {0.25f, 0.5f, 1, 0.75f, 0, 0, 0, 0, 0, 0, 0, 0});
        }) == glm::vec4(0.25f, 0.5f, 1, 0.75f));
  CHECK(color([](GltfBuilder& b) {
          return b.accessor<std::uint8_t>("VEC4", {255, 0, 51, 102, 0, 0, 0, 0, 0, 0, 0, 0}, true);
        }) == glm::vec4(1, 0, static_cast<float>(51 / 255.0), static_cast<float>(102 / 255.0)));
  CHECK(color([](GltfBuilder& b) {
          const int index = b.accessor<std::uint16_t>("VEC3", {65535, 0, 13107, 0, 0, 0, 0, 0, 0, 0, 0, 0}, true);
          b.root["accessors"][index]["count"] = 3;
          return index;
        }) == glm::vec4(1, 0, static_cast<float>(13107 / 65535.0), 1));
}

TEST_CASE("both sets of texture coordinates are read") {
  GltfLoader loader;
  GltfBuilder builder;
  json& attributes = builder.triangle()["attributes"];
  attributes["TEXCOORD_0"] = builder.accessor<float>("VEC2", {0.5f, -2, 0, 0, 0, 0});
  attributes["TEXCOORD_1"] = builder.accessor<std::uint16_t>("VEC2", {65535, 13107, 0, 0, 0, 0}, true);
  const LoadedPart part = loader.load(builder);
  CHECK(only_mesh(part).attributes[0].uv[0] == glm::vec2(0.5f, -2));
  CHECK(only_mesh(part).attributes[0].uv[1] == glm::vec2(1, static_cast<float>(13107 / 65535.0)));
}

TEST_CASE("nodes of a scene are placed by TRS, matrices and their parents") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle();  // node 0 shows mesh 0
  const double half = std::sqrt(0.5);
  builder.root["nodes"][0].update(
      {{"translation", {1, 2, 3}}, {"rotation", {0, 0, half, half}}, {"scale", {2, -3, 4}}});
  builder.append("nodes", {{"children", {0}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 1, 0, 10, 20, 30, 1}}});
  builder.append("nodes", {{"mesh", 0}});
  builder.root["scenes"] = {{{"nodes", {2}}}, {{"nodes", {1, 2}}}};
  builder.root["scene"] = 1;
  const LoadedPart part = loader.load(builder);
  REQUIRE(part.list.items.size() == 2);
  // A quarter turn about z takes x to y and y to -x, after scaling by (2, -3, 4). Then the parent shears x by z / 2.
  const glm::dmat4 local(0, 2, 0, 0, 3, 0, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1);
  const glm::dmat4 parent(1, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 1, 0, 10, 20, 30, 1);
  check_near(part.list.world_from_node[part.list.items[0].transform], parent * local);
  check_near(part.list.world_from_node[part.list.items[1].transform], glm::dmat4(1));
  CHECK(part.list.items[0].mesh == part.list.items[1].mesh);
}

TEST_CASE("without a default scene, scene 0 is read; without scenes, all roots") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle();
  builder.append("nodes", {{"mesh", 0}});
  builder.append("nodes", {{"children", {1}}});
  CHECK(loader.load(builder).list.items.size() == 2);
  builder.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {0, 2}}}};
  CHECK(loader.load(builder).list.items.size() == 1);
  builder.root["scene"] = 1;
  CHECK(loader.load(builder).list.items.size() == 2);
}

TEST_CASE("y up is rotated to z up unless the part says otherwise") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle();
  write_text(loader.folder / "part.GLTF", builder.text());
  const auto turn = [&](ImportRequest request) {
    request.file = loader.folder / "part.GLTF";
    const DrawList list = flatten(find_part_importer(request.file)(request, loader.pool));
    return glm::dvec3(list.world_from_node[list.items.at(0).transform] * glm::dvec4(1, 2, 3, 1));
  };
  CHECK(turn({{}, false, UpAxis::z}) == glm::dvec3(1, -3, 2));
  CHECK(turn({{}, true, UpAxis::y}) == glm::dvec3(1, -3, 2));
  CHECK(turn({{}, true, UpAxis::z}) == glm::dvec3(1, 2, 3));
}

TEST_CASE("lights shine along -z of their node, cameras become mounts, names are kept") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"},
       {"name", "LAMP"},
       {"color", {1, 0.5, 0.25}},
       {"intensity", 40},
       {"range", 7},
       {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
      {{"type", "point"}},
      {{"type", "directional"}}};
  for (int light = 0; light < 3; ++light) {
    builder.append("nodes",
                   {{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}, {"translation", {0, 0, 5}}});
  }
  builder.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
  builder.append("nodes", {{"camera", 0}, {"name", "EYE"}});
  const LoadedPart part = loader.load(builder);
  REQUIRE(part.list.lights.size() == 3);
  const Light& spot = part.list.lights[0].light;
  CHECK(spot.kind == LightKind::spot);
  CHECK(spot.color == glm::vec3(1, 0.5f, 0.25f));
  CHECK(spot.intensity == 40);
  CHECK(spot.range_m == 7);
  CHECK(spot.inner_cone_rad == 0.1);
  CHECK(spot.outer_cone_rad == 0.2);
  CHECK(spot.direction == glm::dvec3(0, 0, -1));
  CHECK(part.list.world_from_node[part.list.lights[0].transform][3] == glm::dvec4(0, 0, 5, 1));
  CHECK(part.list.lights[1].light.kind == LightKind::point);
  CHECK(part.list.lights[2].light.kind == LightKind::directional);
  CHECK(part.list.lights[2].light.intensity == 1);

  const auto& root = dynamic_cast<const Group&>(*part.content.root);
  const auto& camera_node = dynamic_cast<const Group&>(*root.children().at(3));
  CHECK(camera_node.name == "EYE");
  const auto mount = std::dynamic_pointer_cast<Mount>(camera_node.children().at(0));
  REQUIRE(mount != nullptr);
  CHECK(mount->name == "EYE");
}

TEST_CASE("nodes of glTF name insertion points in their frames") {
  GltfBuilder builder;
  builder.triangle();
  builder.append("nodes", {{"translation", {1, 2, 3}}, {"extras", {{"simvis_points", {"GRIPPER", "HAND"}}}}});
  const TemporaryFolder folder;
  write_text(folder / "a.gltf", builder.text());
  const BuiltScene built =
      build_scene(parse_commands("<part file='a.gltf' name='P' insert_at='ROOT'/>", "s.xml", folder.path()));
  for (const char* const name : {"GRIPPER", "HAND"}) {
    CAPTURE(name);
    REQUIRE(built.scene.has_insertion_point(name));
    // y is up in glTF: (1, 2, 3) is (1, -3, 2) here.
    CHECK(glm::dvec3(built.scene.world_from_point(name).value()[3]) == glm::dvec3(1, -3, 2));
  }
}

TEST_CASE("commands in extras.simvis are collected in the scene's order") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.append("nodes", {{"extras", {{"simvis", {"<a/>", "<b/>"}}, {"other", 1}}}, {"children", {1}}});
  builder.append("nodes", {{"extras", {{"simvis", "<c/>"}}}});
  builder.append("nodes", {{"extras", "anything"}});
  CHECK(loader.load(builder).content.commands == std::vector<std::string>{"<a/>", "<b/>", "<c/>"});
}

TEST_CASE("a .glb with an embedded buffer is read like a .gltf") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle();
  ByteString bytes = builder.glb();
  write_bytes(loader.folder / "part.glb", bytes);
  CHECK(load_unturned(loader.folder / "part.glb", loader.pool).list.items.size() == 1);
  bytes.push_back(0);
  write_bytes(loader.folder / "part.glb", bytes);
  CHECK(load_unturned(loader.folder / "part.glb", loader.pool).content.warnings.size() == 1);
}

TEST_CASE("external buffers: names with spaces, percent-encoded, in subfolders") {
  for (const char* uri : {"sub folder/my data.bin", "sub%20folder/my%20data.bin", "./x/../sub folder/my data.bin"}) {
    CAPTURE(uri);
    GltfLoader loader;
    GltfBuilder builder;
    builder.triangle();
    std::filesystem::create_directories(loader.folder / "sub folder");
    write_bytes(loader.folder / "sub folder/my data.bin", builder.bytes);
    builder.root["buffers"] = {{{"byteLength", builder.bytes.size()}, {"uri", uri}}};
    CHECK(only_mesh(loader.load(builder)).positions[1] == glm::vec3(1, 0, 0));
  }
}

TEST_CASE("skinned meshes are placed by their joints, regardless of their node") {
  GltfLoader loader;
  GltfBuilder builder;
  json& primitive = builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                                       {"NORMAL", builder.accessor<float>("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0})}});
  primitive["attributes"]["JOINTS_0"] = builder.accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
  primitive["attributes"]["WEIGHTS_0"] = builder.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0});
  const double half = std::sqrt(0.5);
  builder.root["nodes"][0].update({{"skin", 0}, {"translation", {100, 100, 100}}});
  builder.append("nodes", {{"translation", {0, 0, 2}}, {"children", {2}}});
  builder.append("nodes", {{"translation", {0, 0, 2}}, {"rotation", {0, 0, half, half}}});
  // Joint 1 binds at (0, 0, 1): its inverse bind matrix moves by -1 in z.
  const std::vector<float> inverse_bind{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0,  1,
                                        1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 1};
  builder.append("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", builder.accessor<float>("MAT4", inverse_bind)}});
  const LoadedPart part = loader.load(builder);
  const Mesh& mesh = only_mesh(part);
  check_near<3>(mesh.positions[0], {0, 0, 2});            // joint 0: up by 2
  check_near<3>(mesh.positions[1], {0, 1, 3});            // joint 1: down 1, a quarter turn, up 4
  check_near<3>(mesh.positions[2], {-0.5f, 0.5f, 2.5f});  // half of each
  check_near<3>(mesh.attributes[0].normal, {1, 0, 0});
  check_near<3>(mesh.attributes[1].normal, {0, 1, 0});
  CHECK(part.list.world_from_node[part.list.items[0].transform] == glm::dmat4(1));
  REQUIRE(part.content.warnings.size() == 1);
  CHECK(has_part(part.content.warnings[0], "skins are not animated"));
}

TEST_CASE("morph targets are applied with the mesh's weights, or the node's own") {
  GltfLoader loader;
  GltfBuilder builder;
  json& primitive = builder.triangle();
  primitive["targets"] = {{{"POSITION", builder.accessor<float>("VEC3", {1, 0, 0, 0, 0, 0, 0, 0, 0})}},
                          {{"POSITION", builder.accessor<float>("VEC3", {0, 0, 8, 0, 0, 0, 0, 0, 0})}}};
  builder.root["meshes"][0]["weights"] = {0.5, 0.25};
  builder.append("nodes", {{"mesh", 0}, {"weights", {0, 1}}});
  builder.append("nodes", {{"mesh", 0}});
  const LoadedPart part = loader.load(builder);
  REQUIRE(part.list.meshes.size() == 2);
  CHECK(part.list.meshes[0]->positions[0] == glm::vec3(0.5f, 0, 2));
  CHECK(part.list.meshes[1]->positions[0] == glm::vec3(0, 0, 8));
  CHECK(part.list.items[2].mesh == part.list.items[0].mesh);
  CHECK(part.content.warnings.size() == 1);
}

TEST_CASE("EXT_mesh_gpu_instancing draws one mesh many times") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.root["extensionsRequired"] = builder.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  builder.triangle();
  const json attributes{{"TRANSLATION", builder.accessor<float>("VEC3", {1, 2, 3, 4, 5, 6})},
                        {"SCALE", builder.accessor<float>("VEC3", {1, 1, 1, 2, 2, 2})}};
  builder.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  builder.root["nodes"][0]["translation"] = {10, 0, 0};
  const LoadedPart part = loader.load(builder);
  REQUIRE(part.list.items.size() == 2);
  CHECK(part.list.meshes.size() == 1);
  check_near(part.list.world_from_node[part.list.items[1].transform],
             glm::dmat4(2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 14, 5, 6, 1));
}

TEST_CASE("extensions: required ones must be supported, used ones are reported once") {
  GltfLoader loader;
  GltfBuilder builder;
  builder.root["extensionsUsed"] = {"EXT_some", "KHR_materials_unlit", "EXT_some"};
  const LoadedPart part = loader.load(builder);
  REQUIRE(part.content.warnings.size() == 1);
  CHECK(has_part(part.content.warnings[0], "EXT_some"));
  builder.root["extensionsRequired"] = {"KHR_meshopt_compression"};
  const std::string refusal = loader.refusal(builder.text());
  CHECK(has_part(refusal, "requires KHR_meshopt_compression"));
  CHECK(has_part(refusal, "save the file without compression"));
  builder.root["extensionsRequired"] = {"EXT_some", "KHR_texture_transform", "EXT_other"};
  CHECK(has_part(loader.refusal(builder.text()),
                 "part.gltf: error: requires extensions that are not supported: EXT_some, EXT_other;"));
}

TEST_CASE("a chain of 100,000 nodes is read and destroyed without recursion") {
  constexpr int kDepth = 100000;
  GltfLoader loader;
  GltfBuilder builder;
  builder.triangle();
  for (int i = 1; i < kDepth; ++i) builder.append("nodes", {{"children", {i - 1}}, {"translation", {0, 0, 1}}});
  const LoadedPart part = loader.load(builder);
  REQUIRE(part.list.items.size() == 1);
  CHECK(part.list.world_from_node[part.list.items[0].transform][3].z == kDepth - 1);
}

TEST_CASE("deeply nested JSON is read too") {
  GltfLoader loader;
  const std::string open(1000000, '['), close(1000000, ']');
  CHECK(loader.refusal(R"({"asset":{"version":"2.0"},"extras":)" + open + close + "}") == "");
  CHECK(has_part(loader.refusal(open), "not valid JSON"));
}

TEST_CASE("parts without shapes are accepted") {
  GltfLoader loader;
  GltfBuilder builder;
  const LoadedPart part = loader.load(builder);
  CHECK(part.list.items.empty());
  CHECK(part.content.warnings.empty());
}

TEST_CASE("known endings") {
  CHECK((find_part_importer("a/b.GlB") != nullptr));
  CHECK((find_part_importer("a/b.txt") == nullptr));
  CHECK((find_part_importer("gltf") == nullptr));
}

TEST_SUITE_END();
