// The element `label`: gives the shapes of parts a class, which the outputs `semantic` of cameras and scanners show.
//
//   <element type="label" name="CHAIRS" insert_at="ROOT" parts="CHAIR_*" class="chair" class_id="62"/>
//   <element type="label" name="LEGS" insert_at="ROOT" part="TABLE" material="Steel" class="leg" class_id="7"/>
//   <element type="label" name="KNOBS" insert_at="ROOT" part="STOVE" shapes="knob_*" class="knob" class_id="9"/>
//   <element type="label" name="HAND" insert_at="ROBOT/hand" class="hand" class_id="8"/>
//
// Reach    see shape_selection.h; what was inserted at a part has labels of its own.
// Objects  A label makes one object, with one id in the output `instance`, of each part or model that it names, with
//          all of its file; of each link; and of the shapes of one name. `level` says otherwise.
// Ids      The first label of a class gives it its id. An id belongs to one class, a class has one id.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>
#include "elements/shape_selection.h"

namespace simvis {

/// A class of shapes.
struct Label {
  std::string element;         ///< name of the element
  std::string class_name;      ///< for people
  std::uint32_t class_id = 0;  ///< at least 1
  ShapeSelection shapes;       ///< that have the class
};

/// The labels of a scene, in any order. Valid until a label is made or removed.
std::vector<const Label*> labels_of(const Scene& scene);

class LabelElement : public Element {
 public:
  /// Throws InputError at the attribute: no such material or name, a pattern that matches nothing, a part that has a
  /// label already, a class without an id, or an id of another class.
  explicit LabelElement(const ElementContext& context);
  void update(ParameterView) override {}
};

}  // namespace simvis
