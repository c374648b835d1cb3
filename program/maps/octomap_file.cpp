#include "program/maps/octomap_file.h"

#include <optional>

#include <simvis/attributes.h>
#include <simvis/error.h>

namespace simvis {
namespace {

constexpr int kTreeDepth = 16, kRootCells = 1 << kTreeDepth, kHalfRoot = kRootCells / 2;
constexpr std::size_t kNodeBytes = 2;

class TreeWriter {
 public:
  explicit TreeWriter(const SceneCells& map) : map_(map), low_(map.first + kHalfRoot) {}

  std::string run() {
    // A map is smaller than the root, so that the root is never uniform unless all is unknown.
    nodes_ = 1;
    add_node(glm::ivec3(0), kRootCells);
    return "# Octomap OcTree binary file\n# (feel free to add / change comments, but leave the first line as it "
           "is!)\n#\n"
           "id OcTree\nsize " +
           std::to_string(nodes_) + "\nres " + format_number(map_.resolution_m) + "\ndata\n" + bytes_;
  }

 private:
  // Appends a node and what is below it. A uniform node is not appended, and its state is returned.
  std::optional<CellState> add(const glm::ivec3& low, int cells) {
    const glm::ivec3 first = low - low_, end = first + cells, size(map_.size);
    if (glm::any(glm::lessThanEqual(end, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(first, size))) {
      return CellState::unknown;
    }
    if (cells == 1) return map_.at(glm::uvec3(first));
    const std::size_t place = bytes_.size(), nodes = nodes_;
    const std::optional<CellState> state = add_node(low, cells);
    if (state) {
      bytes_.resize(place);
      nodes_ = nodes;
    }
    return state;
  }

  // Appends an inner node. Returns the state of all its children, if they are leaves of one state.
  std::optional<CellState> add_node(const glm::ivec3& low, int cells) {
    const std::size_t place = bytes_.size();
    bytes_.append(kNodeBytes, '\0');
    unsigned bits = 0;
    std::optional<CellState> all;
    bool is_uniform = true;
    for (unsigned child = 0; child < 8; ++child) {
      const glm::ivec3 half(child & 1, child >> 1 & 1, child >> 2 & 1);
      const std::optional<CellState> state = add(low + cells / 2 * half, cells / 2);
      bits |= bits_of(state) << (2 * child);
      nodes_ += state == CellState::unknown ? 0 : 1;
      if (child == 0) all = state;
      is_uniform = is_uniform && state && state == all;
    }
    bytes_[place] = static_cast<char>(bits & 0xff);
    bytes_[place + 1] = static_cast<char>(bits >> 8);
    return is_uniform ? all : std::nullopt;
  }

  static unsigned bits_of(const std::optional<CellState>& state) {
    if (!state) return 3;
    return *state == CellState::occupied ? 2 : *state == CellState::free ? 1 : 0;
  }

  const SceneCells& map_;
  glm::ivec3 low_;  // of the map, in cells from the lowest corner of the root
  std::string bytes_;
  std::size_t nodes_ = 0;
};

}  // namespace

std::string encode_octomap(const SceneCells& map) {
  const glm::ivec3 end = map.first + glm::ivec3(map.size);
  if (glm::any(glm::lessThan(map.first, glm::ivec3(-kHalfRoot))) ||
      glm::any(glm::greaterThan(end, glm::ivec3(kHalfRoot)))) {
    throw InputError("the map reaches farther than " + std::to_string(kHalfRoot) +
                     " cells from the origin, which an OctoMap cannot hold, expected larger cells or a smaller area");
  }
  return TreeWriter(map).run();
}

}  // namespace simvis
