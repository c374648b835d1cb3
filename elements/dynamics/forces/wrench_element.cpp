#include "elements/dynamics/forces/wrench_element.h"

#include <simvis/error.h>
#include <simvis/node.h>

namespace simvis {

WrenchElement::WrenchElement(const ElementContext& context)
    : WrenchSource(context.command.require("name").value, context.command.require("insert_at").value),
      dynamic_(find_dynamic_scene(context)) {
  const CommandAttribute& at = context.command.require("insert_at");
  const StandingBody body = dynamic_->require_body(at);
  if (!body.is_moved()) {
    fail_at(at.where, "no force moves " + in_quotes(point()) + ", where element " + in_quotes(body.object->name) +
                          " stands, expected a dynamic body or a link that moves");
  }
  const auto mark = std::make_shared<Group>();
  mark->name = name();
  context.scene.insert(context.command, mark);
  dynamic_->wrenches().add(*this);
}

LinkParts WrenchElement::body(const ElementContext& context) const {
  const StandingBody body = dynamic_->require_body(context.command.require("insert_at"));
  return body.object->parts().of_link(body.link);
}

WrenchElement::~WrenchElement() { dynamic_->wrenches().remove(*this); }

}  // namespace simvis
