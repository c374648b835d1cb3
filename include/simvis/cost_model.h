// The cost model of measurements: countable kinds of work, and the time that one unit of each takes on a device.
//
// A sensor that can measure by several methods counts the work of each method and selects the method with the lowest
// sum of counts x costs. The counts follow from the scene and the pose. The costs are measured once per device, rounded
// to two digits and kept in a file. The selection is therefore the same in every run on the same machine, although
// measured times vary.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include <simvis/export.h>

namespace simvis {

class Device;

/// Kinds of work.
enum class CostTerm : std::uint8_t {
  pass,           ///< a render pass, with its submission and its readback
  view,           ///< a view of a pass
  item_drawn,     ///< an item in the draw list of a rendered frame, visible or not
  examined,       ///< a box or a triangle that the host tests against a view
  draw,           ///< a draw call
  triangle,       ///< a drawn triangle whose pixels need no alpha
  masked,         ///< a drawn triangle whose pixels need alpha
  pixel,          ///< a pixel that is cleared, drawn and read back
  beam,           ///< a range that is computed from pixels
  cast,           ///< a call of RayCaster::cast()
  item_cast,      ///< an item in the draw list that rays are cast into
  ray,            ///< a ray that is cast
  item_test,      ///< a test of a ray packet with an item
  triangle_test,  ///< a test of a ray packet with a triangle
};
/// The number of values of CostTerm.
inline constexpr std::size_t kCostTerms = 14;

/// The name of the enumerator: "pass", "view" and so on. The text is static.
SIMVIS_API std::string_view to_string(CostTerm term);

/// One number per kind of work: either how much of it there is, or what one unit costs in nanoseconds.
struct CostModel {
  std::array<double, kCostTerms> of{};  ///< by CostTerm

  double& operator[](CostTerm term) { return of[static_cast<std::size_t>(term)]; }       ///< the number of one kind
  double operator[](CostTerm term) const { return of[static_cast<std::size_t>(term)]; }  ///< the number of one kind
  bool operator==(const CostModel&) const = default;                                     ///< compares all numbers
};

/// The predicted time in nanoseconds of the work `counts`, where `cost` holds nanoseconds per unit.
SIMVIS_API double predict(const CostModel& counts, const CostModel& cost);

/// The file below `folder` for the costs of this device, driver, thread count and version of SimVis; see
/// cache_folder(). An empty `folder` gives an empty path.
SIMVIS_API std::filesystem::path cost_model_file(Device& device, const std::filesystem::path& folder,
                                                 std::string_view version);

/// The costs in a file. Empty if the file does not exist or differs in any way from what save_cost_model() wrote.
SIMVIS_API std::optional<CostModel> load_cost_model(const std::filesystem::path& file);

/// Rounds the costs to two digits, clamps each to the range from 0.001 to 10^9 ns, writes them and returns what
/// load_cost_model() will read. A file that cannot be written is not an error; an empty path writes nothing.
SIMVIS_API CostModel save_cost_model(const std::filesystem::path& file, const CostModel& cost);

}  // namespace simvis
