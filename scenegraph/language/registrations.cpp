#include "scenegraph/language/registrations.h"

#include <simvis/error.h>
#include <simvis/version.h>

namespace simvis {
namespace {

// "0.1" of "0.1.2": what has to be equal before 1.0.
std::string_view interface_of(std::string_view version) { return version.substr(0, version.rfind('.')); }

}  // namespace

Registrations& Registrations::instance() {
  static Registrations registrations;
  return registrations;
}

std::string Registrations::check_version(std::string_view built_for) {
  if (interface_of(built_for) == interface_of(kHeaderVersion)) return {};
  return "it was built for SimVis " + std::string(built_for) + ", and this is SimVis " + std::string(kHeaderVersion);
}

void Registrations::roll_back(std::size_t accepted, std::size_t refused) {
  for (; undo_.size() > accepted; undo_.pop_back()) undo_.back()();
  refused_.resize(refused);
}

void Registrations::require_none_refused() const {
  if (refused_.empty()) return;
  std::string text = "this program registers types that are refused:";
  for (const std::string& reason : refused_) text += "\n  " + reason;
  throw InputError(text);
}

}  // namespace simvis
