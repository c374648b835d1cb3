// Who may use the server.
#pragma once

#include <string>
#include <string_view>

namespace simvis::live {

/// What the headers and the target of a request say.
struct RequestFacts {
  std::string_view target, host, origin;
  bool has_origin = false;
};

/// The target of a request in its parts.
struct Target {
  std::string_view path, token;
  std::string query;  ///< without the token
};
Target parse_target(std::string_view target);

struct AccessRules {
  std::string address;  ///< that the server listens at
  std::string token;
  bool needs_token = false;
};

/// Empty: the request may be answered. Otherwise the reason why not.
std::string refusal(const RequestFacts& request, const AccessRules& rules);

/// Whether both are the same, in a time that does not depend on where they differ.
bool same_secret(std::string_view a, std::string_view b);

}  // namespace simvis::live
