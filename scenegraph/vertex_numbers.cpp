#include "scenegraph/vertex_numbers.h"

#include <algorithm>
#include <cstring>

namespace simvis {
namespace {

constexpr std::uint32_t kFree = ~0u;
constexpr std::size_t kLeastSlots = 64;

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(VertexAttributes) == 11 * sizeof(float),
              "no padding, so that equal vertices have equal bytes");

// The high bits, where products gather, come down after each word.
std::uint64_t hash_of(const glm::vec3& position, const VertexAttributes& attributes) {
  std::uint64_t words[7];
  std::memcpy(words, &position, sizeof position);
  std::memcpy(reinterpret_cast<char*>(words) + sizeof position, &attributes, sizeof attributes);
  std::uint64_t hash = 0;
  for (const std::uint64_t word : words) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  }
  return hash;
}

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

std::uint32_t VertexNumbers::add(Mesh& mesh, const glm::vec3& position, const VertexAttributes& attributes) {
  if (2 * (mesh.positions.size() + 1) > slots_.size()) grow(mesh);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t slot = hash_of(position, attributes) & mask;; slot = (slot + 1) & mask) {
    std::uint32_t& number = slots_[slot];
    if (number == kFree) {
      number = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(position);
      mesh.attributes.push_back(attributes);
      return number;
    }
    if (same_bits(mesh.positions[number], position) && same_bits(mesh.attributes[number], attributes)) return number;
  }
}

void VertexNumbers::grow(const Mesh& mesh) {
  slots_.assign(std::max(kLeastSlots, 2 * slots_.size()), kFree);
  const std::size_t mask = slots_.size() - 1;
  for (std::uint32_t number = 0; number < mesh.positions.size(); ++number) {
    std::size_t slot = hash_of(mesh.positions[number], mesh.attributes[number]) & mask;
    while (slots_[slot] != kFree) slot = (slot + 1) & mask;
    slots_[slot] = number;
  }
}

}  // namespace simvis
