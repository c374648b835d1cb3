// The message of the error that something throws.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include <simvis/error.h>

namespace simvis {

template <typename Expected, typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Expected& error) {
    return error.what();
  }
  return "nothing was thrown";
}

template <typename Action>
std::string error_of(const Action& action) {
  return message_of<InputError>(action);
}

template <typename Action>
std::string machine_error_of(const Action& action) {
  return message_of<MachineError>(action);
}

inline bool contains(const std::string& text, const std::string& part) {
  const bool found = text.find(part) != std::string::npos;
  if (!found) MESSAGE("\"" << part << "\" is not in: " << text);
  return found;
}

}  // namespace simvis
