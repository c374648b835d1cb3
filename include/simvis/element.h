// Elements: freely programmable objects that change the scene online through named scalar parameters.
//
// To add one: a pair of files here with a class, its attribute table, and one static ElementRegistration. Nothing else
// is edited. A class in a user's own program or in a plug-in library registers the same way.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include <simvis/scan.h>
#include <simvis/scene.h>
#include <simvis/version.h>

namespace simvis {

/// Current values of an element's live parameters, in the units and the order of its table.
using ParameterView = std::span<const double>;

/// What a scanner measured and where it stood.
struct ObservedScan {
  const Scan* scan = nullptr;  ///< null before its first
  glm::dmat4 world_from_sensor{1.0};
  std::uint64_t count = 0;  ///< how many it has made: a new number, a new scan
};

/// What elements that draw for people may look at: the frame that the sensors have just seen.
class Observations {
 public:
  virtual ~Observations() = default;
  /// The sensor exists and gives scans: the scene was checked for that.
  virtual ObservedScan scan(std::string_view sensor) const = 0;
  /// False where the mount is not reached.
  virtual bool find_mount(const Mount& mount, glm::dmat4& world_from_mount) const = 0;
};

/// Life     made from its command; `update` is called once right after with every value, then each frame in which one
///          of its parameters changed, never otherwise.
/// Errors   the constructor throws InputError at the command or attribute. `update` gets only values that the table
///          allows; it must not throw.
class Element {
 public:
  virtual ~Element() = default;
  virtual void update(ParameterView values) = 0;
  /// Called once before the first update with the live rows of its table, in their order: may narrow their limits or
  /// name their unit (what lies outside is then refused, in the command too), take away what means nothing to it, and
  /// add rows of its own behind them. Those begin at their default; their texts must live as long as the element.
  virtual void adapt_parameters(std::vector<AttributeSpec>& /*live_rows*/) const {}
  /// Called in each frame of a scene with a visualization, after the sensors have measured and before it is drawn.
  /// What it changes must stand below a VisualSeparator.
  virtual void observe(const Observations& /*seen*/) {}
};

/// What an element's constructor gets.
struct ElementContext {
  const Command& command;             ///< the whole command
  const AttributeValues& attributes;  ///< checked against the type's table
  Scene& scene;                       ///< to put nodes before the insertion point: scene.insert(command, node)
  std::function<Element*(std::string_view)> find_element;  ///< one made before, by name; null when there is none
};

struct ElementType {
  std::string_view name;     ///< the command's `type`
  std::string_view summary;  ///< one sentence
  std::string_view notes{};  ///< what the table does not say: paragraphs, separated by '\n'; may be empty
  AttributeTable attributes;
  std::unique_ptr<Element> (*create)(const ElementContext& context);
};

/// Attributes that every element command may carry besides its type's own.
inline constexpr std::string_view kElementCommonAttributes[] = {"type", "name", "insert_at"};

/// A static object of this type makes an element type known; the strings and the table must live as long.
/// A type whose name is taken, whose table has a mistake, or that was compiled with headers of another version is not
/// made known: load_plugin() refuses the plug-in that has it, and Simulation::load() throws InputError for one of the
/// program itself.
struct ElementRegistration {
  explicit ElementRegistration(const ElementType& type, std::string_view built_for = kHeaderVersion);
};

/// Null when there is none of that name.
const ElementType* find_element_type(std::string_view name);
/// Sorted by name.
std::vector<const ElementType*> element_types();

}  // namespace simvis
