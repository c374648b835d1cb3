// Classes that an SDF file gives: the plug-in gz::sim::systems::Label of gz-sim, whose <label> is a number from 0 to
// 255.
//
//   <model name="chair"> ... <plugin filename="gz-sim-label-system" name="gz::sim::systems::Label"><label>62</label>
//
// Source   src/systems/label/Label.cc of gz-sim (commit 01d9d94): in a model it labels the visuals of the model's own
//          links, not those of nested models; in a visual, that visual. Elsewhere it does nothing.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "import/model/import_report.h"
#include "import/sdf/sdf_commands.h"
#include "import/sdf/sdf_element.h"
#include "import/sdf/sdf_model.h"

namespace simvis {

bool is_sdf_label(const SdfElement& plugin);

/// The number of the last label among the children of a model, an <include> or a visual; empty: there is none, or it is
/// 0, which stands for things without a class. Throws InputError at a label without a number from 0 to 255.
std::optional<int> sdf_label(const SdfElement& parent);

/// The label of a visual, or of a whole link.
struct SdfLabel {
  int number = 0;
  std::string visual{};   ///< its name; empty: all visuals of the link
  bool of_model = false;  ///< all links of the link's model are one object
};

/// Whether the model's own label holds for all its visuals: the model has a label, no nested models, and no visuals
/// with labels of their own.
bool is_labelled_as_whole(const SdfScope& model);

/// The labels of a link's visuals: that of their model, `of_model`, but for those that have one of their own. `shown`
/// has the names of the visuals that are not left out. A visual whose label differs from others' and that has no name,
/// or that of another one, is reported. Throws as sdf_label().
std::vector<SdfLabel> sdf_link_labels(const SdfElement& link, std::optional<int> of_model,
                                      const std::set<std::string>& shown, ImportReport& report);

/// The element `label` for what the insertion point of `place` shows; its class is "label_NUMBER".
std::string sdf_label_command(const SdfLabel& label, const SdfPlace& place);

}  // namespace simvis
