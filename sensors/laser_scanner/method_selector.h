// Selects the measuring method of `method="auto"` and decides when to survey the methods again.
//
// A choice stays until the scene has changed enough: until the number of triangles in the draw list, or the predicted
// cost of the chosen method in a frame, differs by more than the factor kMoved from its value at the choice. Both
// follow from counts of the work of the frame; nothing is timed. The next frame then surveys again, unless the second
// best method was so much more expensive that it cannot have become the cheapest even if its cost changed by the same
// factor in the other direction. If costs fluctuate, as with a tilting scanner, surveys that confirm the choice become
// rarer: after each of them the cost is ignored for twice as many frames, up to kLongestWait. A choice therefore
// depends only on the scene, the poses so far and the costs of the device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/sensor.h>
#include <simvis/state_archive.h>
#include "sensors/laser_scanner/method_survey.h"

namespace simvis {

class MethodSelector {
 public:
  static constexpr double kMoved = 1.5;
  static constexpr std::uint64_t kLongestWait = 1024;  // frames

  /// Returns true if the frame has to survey. Called whenever the frame is planned, which is twice if pictures are read
  /// for it.
  bool is_due(const DrawList& list);

  /// Takes the choice of the survey among all methods that meet `tolerance`.
  void take(const MethodSurvey& survey, const ScanTolerance& tolerance);

  /// Records the work of a frame that used the chosen method: once per frame.
  void measured(const CostModel& work, const CostModel& cost);

  /// The chosen method and the reason, for the reasons in the plan.
  std::string text() const;

  void report(const std::string& scanner, SensorReport& report) const;

  /// As that of Stateful. Surveys have a candidate for each of these resolutions, then `raycast`.
  void archive(StateArchive& state, std::span<const double> resolutions_px, const ScanTolerance& tolerance);
  /// The resolution of the chosen method; 0: it renders nothing, or there has been no survey.
  double resolution_px() const { return surveys_ == 0 ? 0 : chosen().resolution_px; }

 private:
  const ScanCandidate& chosen() const { return candidates_[chosen_]; }
  bool another_may_be_cheaper(double now_ns) const;

  std::vector<ScanCandidate> candidates_;  // of the last survey
  std::size_t chosen_ = 0;
  std::string because_;
  std::uint64_t surveys_ = 0;
  std::optional<std::uint64_t> structure_;  // revision of the draw list whose triangles are counted
  std::uint64_t triangles_ = 0;             // of the draw list in this frame
  std::uint64_t chosen_at_triangles_ = 0;
  std::uint64_t wait_ = 0, frames_ = 0;  // frames for which costs are ignored, and frames since the last survey
  bool moved_ = false;
};

}  // namespace simvis
