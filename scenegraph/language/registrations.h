// A record of type registrations, so that a plug-in with a wrong registration can be refused and undone.
//
// A type registers itself by a static object, that is before main() or while dlopen() runs. An exception there would
// end the process. This record therefore stores registrations that were refused, and code that uses the types checks
// it.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

/// All functions may be called from any thread.
class Registrations {
 public:
  /// The record of this process. It exists before the first registration of any file.
  static Registrations& instance();

  /// Returns an empty string if headers of this version may register with this library, else the reason why not.
  static std::string check_version(std::string_view built_for);

  /// Records that a type was accepted. `undo` removes the type.
  void accept(std::function<void()> undo);
  /// Records that a type was refused, and the reason.
  void refuse(std::string reason);

  /// The number of accepted types, and the reasons for each refused one, since the start of the process.
  std::size_t accepted() const;
  std::vector<std::string> refused() const;

  /// Removes the types accepted after the first `accepted` registrations, the newest first, and removes the reasons
  /// after the first `refused`.
  void roll_back(std::size_t accepted, std::size_t refused);

  /// Throws InputError naming every refused registration, if there is one.
  void require_none_refused() const;

 private:
  mutable std::mutex mutex_;  // guards the lists
  std::vector<std::function<void()>> undo_;
  std::vector<std::string> refused_;
};

}  // namespace simvis
