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

struct AccessRules {
  std::string address;  ///< that the server listens at
  std::uint16_t port = 0;
  std::string token;   ///< of the printed link
  std::string page;    ///< a secret: the folder of the page, in its address alone
  std::string cookie;  ///< a secret: what a browser keeps that has opened the printed link
};

/// The answer to a request for access.
struct Admission {
  std::string refusal;    ///< empty: the request may be answered
  std::string_view path;  ///< begins with "/"; without the page's folder
  std::string query;      ///< without the token
  bool by_token = false;  ///< else by the cookie
};

/// A token in the target admits a page of any Origin, such as Foxglove's own. A cookie, which a browser sends by
/// itself, admits the server's own page alone, below the page's folder.
Admission admission(const RequestFacts& request, const AccessRules& rules);

/// The value of Set-Cookie. A browser sends a cookie to every port of the host, but to the page's folder alone, which
/// no other server knows.
std::string page_cookie(const AccessRules& rules);

/// The answer to the printed link, with the cookie: it replaces the address, which has the token, by the page's, in the
/// browser's history too. Its script has the nonce.
std::string entry_page(const AccessRules& rules, const std::string& nonce);

/// Whether both are the same, in a time that does not depend on where they differ.
bool same_secret(std::string_view a, std::string_view b);

}  // namespace simvis::live
