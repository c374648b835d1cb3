#include "elements/dynamics/wrench_sources.h"

#include <algorithm>
#include <optional>

namespace simvis {

void WrenchSources::add(WrenchSource& source) {
  sources_.insert(std::ranges::upper_bound(sources_, source.name(), {}, &WrenchSource::name), &source);
  is_found_ = false;
}

void WrenchSources::remove(WrenchSource& source) {
  std::erase(sources_, &source);
  is_found_ = false;
}

void WrenchSources::restart() {
  for (WrenchSource* const source : sources_) source->restart();
  is_found_ = false;
}

void WrenchSources::find_bodies(std::span<DynamicObject* const> objects) {
  if (is_found_) return;
  is_found_ = true;
  acting_.clear();
  for (WrenchSource* const source : sources_) {
    const std::optional<StandingBody> body = find_body(objects, source->point());
    if (!body || !body->is_moved()) continue;
    acting_.push_back({source,
                       {*body->object->id, body->link},
                       body->object->parts().of_link(body->link),
                       body->object->body_from_point(source->point())});
  }
  for (Acting& each : acting_) {
    each.sharing = static_cast<double>(std::ranges::count(acting_, each.link, &Acting::link));
  }
}

void WrenchSources::act(DynamicsWorld& world, const PhysicsStep& step) const {
  for (const Acting& each : acting_) {
    world.push(each.link, each.source->wrench({world.state(each.link), *each.parts.mass, each.parts.shapes,
                                               each.body_from_point, each.sharing},
                                              step));
  }
}

}  // namespace simvis
