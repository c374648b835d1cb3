// Which way of measuring `method="auto"` uses, until when, and why.
//
// A choice stands until the scene has changed enough: until the triangles of the draw list, or the predicted cost of
// the chosen way in a frame, are more or fewer by kMoved than they were at the choice. Both are counts of what the
// frame does anyway; nothing is timed. The next frame then surveys again, unless the next best way was dearer by so
// much that it cannot have become the cheapest, had its cost moved the other way as far. Where costs swing, as with a
// scanner that tilts, surveys that choose the same again get rarer: after each the cost is not looked at for twice as
// many frames, up to kLongestWait. So a choice is a function of the scene, of the poses so far and of the device's
// costs alone.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/sensor.h>
#include "sensors/laser_scanner/method_survey.h"

namespace simvis {

class MethodSelector {
 public:
  static constexpr double kMoved = 1.5;
  static constexpr std::uint64_t kLongestWait = 1024;  // frames

  /// To be asked once a frame, before it is planned: whether it has to survey.
  bool is_due(const DrawList& list);

  /// Takes what the survey chose, of all that meets `tolerance`.
  void take(const MethodSurvey& survey, const ScanTolerance& tolerance);

  /// The work of a frame that was measured by the chosen way.
  void measured(const CostModel& work, const CostModel& cost);

  /// What was chosen, and why: for the plan's reasons.
  std::string text() const;

  void report(const std::string& scanner, SensorReport& report) const;

 private:
  const ScanCandidate& chosen() const { return candidates_[chosen_]; }
  bool another_may_be_cheaper(double now_ns) const;

  std::vector<ScanCandidate> candidates_;  // as of the last survey
  std::size_t chosen_ = 0;
  std::string because_;
  std::uint64_t surveys_ = 0;
  std::uint64_t structure_ = 0, triangles_ = 0;  // of the draw list: its revision, and as of this frame
  std::uint64_t chosen_at_triangles_ = 0;
  std::uint64_t wait_ = 0, frames_ = 0;  // how long costs are not looked at, and frames since the last survey
  bool moved_ = false;
};

}  // namespace simvis
