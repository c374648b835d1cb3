// Which shapes an element means: those of parts or links, and of these the ones with some names or materials. Elements
// such as `label` and `temperature` have the attributes `part`, `parts`, `shapes` and `material` for it.
//
// Reach    `part` names one object of Scene::objects(), `parts` all that match when the element is made. A part or a
//          model is meant with all of its file; a link is meant for itself. With neither of them, the object where the
//          element is inserted, for itself. What was inserted at a part is not the part's content.
// Level    `level` says which objects the meant shapes make up: see SelectionLevel.
// Shapes   With `shapes`, only shapes that have this name in their file, or one that matches it as a pattern: that of
//          their own, or of a group around them below the insertion point (Flattener::names_of()). The group of the
//          point itself counts if the point is called otherwise.
// Material With `material`, only shapes whose material has this name, or matches it as a pattern.
// Rank     Of the selections that have a shape, the one with the name nearest to it counts, then one with a name, then
//          one with a material.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <simvis/element.h>
#include <simvis/location.h>

namespace simvis {

using SelectedNames = std::set<std::string, std::less<>>;

/// Which objects selected shapes make up.
enum class SelectionLevel : std::uint8_t {
  named,  ///< each object that is named, with its content
  part,   ///< the parts around what is named, each as a whole
  model,  ///< the models around what is named, each as a whole; parts, where no model is
  link,   ///< each link or other object of its own in the content of what is named
  shape   ///< each group of shapes that `names` names; without these, each shape
};

/// Selected shapes.
struct ShapeSelection {
  /// Insertion points whose shapes are meant, each with the name of the object that they make up.
  std::map<std::string, std::string, std::less<>> points;
  bool by_shape = false;    ///< SelectionLevel::shape
  SelectedNames names;      ///< of shapes, or of groups around them, in their files; empty: any
  SelectedNames materials;  ///< names of their materials; empty: any

  bool operator==(const ShapeSelection&) const = default;
};

/// The table of an element that selects shapes: the rows `part`, `parts`, `shapes` and `material`, and its own.
AttributeTable with_selection_rows(AttributeTable own);

/// Returns the shapes that the attributes of an element select. `kind` names the element in messages, such as "label".
/// Throws InputError at the attribute for an unknown part, name or material, and for a pattern that matches nothing.
ShapeSelection selected_shapes(const ElementContext& context, std::string_view kind,
                               SelectionLevel level = SelectionLevel::named);

/// The place of the attribute that names the points.
Location selection_place(const ElementContext& context);

/// Shapes that two selections share, neither of them by precedence.
struct SharedShapes {
  std::string point;     ///< an insertion point
  std::string name;      ///< of its shapes; empty: all
  std::string material;  ///< of its shapes; empty: all

  /// The end of a message about the point: ` for the shapes "leg" and the material "Steel"`, for example. It is empty
  /// if all shapes of the point are shared.
  std::string which() const;
};
std::optional<SharedShapes> shared_shapes(const ShapeSelection& a, const ShapeSelection& b);

}  // namespace simvis
