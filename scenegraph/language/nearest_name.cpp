#include <algorithm>
#include <cctype>
#include <vector>

#include <simvis/location.h>

namespace simvis {
namespace {

constexpr std::size_t kShortestEnding = 3;  // "vlp16" of "velodyne_vlp16"
constexpr std::size_t kLongestName = 200;   // longer names are not typing errors, and they cost time

// Words of other simulators and of their users, and what has that meaning here. The first of these that is known where
// the word stands is suggested.
struct Synonym {
  std::string_view word, here;
};
constexpr Synonym kSynonyms[] = {
    // Types of sensors.
    {"lidar", "laser_scanner"},
    {"laser", "laser_scanner"},
    {"laser_scan", "laser_scanner"},
    {"ray", "laser_scanner"},
    {"gpu_lidar", "laser_scanner"},
    {"gpu_ray", "laser_scanner"},
    {"depth_camera", "rgbd_camera"},
    {"depth", "rgbd_camera depth"},
    {"rgbd", "rgbd_camera"},
    {"dvs", "event_camera"},
    {"gps", "gnss"},
    {"navsat", "gnss"},
    {"ultrasonic", "range"},
    {"ultrasound", "range"},
    {"air_pressure", "barometer"},
    {"sun", "light"},
    {"lamp", "light"},
    // Attributes.
    {"pose", "pose_offset"},
    {"pos", "pose_offset"},
    {"position", "pose_offset"},
    {"xyz", "pose_offset"},
    {"origin", "pose_offset ROOT"},
    {"rotation", "quaternion"},
    {"orientation", "quaternion"},
    {"parent", "insert_at"},
    {"link", "insert_at"},
    {"attach_to", "insert_at"},
    {"uri", "file"},
    {"filename", "file"},
    {"mesh", "file mesh"},
    {"model", "file"},
    {"fps", "rate rate_hz"},
    {"hz", "rate rate_hz"},
    {"rate_hz", "rate"},
    {"frequency", "rate rate_hz"},
    {"update_rate", "rate rate_hz"},
    {"resolution", "width"},
    {"image_size", "width"},
    {"fov", "hfov"},
    {"horizontal_fov", "hfov"},
    {"horizontal_samples", "samples"},
    {"rays", "samples"},
    {"max_range", "range_max"},
    {"min_range", "range_min"},
    {"noise", "range_noise"},
    {"colour", "color"},
    {"rgba", "color"},
    // Outputs of cameras.
    {"rgb", "color"},
    {"image", "color"},
    {"segmentation", "semantic"},
    {"semantic_segmentation", "semantic"},
    {"instance_segmentation", "instance"},
    {"normals", "normal"},
    {"bbox", "boxes"},
    {"bounding_boxes", "boxes"},
    {"optical_flow", "flow_backward"},
    // Insertion points.
    {"world", "ROOT"},
    {"map", "ROOT"},
    // Outputs of scanners.
    {"ranges", "range_m"},
    {"range", "range_m"},
    {"distance", "range_m"},
    {"distances", "range_m"},
    {"intensities", "intensity"},
    {"point_cloud", "points"},
    // Settings of Python.
    {"rate", "rate_hz"},
    {"num_threads", "threads"},
    {"gpu", "device"},
    // Options.
    {"--output", "--out"},
    {"--output_dir", "--out"},
    {"--duration", "--frames"},
    {"--steps", "--frames"},
    {"-n", "--frames"},
    {"--fps", "--rate"},
    {"--gui", "--live"},
    {"--viewer", "--live"},
    {"-v", "--version"},
};

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, substitutions and swaps of adjacent
// characters.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

// What a word of another simulator is called here, if that is known; else empty.
std::string_view synonym(std::string_view seen_lower, std::span<const std::string_view> known) {
  const auto* const found = std::ranges::find(kSynonyms, seen_lower, &Synonym::word);
  if (found == std::end(kSynonyms)) return {};
  for (std::string_view rest = found->here; !rest.empty();) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    const auto here = std::ranges::find(known, rest.substr(0, end));
    if (here != known.end()) return *here;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

}  // namespace

std::string nearest_name(std::string_view seen, std::span<const std::string_view> known) {
  // A part's names have its own name in front if there are several copies of the part.
  const std::string of_copy = "/" + std::string(seen);
  const auto copy = std::ranges::find_if(known, [&](std::string_view name) { return name.ends_with(of_copy); });
  if (!seen.empty() && copy != known.end()) return std::string(*copy);
  const std::string seen_lower = lower(seen.substr(0, kLongestName));
  std::string_view best = synonym(seen_lower, known);
  if (!best.empty()) return std::string(best);
  std::size_t best_distance = 0;
  for (const std::string_view name : known) {
    // A third of the letters may be wrong. In a name of one or two letters only their case may be wrong.
    const std::size_t longer = std::max(seen.size(), name.size());
    const std::size_t difference = longer - std::min(seen.size(), name.size());
    if (longer > kLongestName || difference > longer / 3) continue;
    const std::size_t d = distance(seen_lower, lower(name));
    if (d > longer / 3) continue;
    if (best.empty() || d < best_distance) {
      best = name;
      best_distance = d;
    }
  }
  if (!best.empty() || seen.size() < kShortestEnding) return std::string(best);
  const auto longer =
      std::ranges::find_if(known, [&](std::string_view name) { return lower(name).ends_with("_" + seen_lower); });
  return longer == known.end() ? "" : std::string(*longer);
}

std::string suggestion(std::string_view seen, std::span<const std::string_view> known) {
  const std::string name = nearest_name(seen, known);
  return name.empty() ? name : ", did you mean " + in_quotes(name) + "?";
}

}  // namespace simvis
