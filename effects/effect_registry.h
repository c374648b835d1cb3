// Effects of one family, such as those of scanners: types that hold an EffectType and say when they are called.
#pragma once

#include <algorithm>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <string_view>
#include <vector>

#include <simvis/effect.h>
#include "scenegraph/language/registrations.h"

namespace simvis {

/// `Type` has the members `type`, an EffectType, and `order`, which can be compared.
///
/// Lifetime  it lives until the end of the program, as the catalogue does.
/// Threads   any thread: a plug-in may be loaded while other threads create sensors.
template <typename Type>
class EffectRegistry {
 public:
  /// Adds the type to the catalogue of effects, and here if the catalogue accepts it.
  void add(const Type& type, std::string_view built_for) {
    if (!EffectRegistration(type.type, built_for).accepted) return;
    {
      const std::lock_guard lock(mutex_);
      types_.emplace(type.type.name, type);
    }
    Registrations::instance().accept([this, name = type.type.name] {
      const std::lock_guard lock(mutex_);
      types_.erase(name);
    });
  }

  /// The types that sensors with these capabilities may have, in calling order.
  std::vector<const Type*> in_order(std::uint8_t capabilities) const {
    const std::shared_lock lock(mutex_);
    std::vector<const Type*> types;
    for (const auto& [name, type] : types_) {
      if (may_have(capabilities, type.type)) types.push_back(&type);
    }
    std::ranges::stable_sort(types, {}, &Type::order);
    return types;
  }

 private:
  mutable std::shared_mutex mutex_;  // guards types_
  std::map<std::string_view, Type> types_;
};

}  // namespace simvis
