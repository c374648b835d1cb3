// When and from where an image was taken, and the world at that time: what two images of one camera are compared by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/pose.h>
#include <simvis/sensor_needs.h>
#include <simvis/state_archive.h>
#include "sensors/camera/surface_layer.h"

namespace simvis {

/// Rows of an image that share one pose.
struct PosedRows {
  std::uint32_t first = 0, count = 0;
  glm::dmat4 world_from_view{1.0};  ///< rigid
  double share = 0;                 ///< their time, as a share of each item's move; at most 0

  void archive(StateArchive& state);
};

/// The scene of one frame, kept beyond it.
struct KeptScene {
  const DrawList& list;
  std::vector<std::uint32_t> shape;  ///< as in ItemIds
  std::vector<ItemMove> moves;       ///< ascending by item; empty if all rows are taken at the frame's time
};

/// Keeps scenes as rays see them that look for a layer. The memory of a scene that nothing refers to any more serves
/// the next one, for which only what has changed since is copied.
class SceneKeeper {
 public:
  explicit SceneKeeper(SurfaceLayer layer) : layer_(layer) {}

  /// `moves` are those for an image whose rows are taken before the frame's time.
  std::shared_ptr<const KeptScene> keep(const SensedScene& scene, std::span<const ItemMove> moves);

  /// Draw lists copied as a whole since it was made.
  std::uint64_t lists_copied() const;

 private:
  struct Kept {
    explicit Kept(SurfaceLayer layer) : list(layer) {}
    LayerList list;
    KeptScene scene{.list = list.list(), .shape = {}, .moves = {}};
  };
  SurfaceLayer layer_;
  std::vector<std::shared_ptr<Kept>> kept_;
};

struct CameraMoment {
  std::int64_t time_ns = 0;
  std::shared_ptr<const KeptScene> scene;
  std::vector<PosedRows> rows;  ///< of the whole image, from the top

  /// Where an item is when these rows are taken.
  glm::dmat4 world_from_mesh(std::size_t of_rows, std::uint32_t item) const;
  /// The items that are elsewhere than in the list when these rows are taken.
  std::vector<ItemPlace> places(std::size_t of_rows) const;
  /// The rows that have this height in the image, or are nearest to it.
  std::size_t rows_at(double y_px) const;

  /// The scene of a moment that is read is as rays meet it, see archive_surfaces(). `known` is a scene that the state
  /// has before, or null: it is not written again.
  void archive(StateArchive& state, const std::shared_ptr<const KeptScene>& known);
};

/// Searches the rows that meet a point: the point is at their height in the image when they are taken. Each step leaves
/// out the rows on one side of those that were tried, so the search ends.
class RowSearch {
 public:
  /// Begins with rows of the moment, which must outlive the search.
  RowSearch(const CameraMoment& moment, std::size_t rows) : moment_(moment), rows_(rows), end_(moment.rows.size()) {}

  /// In CameraMoment::rows.
  std::size_t rows() const { return rows_; }
  /// Takes the height of the point at the time of rows(), in pixels from the top. Returns whether rows() has changed
  /// and must be tried.
  bool next(double y_px);
  /// Returns whether rows() meet the point. If they do not when the search ends, the point passes between two rows.
  bool is_met() const { return is_met_; }

 private:
  const CameraMoment& moment_;
  std::size_t rows_, first_ = 0, end_;
  bool is_met_ = false;
};

/// The moment of a sensor's frame and of the one before, in which it was due.
class MomentHistory {
 public:
  /// A later frame, or the same one, which is then made again.
  void add(CameraMoment moment);
  const CameraMoment* now() const { return now_ ? &*now_ : nullptr; }
  const CameraMoment* before() const { return before_ ? &*before_ : nullptr; }

  /// The next frame is compared with now(), unless it makes the frame of now() again, which failed: before() is a part
  /// of the state only then. `beside` is the history of another eye of the same camera, which the state has before;
  /// null: there is none.
  void archive(StateArchive& state, const MomentHistory* beside);

 private:
  std::optional<CameraMoment> now_, before_;
};

}  // namespace simvis
