#include "scenegraph/language/registrations.h"

#include <utility>

#include <simvis/error.h>
#include <simvis/version.h>

namespace simvis {
namespace {

// Returns "0.1" for "0.1.2": the part of the version that must be equal before 1.0.
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

void Registrations::accept(std::function<void()> undo) {
  const std::lock_guard lock(mutex_);
  undo_.push_back(std::move(undo));
}

void Registrations::refuse(std::string reason) {
  const std::lock_guard lock(mutex_);
  refused_.push_back(std::move(reason));
}

std::size_t Registrations::accepted() const {
  const std::lock_guard lock(mutex_);
  return undo_.size();
}

std::vector<std::string> Registrations::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
}

void Registrations::roll_back(std::size_t accepted, std::size_t refused) {
  const std::lock_guard lock(mutex_);
  for (; undo_.size() > accepted; undo_.pop_back()) undo_.back()();
  refused_.resize(refused);
}

void Registrations::require_none_refused() const {
  const std::vector<std::string> reasons = refused();
  if (reasons.empty()) return;
  std::string text = "this program registers types that are refused:";
  for (const std::string& reason : reasons) text += "\n  " + reason;
  throw InputError(text);
}

}  // namespace simvis
