// The objects of a device that exist: what is left at its end has leaked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace simvis::faults {

/// Threads  any.
class ObjectTable {
 public:
  void add(std::string_view type, std::uint64_t handle) {
    const std::lock_guard lock(mutex_);
    ++objects_[{type, handle}];  // a driver may return one handle for equal objects
  }
  void remove(std::string_view type, std::uint64_t handle) {
    const std::lock_guard lock(mutex_);
    const auto found = objects_.find({type, handle});
    if (found == objects_.end()) {
      ++unknown_[std::string(type)];
    } else if (--found->second == 0) {
      objects_.erase(found);
    }
  }

  /// The numbers of objects that exist, by type.
  std::map<std::string, std::size_t> left() const {
    const std::lock_guard lock(mutex_);
    std::map<std::string, std::size_t> result;
    for (const auto& [object, count] : objects_) result[std::string(object.first)] += count;
    return result;
  }
  /// The numbers of objects, by type, that were destroyed and did not exist.
  std::map<std::string, std::size_t> unknown() const {
    const std::lock_guard lock(mutex_);
    return unknown_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<std::string_view, std::uint64_t>, std::size_t> objects_;
  std::map<std::string, std::size_t> unknown_;
};

}  // namespace simvis::faults
