// The element `label`: gives the shapes of parts a class, which the outputs `semantic` of cameras and scanners show.
//
//   <element type="label" name="CHAIRS" insert_at="ROOT" parts="CHAIR_*" class="chair" class_id="62"/>
//   <element type="label" name="LEGS" insert_at="ROOT" part="TABLE" material="Steel" class="leg" class_id="7"/>
//   <element type="label" name="HAND" insert_at="ROBOT/hand" class="hand" class_id="8"/>
//
// Reach    `part`: the content of the part's file, its links included. `parts`: each insertion point whose name matches
//          when the element is made; of a robot, each link for itself. With neither of them, the insertion point where
//          the element is inserted, for itself. What was inserted at a part is not the part's content and has labels of
//          its own.
// Material With `material`, only shapes whose material has this name, or matches it as a pattern. It takes precedence
// over a label of the same part
//          without a material.
// Ids      The first label of a class gives it its id. An id belongs to one class, a class has one id.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

/// A class of shapes.
struct Label {
  std::string element;                           ///< name of the element
  std::string class_name;                        ///< for people
  std::uint32_t class_id = 0;                    ///< at least 1
  std::set<std::string, std::less<>> points;     ///< insertion points whose shapes have the class
  std::set<std::string, std::less<>> materials;  ///< names of their materials; empty: any
};

/// The labels of a scene, in any order. Valid until a label is made or removed.
std::vector<const Label*> labels_of(const Scene& scene);

class LabelElement : public Element {
 public:
  /// Throws InputError at the attribute: no such material, a pattern that matches nothing, a part that has a
  /// label already, a class without an id, or an id of another class.
  explicit LabelElement(const ElementContext& context);
  void update(ParameterView) override {}
};

}  // namespace simvis
