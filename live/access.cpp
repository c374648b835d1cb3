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

// A name that somebody else chose may resolve to this machine; an address cannot.
bool names_this_machine(const std::string& name, const AccessRules& rules) {
  if (name == "localhost" || name == "127.0.0.1" || name == "::1" || name == rules.address) return true;
  if (!rules.needs_token || name.empty()) return false;
  const std::string own = own_name();
  return is_numeric_address(name) || (!own.empty() && (name == own || name == own + ".local"));
}

/// Whether `origin` is the page that `host` serves.
bool is_same_origin(std::string_view origin, std::string_view host) {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && origin.substr(kScheme.size()) == host;
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
  if (!names_this_machine(host_name(request.host), rules)) return "the Host is none of this machine";
  const bool has_token = !rules.token.empty() && same_secret(parse_target(request.target).token, rules.token);
  if (has_token) return "";
  if (rules.needs_token) return "the token is missing or wrong: expected ?token=TOKEN, as simvis-run has printed it";
  if (request.has_origin && !is_same_origin(request.origin, request.host)) {
    return "the page is of another Origin: expected the link with the token that simvis-run has printed";
  }
  return "";
}

}  // namespace simvis::live
