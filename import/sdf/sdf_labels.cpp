#include "import/sdf/sdf_labels.h"

#include <cmath>
#include <map>

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

bool is_labelled_as_whole(const SdfScope& model) {
  if (!model.label) return false;
  return std::ranges::none_of(model.items, [](const std::unique_ptr<SdfItem>& item) {
    const auto& children = item->element.children();
    return item->scope != nullptr || std::ranges::any_of(children, [](const SdfElement& child) {
             const auto& inner = child.children();
             return child.tag() == "visual" && std::ranges::any_of(inner, is_sdf_label);
           });
  });
}

std::vector<SdfLabel> sdf_link_labels(const SdfElement& link, std::optional<int> of_model,
                                      const std::set<std::string>& shown, ImportReport& report) {
  std::map<std::string, std::set<std::optional<int>>> by_visual;
  std::set<std::optional<int>> all;
  for (const SdfElement& child : link.children()) {
    if (child.tag() != "visual") continue;
    const std::optional<int> own = sdf_label(child), label = own ? own : of_model;
    by_visual[child.attribute("name")].insert(label);
    all.insert(label);
  }
  std::vector<SdfLabel> labels;
  if (all.size() == 1 && *all.begin()) labels.push_back({.number = **all.begin()});
  if (all.size() < 2) return labels;
  for (const auto& [visual, of_visual] : by_visual) {
    if (visual.empty() || of_visual.size() > 1) {
      report.leave_out("label of a visual that has no name of its own", link.at());
    } else if (shown.contains(visual) && *of_visual.begin()) {
      labels.push_back({.number = **of_visual.begin(), .visual = visual});
    }
  }
  return labels;
}

std::string sdf_label_command(const SdfLabel& label, const SdfPlace& place) {
  SdfCommand command(CommandKind::element, "label", place);
  if (!label.visual.empty()) command.add("shapes", label.visual);
  if (label.of_model) command.add("level", "model");
  command.add("class", "label_" + std::to_string(label.number));
  command.add("class_id", label.number);
  return command.text();
}

}  // namespace simvis
