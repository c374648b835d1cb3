// The registered types of one family (elements or sensors), by name.
#pragma once

#include <map>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include "scenegraph/language/registrations.h"

namespace simvis {

/// `Type` has `name` and `attributes`. Declare a registry as a static variable of a function, so that it exists before
/// the first registration of any file or plug-in. A type is removed only if its plug-in is refused, so pointers to the
/// types of loaded plug-ins stay valid.
///
/// Threads  all functions may be called from any thread: one thread may load a plug-in while others look up types.
template <typename Type>
class TypeRegistry {
 public:
  explicit TypeRegistry(std::string_view family) : family_(family) {}

  /// Adds the type. Returns false and refuses the type if it was built for another version, its name is taken or its
  /// table has an error; see Registrations.
  bool add(const Type& type, std::string_view built_for) {
    Registrations& registrations = Registrations::instance();
    std::string wrong = Registrations::check_version(built_for);
    if (wrong.empty()) wrong = check_table(type.attributes);
    if (wrong.empty() && !insert(type)) wrong = "a type with this name already exists";
    if (!wrong.empty()) {
      registrations.refuse(std::string(family_) + " type \"" + std::string(type.name) + "\": " + wrong);
      return false;
    }
    registrations.accept([this, name = type.name] {
      const std::lock_guard lock(mutex_);
      types_.erase(name);
    });
    return true;
  }

  const Type* find(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = types_.find(name);
    return found == types_.end() ? nullptr : &found->second;
  }

  std::vector<const Type*> sorted() const {
    const std::shared_lock lock(mutex_);
    std::vector<const Type*> types;
    for (const auto& [name, type] : types_) types.push_back(&type);
    return types;
  }

 private:
  bool insert(const Type& type) {
    const std::lock_guard lock(mutex_);
    return types_.emplace(type.name, type).second;
  }

  std::string_view family_;
  mutable std::shared_mutex mutex_;  // guards types_
  std::map<std::string_view, Type> types_;
};

}  // namespace simvis
