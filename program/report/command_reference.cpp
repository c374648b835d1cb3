#include "program/report/command_reference.h"

#include <simvis/element.h>
#include <simvis/scene.h>
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/language/command_tags.h"
#include "scenegraph/language/statement_attributes.h"

namespace simvis {
namespace {

std::vector<AttributeSpec> joined(AttributeTable first, AttributeTable second = {}) {
  std::vector<AttributeSpec> rows(first.begin(), first.end());
  rows.insert(rows.end(), second.begin(), second.end());
  return rows;
}

}  // namespace

std::vector<CommandForm> command_forms() {
  return {
      {"part",
       "Inserts a file, a shape or an empty frame at an insertion point.",
       joined(kPartCommonRows, Scene::part_attributes()),
       {"name", "insert_at"}},
      {"element",
       "Inserts a programmable object, which has the attributes of its type too.",
       joined(kElementCommonRows),
       {"type", "name", "insert_at"}},
      {"sensor",
       "Inserts a sensor, which has the attributes of its type too.",
       joined(kSensorCommonRows),
       {"type", "name", "insert_at"}},
      {"remove",
       "Removes a part, an element or a sensor, with all that is inserted at it.",
       joined(kRemoveCommonRows, kRemoveRows),
       {"name"}},
      {kRandomize,
       "Draws a parameter of an element in each frame: short for an element of type randomize, which has "
       "this name.",
       joined(find_element_type(kRandomize)->attributes)},
      {kSet, "Defines a variable for ${EXPRESSION}.", joined(kSetRows), {"name", "value"}},
      {kRepeat, "Repeats the commands between its tags.", joined(kRepeatRows), {"count", "as"}},
      {kInclude, "Executes the commands of another scene file.", joined(kIncludeRows), {"file"}},
  };
}

}  // namespace simvis
