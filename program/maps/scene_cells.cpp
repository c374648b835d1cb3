#include "program/maps/scene_cells.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <string>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "engine/base/assert.h"
#include "program/maps/cell_overlap.h"
#include "program/maps/placed_surfaces.h"

namespace simvis {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFarthestCell = 1 << 30;
constexpr double kSlack = 1e-6;  // of a cell: decimal limits of the command line count as multiples of its side

// A box that grows by others.
struct Bounds {
  glm::dvec3 low{kInfinity}, high{-kInfinity};

  void add(const CellBox& box) {
    low = glm::min(low, box.low);
    high = glm::max(high, box.high);
  }
};

class SceneMapper {
 public:
  SceneMapper(const DrawList& list, const std::vector<bool>& left_out, const MapDesc& desc)
      : list_(list), left_out_(left_out), desc_(desc) {}

  SceneCells run() {
    place_cells();
    const bool is_explored = desc_.start_m.has_value();
    map_.states.assign(std::size_t{map_.size.x} * map_.size.y * map_.size.z,
                       is_explored ? CellState::unknown : CellState::free);
    const CellFrame frame{.origin_m = map_.origin_m, .cell_m = map_.cell_m, .size = map_.size};
    for_each_surface(frame, [&](const auto& surface, const CellBox& around) {
      const glm::dvec3 end(map_.size);
      const glm::ivec3 low(glm::clamp(glm::floor(around.low), glm::dvec3(0), end)),
          high(glm::clamp(glm::ceil(around.high), glm::dvec3(0), end));
      occupy(surface, low, high);
    });
    if (is_explored) explore();
    return std::move(map_);
  }

 private:
  template <typename Action>
  void for_each_surface(const CellFrame& frame, const Action& action) const {
    for (std::size_t i = 0; i < list_.items.size(); ++i) {
      if (!left_out_.empty() && left_out_[i]) continue;
      for_each_placed_surface(list_, list_.items[i], frame, action);
    }
  }

  // The cells of all shapes that have an end.
  Bounds bounds() const {
    Bounds bounds;
    const CellFrame world{.cell_m = glm::dvec3(desc_.resolution_m)};
    for_each_surface(world, [&](const auto& /*surface*/, const CellBox& around) { bounds.add(around); });
    return bounds;
  }

  void place_cells() {
    Bounds cells;
    if (!desc_.area_m || !desc_.heights_m) cells = bounds();
    const double side_m = desc_.resolution_m;
    if (desc_.area_m) {
      cells.low = {desc_.area_m->low / side_m + kSlack, cells.low.z};
      cells.high = {desc_.area_m->high / side_m - kSlack, cells.high.z};
    }
    if (desc_.heights_m) {
      cells.low.z = desc_.heights_m->x / side_m + kSlack;
      cells.high.z = desc_.heights_m->y / side_m - kSlack;
    }
    if (std::isinf(cells.low.x) || std::isinf(cells.low.z)) {
      throw InputError("the scene has no shape that has an end, expected some, or a given area");
    }
    const glm::dvec3 low = glm::floor(cells.low);
    set_size(low, glm::max(glm::ceil(cells.high), low + 1.0));
  }

  void set_size(glm::dvec3 low, glm::dvec3 high) {
    if (desc_.is_flat) {
      low.z = 0;
      high.z = 1;
    }
    const glm::dvec3 size = high - low, farthest = glm::max(glm::abs(low), glm::abs(high));
    const bool is_far = !glm::all(glm::lessThanEqual(farthest, glm::dvec3(kFarthestCell)));
    if (is_far || size.x * size.y * size.z > static_cast<double>(kMaxMapCells)) {
      throw InputError("the map would have " + format_number(size.x) + " x " + format_number(size.y) +
                       (desc_.is_flat ? "" : " x " + format_number(size.z)) + " cells of " +
                       format_number(desc_.resolution_m) + " m from " + format_number(low.x * desc_.resolution_m) +
                       ", " + format_number(low.y * desc_.resolution_m) + " on, expected at most " +
                       std::to_string(kMaxMapCells) + " cells: larger ones, or a smaller area");
    }
    map_.resolution_m = desc_.resolution_m;
    map_.first = glm::ivec3(low);
    map_.size = glm::uvec3(size);
    map_.origin_m = low * desc_.resolution_m;
    map_.cell_m = glm::dvec3(desc_.resolution_m);
    if (!desc_.is_flat) return;
    map_.origin_m.z = desc_.heights_m->x;
    map_.cell_m.z = desc_.heights_m->y - desc_.heights_m->x;
  }

  // Occupies the cells of a block through which the surface passes, by halves of the block.
  template <typename Surface>
  void occupy(const Surface& surface, const glm::ivec3& low, const glm::ivec3& high) {
    const glm::ivec3 size = high - low;
    if (std::min({size.x, size.y, size.z}) <= 0) return;
    const bool is_cell = size == glm::ivec3(1);
    if (is_cell && map_.at(glm::uvec3(low)) == CellState::occupied) return;
    if (!overlaps(surface, CellBox{glm::dvec3(low), glm::dvec3(high)})) return;
    if (is_cell) {
      map_.states[map_.index(glm::uvec3(low))] = CellState::occupied;
      return;
    }
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    glm::ivec3 end_of_first = high, begin_of_second = low;
    end_of_first[axis] = begin_of_second[axis] = low[axis] + size[axis] / 2;
    occupy(surface, low, end_of_first);
    occupy(surface, begin_of_second, high);
  }

  // The start's cell.
  glm::ivec3 start() const {
    glm::dvec3 cell = glm::floor((*desc_.start_m - map_.origin_m) / map_.cell_m);
    if (desc_.is_flat) cell.z = 0;
    const bool is_within =
        glm::all(glm::greaterThanEqual(cell, glm::dvec3(0))) && glm::all(glm::lessThan(cell, glm::dvec3(map_.size)));
    const std::string where = format_number(desc_.start_m->x) + ", " + format_number(desc_.start_m->y);
    if (!is_within) throw InputError("the start " + where + " lies outside of the map, expected a place within it");
    if (map_.at(glm::uvec3(cell)) == CellState::occupied) {
      throw InputError("the start " + where + " lies in an occupied cell, expected a free one");
    }
    return glm::ivec3(cell);
  }

  void explore() {
    std::deque<glm::ivec3> reached{start()};  // breadth first, so that it holds only the front of the search
    map_.states[map_.index(glm::uvec3(reached.front()))] = CellState::free;
    while (!reached.empty()) {
      const glm::ivec3 cell = reached.front();
      reached.pop_front();
      for (int axis = 0; axis < 3; ++axis) {
        for (const int way : {-1, 1}) {
          glm::ivec3 beside = cell;
          beside[axis] += way;
          if (beside[axis] < 0 || beside[axis] >= static_cast<int>(map_.size[axis])) continue;
          CellState& state = map_.states[map_.index(glm::uvec3(beside))];
          if (state != CellState::unknown) continue;
          state = CellState::free;
          reached.push_back(beside);
        }
      }
    }
  }

  const DrawList& list_;
  const std::vector<bool>& left_out_;
  const MapDesc& desc_;
  SceneCells map_;
};

}  // namespace

SceneCells map_scene(const DrawList& list, const std::vector<bool>& left_out, const MapDesc& desc) {
  SIMVIS_ASSERT(desc.resolution_m > 0 && (!desc.is_flat || desc.heights_m));
  SIMVIS_ASSERT(left_out.empty() || left_out.size() == list.items.size());
  return SceneMapper(list, left_out, desc).run();
}

}  // namespace simvis
