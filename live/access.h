// Who may use the server.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace simvis::live {

/// What the headers and the target of a request say.
struct RequestFacts {
  std::string_view target, host, origin;
  bool has_origin = false;
  std::string_view cookie{};  ///< the header of this name
};

/// The target of a request in its parts.
struct Target {
  std::string_view path, token;
  std::string query;  ///< without the token
};
Target parse_target(std::string_view target);

struct AccessRules {
  std::string address;  ///< that the server listens at
  std::uint16_t port = 0;
  std::string token;  ///< every request needs it
};

/// Empty: the request may be answered. Otherwise the reason why not. A token in the target admits a page of any Origin,
/// such as Foxglove's own; a cookie, which a browser sends by itself, admits the server's own page alone.
std::string refusal(const RequestFacts& request, const AccessRules& rules);

/// The value of Set-Cookie by which a browser keeps the token. Cookies do not depend on the port, so its name does.
std::string token_cookie(const AccessRules& rules);

/// Whether both are the same, in a time that does not depend on where they differ.
bool same_secret(std::string_view a, std::string_view b);

}  // namespace simvis::live
