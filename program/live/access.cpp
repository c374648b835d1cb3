#include "program/live/access.h"

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

// Cookies do not depend on the port, so their name does.
std::string cookie_name(const AccessRules& rules) { return "simvis_" + std::to_string(rules.port); }

/// Whether the header Cookie has "NAME=SECRET" of the rules, perhaps beside others of this name: servers at other ports
/// of the machine can set them too.
bool has_cookie(std::string_view cookies, const AccessRules& rules) {
  const std::string name = cookie_name(rules);
  while (!cookies.empty()) {
    const std::size_t end = std::min(cookies.find(';'), cookies.size());
    std::string_view item = cookies.substr(0, end);
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
    item.remove_prefix(std::min(item.find_first_not_of(' '), item.size()));
    if (!item.starts_with(name) || !item.substr(name.size()).starts_with('=')) continue;
    if (same_secret(item.substr(name.size() + 1), rules.cookie)) return true;
  }
  return false;
}

/// The target of a request in its parts.
struct Target {
  std::string_view path, token;
  std::string query;  // without the token
};

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

/// The path below the page's folder, with its "/"; empty: the path is elsewhere.
std::string_view path_in_page(std::string_view path, const AccessRules& rules) {
  if (!path.starts_with('/')) return {};
  path.remove_prefix(1);
  const std::size_t end = std::min(path.find('/'), path.size());
  return same_secret(path.substr(0, end), rules.page) ? path.substr(end) : std::string_view();
}

Admission refused(std::string why) { return {.refusal = std::move(why), .path = {}, .query = {}}; }

}  // namespace

bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;  // the length is no secret
  volatile unsigned char differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    differs =
        static_cast<unsigned char>(differs | (static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i])));
  }
  return differs == 0;
}

// What a wrong path is answered does not differ from a wrong cookie: it tells neither secret.
Admission admission(const RequestFacts& request, const AccessRules& rules) {
  if (!names_this_machine(host_name(request.host))) return refused("the Host is none of this machine");
  Target target = parse_target(request.target);
  if (same_secret(target.token, rules.token)) {
    return {.refusal = "", .path = target.path, .query = std::move(target.query), .by_token = true};
  }
  const std::string_view path = path_in_page(target.path, rules);
  const bool has_secret = has_cookie(request.cookie, rules);
  if (path.empty() || !has_secret) {
    return refused("the token is missing or wrong: expected ?token=TOKEN, as in the printed link");
  }
  if (request.has_origin && !is_same_origin(request.origin, request.host)) {
    return refused("the page is of another Origin: expected the printed link with the token");
  }
  return {.refusal = "", .path = path, .query = std::move(target.query)};
}

std::string page_cookie(const AccessRules& rules) {
  return cookie_name(rules) + "=" + rules.cookie + "; Path=/" + rules.page + "/; HttpOnly; SameSite=Strict";
}

// A redirection would not do: a browser sends no cookie that is SameSite=Strict behind one, where the link was on a
// page of another site.
std::string entry_page(const AccessRules& rules, const std::string& nonce) {
  return "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>SimVis</title>\n<script nonce=\"" +
         nonce + "\">location.replace(\"/" + rules.page + "/\" + location.hash);</script>\n" +
         "<noscript>The page needs JavaScript.</noscript>\n</html>\n";
}

}  // namespace simvis::live
