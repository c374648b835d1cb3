// What measuring takes: kinds of work that can be counted, and what one of each costs on a device.
//
// A sensor that can measure in several ways counts what each takes and chooses by counts x costs. The counts follow
// from the scene and the pose; the costs are measured once per device, rounded to two digits and kept in a file. So
// the choice is the same in every run on the same machine, although clocks never are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace simvis {

class Device;

enum class CostTerm : std::uint8_t {
  pass,           ///< a render pass, with its submission and reading it back
  view,           ///< a view of one
  item_drawn,     ///< an item in the draw list of what is rendered, wherever it stands
  examined,       ///< a box or a triangle that the host holds against a view
  draw,           ///< a draw call
  triangle,       ///< a triangle drawn whose pixels need no alpha
  masked,         ///< one whose pixels do
  pixel,          ///< cleared, drawn and read back
  beam,           ///< a range taken from pixels
  cast,           ///< a call of RayCaster::cast()
  item_cast,      ///< an item in the draw list that rays are cast into
  ray,            ///< a ray on its way
  item_test,      ///< of a bundle of rays with an item
  triangle_test,  ///< of one with a triangle
};
inline constexpr std::size_t kCostTerms = 14;

/// Names as in Work: "pass" ...
std::string_view to_string(CostTerm term);

/// How much of each kind, or what one of each costs.
struct CostModel {
  std::array<double, kCostTerms> of{};

  double& operator[](CostTerm term) { return of[static_cast<std::size_t>(term)]; }
  double operator[](CostTerm term) const { return of[static_cast<std::size_t>(term)]; }
  bool operator==(const CostModel&) const = default;
};

/// In nanoseconds, where `cost` is what one of each takes in nanoseconds.
double predict(const CostModel& counts, const CostModel& cost);

/// The file for the costs of this device, driver, machine and version of SimVis below `folder` (see cache_folder());
/// empty where that is empty.
std::filesystem::path cost_model_file(Device& device, const std::filesystem::path& folder, std::string_view version);

/// The costs in a file. Nothing if there is none, or if anything in it is not as save_cost_model() wrote it.
std::optional<CostModel> load_cost_model(const std::filesystem::path& file);

/// Rounds to two digits what it writes and returns: what load_cost_model() will read, each from 0.001 to 10^9 ns.
/// A file that cannot be written is no error.
CostModel save_cost_model(const std::filesystem::path& file, const CostModel& cost);

}  // namespace simvis
