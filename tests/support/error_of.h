// The message of the InputError that something throws.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include <simvis/error.h>

namespace simvis {

template <typename Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

inline bool contains(const std::string& text, const std::string& part) {
  const bool found = text.find(part) != std::string::npos;
  if (!found) MESSAGE("\"" << part << "\" is not in: " << text);
  return found;
}

}  // namespace simvis
