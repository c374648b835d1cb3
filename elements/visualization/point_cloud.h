// The element `point_cloud`: shows points from a file, or the points that a scanner's beams hit.
//
//   <element type="point_cloud" name="MAP" insert_at="ROOT" file="points.csv"/>
//   <element type="point_cloud" name="HITS" insert_at="ROOT" scanner="TILT_SCANNER" keep="50"/>
//
// Only cameras with view="visualization" see it.
// Frames   the points of a file are in the frame of the insertion point; see point_file.h for the format. The points of
//          a scan stay at their world positions, and the insertion point has no effect on them.
// Parameters  count, size (m), keep, red green blue (linear), all live.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/state_archive.h>
#include "elements/visualization/marker_mesh.h"
#include "elements/visualization/point_file.h"

namespace simvis {

struct PointCloudLook {
  double count = 1e6, size_m = 0.04;
  double keep = 1;  ///< scans
  glm::vec3 color{0, 0.6f, 0.9f};
};

class PointCloudElement : public Element, public Stateful {
 public:
  /// Throws InputError unless exactly one of file and scanner is given, and if the file has an error.
  explicit PointCloudElement(const ElementContext& context);
  void update(ParameterView values) override;
  void observe(const Observations& seen) override;
  void archive(StateArchive& state) override;

 private:
  // The points of the file or of one scan, with an origin near them: separator { place, shape }.
  struct Batch {
    std::shared_ptr<Separator> separator{};
    std::shared_ptr<Transform> place{};
    std::shared_ptr<Shape> shape{};
    std::vector<glm::vec3> points_m{};  // relative to `place`
    std::vector<glm::vec3> colors{};    // of the points; empty: the element's colour
    std::shared_ptr<Mesh> shown{}, shown_before{};
  };
  void add_file(const ElementContext& context);
  Batch& add_batch();
  void replace_batches(const StateArchive& state, std::span<const std::uint64_t> places);
  void read_scan(const ObservedScan& observed);
  void draw(Batch& batch);
  void color_points(const Batch& batch, Mesh& mesh, std::size_t count) const;

  std::string name_, scanner_;  // scanner_ is empty for a file
  std::shared_ptr<VisualSeparator> separator_;
  std::shared_ptr<Group> batch_nodes_;  // of the batches, the last child of the separator
  std::deque<Batch> batches_;           // for scans: the newest last
  PointCloudLook look_;
  bool stale_ = false;      // a parameter changed after the meshes were made
  std::uint64_t seen_ = 0;  // ObservedScan::count of the newest batch
};

}  // namespace simvis
