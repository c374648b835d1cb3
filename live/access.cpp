#include "live/access.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace simvis::live {
namespace {

/// "NAME" of "NAME:PORT" or "[ADDRESS]:PORT", in small letters.
std::string host_name(std::string_view host) {
  if (host.starts_with('[')) {
    host = host.substr(1, host.find(']') - 1);
  } else {
    host = host.substr(0, host.find(':'));
  }
  std::string name(host);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

bool is_numeric_address(const std::string& name) {
  in_addr v4{};
  in6_addr v6{};
  return ::inet_pton(AF_INET, name.c_str(), &v4) == 1 || ::inet_pton(AF_INET6, name.c_str(), &v6) == 1;
}

std::string own_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "";
  return host_name(name.data());
}

// A foreign name may resolve to this machine (DNS rebinding); a numeric address does not depend on a resolver.
bool names_this_machine(const std::string& name) {
  if (name.empty()) return false;
  if (name == "localhost") return true;
  const std::string own = own_name();
  return is_numeric_address(name) || (!own.empty() && (name == own || name == own + ".local"));
}

/// Whether `origin` is the page that `host` serves.
bool is_same_origin(std::string_view origin, std::string_view host) {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && origin.substr(kScheme.size()) == host;
}

std::string cookie_name(const AccessRules& rules) { return "simvis_" + std::to_string(rules.port); }

/// The value of "NAME=VALUE" in the header Cookie; empty: it has none.
std::string_view cookie_value(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = std::min(cookies.find(';'), cookies.size());
    std::string_view item = cookies.substr(0, end);
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
    item.remove_prefix(std::min(item.find_first_not_of(' '), item.size()));
    if (item.starts_with(name) && item.substr(name.size()).starts_with('=')) return item.substr(name.size() + 1);
  }
  return {};
}

}  // namespace

Target parse_target(std::string_view target) {
  constexpr std::string_view kToken = "token=";
  Target parts;
  const std::size_t mark = target.find('?');
  parts.path = target.substr(0, mark);
  if (mark == target.npos) return parts;
  for (std::string_view rest = target.substr(mark + 1); !rest.empty();) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view item = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (item.starts_with(kToken)) {
      parts.token = item.substr(kToken.size());
    } else {
      parts.query += (parts.query.empty() ? "" : "&") + std::string(item);
    }
  }
  return parts;
}

bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;  // the length is no secret
  volatile unsigned char differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    differs =
        static_cast<unsigned char>(differs | (static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i])));
  }
  return differs == 0;
}

std::string refusal(const RequestFacts& request, const AccessRules& rules) {
  if (!names_this_machine(host_name(request.host))) return "the Host is none of this machine";
  if (same_secret(parse_target(request.target).token, rules.token)) return "";
  if (!same_secret(cookie_value(request.cookie, cookie_name(rules)), rules.token)) {
    return "the token is missing or wrong: expected ?token=TOKEN, as in the printed link";
  }
  if (request.has_origin && !is_same_origin(request.origin, request.host)) {
    return "the page is of another Origin: expected the printed link with the token";
  }
  return "";
}

std::string token_cookie(const AccessRules& rules) {
  return cookie_name(rules) + "=" + rules.token + "; Path=/; HttpOnly; SameSite=Strict";
}

}  // namespace simvis::live
