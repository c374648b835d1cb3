#include "import/mjcf/mjcf_text.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

namespace simvis {
namespace {

pugi::xml_parse_result parse(pugi::xml_document& document, std::string_view text) {
  return document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
}

// The offset of a closing tag behind a root that is whole.
std::optional<std::size_t> find_stray_end(std::string_view text) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = parse(document, text);
  if (result.status != pugi::status_end_element_mismatch) return std::nullopt;
  const std::size_t tag = text.rfind("</", static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)));
  if (tag == std::string_view::npos || text.find('>', tag) == std::string_view::npos) return std::nullopt;
  const bool is_whole = parse(document, text.substr(0, tag)) && document.document_element();
  return is_whole ? std::optional(tag) : std::nullopt;
}

}  // namespace

XmlText read_mjcf_text(const std::filesystem::path& file, std::vector<std::string>& warnings) {
  SourceText source = SourceText::read(file);
  const std::string_view text = source.text();
  const std::optional<std::size_t> end = find_stray_end(text);
  if (!end) return XmlText(std::move(source));
  warnings.push_back(to_string(source.at(*end)) + ": tag " +
                     std::string(text.substr(*end, text.find('>', *end) - *end)) +
                     "> closes nothing; it is left out, with what is behind it");
  return XmlText(SourceText(text.substr(0, *end), source.file()));
}

}  // namespace simvis
