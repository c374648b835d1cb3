// Elements: freely programmable objects that change the scene online through named scalar parameters.
//
// To add one: a pair of files here with a class, its attribute table, and one static ElementRegistration. Nothing else
// is edited. A class in a user's own program or in a plug-in library registers the same way.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenegraph/attributes.h"
#include "scenegraph/command.h"
#include "scenegraph/scene.h"

namespace simvis {

/// Current values of an element's live parameters, in the units and the order of its table.
using ParameterView = std::span<const double>;

/// Life     made from its command; `update` is called once right after with every value, then each frame in which one
///          of its parameters changed, never otherwise.
/// Errors   the constructor throws InputError at the command or attribute. `update` gets only values that the table
///          allows; it must not throw.
class Element {
 public:
  virtual ~Element() = default;
  virtual void update(ParameterView values) = 0;
  /// Called once before the first update: narrows the limits of this element's own live rows, in the order of its
  /// table, or names their unit. What lies outside is then refused, in the command too.
  virtual void limit_parameters(std::span<AttributeSpec> /*live_rows*/) const {}
};

/// What an element's constructor gets.
struct ElementContext {
  const Command& command;             ///< the whole command
  const AttributeValues& attributes;  ///< checked against the type's table
  Scene& scene;                       ///< to put nodes before the insertion point: scene.insert(command, node)
};

struct ElementType {
  std::string_view name;     ///< the command's `type`
  std::string_view summary;  ///< one sentence for people
  AttributeTable attributes;
  std::unique_ptr<Element> (*create)(const ElementContext& context);
};

/// Attributes that every element command may carry besides its type's own.
inline constexpr std::string_view kElementCommonAttributes[] = {"type", "name", "insert_at"};

/// A static object of this type makes an element type known; the strings and the table must live as long.
/// Two types of one name, or a table with a mistake in it: the program stops with a message naming it.
struct ElementRegistration {
  explicit ElementRegistration(const ElementType& type);
};

/// Null when there is none of that name.
const ElementType* find_element_type(std::string_view name);
/// Sorted by name.
std::vector<const ElementType*> element_types();

}  // namespace simvis
