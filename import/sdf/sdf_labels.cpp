#include "import/sdf/sdf_labels.h"

#include <cmath>
#include <map>

#include "import/sdf/sdf_command.h"
#include "scenegraph/collision_mask.h"

namespace simvis {
namespace {

constexpr int kMaxLabel = 255;
constexpr std::uint32_t kAllBits = 0xFFFFFFFF;

}  // namespace

// The name before gz-sim 7 is the second.
bool is_sdf_label(const SdfElement& plugin) {
  const std::string name = plugin.attribute("name");
  return plugin.tag() == "plugin" && (name == "gz::sim::systems::Label" || name == "ignition::gazebo::systems::Label");
}

std::optional<std::uint32_t> sdf_label(const SdfElement& parent) {
  std::optional<std::uint32_t> label;
  for (const SdfElement& child : parent.children()) {
    if (!is_sdf_label(child)) continue;
    const SdfElement number = child.child("label");
    if (!number) child.fail("has no <label>");
    const double value = number.number(-1);
    if (!(value >= 0 && value <= kMaxLabel) || value != std::trunc(value)) {
      number.fail("has " + in_quotes(number.text()) + ", expected a whole number from 0 to 255");
    }
    label = static_cast<std::uint32_t>(value);
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

std::vector<SdfVisualNumber> sdf_visual_numbers(
    const SdfElement& link, const std::set<std::string>& shown, const std::string& what,
    const std::function<std::optional<std::uint32_t>(const SdfElement&)>& number_of, ImportReport& report) {
  std::map<std::string, std::set<std::optional<std::uint32_t>>> by_visual;
  std::set<std::optional<std::uint32_t>> all;
  for (const SdfElement& child : link.children()) {
    if (child.tag() != "visual") continue;
    const std::optional<std::uint32_t> number = number_of(child);
    by_visual[child.attribute("name")].insert(number);
    all.insert(number);
  }
  std::vector<SdfVisualNumber> numbers;
  if (all.size() == 1 && *all.begin()) numbers.push_back({.number = **all.begin()});
  if (all.size() < 2) return numbers;
  for (const auto& [visual, of_visual] : by_visual) {
    if (visual.empty() || of_visual.size() > 1) {
      report.leave_out(what + " of a visual that has no name of its own", link.at());
    } else if (shown.contains(visual) && *of_visual.begin()) {
      numbers.push_back({.number = **of_visual.begin(), .visual = visual});
    }
  }
  return numbers;
}

std::vector<SdfVisualNumber> sdf_link_labels(const SdfElement& link, std::optional<std::uint32_t> of_model,
                                             const std::set<std::string>& shown, ImportReport& report) {
  const auto label_of = [&](const SdfElement& visual) {
    const std::optional<std::uint32_t> own = sdf_label(visual);
    return own ? own : of_model;
  };
  return sdf_visual_numbers(link, shown, "label", label_of, report);
}

std::string sdf_label_command(const SdfVisualNumber& label, bool of_model, const SdfPlace& place) {
  SdfCommand command(CommandKind::element, "label", place);
  if (!label.visual.empty()) command.add("shapes", label.visual);
  if (of_model) command.add("level", "model");
  command.add("class", "label_" + std::to_string(label.number));
  command.add("class_id", label.number);
  return command.text();
}

std::optional<std::uint32_t> sdf_visibility_bits(const SdfElement& parent, const char* tag) {
  const SdfElement element = parent.child(tag);
  if (!element) return std::nullopt;
  const std::optional<std::uint32_t> bits = parse_bitmask(element.text());
  if (!bits) element.fail("is " + in_quotes(element.text()) + ", expected " + std::string(kBitmaskExpected));
  return *bits == kAllBits ? std::nullopt : bits;
}

std::string sdf_visibility_command(const SdfVisualNumber& flags, const SdfPlace& place) {
  SdfCommand command(CommandKind::element, "visibility_flags", place);
  if (!flags.visual.empty()) command.add("shapes", flags.visual);
  command.add("flags", flags.number);
  return command.text();
}

}  // namespace simvis
