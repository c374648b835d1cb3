#include "import/model/srdf_file.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "import/model/import_report.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {
namespace {

using LinkNames = std::pair<std::string, std::string>;  // the lesser one first

class SrdfReader {
 public:
  SrdfReader(const XmlText& text, const std::vector<std::string_view>& links) : text_(text), links_(links) {}

  std::vector<ModelPair> read(std::vector<std::string>& warnings) {
    const pugi::xml_node root = text_.document().document_element();
    if (std::string_view(root.name()) != "robot") fail(root, "is the root, expected <robot>");
    for (const pugi::xml_node& node : root.children("disable_default_collisions")) {
      const std::optional<std::string> link = link_of(node, "link");
      for (const std::string_view other : links_) {
        if (link && *link != other) apart_.insert(std::minmax(*link, std::string(other)));
      }
    }
    for (const pugi::xml_node& node : root.children("enable_collisions")) {
      if (const std::optional<LinkNames> pair = pair_of(node)) apart_.erase(*pair);
    }
    for (const pugi::xml_node& node : root.children("disable_collisions")) {
      if (std::optional<LinkNames> pair = pair_of(node)) apart_.insert(*std::move(pair));
    }
    for (std::string& warning : report_.release()) warnings.push_back(std::move(warning));
    std::vector<ModelPair> pairs;
    for (const auto& [a, b] : apart_) pairs.push_back({a, b});
    return pairs;
  }

 private:
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& message) const {
    fail_at(text_.at(node), "element <" + std::string(node.name()) + "> " + message);
  }

  std::optional<std::string> link_of(const pugi::xml_node& node, const char* attribute) {
    std::string name = node.attribute(attribute).value();
    if (name.empty()) fail(node, "has no attribute " + in_quotes(attribute) + ", expected the name of a link");
    if (std::ranges::find(links_, name) != links_.end()) return name;
    report_.warn(text_.at(node), "element <" + std::string(node.name()) + "> names the link " + in_quotes(name) +
                                     ", which the robot does not have" + suggestion(name, links_) + "; it is left out");
    return std::nullopt;
  }

  std::optional<LinkNames> pair_of(const pugi::xml_node& node) {
    std::optional<std::string> a = link_of(node, "link1"), b = link_of(node, "link2");
    if (!a || !b) return std::nullopt;
    if (*b < *a) std::swap(a, b);
    return LinkNames(*std::move(a), *std::move(b));
  }

  const XmlText& text_;
  const std::vector<std::string_view>& links_;
  std::set<LinkNames> apart_;
  ImportReport report_;
};

}  // namespace

std::vector<ModelPair> read_srdf(const std::filesystem::path& file, const std::vector<std::string_view>& links,
                                 std::vector<std::string>& warnings) {
  const XmlText text = XmlText::read(file);
  return SrdfReader(text, links).read(warnings);
}

}  // namespace simvis
