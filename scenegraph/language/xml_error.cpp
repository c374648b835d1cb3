#include "scenegraph/language/xml_error.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {
namespace {

struct Tag {
  std::string_view name;
  std::size_t offset = 0;
};

// The offset behind the construct that begins at `text[at] == '<'` and ends with `end`, or the text's end.
std::size_t behind(std::string_view text, std::size_t at, std::string_view end) {
  const std::size_t found = text.find(end, at);
  return found == std::string_view::npos ? text.size() : found + end.size();
}

// The offset of the '>' that ends a tag, outside of quotes, or the text's end.
std::size_t tag_end(std::string_view text, std::size_t at) {
  for (char quote = 0; at < text.size(); ++at) {
    if (quote != 0) {
      if (text[at] == quote) quote = 0;
    } else if (text[at] == '"' || text[at] == '\'') {
      quote = text[at];
    } else if (text[at] == '>') {
      break;
    }
  }
  return at;
}

// What is wrong with the nesting of tags; empty if nothing is.
std::string nesting_error(const SourceText& source) {
  const std::string_view text = source.text();
  const auto quoted = [](std::string_view name) { return "tag <" + std::string(name) + ">"; };
  const auto unclosed = [&](const Tag& tag) {
    const Location where = source.at(tag.offset);
    return quoted(tag.name) + " of line " + std::to_string(where.line) +
           " is not closed, expected \"/>\" at its end, or </" + std::string(tag.name) + ">";
  };
  std::vector<Tag> open;
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = behind(text, at, "-->");
    } else if (rest.starts_with("<![CDATA[")) {
      at = behind(text, at, "]]>");
    } else if (rest.starts_with("<?") || rest.starts_with("<!")) {
      at = behind(text, at, ">");
    } else {
      const bool closes = rest.starts_with("</");
      const std::size_t begin = at + (closes ? 2 : 1), end = tag_end(text, begin);
      const std::size_t name_end = std::min(text.find_first_of(" \t\r\n/>", begin), end);
      const Tag tag{text.substr(begin, name_end - begin), begin};
      if (closes) {
        if (open.empty()) return "tag </" + std::string(tag.name) + "> closes nothing";
        if (open.back().name != tag.name) return unclosed(open.back());
        open.pop_back();
      } else if (text[end - 1] != '/') {
        open.push_back(tag);
      }
      at = end;
    }
  }
  return open.empty() ? "" : unclosed(open.back());
}

}  // namespace

void fail_xml(const SourceText& source, const pugi::xml_parse_result& result) {
  std::string what;
  if (result.status == pugi::status_end_element_mismatch) what = nesting_error(source);
  if (result.status == pugi::status_bad_attribute) what = "an attribute is not NAME=\"VALUE\"; a quote may be missing";
  if (what.empty()) what = result.description();
  fail_at(source.at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0))), "malformed XML: " + what);
}

}  // namespace simvis
