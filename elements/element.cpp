#include <simvis/element.h>

#include "scenegraph/language/type_registry.h"

namespace simvis {
namespace {

TypeRegistry<ElementType>& registry() {
  static TypeRegistry<ElementType> types("element");
  return types;
}

}  // namespace

ElementRegistration::ElementRegistration(const ElementType& type, std::string_view built_for) {
  registry().add(type, built_for);
}

const ElementType* find_element_type(std::string_view name) { return registry().find(name); }

std::vector<const ElementType*> element_types() { return registry().sorted(); }

}  // namespace simvis
