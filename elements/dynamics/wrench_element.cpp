#include "elements/dynamics/wrench_element.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <simvis/error.h>
#include <simvis/node.h>
#include "elements/dynamics/dynamic_scene.h"

namespace simvis {

glm::dvec3 unit_axis(const ElementContext& context, std::string_view attribute) {
  const double(&v)[3] = context.attributes.vector(attribute);
  const double length = std::hypot(v[0], v[1], v[2]);
  if (length > 0 && std::isfinite(length)) return glm::dvec3(v[0], v[1], v[2]) / length;
  fail_at(context.attributes.where(attribute),
          "attribute " + in_quotes(attribute) + " has no direction, expected three numbers that are not all 0");
}

WrenchElement::WrenchElement(const ElementContext& context)
    : dynamic_(find_dynamic_scene(context)),
      name_(context.command.require("name").value),
      point_(context.command.require("insert_at").value) {
  const CommandAttribute& at = context.command.require("insert_at");
  const StandingBody body = dynamic_->require_body(at);
  if (!body.is_moved()) {
    fail_at(at.where, "no force moves " + in_quotes(point_) + ", where element " + in_quotes(body.object->name) +
                          " stands, expected a dynamic body or a link that moves");
  }
  const auto mark = std::make_shared<Group>();
  mark->name = name_;
  context.scene.insert(context.command, mark);
  dynamic_->wrenches().add(*this);
}

LinkParts WrenchElement::body(const ElementContext& context) const {
  const StandingBody body = dynamic_->require_body(context.command.require("insert_at"));
  return body.object->parts().of_link(body.link);
}

WrenchElement::~WrenchElement() { dynamic_->wrenches().remove(*this); }

void WrenchElements::add(WrenchElement& element) {
  elements_.insert(std::ranges::upper_bound(elements_, element.name(), {}, &WrenchElement::name), &element);
  is_found_ = false;
}

void WrenchElements::remove(WrenchElement& element) {
  std::erase(elements_, &element);
  is_found_ = false;
}

void WrenchElements::restart() {
  for (WrenchElement* const element : elements_) element->restart();
  is_found_ = false;
}

void WrenchElements::find_bodies(std::span<DynamicObject* const> objects) {
  if (is_found_) return;
  is_found_ = true;
  acting_.clear();
  for (WrenchElement* const element : elements_) {
    const std::optional<StandingBody> body = find_body(objects, element->point());
    if (!body || !body->is_moved()) continue;
    acting_.push_back({element,
                       {*body->object->id, body->link},
                       body->object->parts().of_link(body->link),
                       body->object->body_from_point(element->point())});
  }
}

void WrenchElements::act(DynamicsWorld& world, const PhysicsStep& step) const {
  for (const Acting& each : acting_) {
    world.push(each.link, each.element->wrench({world.state(each.link), *each.parts.mass, each.parts.shapes,
                                                each.body_from_point},
                                               step));
  }
}

}  // namespace simvis
