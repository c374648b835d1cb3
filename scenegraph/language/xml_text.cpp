#include "scenegraph/language/xml_text.h"

#include <algorithm>
#include <string>
#include <utility>

#include "scenegraph/language/xml_error.h"

namespace simvis {
namespace {

constexpr int kMaxDepth = 256;

}  // namespace

XmlText XmlText::read(const std::filesystem::path& file) { return XmlText(SourceText::read(file)); }

XmlText::XmlText(SourceText source) : source_(std::move(source)) {
  const std::string& text = source_.text();
  const pugi::xml_parse_result result = document_.load_buffer(
      text.data(), text.size(), pugi::parse_default | pugi::parse_trim_pcdata, pugi::encoding_utf8);
  if (!result) fail_xml(source_, result);
  int depth = 0;
  for (pugi::xml_node node = document_.first_child(); node;) {
    if (depth > kMaxDepth) {
      fail_at(at(node), "elements are nested deeper than " + std::to_string(kMaxDepth) + ", expected less");
    }
    if (node.first_child()) {
      node = node.first_child();
      ++depth;
      continue;
    }
    while (node && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    node = node.next_sibling();
  }
}

Location XmlText::at(const pugi::xml_node& node) const {
  return source_.at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)));
}

}  // namespace simvis
