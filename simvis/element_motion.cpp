#include "simvis/element_motion.h"

#include <algorithm>

#include "elements/randomize.h"

namespace simvis {

void update_elements(BuiltScene& built) {
  Parameters& parameters = built.parameters;
  for (const std::size_t i : parameters.drain_changed_elements()) {
    const ElementDescriptor& element = parameters.elements()[i];
    built.elements[i]->update(parameters.values().subspan(element.first_value, element.parameters.size()));
  }
}

std::vector<DrawnValue> drawn_values(const BuiltScene& built, std::uint64_t frame) {
  std::vector<DrawnValue> values;
  for (const std::unique_ptr<Element>& each : built.elements) {
    const auto* const randomized = dynamic_cast<const RandomizeElement*>(each.get());
    if (randomized == nullptr) continue;
    values.push_back({randomized->element(), randomized->parameter(), randomized->value(frame)});
  }
  return values;
}

void advance_elements(BuiltScene& built, const FrameTime& time) {
  Parameters& parameters = built.parameters;
  for (const std::unique_ptr<Element>& each : built.elements) {
    const auto* const randomized = dynamic_cast<const RandomizeElement*>(each.get());
    if (randomized != nullptr) parameters.set(randomized->index(), randomized->value(random_key(time)));
  }
  update_elements(built);
  std::vector<double> values;
  for (std::size_t i = 0; i < built.elements.size(); ++i) {
    Element* const element = built.elements[i].get();
    if (element == nullptr || !element->moves_itself()) continue;
    const ElementDescriptor& descriptor = parameters.elements()[i];
    const auto own = parameters.values().subspan(descriptor.first_value, descriptor.parameters.size());
    values.assign(own.begin(), own.end());
    element->advance(time.time_ns, values);
    for (std::size_t p = 0; p < values.size(); ++p) parameters.set(descriptor.first_value + p, values[p]);
  }
  update_elements(built);
}

bool has_motion(const BuiltScene& built) {
  return std::ranges::any_of(built.elements,
                             [](const auto& element) { return element != nullptr && element->moves_itself(); });
}

}  // namespace simvis
