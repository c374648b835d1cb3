#include "import/sdf/sdf_labels.h"

#include <cmath>
#include <set>

#include "import/sdf/sdf_command.h"

namespace simvis {
namespace {

constexpr int kMaxLabel = 255;

}  // namespace

// The name before gz-sim 7 is the second.
bool is_sdf_label(const SdfElement& plugin) {
  const std::string name = plugin.attribute("name");
  return plugin.tag() == "plugin" && (name == "gz::sim::systems::Label" || name == "ignition::gazebo::systems::Label");
}

std::optional<int> sdf_label(const SdfElement& parent) {
  std::optional<int> label;
  for (const SdfElement& child : parent.children()) {
    if (!is_sdf_label(child)) continue;
    const SdfElement number = child.child("label");
    if (!number) child.fail("has no <label>");
    const double value = number.number(-1);
    if (!(value >= 0 && value <= kMaxLabel) || value != std::trunc(value)) {
      number.fail("has " + in_quotes(number.text()) + ", expected a whole number from 0 to 255");
    }
    label = static_cast<int>(value);
  }
  return label == 0 ? std::nullopt : label;
}

std::optional<int> sdf_link_label(const SdfElement& link, std::optional<int> of_model, ImportReport& report) {
  std::set<std::optional<int>> labels;
  for (const SdfElement& child : link.children()) {
    if (child.tag() != "visual") continue;
    const std::optional<int> own = sdf_label(child);
    labels.insert(own ? own : of_model);
  }
  if (labels.empty()) return std::nullopt;
  if (labels.size() == 1) return *labels.begin();
  report.leave_out("label of one visual among others of its link", link.at());
  return std::nullopt;
}

std::string sdf_label_command(int label, const SdfPlace& place) {
  SdfCommand command(CommandKind::element, "label", place);
  command.add("class", "label_" + std::to_string(label));
  command.add("class_id", label);
  return command.text();
}

}  // namespace simvis
