#include "import/mjcf/mjcf_element.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <system_error>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "engine/base/read_error.h"
#include "engine/base/words.h"
#include "import/mjcf/mjcf_text.h"
#include "import/model/turn_z_to.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxIncludes = 1000;

}  // namespace

void MjcfElement::fail(const std::string& message) const {
  fail_at(at(), "element <" + std::string(tag()) + "> " + message);
}

std::optional<std::string> MjcfElement::written(const char* name) const {
  const pugi::xml_attribute attribute = node_.attribute(name);
  if (!attribute) return std::nullopt;
  return std::string(attribute.value());
}

std::optional<std::string> MjcfElement::find(const char* name) const {
  if (auto own = written(name)) return own;
  return model_->default_of(written("class").value_or(childclass_), tag(), name);
}

std::string MjcfElement::unknown_class() const {
  const std::string name = written("class").value_or(childclass_);
  return name.empty() || model_->has_class(name) ? "" : name;
}

std::vector<double> MjcfElement::numbers(const char* name, std::size_t least, std::size_t most) const {
  const std::optional<std::string> text = find(name);
  std::vector<double> numbers;
  if (!text) return numbers;
  bool valid = true;
  for (const std::string_view word : words_of(*text)) {
    double value = 0;
    valid = valid && parse_number(word.starts_with('+') ? word.substr(1) : word, value) &&
            std::abs(value) <= kMaxCoordinate_m;
    numbers.push_back(value);
  }
  if (valid && numbers.size() >= least && numbers.size() <= most) return numbers;
  const std::string count =
      least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most);
  fail("has the attribute " + std::string(name) + "=" + in_quotes(*text) + ", expected " + count + " finite numbers");
}

double MjcfElement::number(const char* name, double fallback) const {
  const std::vector<double> values = numbers(name, 1, 1);
  return values.empty() ? fallback : values[0];
}

glm::dvec3 MjcfElement::vector(const char* name, const glm::dvec3& fallback) const {
  const std::vector<double> values = numbers(name, 3, 3);
  return values.empty() ? fallback : glm::dvec3(values[0], values[1], values[2]);
}

bool MjcfElement::flag(const char* name, bool fallback) const {
  const std::optional<std::string> text = find(name);
  return text ? *text == "true" : fallback;
}

std::vector<MjcfElement> MjcfElement::children() const {
  std::vector<MjcfElement> elements;
  const std::string inner = written("childclass").value_or(childclass_);
  for (const pugi::xml_node& node : node_.children()) {
    if (node.type() != pugi::node_element) continue;
    MjcfElement child(node, *text_, *model_, inner);
    if (child.tag() != "include") {
      elements.push_back(std::move(child));
      continue;
    }
    const std::optional<std::string> file = child.written("file");
    if (!file) child.fail("has no attribute \"file\"");
    const XmlText& text = model_->include(child, *file);
    const std::vector<MjcfElement> more =
        MjcfElement(text.document().document_element(), text, *model_, inner).children();
    elements.insert(elements.end(), more.begin(), more.end());
  }
  return elements;
}

MjcfModel::MjcfModel(const std::filesystem::path& file) : file_(file) {
  texts_.push_back(read_mjcf_text(file, warnings_));
  std::error_code error;
  included_[std::filesystem::canonical(file, error)] = {&texts_.front(), ""};
  const pugi::xml_node root = texts_.front().document().document_element();
  if (std::string_view(root.name()) != "mujoco") {
    fail_at(texts_.front().at(root), "element <" + std::string(root.name()) +
                                         "> is the root, expected <mujoco>: a part file .xml is an MJCF model; a scene "
                                         "is included by <include file=\"...\"/>");
  }
  mesh_folder = texture_folder = file_.parent_path();
  read_compiler();
  read_flags();
  for (const MjcfElement& each : sections("default")) read_defaults(each, "", 0);
}

std::string MjcfModel::name() const {
  const std::string name = texts_.front().document().document_element().attribute("model").value();
  return name.empty() ? file_.stem().string() : name;
}

std::vector<MjcfElement> MjcfModel::top() const {
  return MjcfElement(texts_.front().document().document_element(), texts_.front(), *this, "").children();
}

std::vector<MjcfElement> MjcfModel::sections(std::string_view tag) const {
  std::vector<MjcfElement> all = top();
  std::erase_if(all, [&](const MjcfElement& each) { return each.tag() != tag; });
  return all;
}

void MjcfModel::read_compiler() {
  for (const MjcfElement& compiler : sections("compiler")) {
    if (const auto angle = compiler.written("angle")) is_degrees = *angle != "radian";
    autolimits = compiler.written("autolimits").value_or(autolimits ? "true" : "false") == "true";
    strips_path = compiler.written("strippath").value_or(strips_path ? "true" : "false") == "true";
    if (const auto sequence = compiler.written("eulerseq")) {
      const bool valid = sequence->size() == 3 && sequence->find_first_not_of("xyzXYZ") == std::string::npos;
      if (!valid) compiler.fail("has eulerseq=" + in_quotes(*sequence) + ", expected three of x, y, z, X, Y and Z");
      eulerseq = *sequence;
    }
    if (const auto folder = compiler.written("assetdir")) mesh_folder = texture_folder = file_.parent_path() / *folder;
    if (const auto folder = compiler.written("meshdir")) mesh_folder = file_.parent_path() / *folder;
    if (const auto folder = compiler.written("texturedir")) texture_folder = file_.parent_path() / *folder;
  }
}

void MjcfModel::read_flags() {
  for (const MjcfElement& option : sections("option")) {
    for (const MjcfElement& child : option.children()) {
      if (child.tag() != "flag") continue;
      for (const pugi::xml_attribute& flag : child.attributes()) {
        const std::string_view value = flag.value();
        if (value != "enable" && value != "disable") {
          child.fail("has " + std::string(flag.name()) + "=" + in_quotes(value) + ", expected enable or disable");
        }
        if (value == "disable") off_.insert(flag.name());
      }
    }
  }
  if (is_off("constraint")) off_.insert({"contact", "equality", "frictionloss", "limit"});
  if (is_off("passive")) off_.insert({"spring", "damper"});
}

// The outermost class is called "main", whether it has a name or not.
void MjcfModel::read_defaults(const MjcfElement& element, const std::string& outer, int depth) {
  if (depth > kMaxMjcfDepth) element.fail("is nested too deeply");
  const std::string name = element.written("class").value_or("main");
  DefaultClass& own = classes_[name];
  own.outer = name == "main" ? "" : (outer.empty() ? "main" : outer);
  for (const MjcfElement& child : element.children()) {
    if (child.tag() == "default") {
      read_defaults(child, name, depth + 1);
      continue;
    }
    for (const pugi::xml_attribute& attribute : child.attributes()) {
      own.attributes[std::string(child.tag())].emplace(attribute.name(), attribute.value());
    }
  }
}

std::optional<std::string> MjcfModel::default_of(const std::string& name, std::string_view tag,
                                                 const char* attribute) const {
  auto found = classes_.find(name.empty() ? "main" : name);
  for (std::size_t depth = 0; found != classes_.end() && depth <= classes_.size(); ++depth) {
    const auto of_tag = found->second.attributes.find(tag);
    if (of_tag != found->second.attributes.end()) {
      const auto value = of_tag->second.find(attribute);
      if (value != of_tag->second.end()) return value->second;
    }
    if (found->second.outer.empty()) break;
    found = classes_.find(found->second.outer);
  }
  return std::nullopt;
}

std::filesystem::path mjcf_path(std::string name) {
  std::ranges::replace(name, '\\', '/');
  return name;
}

std::filesystem::path MjcfModel::asset_file(const MjcfElement& asset, const std::filesystem::path& folder,
                                            const std::string& name) const {
  const std::filesystem::path written = mjcf_path(name), file = strips_path ? written.filename() : written;
  const std::filesystem::path model = file_.parent_path(),
                              beside = std::filesystem::path(asset.at().file).parent_path();
  for (const std::filesystem::path& each :
       {folder, folder / beside.lexically_relative(model), beside / folder.lexically_relative(model), beside}) {
    if (is_input_file(each / file)) return each / file;
  }
  return folder / file;
}

// A model may include a file once, as MuJoCo says, so there is no circle.
const XmlText& MjcfModel::include(const MjcfElement& include, const std::string& file) const {
  std::error_code error;
  std::filesystem::path path = file_.parent_path() / mjcf_path(file);
  const std::filesystem::path beside = std::filesystem::path(include.at().file).parent_path() / mjcf_path(file);
  if (!is_input_file(path)) path = beside;
  if (!is_input_file(path)) include.fail("names a file that is not there: " + in_quotes(file));
  const std::filesystem::path canonical = std::filesystem::canonical(path, error);
  const auto known = included_.find(canonical);
  if (known == included_.end()) {
    if (included_.size() >= kMaxIncludes) include.fail("is one of too many files");
    texts_.push_back(read_mjcf_text(path, warnings_));
    included_[canonical] = {&texts_.back(), to_string(include.at())};
    return texts_.back();
  }
  if (known->second.place == to_string(include.at())) return *known->second.text;
  include.fail("includes " + in_quotes(file) + " a second time, expected each file once");
}

namespace {

glm::dvec3 unit_of(const MjcfElement& element, const char* name, const glm::dvec3& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0)) element.fail("has the attribute " + std::string(name) + " without length");
  return glm::normalize(v / largest);
}

// Small letters turn about the axes that the turns before have turned, large ones about the fixed axes.
glm::dmat3 turn_by_euler(const MjcfModel& model, const std::vector<double>& angles_rad) {
  glm::dmat3 turn(1);
  for (std::size_t i = 0; i < 3; ++i) {
    const char letter = model.eulerseq[i];
    glm::dvec3 axis(0);
    axis[std::tolower(letter) - 'x'] = 1;
    const glm::dmat3 step = glm::mat3_cast(glm::angleAxis(angles_rad[i], axis));
    turn = letter >= 'a' ? turn * step : step * turn;
  }
  return turn;
}

glm::dmat3 orientation_of(const MjcfElement& element) {
  const MjcfModel& model = element.model();
  const double unit = model.is_degrees ? glm::radians(1.0) : 1;
  if (const auto q = element.numbers("quat", 4, 4); !q.empty()) {
    const double largest = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2]), std::abs(q[3])});
    if (!(largest > 0)) element.fail("has a quaternion without length");
    return glm::mat3_cast(glm::normalize(glm::dquat(q[0] / largest, q[1] / largest, q[2] / largest, q[3] / largest)));
  }
  if (const auto a = element.numbers("axisangle", 4, 4); !a.empty()) {
    return glm::mat3_cast(glm::angleAxis(a[3] * unit, unit_of(element, "axisangle", {a[0], a[1], a[2]})));
  }
  if (auto e = element.numbers("euler", 3, 3); !e.empty()) {
    for (double& angle : e) angle *= unit;
    return turn_by_euler(model, e);
  }
  if (const auto a = element.numbers("xyaxes", 6, 6); !a.empty()) {
    const glm::dvec3 x = unit_of(element, "xyaxes", {a[0], a[1], a[2]}), given(a[3], a[4], a[5]);
    const glm::dvec3 y = unit_of(element, "xyaxes", given - glm::dot(given, x) * x);
    return {x, y, glm::cross(x, y)};
  }
  if (const auto z = element.numbers("zaxis", 3, 3); !z.empty()) {
    return turn_z_to(unit_of(element, "zaxis", {z[0], z[1], z[2]}));
  }
  return glm::dmat3(1);
}

}  // namespace

glm::dmat4 mjcf_pose(const MjcfElement& element) {
  glm::dmat4 pose(orientation_of(element));
  pose[3] = glm::dvec4(element.vector("pos", glm::dvec3(0)), 1);
  return pose;
}

}  // namespace simvis
