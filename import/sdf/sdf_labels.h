// What an SDF file says of single visuals by numbers: classes and visibility flags.
//
// Classes  the plug-in gz::sim::systems::Label of gz-sim, whose <label> is a number from 0 to 255.
//
//   <model name="chair"> ... <plugin filename="gz-sim-label-system" name="gz::sim::systems::Label"><label>62</label>
//
//   Source: src/systems/label/Label.cc of gz-sim (commit 01d9d94). In a model it labels the visuals of the model's own
//   links, not those of nested models; in a visual, that visual. Elsewhere it does nothing.
//
// Flags    <visibility_flags> of a visual, 32 bits. A camera or lidar shows the visual if its <visibility_mask> shares
//          a bit with them; both have all bits by default (visual.sdf, camera.sdf and lidar.sdf of SDF 1.12).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "import/model/import_report.h"
#include "import/sdf/sdf_commands.h"
#include "import/sdf/sdf_element.h"
#include "import/sdf/sdf_model.h"

namespace simvis {

bool is_sdf_label(const SdfElement& plugin);

/// The number of the last label among the children of a model, an <include> or a visual; empty: there is none, or it is
/// 0, which stands for objects without a class. Throws InputError at a label without a number from 0 to 255.
std::optional<std::uint32_t> sdf_label(const SdfElement& parent);

/// A number of a visual, or of a whole link.
struct SdfVisualNumber {
  std::uint32_t number = 0;
  std::string visual{};  ///< its name; empty: all visuals of the link
  bool operator==(const SdfVisualNumber&) const = default;
};

/// The numbers of a link's visuals, as `number_of` gives them; those of all visuals if they are equal. `shown` has the
/// names of the visuals that are not left out. A visual whose number differs from others' and that has no name, or that
/// of another one, is reported as left out, with what the number is: `what`. Throws what `number_of` throws.
std::vector<SdfVisualNumber> sdf_visual_numbers(
    const SdfElement& link, const std::set<std::string>& shown, const std::string& what,
    const std::function<std::optional<std::uint32_t>(const SdfElement&)>& number_of, ImportReport& report);

/// Whether the model's own label holds for all its visuals: the model has a label, no nested models, and no visuals
/// with labels of their own.
bool is_labelled_as_whole(const SdfScope& model);

/// The labels of a link's visuals: that of their model, `of_model`, but for those that have one of their own. Otherwise
/// as sdf_visual_numbers() and sdf_label().
std::vector<SdfVisualNumber> sdf_link_labels(const SdfElement& link, std::optional<std::uint32_t> of_model,
                                             const std::set<std::string>& shown, ImportReport& report);

/// The element `label` for what the insertion point of `place` shows; its class is "label_NUMBER". `of_model`: all
/// links of the link's model are one object.
std::string sdf_label_command(const SdfVisualNumber& label, bool of_model, const SdfPlace& place);

/// The bits of an element such as <visibility_flags> among the children of another one; empty: it is not there, or has
/// all bits. Throws InputError if it has no 32 bits.
std::optional<std::uint32_t> sdf_visibility_bits(const SdfElement& parent, const char* tag);

/// The element `visibility_flags` for what the insertion point of `place` shows.
std::string sdf_visibility_command(const SdfVisualNumber& flags, const SdfPlace& place);

}  // namespace simvis
