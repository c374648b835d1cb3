#include "bench/scenes/glb_file.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace simvis::bench {

namespace {

using Json = nlohmann::json;

// glTF 2.0, sections 3.6.2.2 (component types) and 4.4 (binary files).
constexpr int kGlFloat = 5126, kGlUnsignedInt = 5125;
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr std::size_t kAlignment = 4, kHeader = 12, kChunkHeader = 8;

std::size_t add_accessor(GlbDocument& document, std::size_t view, int component, const char* type, std::size_t count) {
  document.json["accessors"].push_back(
      {{"bufferView", view}, {"componentType", component}, {"type", type}, {"count", count}});
  return document.json["accessors"].size() - 1;
}

Json primitive_of(GlbDocument& document, const Mesh& mesh) {
  std::vector<glm::vec3> normals;
  for (const VertexAttributes& vertex : mesh.attributes) normals.push_back(vertex.normal);
  glm::vec3 low = mesh.positions.front(), high = low;
  for (const glm::vec3& p : mesh.positions) {
    low = min(low, p);
    high = max(high, p);
  }
  const auto vectors = [&](const std::vector<glm::vec3>& values) {
    const std::size_t view = document.add_view(values.data(), values.size() * sizeof(glm::vec3));
    return add_accessor(document, view, kGlFloat, "VEC3", values.size());
  };
  const std::size_t positions = vectors(mesh.positions);
  document.json["accessors"][positions]["min"] = {low.x, low.y, low.z};
  document.json["accessors"][positions]["max"] = {high.x, high.y, high.z};
  const std::size_t view = document.add_view(mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
  return {{"attributes", {{"POSITION", positions}, {"NORMAL", vectors(normals)}}},
          {"indices", add_accessor(document, view, kGlUnsignedInt, "SCALAR", mesh.indices.size())},
          {"material", 0}};
}

void put(std::ofstream& out, std::uint32_t value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); }

std::uint32_t word_at(const std::string& bytes, std::size_t place) {
  std::uint32_t value = 0;
  if (place + sizeof value > bytes.size()) throw std::runtime_error("a .glb file ends too early");
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

}  // namespace

std::size_t GlbDocument::add_view(const void* bytes, std::size_t size) {
  buffer.resize((buffer.size() + kAlignment - 1) / kAlignment * kAlignment);
  json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", size}});
  buffer.append(static_cast<const char*>(bytes), size);
  return json["bufferViews"].size() - 1;
}

void write_glb(const std::filesystem::path& file, std::span<const Mesh> meshes, std::span<const PlacedMesh> placed) {
  GlbDocument document;
  document.json = {{"asset", {{"version", "2.0"}}},
                   {"scene", 0},
                   {"materials", {{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}}}},
                   {"buffers", {{{"byteLength", 0}}}}};
  for (const Mesh& mesh : meshes) {
    document.json["meshes"].push_back({{"primitives", Json::array({primitive_of(document, mesh)})}});
  }
  Json roots = Json::array();
  for (const PlacedMesh& item : placed) {
    roots.push_back(roots.size());
    document.json["nodes"].push_back({{"mesh", item.mesh},
                                      {"translation", {item.position_m.x, item.position_m.y, item.position_m.z}},
                                      {"rotation", {item.turn.x, item.turn.y, item.turn.z, item.turn.w}}});
  }
  document.json["scenes"] = Json::array({{{"nodes", roots}}});
  write_glb(file, std::move(document));
}

GlbDocument read_glb(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (word_at(bytes, 0) != kMagic) throw std::runtime_error(file.string() + " is no .glb file");
  const std::size_t json = kHeader + kChunkHeader, json_size = word_at(bytes, kHeader);
  const std::size_t bin = json + json_size + kChunkHeader;
  const std::size_t bin_size = word_at(bytes, json + json_size);
  return {Json::parse(bytes.substr(json, json_size)), bytes.substr(bin, bin_size)};
}

void write_glb(const std::filesystem::path& file, GlbDocument document) {
  document.buffer.resize((document.buffer.size() + kAlignment - 1) / kAlignment * kAlignment);
  document.json["buffers"][0]["byteLength"] = document.buffer.size();
  std::string json = document.json.dump();
  json.resize((json.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
  std::ofstream out(file, std::ios::binary);
  put(out, kMagic);
  put(out, kVersion);
  put(out, static_cast<std::uint32_t>(kHeader + 2 * kChunkHeader + json.size() + document.buffer.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  put(out, kJsonChunk);
  out << json;
  put(out, static_cast<std::uint32_t>(document.buffer.size()));
  put(out, kBinChunk);
  out << document.buffer;
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace simvis::bench
