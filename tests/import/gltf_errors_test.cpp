// One mistake at a time in an otherwise valid file, and the message of the importer about it.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <string>
#include <string_view>

#include <simvis/error.h>
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_fixture.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

struct Case {
  const char* what;  // a part of the message
  std::function<void(GltfBuilder&)> spoil;
};

// A textured, indexed triangle: accessor 0 POSITION, 1 TEXCOORD_0, 2 indices.
GltfBuilder good_file() {
  GltfBuilder builder;
  json& primitive = builder.primitive({{"POSITION", builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                                       {"TEXCOORD_0", builder.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1})}});
  primitive["indices"] = builder.accessor<std::uint16_t>("SCALAR", {0, 1, 2});
  primitive["material"] = 0;
  const ByteString picture = png(1, 1, 8, 6, {{1, 2, 3, 4}});
  builder.append("images", {{"bufferView", builder.view(picture.data(), picture.size())}});
  builder.append("samplers", json::object());
  builder.append("textures", {{"source", 0}, {"sampler", 0}});
  builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  return builder;
}

void check_refused(const std::filesystem::path& file, const std::string& what) {
  CAPTURE(what);
  ContentPool pool;
  std::string message = "(nothing)";
  try {
    import_part(file, pool);
  } catch (const InputError& e) {
    message = e.what();
  }
  CAPTURE(message);
  CHECK(message.starts_with(file.string() + ": error: "));
  CHECK(message.find(what) != std::string::npos);
}

void check_cases(std::initializer_list<Case> cases) {
  TemporaryFolder folder;
  for (const Case& c : cases) {
    GltfBuilder builder = good_file();
    c.spoil(builder);
    write_text(folder / "part.gltf", builder.text());
    check_refused(folder / "part.gltf", c.what);
  }
}

json& primitive_of(GltfBuilder& b) { return b.root["meshes"][0]["primitives"][0]; }
json& pbr_of(GltfBuilder& b) { return b.root["materials"][0]["pbrMetallicRoughness"]; }

// A builder whose buffer is described by hand.
void set_buffer(GltfBuilder& b, const char* uri) {
  b.root["buffers"] = {{{"byteLength", b.bytes.size()}, {"uri", uri}}};
}

}  // namespace

TEST_CASE("the base file without mistakes is valid") {
  TemporaryFolder folder;
  ContentPool pool;
  write_text(folder / "part.gltf", good_file().text());
  CHECK(load_unturned(folder / "part.gltf", pool).list.items.size() == 1);
}

TEST_CASE("JSON of the wrong type or range") {
  check_cases({
      {"asset lacks the required property \"version\"", [](GltfBuilder& b) { b.root["asset"].erase("version"); }},
      {"asset/version is \"1.0\"", [](GltfBuilder& b) { b.root["asset"]["version"] = "1.0"; }},
      {"is glTF of version 1, since its meshes have names; expected version 2",
       [](GltfBuilder& b) {
         b.root["meshes"] = json{{"plate", b.root["meshes"][0]}};
         b.root.erase("asset");
       }},
      {"asset/minVersion is \"2.1\"", [](GltfBuilder& b) { b.root["asset"]["minVersion"] = "2.1"; }},
      {"nodes must be an array", [](GltfBuilder& b) { b.root["nodes"] = 3; }},
      {"nodes/0 must be an object", [](GltfBuilder& b) { b.root["nodes"][0] = "x"; }},
      {"nodes/0/mesh is -1", [](GltfBuilder& b) { b.root["nodes"][0]["mesh"] = -1; }},
      {"nodes/0/mesh is 1, but the file has 1 meshes", [](GltfBuilder& b) { b.root["nodes"][0]["mesh"] = 1; }},
      {"nodes/0/mesh is 0.5; expected a whole", [](GltfBuilder& b) { b.root["nodes"][0]["mesh"] = 0.5; }},
      {"nodes/0/skin is 0, but the file has 0 skins", [](GltfBuilder& b) { b.root["nodes"][0]["skin"] = 0; }},
      {"nodes/0/translation has 2 values; expected 3",
       [](GltfBuilder& b) {
         b.root["nodes"][0]["translation"] = {1, 2};
       }},
      {"nodes/0/scale/1 must be a number",
       [](GltfBuilder& b) {
         b.root["nodes"][0]["scale"] = {1, "2", 3};
       }},
      {"nodes/0/extras/simvis/1 must be a string",
       [](GltfBuilder& b) {
         b.root["nodes"][0]["extras"]["simvis"] = {"<a/>", 7};
       }},
      {"nodes/0/extras/simvis_points/0 must be a string",
       [](GltfBuilder& b) { b.root["nodes"][0]["extras"]["simvis_points"] = json::array({7}); }},
      {"scene is 4", [](GltfBuilder& b) { b.root["scene"] = 4; }},
      {"meshes/0/primitives/0/mode is 7", [](GltfBuilder& b) { primitive_of(b)["mode"] = 7; }},
      {"primitives/0/attributes/POSITION is 99",
       [](GltfBuilder& b) { primitive_of(b)["attributes"]["POSITION"] = 99; }},
      {"accessors/0/count is 0", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 0; }},
      {"baseColorFactor/0 is 2",
       [](GltfBuilder& b) {
         pbr_of(b)["baseColorFactor"] = {2, 0, 0, 1};
       }},
      {"metallicFactor is 2", [](GltfBuilder& b) { pbr_of(b)["metallicFactor"] = 2; }},
      {"roughnessFactor is -1", [](GltfBuilder& b) { pbr_of(b)["roughnessFactor"] = -1; }},
      {"metallicRoughnessTexture/index is 3",
       [](GltfBuilder& b) { pbr_of(b)["metallicRoughnessTexture"]["index"] = 3; }},
      {"normalTexture/scale must be a number",
       [](GltfBuilder& b) {
         b.root["materials"][0]["normalTexture"] = {{"index", 0}, {"scale", "1"}};
       }},
      {"occlusionTexture/strength is 2",
       [](GltfBuilder& b) {
         b.root["materials"][0]["occlusionTexture"] = {{"index", 0}, {"strength", 2}};
       }},
      {"materials/0/doubleSided must be true or false",
       [](GltfBuilder& b) { b.root["materials"][0]["doubleSided"] = 1; }},
      {"materials/0/alphaMode is \"GLASS\"", [](GltfBuilder& b) { b.root["materials"][0]["alphaMode"] = "GLASS"; }},
      {"samplers/0 has the wrap mode 20000", [](GltfBuilder& b) { b.root["samplers"][0]["wrapS"] = 20000; }},
      {"samplers/0 has the minFilter 9800", [](GltfBuilder& b) { b.root["samplers"][0]["minFilter"] = 9800; }},
  });
}

TEST_CASE("inconsistent accessors, buffer views and buffers") {
  check_cases({
      {"reaches to byte 48 of bufferViews/0, which has 36",
       [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 4; }},
      {"reaches to byte 40", [](GltfBuilder& b) { b.root["accessors"][0]["byteOffset"] = 4; }},
      {"reaches to byte 1000000000000036", [](GltfBuilder& b) { b.root["accessors"][0]["byteOffset"] = 1e15; }},
      {"byteOffset is 1e+16", [](GltfBuilder& b) { b.root["accessors"][0]["byteOffset"] = 1e16; }},
      {"the buffer view's byteStride is 8", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 8; }},
      {"bufferViews/0/byteStride is 256", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 256; }},
      {"which ends at byte 1000000", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteLength"] = 1000000; }},
      {"elements; expected at most 1048576",
       [](GltfBuilder& b) {
         b.root["accessors"][0].erase("bufferView");
         b.root["accessors"][0]["count"] = 2000000000;
       }},
      {"(TEXCOORD_0) has 2 elements; expected 3", [](GltfBuilder& b) { b.root["accessors"][1]["count"] = 2; }},
      {"accessors/0 (POSITION) is of type VEC2; expected VEC3",
       [](GltfBuilder& b) { b.root["accessors"][0]["type"] = "VEC2"; }},
      {"(POSITION) holds UNSIGNED_SHORT; expected FLOAT, or KHR_mesh_quantization",
       [](GltfBuilder& b) { b.root["accessors"][0]["componentType"] = kUShort; }},
      {"(indices) holds SHORT", [](GltfBuilder& b) { b.root["accessors"][2]["componentType"] = kShort; }},
      {"componentType and normalized", [](GltfBuilder& b) { b.root["accessors"][0]["normalized"] = true; }},
      {"(indices) has the index 3 in element 1, but there are 3 vertices",
       [](GltfBuilder& b) {
         primitive_of(b)["indices"] = b.accessor<std::uint8_t>("SCALAR", {0, 3, 1});
       }},
      {"(POSITION) has a value that is not finite in element 1",
       [](GltfBuilder& b) {
         primitive_of(b)["attributes"]["POSITION"] = b.accessor<float>("VEC3", {0, 0, 0, 1, NAN, 0, 0, 0, 0});
       }},
      {"buffers/0 has 3 bytes; expected",
       [](GltfBuilder& b) { set_buffer(b, "data:application/octet-stream;base64,AAAA"); }},
  });
}

TEST_CASE("sparse accessors") {
  const auto sparse = [](std::vector<std::uint16_t> indices, int count) {
    return [indices, count](GltfBuilder& b) {
      const std::vector<float> values(12, 1.0f);
      b.root["accessors"][0]["sparse"] = {
          {"count", count},
          {"indices", {{"bufferView", b.view(indices.data(), indices.size() * 2)}, {"componentType", kUShort}}},
          {"values", {{"bufferView", b.view(values.data(), 48)}}}};
    };
  };
  check_cases({
      {"has the sparse index 1 after 1", sparse({1, 1}, 2)},
      {"has the sparse index 0 after 2", sparse({2, 0}, 2)},
      {"has the sparse index 3 after 0", sparse({0, 3}, 2)},
      {"replaces 4 elements of 3", sparse({0, 1, 2, 3}, 4)},
      {"reaches to byte 4 of", sparse({0}, 2)},
  });
}

TEST_CASE("URIs and data") {
  check_cases({
      {"buffers/0: ", [](GltfBuilder& b) { set_buffer(b, "missing.bin"); }},
      {"missing.bin: error: there is no such file", [](GltfBuilder& b) { set_buffer(b, "missing.bin"); }},
      {"is not a regular file", [](GltfBuilder& b) { set_buffer(b, "."); }},
      {"expected a relative path", [](GltfBuilder& b) { set_buffer(b, "/etc/hostname"); }},
      {"expected a relative path", [](GltfBuilder& b) { set_buffer(b, "%2Fetc/hostname"); }},
      {"expected a relative path", [](GltfBuilder& b) { set_buffer(b, "../part.bin"); }},
      {"expected a relative path", [](GltfBuilder& b) { set_buffer(b, "a/%2e%2e/../../part.bin"); }},
      {"expected a relative path", [](GltfBuilder& b) { set_buffer(b, "https://example.org/a.bin"); }},
      {"expected a relative path", [](GltfBuilder& b) { set_buffer(b, ""); }},
      {"malformed percent-encoding", [](GltfBuilder& b) { set_buffer(b, "a%2"); }},
      {"malformed percent-encoding", [](GltfBuilder& b) { set_buffer(b, "a%zz.bin"); }},
      {"has a zero byte in its URI", [](GltfBuilder& b) { set_buffer(b, "a%00.bin"); }},
      {"has a malformed data URI", [](GltfBuilder& b) { set_buffer(b, "data:application/octet-stream,AAAA"); }},
      {"is not base64", [](GltfBuilder& b) { set_buffer(b, "data:;base64,AA*A"); }},
      {"is not base64", [](GltfBuilder& b) { set_buffer(b, "data:;base64,A"); }},
      {"must have either uri or bufferView", [](GltfBuilder& b) { b.root["images"][0]["uri"] = "a.png"; }},
  });
}

TEST_CASE("pictures that are broken give warnings, and the colour takes their place") {
  const auto picture = [](ByteString bytes) {
    return [bytes](GltfBuilder& b) { b.root["images"][0]["bufferView"] = b.view(bytes.data(), bytes.size()); };
  };
  ByteString cut = png(4, 4, 8, 6, std::vector<ByteString>(4, ByteString(16, 9)));
  cut.resize(60);
  const std::initializer_list<Case> cases{
      {"images/0 is of no known kind", picture({'a', 'b', 'c', 0, 1, 0, 1, 0, 0, 0})},
      {"images/0 has a broken header", picture({0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n', 0, 0, 0, 0})},
      {"has 16385 x 1 pixels; expected at most 16384", picture(png(16385, 1, 8, 6, {{1}}))},
      {"claims 16384 x 16384 pixels but has only", picture(png(16384, 16384, 1, 0, {{1}}))},
      {"images/0 cannot be decoded", picture(cut)},
      {"images/0 cannot be decoded", picture(png(4, 4, 8, 6, {{1, 2, 3, 4}}))},
  };
  TemporaryFolder folder;
  for (const Case& c : cases) {
    GltfBuilder builder = good_file();
    c.spoil(builder);
    write_text(folder / "part.gltf", builder.text());
    ContentPool pool;
    const LoadedPart part = load_unturned(folder / "part.gltf", pool);
    CHECK(part.list.materials.at(0)->base_color_texture == nullptr);
    REQUIRE(part.content.warnings.size() == 1);
    CHECK(contains(part.content.warnings[0], c.what));
    CHECK(contains(part.content.warnings[0], "; the material's colour replaces it"));
  }
}

TEST_CASE("node trees and transforms") {
  check_cases({
      {"form a cycle",
       [](GltfBuilder& b) {
         b.append("nodes", {{"children", {2}}});
         b.append("nodes", {{"children", {1}}});
       }},
      {"form a cycle", [](GltfBuilder& b) { b.root["nodes"][0]["children"] = {0}; }},
      {"scenes/0 has nodes/0 twice",
       [](GltfBuilder& b) {
         b.root["scenes"] = {{{"nodes", {0, 0}}}};
       }},
      {"nodes/0/rotation is not a unit quaternion",
       [](GltfBuilder& b) {
         b.root["nodes"][0]["rotation"] = {0, 0, 0, 0};
       }},
      {"nodes/0 has both a matrix and",
       [](GltfBuilder& b) {
         b.root["nodes"][0]["scale"] = {1, 1, 1};
         b.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
       }},
      {"nodes/0/matrix is not affine",
       [](GltfBuilder& b) { b.root["nodes"][0]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }},
      {"nodes/0/mesh is -5, but the file has 1 meshes", [](GltfBuilder& b) { b.root["nodes"][0]["mesh"] = -5; }},
      {"nodes/0/translation/0 is 1e+39",
       [](GltfBuilder& b) {
         b.root["nodes"][0]["translation"] = {1e39, 0, 0};
       }},
      {"stands where nothing is finite",
       [](GltfBuilder& b) {
         for (int i = 0; i < 12; ++i) b.append("nodes", {{"children", {i}}, {"scale", {1e38, 1, 1}}});
       }},
  });
}

TEST_CASE("a node with two parents, or that is a root and a child, is shown once, with a warning") {
  const Case cases[] = {
      {"nodes/0 has two parents, nodes/1 and nodes/2; it is left out of the second",
       [](GltfBuilder& b) {
         b.append("nodes", {{"children", {0}}, {"translation", {1, 0, 0}}});
         b.append("nodes", {{"children", {0}}});
         b.root["scenes"] = {{{"nodes", {1, 2}}}};
       }},
      {"scenes/0 has the root nodes/0, which is a child of nodes/1; it is read as a child alone",
       [](GltfBuilder& b) {
         b.append("nodes", {{"children", {0}}, {"translation", {1, 0, 0}}});
         b.root["scenes"] = {{{"nodes", {0, 1}}}};
       }},
      {"scenes/0 has the root nodes/0, which is a child of nodes/1; it is read as a root alone",
       [](GltfBuilder& b) {
         b.append("nodes", {{"children", {0}}, {"translation", {1, 0, 0}}});
         b.root["scenes"] = {{{"nodes", {0}}}};
       }},
  };
  TemporaryFolder folder;
  for (const Case& c : cases) {
    CAPTURE(c.what);
    GltfBuilder builder = good_file();
    c.spoil(builder);
    write_text(folder / "part.gltf", builder.text());
    ContentPool pool;
    const LoadedPart part = load_unturned(folder / "part.gltf", pool);
    REQUIRE(part.list.items.size() == 1);
    const double x_m = part.list.world_from_node[part.list.items[0].transform][3].x;
    CHECK(x_m == (std::string_view(c.what).ends_with("as a root alone") ? 0 : 1));
    REQUIRE(part.content.warnings.size() == 1);
    CHECK(contains(part.content.warnings[0], c.what));
  }
}

TEST_CASE("lights, skins and morph targets") {
  const auto light = [](json description) {
    return [description](GltfBuilder& b) { b.root["extensions"]["KHR_lights_punctual"]["lights"] = {description}; };
  };
  check_cases({
      {"lights/0/type is \"sun\"", light({{"type", "sun"}})},
      {"lights/0/intensity is -1", light({{"type", "point"}, {"intensity", -1}})},
      {"Spot light description not found", light({{"type", "spot"}})},
      {"innerConeAngle that is not below",
       light({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}})},
      {"light is 0, but the file has 0 lights",
       [](GltfBuilder& b) { b.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; }},
      {"without JOINTS_0",
       [](GltfBuilder& b) {
         b.append("skins", {{"joints", {0}}});
         b.root["nodes"][0]["skin"] = 0;
       }},
      {"has the joint 9, but the skin has 1",
       [](GltfBuilder& b) {
         b.append("skins", {{"joints", {0}}});
         b.root["nodes"][0]["skin"] = 0;
         json& attributes = primitive_of(b)["attributes"];
         attributes["JOINTS_0"] = b.accessor<std::uint8_t>("VEC4", {9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
         attributes["WEIGHTS_0"] = b.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
       }},
      {"2 morph weights for a primitive of 1 targets",
       [](GltfBuilder& b) {
         primitive_of(b)["targets"] = {{{"POSITION", 0}}};
         b.root["meshes"][0]["weights"] = {1, 1};
       }},
  });
}

TEST_CASE("whole files: missing, empty, no JSON, broken .glb") {
  TemporaryFolder folder;
  check_refused(folder / "none.gltf", "there is no such file");
  std::filesystem::create_directory(folder / "folder.glb");
  check_refused(folder / "folder.glb", "is not a regular file");
  const auto refused = [&](const char* name, const ByteString& bytes, const char* what) {
    write_bytes(folder / name, bytes);
    check_refused(folder / name, what);
  };
  refused("part.gltf", {}, "is empty");
  refused("part.gltf", {'{'}, "is not valid JSON");
  refused("part.gltf", {'[', ']'}, "the document must be an object");
  refused("part.glb", {'{', '}'}, "does not begin with \"glTF\"");
  const ByteString good = good_file().glb();
  const auto changed = [&](std::size_t at, std::uint8_t value) {
    ByteString bytes = good;
    bytes[at] = value;
    return bytes;
  };
  refused("part.glb", ByteString(good.begin(), good.begin() + 8), "header is cut off");
  refused("part.glb", changed(4, 1), "is binary glTF of version 1");
  refused("part.glb", changed(11, 0x7F), "but the file has");
  refused("part.glb", changed(15, 0x7F), "chunk 0 of the .glb claims");
  refused("part.glb", changed(16, 'X'), "expected first one JSON chunk");
  refused("part.glb", ByteString(good.begin(), good.end() - 4), "but the file has");
}

TEST_SUITE_END();
