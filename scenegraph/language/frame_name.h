// Names of ROS frames in attributes.
#pragma once

#include <algorithm>
#include <string_view>

#include <simvis/command.h>
#include <simvis/location.h>

namespace simvis {

/// Whether ROS 2 takes the text as a frame_id: not empty, no '/' in front, no spaces or control characters.
inline bool is_frame_name(std::string_view text) {
  const auto is_allowed = [](char c) { return static_cast<unsigned char>(c) > ' ' && c != '\x7f'; };
  return !text.empty() && text.front() != '/' && std::ranges::all_of(text, is_allowed);
}

/// Throws InputError at the attribute if its value is no name of a frame.
inline void check_frame_name(const CommandAttribute& attribute) {
  if (is_frame_name(attribute.value)) return;
  fail_at(attribute.where, "attribute " + in_quotes(attribute.name) + ": " + in_quotes(attribute.value) +
                               " is not allowed, expected a name without spaces and without '/' in front");
}

}  // namespace simvis
