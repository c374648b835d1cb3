// The types of one family, elements or sensors, by name: what their registrations fill.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include "scenegraph/language/registrations.h"

namespace simvis {

/// `Type` has `name` and `attributes`. Use one as a function's static, so that it exists before the first registration
/// of any file or plug-in.
template <typename Type>
class TypeRegistry {
 public:
  explicit TypeRegistry(std::string_view family) : family_(family) {}

  /// Makes the type known. A type that was built for another version, whose name is taken or whose table has a
  /// mistake is refused, and the result is false: see Registrations.
  bool add(const Type& type, std::string_view built_for) {
    Registrations& registrations = Registrations::instance();
    const std::string what = std::string(family_) + " type \"" + std::string(type.name) + "\": ";
    std::string wrong = Registrations::check_version(built_for);
    if (wrong.empty()) wrong = check_table(type.attributes);
    if (wrong.empty() && types_.contains(type.name)) wrong = "there is a type of that name already";
    if (!wrong.empty()) {
      registrations.refuse(what + wrong);
      return false;
    }
    types_.emplace(type.name, type);
    registrations.accept([this, name = type.name] { types_.erase(name); });
    return true;
  }

  const Type* find(std::string_view name) const {
    const auto found = types_.find(name);
    return found == types_.end() ? nullptr : &found->second;
  }

  std::vector<const Type*> sorted() const {
    std::vector<const Type*> types;
    for (const auto& [name, type] : types_) types.push_back(&type);
    return types;
  }

 private:
  std::string_view family_;
  std::map<std::string_view, Type> types_;
};

}  // namespace simvis
