// Imports binary trees of OctoMap (.bt): occupied leaves become walls. The format is that of OctoMap 1.9, files
// AbstractOcTree.cpp, AbstractOccupancyOcTree.cpp and OccupancyOcTreeBase.hxx.
//
// A header of lines, the last of which is "data", and then the tree: two bytes for each inner node, the node in front
// of its children. Child i, whose bits 0, 1 and 2 are the halves along x, y and z, has the bits 2 i and 2 i + 1 of
// these bytes, a number: 0 unknown, 1 free, 2 occupied, 3 an inner node. The root is a cube of 2^16 cells on a side
// around the origin.
#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include <simvis/part_importer.h>
#include "engine/base/input_file.h"
#include "engine/base/words.h"
#include "import/grid_map/grid_part.h"

namespace simvis {
namespace {

constexpr int kTreeDepth = 16;
constexpr std::uint32_t kRootCells = 1u << kTreeDepth, kHalfRoot = kRootCells / 2;

// An occupied cube, in cells from the lowest corner of the root.
struct Leaf {
  glm::uvec3 low{0};
  std::uint32_t cells = 0;  // on a side
};

class OctreeFile {
 public:
  explicit OctreeFile(const std::filesystem::path& file) : file_(file), bytes_(read_whole_file(file)) {
    read_header();
    if (nodes_ > 0) {
      found_nodes_ = 1;
      read_node({0, 0, 0}, kRootCells);
    }
    if (found_nodes_ != nodes_) {
      fail(size_line_, "says that the tree has " + std::to_string(nodes_) + " nodes, but it has " +
                           std::to_string(found_nodes_) + ", expected a whole file");
    }
    if (at_ < bytes_.size()) warn("has " + std::to_string(bytes_.size() - at_) + " bytes behind the tree, left out");
  }

  double cell_m() const { return cell_m_; }
  const std::vector<Leaf>& occupied() const { return occupied_; }
  std::vector<std::string> take_warnings() { return std::move(warnings_); }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    fail_at({.file = file_.string(), .line = line, .column = line > 0 ? 1 : 0}, what);
  }

  void warn(const std::string& what) { warnings_.push_back(file_.string() + ": " + what); }

  void read_header() {
    const std::string_view text(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    if (!text.starts_with("# Octomap OcTree binary file")) {
      fail(1, text.starts_with("# Octomap OcTree file")
                  ? "is a tree with probabilities (.ot), expected a binary one (.bt), which convert_octree writes"
                  : "does not begin with \"# Octomap OcTree binary file\", expected a binary tree of OctoMap");
    }
    for (int line = 1; at_ < bytes_.size(); ++line) {
      const std::size_t end = std::min(text.find('\n', at_), text.size());
      const std::vector<std::string_view> words = words_of(text.substr(at_, end - at_));
      at_ = std::min(end + 1, text.size());
      if (words.empty() || words[0].starts_with('#')) continue;
      if (words[0] == "data") return require_header(line);
      read_row(words[0], words.size() > 1 ? words[1] : "", line);
    }
    fail(0, "has no line \"data\", expected the tree behind it");
  }

  void read_row(std::string_view key, std::string_view value, int line) {
    if (key == "res") {
      const bool is_size = parse_number(value, cell_m_) && cell_m_ >= kMinCell_m && cell_m_ <= kMaxCell_m;
      if (!is_size) fail(line, "res " + in_quotes(value) + " is not allowed, expected metres from 1e-06 to 1000000");
    } else if (key == "size") {
      const std::optional<std::uint64_t> nodes = as_number<std::uint64_t>(value);
      if (!nodes) fail(line, "size " + in_quotes(value) + " is not allowed, expected the number of nodes");
      nodes_ = *nodes;
      size_line_ = line;
    } else if (key != "id") {
      warn("line " + std::to_string(line) + ": " + in_quotes(key) + " is not known, the line is left out");
    }
  }

  void require_header(int line) const {
    if (cell_m_ == 0) fail(line, "comes without a line \"res\", expected the size of a cell above it");
    if (size_line_ == 0) fail(line, "comes without a line \"size\", expected the number of nodes above it");
  }

  // `cells` is a side of the node, at least 2.
  void read_node(const glm::uvec3& low, std::uint32_t cells) {
    if (bytes_.size() - at_ < 2) fail(0, "ends within the tree, expected more nodes");
    const unsigned bits = bytes_[at_] | unsigned{bytes_[at_ + 1]} << 8;
    at_ += 2;
    const std::uint32_t half = cells / 2;
    std::array<bool, 8> is_inner{};
    const auto low_of = [&](unsigned child) {
      return low + half * glm::uvec3(child & 1, child >> 1 & 1, child >> 2 & 1);
    };
    for (unsigned child = 0; child < 8; ++child) {
      const unsigned kind = bits >> (2 * child) & 3;
      if (kind == 0) continue;
      ++found_nodes_;
      if (kind == 2) occupied_.push_back({low_of(child), half});
      is_inner[child] = kind == 3;
    }
    for (unsigned child = 0; child < 8; ++child) {
      if (!is_inner[child]) continue;
      if (half == 1) fail(0, "has a node below depth 16, expected a tree of OctoMap");
      read_node(low_of(child), half);
    }
  }

  std::filesystem::path file_;
  Bytes bytes_;
  std::size_t at_ = 0;
  double cell_m_ = 0;
  std::uint64_t nodes_ = 0, found_nodes_ = 0;
  int size_line_ = 0;
  std::vector<Leaf> occupied_;
  std::vector<std::string> warnings_;
};

PlacedGrid grid_of(const OctreeFile& tree, const std::filesystem::path& file) {
  glm::uvec3 low(kRootCells), high(0);
  for (const Leaf& leaf : tree.occupied()) {
    low = glm::min(low, leaf.low);
    high = glm::max(high, leaf.low + leaf.cells);
  }
  if (tree.occupied().empty()) low = high;
  check_grid_size(file, "its occupied cells span", high - low);
  CellGrid grid(high - low);
  for (const Leaf& leaf : tree.occupied()) {
    const glm::uvec3 first = leaf.low - low, end = first + leaf.cells;
    for (std::uint32_t z = first.z; z < end.z; ++z) {
      for (std::uint32_t y = first.y; y < end.y; ++y) {
        for (std::uint32_t x = first.x; x < end.x; ++x) grid.occupy({x, y, z});
      }
    }
  }
  const glm::dvec3 corner_m = (glm::dvec3(low) - double{kHalfRoot}) * tree.cell_m();
  return {std::move(grid), glm::dvec3(tree.cell_m()), 1, glm::translate(glm::dmat4(1), corner_m)};
}

PartContent import_octomap(const ImportRequest& request, ContentPool& pool) {
  OctreeFile tree(request.file);
  PartContent content = grid_part(request.file, grid_of(tree, request.file), pool);
  content.warnings = tree.take_warnings();
  return content;
}

const PartImporterRegistration octomap_registration({".bt"}, import_octomap);

}  // namespace
}  // namespace simvis
