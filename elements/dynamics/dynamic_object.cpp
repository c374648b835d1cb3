#include "elements/dynamics/dynamic_object.h"

#include <algorithm>

namespace simvis {

std::optional<StandingBody> find_body(std::span<DynamicObject* const> objects, std::string_view insertion_point) {
  for (const DynamicObject* const object : objects) {
    if (const auto link = object->link_at(insertion_point)) return StandingBody{object, *link};
  }
  const auto stands =
      std::ranges::find_if(objects, [&](const DynamicObject* object) { return object->has_any(insertion_point); });
  return stands == objects.end() ? std::nullopt : std::optional(StandingBody{*stands});
}

}  // namespace simvis
