#include "import/programs/vertex_numbers.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace simvis {
namespace {

constexpr std::uint32_t kFree = ~0u;
constexpr std::size_t kMinSlots = 64;

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(VertexAttributes) == 11 * sizeof(float),
              "no padding, so that equal vertices have equal bytes");

// After each word the high bits, which hold most of the product's information, are mixed into the low bits.
std::uint32_t hash_of(const glm::vec3& position, const VertexAttributes& attributes) {
  std::uint64_t words[7];
  std::memcpy(words, &position, sizeof position);
  std::memcpy(reinterpret_cast<char*>(words) + sizeof position, &attributes, sizeof attributes);
  std::uint64_t hash = 0;
  for (const std::uint64_t word : words) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  }
  return static_cast<std::uint32_t>(hash);
}

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

std::uint32_t VertexNumbers::add(Mesh& mesh, const glm::vec3& position, const VertexAttributes& attributes) {
  if (2 * (mesh.positions.size() + 1) > slots_.size()) grow();
  const std::uint32_t hash = hash_of(position, attributes);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t at = hash & mask;; at = (at + 1) & mask) {
    Slot& slot = slots_[at];
    if (slot.number == kFree) {
      slot = {static_cast<std::uint32_t>(mesh.positions.size()), hash};
      mesh.positions.push_back(position);
      mesh.attributes.push_back(attributes);
      return slot.number;
    }
    if (slot.hash == hash && same_bits(mesh.positions[slot.number], position) &&
        same_bits(mesh.attributes[slot.number], attributes)) {
      return slot.number;
    }
  }
}

void VertexNumbers::grow() {
  const std::vector<Slot> old = std::move(slots_);
  slots_.assign(std::max(kMinSlots, 4 * old.size()), {kFree, 0});
  const std::size_t mask = slots_.size() - 1;
  for (const Slot& slot : old) {
    if (slot.number == kFree) continue;
    std::size_t at = slot.hash & mask;
    while (slots_[at].number != kFree) at = (at + 1) & mask;
    slots_[at] = slot;
  }
}

}  // namespace simvis
