// The types of one family, elements or sensors, by name: what their registrations fill.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>

namespace simvis {

/// `Type` has `name` and `attributes`. Use one as a function's static, so that it exists before the first registration
/// of any file or plug-in. Types are never removed, so pointers to them stay valid.
///
/// Threads  all functions from any thread: one may load a plug-in while others look types up.
template <typename Type>
class TypeRegistry {
 public:
  explicit TypeRegistry(std::string_view family) : family_(family) {}

  /// Stops the program if the name is taken or the table has a mistake in it: both are bugs of whoever wrote the type.
  void add(const Type& type) {
    const std::string wrong = check_table(type.attributes);
    if (!wrong.empty()) stop(type, wrong);
    const std::lock_guard lock(mutex_);
    if (!types_.emplace(type.name, type).second) stop(type, "registered twice");
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
  [[noreturn]] void stop(const Type& type, const std::string& reason) const {
    std::fprintf(stderr, "SimVis: %s type \"%s\": %s\n", std::string(family_).c_str(), std::string(type.name).c_str(),
                 reason.c_str());
    std::abort();
  }

  std::string_view family_;
  mutable std::shared_mutex mutex_;  // of types_
  std::map<std::string_view, Type> types_;
};

}  // namespace simvis
