#include "import/urdf/urdf_file.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <array>
#include <exception>
#include <mutex>
#include <new>
#include <set>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include "scenegraph/language/control_characters.h"

namespace simvis {
namespace {

// Collects liburdfdom's error messages, which otherwise go to the standard error stream. The process has one message
// handler, so a mutex is held.
class UrdfMessages : public console_bridge::OutputHandler {
 public:
  UrdfMessages() : lock_(mutex()), before_(console_bridge::getOutputHandler()), level_(console_bridge::getLogLevel()) {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_WARN);
  }
  ~UrdfMessages() override {
    console_bridge::setLogLevel(level_);
    console_bridge::useOutputHandler(before_);
  }
  UrdfMessages(const UrdfMessages&) = delete;
  UrdfMessages& operator=(const UrdfMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level != console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    if (!errors_.empty()) errors_ += "; ";
    errors_ += text;
  }
  const std::string& errors() const { return errors_; }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* before_;
  console_bridge::LogLevel level_;
  std::string errors_;
};

std::vector<pugi::xml_node> all_elements(const pugi::xml_document& document) {
  std::vector<pugi::xml_node> open{document}, all;
  while (!open.empty()) {
    const pugi::xml_node node = open.back();
    open.pop_back();
    if (node.type() == pugi::node_element) all.push_back(node);
    const std::size_t before = open.size();
    for (const pugi::xml_node& child : node.children()) open.push_back(child);
    std::reverse(open.begin() + static_cast<std::ptrdiff_t>(before), open.end());
  }
  return all;
}

std::string mended_text(const XmlText& text) {
  std::ostringstream out;
  text.document().save(out, "", pugi::format_raw, pugi::encoding_utf8);
  return out.str();
}

// liburdfdom names no place. Only where it refuses a robot, the first attribute that is no numbers is looked for.
void fail_at_wrong_number(const XmlText& text) {
  struct Row {
    std::string_view tag, attribute;
    std::size_t count;
  };
  static constexpr Row kRows[] = {{"origin", "xyz", 3},      {"origin", "rpy", 3},       {"axis", "xyz", 3},
                                  {"box", "size", 3},        {"sphere", "radius", 1},    {"cylinder", "radius", 1},
                                  {"cylinder", "length", 1}, {"mesh", "scale", 3},       {"color", "rgba", 4},
                                  {"limit", "lower", 1},     {"limit", "upper", 1},      {"limit", "effort", 1},
                                  {"limit", "velocity", 1},  {"mimic", "multiplier", 1}, {"mimic", "offset", 1}};
  for (const pugi::xml_node& node : all_elements(text.document())) {
    for (const Row& row : kRows) {
      const pugi::xml_attribute attribute = node.attribute(std::string(row.attribute).c_str());
      std::array<double, 4> values{};
      if (row.tag != node.name() || !attribute ||
          parse_numbers(attribute.value(), std::span(values).first(row.count))) {
        continue;
      }
      fail_at(text.at(node), "element <" + std::string(row.tag) + "> has the attribute " + std::string(row.attribute) +
                                 "=" + in_quotes(attribute.value()) + ", expected " + std::to_string(row.count) +
                                 (row.count == 1 ? " finite number" : " finite numbers"));
    }
  }
}

std::shared_ptr<const urdf::ModelInterface> parse(const XmlText& text) {
  UrdfMessages messages;
  std::string reason;
  try {
    if (const auto robot = urdf::parseURDF(mended_text(text))) {
      // After some errors liburdfdom returns a robot without the faulty parts.
      if (messages.errors().empty()) return robot;
    }
    reason = messages.errors();
  } catch (const std::bad_alloc&) {
    throw;  // says nothing about the file
  } catch (const std::exception& error) {
    reason = messages.errors() + (messages.errors().empty() ? "" : "; ") + error.what();
  }
  fail_at_wrong_number(text);
  fail_at({.file = text.source().file()}, reason.empty() ? "is not a URDF robot" : on_one_line(reason));
}

// liburdfdom accepts a link with two parent joints, and cycles of links that are not connected to the tree.
void check_tree(const UrdfFile& file) {
  std::set<const urdf::Link*> reached;
  std::vector<const urdf::Link*> open{file.robot->getRoot().get()};
  while (!open.empty()) {
    const urdf::Link* link = open.back();
    open.pop_back();
    if (!reached.insert(link).second) file.fail("link", link->name, "has two joints above it, expected one");
    for (const auto& child : link->child_links) open.push_back(child.get());
  }
  for (const auto& [name, link] : file.robot->links_) {
    if (reached.count(link.get()) == 0) file.fail("link", name, "is in a cycle of joints, expected a tree");
  }
}

}  // namespace

Location UrdfFile::at(std::string_view tag, std::string_view name) const {
  const auto found = named.find({std::string(tag), std::string(name)});
  return found != named.end() ? text.at(found->second) : Location{.file = text.source().file()};
}

void UrdfFile::fail(std::string_view tag, std::string_view name, const std::string& message) const {
  fail_at(at(tag, name), std::string(tag) + " " + in_quotes(name) + " " + message);
}

UrdfFile read_urdf(XmlText text) {
  UrdfMending mending = mend_urdf(text);
  std::shared_ptr<const urdf::ModelInterface> robot = parse(text);
  UrdfFile urdf{std::move(text), std::move(robot), std::move(mending)};
  for (const pugi::xml_node& node : urdf.text.document().child("robot").children()) {
    urdf.named.try_emplace({node.name(), node.attribute("name").value()}, node);
  }
  check_tree(urdf);
  return urdf;
}

}  // namespace simvis
