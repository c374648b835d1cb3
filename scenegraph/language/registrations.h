// What registrations of types have done, so that a plug-in that registers wrongly can be refused and undone.
//
// A type registers itself by a static object, that is before main() or while dlopen() runs. An exception there would
// end the process. So a registration that cannot be accepted is noted here, and whatever starts from the types asks for
// the notes.
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
  /// The one of this process. It exists before the first registration of any file.
  static Registrations& instance();

  /// Empty when headers of this version may register with this library, else what is wrong.
  static std::string check_version(std::string_view built_for);

  /// Notes that a type was accepted; `undo` takes it out again.
  void accept(std::function<void()> undo);
  /// Notes that a type was refused, and why.
  void refuse(std::string reason);

  /// How many types were accepted, and why others were refused, since the start of the process.
  std::size_t accepted() const;
  std::vector<std::string> refused() const;

  /// Takes out what was accepted after the first `accepted` registrations, the newest first, and forgets what was
  /// refused after the first `refused`.
  void roll_back(std::size_t accepted, std::size_t refused);

  /// Throws InputError that names every registration that was refused.
  void require_none_refused() const;

 private:
  mutable std::mutex mutex_;  // of the lists
  std::vector<std::function<void()>> undo_;
  std::vector<std::string> refused_;
};

}  // namespace simvis
