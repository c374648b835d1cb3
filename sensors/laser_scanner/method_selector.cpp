#include "sensors/laser_scanner/method_selector.h"

#include <algorithm>
#include <cmath>

#include "engine/base/decimal.h"

namespace simvis {

namespace {

std::uint64_t triangles_of(const DrawList& list) {
  std::uint64_t triangles = 0;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    if (item.visible && mesh.topology == Topology::triangles) triangles += mesh.indices.size() / 3;
  }
  return triangles;
}

bool has_moved(double from, double to) { return std::max(from, to) > MethodSelector::kMoved * std::min(from, to); }

std::string in_ms(double ns) { return decimal(ns / 1e6, 3) + " ms"; }

std::string reason(std::span<const ScanCandidate> candidates, std::size_t chosen, const ScanTolerance& tolerance) {
  const std::string meets = " with no bound above " + to_string(tolerance);
  if (candidates.size() == 1) return "the only method" + meets + ": no rendered range has so small a bound";
  std::vector<ScanCandidate> others(candidates.begin(), candidates.end());
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(chosen));
  const ScanCandidate& next = *std::ranges::min_element(others, {}, &ScanCandidate::predicted_ns);
  return "the cheapest method" + meets + ": predicted " + in_ms(candidates[chosen].predicted_ns) + ", the next, " +
         to_string(next) + ", " + in_ms(next.predicted_ns);
}

}  // namespace

bool MethodSelector::is_due(const DrawList& list) {
  if (list.revisions.structure != structure_) {
    structure_ = list.revisions.structure;
    triangles_ = triangles_of(list);
  }
  return surveys_ == 0 || moved_ ||
         has_moved(static_cast<double>(chosen_at_triangles_), static_cast<double>(triangles_));
}

void MethodSelector::take(const MethodSurvey& survey, const ScanTolerance& tolerance) {
  const bool same = surveys_ > 0 && to_string(chosen()) == to_string(survey.candidates()[survey.chosen()]);
  wait_ = same ? std::clamp<std::uint64_t>(2 * wait_, 1, kLongestWait) : 0;
  frames_ = 0;
  moved_ = false;
  candidates_.assign(survey.candidates().begin(), survey.candidates().end());
  chosen_ = survey.chosen();
  because_ = reason(candidates_, chosen_, tolerance);
  chosen_at_triangles_ = triangles_;
  ++surveys_;
}

void MethodSelector::measured(const CostModel& work, const CostModel& cost) {
  if (++frames_ <= wait_) return;
  const double now_ns = predict(work, cost);
  moved_ = has_moved(chosen().predicted_ns, now_ns) && another_may_be_cheaper(now_ns);
}

// The cost of another method may have changed in the other direction by the same factor; larger changes are not
// considered.
bool MethodSelector::another_may_be_cheaper(double now_ns) const {
  const auto [less_ns, more_ns] = std::minmax(chosen().predicted_ns, now_ns);
  const double reached_ns = more_ns * (more_ns / less_ns);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (i != chosen_ && candidates_[i].predicted_ns < reached_ns) return true;
  }
  return false;
}

// The triangles of the list are counted again.
void MethodSelector::archive(StateArchive& state, std::span<const double> resolutions_px,
                             const ScanTolerance& tolerance) {
  std::uint64_t chosen = chosen_;
  state(surveys_, chosen, chosen_at_triangles_, wait_, frames_, moved_);
  state.require(wait_ <= kLongestWait);
  if (state.is_reading()) {
    structure_.reset();
    chosen_ = chosen;
    candidates_.assign(surveys_ == 0 ? 0 : resolutions_px.size() + 1, {});
    for (std::size_t i = 0; i < resolutions_px.size() && !candidates_.empty(); ++i) {
      candidates_[i].resolution_px = resolutions_px[i];
    }
  }
  for (ScanCandidate& each : candidates_) {
    state(each.beams_cast);
    state.finite(each.worst_bound_m, each.worst_bound_rel, each.predicted_ns);
    state.require(each.predicted_ns >= 0);
  }
  state.require(candidates_.empty() || chosen_ < candidates_.size());
  if (state.is_reading() && !candidates_.empty()) because_ = reason(candidates_, chosen_, tolerance);
}

std::string MethodSelector::text() const { return to_string(chosen()) + ", " + because_; }

void MethodSelector::report(const std::string& scanner, SensorReport& report) const {
  if (surveys_ == 0) return;
  report.notes.push_back({"chosen", to_string(chosen())});
  report.notes.push_back({"chosen_because", because_});
  report.notes.push_back({"predicted_ms", chosen().predicted_ns / 1e6});
  report.notes.push_back({"surveys", surveys_});
  std::string text = "price list of " + scanner + ", a frame of this scanner alone:\n";
  for (const ScanCandidate& each : candidates_) {
    text += (&each == &chosen() ? "  * " : "    ") + to_string(each) + ": " + in_ms(each.predicted_ns) + ", " +
            std::to_string(each.beams_cast) + " beams cast, worst bound " + decimal(each.worst_bound_m, 6) + " m, " +
            decimal(each.worst_bound_rel, 6) + " of the range\n";
  }
  report.explanation += text + "  " + to_string(chosen()) + " was chosen as " + because_ + "\n";
}

}  // namespace simvis
