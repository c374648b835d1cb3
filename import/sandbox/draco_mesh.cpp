#include "import/sandbox/draco_mesh.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

namespace simvis {
namespace {

constexpr std::size_t kDracoHeadBytes = 2 * sizeof(std::uint64_t);  // number of vertices, number of indices

}  // namespace

std::size_t DracoAttribute::bytes() const {
  switch (component_type) {
    case 5120:
    case 5121:
      return components;
    case 5122:
    case 5123:
      return std::size_t{2} * components;
    case 5125:
    case 5126:
      return std::size_t{4} * components;
    default:
      return 0;
  }
}

std::string to_argument(const DracoAttribute& attribute) {
  return std::to_string(attribute.id) + ":" + std::to_string(attribute.component_type) + ":" +
         std::to_string(attribute.components);
}

bool parse_argument(const std::string& text, DracoAttribute& attribute) {
  return std::sscanf(text.c_str(), "%u:%d:%u", &attribute.id, &attribute.component_type, &attribute.components) == 3;
}

std::vector<std::uint8_t> pack_draco_mesh(const DracoMesh& mesh) {
  std::vector<std::uint8_t> bytes;
  const auto add = [&](const void* data, std::size_t size) {
    const auto* const first = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
  };
  const std::array<std::uint64_t, 2> head{mesh.vertices, mesh.indices.size()};
  add(head.data(), kDracoHeadBytes);
  add(mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
  for (const std::vector<std::uint8_t>& attribute : mesh.attributes) add(attribute.data(), attribute.size());
  return bytes;
}

bool unpack_draco_mesh(std::span<const std::uint8_t> bytes, std::span<const DracoAttribute> attributes,
                       DracoMesh& mesh) {
  std::array<std::uint64_t, 2> head{};
  if (bytes.size() < kDracoHeadBytes) return false;
  std::memcpy(head.data(), bytes.data(), kDracoHeadBytes);
  bytes = bytes.subspan(kDracoHeadBytes);
  const auto take = [&bytes](std::uint64_t count, std::size_t size, auto& values) {
    if (size == 0 || count > bytes.size() / size) return false;
    values.resize(count * size / sizeof(values[0]));
    if (count > 0) std::memcpy(values.data(), bytes.data(), count * size);
    bytes = bytes.subspan(count * size);
    return true;
  };
  mesh.vertices = head[0];
  if (!take(head[1], sizeof(std::uint32_t), mesh.indices)) return false;
  for (const DracoAttribute& attribute : attributes) {
    if (!take(mesh.vertices, attribute.bytes(), mesh.attributes.emplace_back())) return false;
  }
  return bytes.empty() && std::ranges::all_of(mesh.indices, [&](std::uint32_t i) { return i < mesh.vertices; });
}

}  // namespace simvis
