// Which shapes an element means: those of parts or links, and of some of their materials. Elements such as `label` and
// `temperature` have the attributes `part`, `parts` and `material` for it.
//
// Reach    `part`: the content of the part's file, its links included. `parts`: each insertion point whose name matches
//          when the element is made; of a robot, each link for itself. With neither of them, the insertion point where
//          the element is inserted, for itself. What was inserted at a part is not the part's content.
// Material With `material`, only shapes whose material has this name, or matches it as a pattern. It takes precedence
//          over a selection of the same part without a material.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <simvis/element.h>
#include <simvis/location.h>

namespace simvis {

using SelectedNames = std::set<std::string, std::less<>>;

/// Selected shapes.
struct ShapeSelection {
  SelectedNames points;     ///< insertion points whose shapes are meant
  SelectedNames materials;  ///< names of their materials; empty: any

  bool operator==(const ShapeSelection&) const = default;
};

/// Returns the shapes that the attributes of an element select. `kind` names the element in messages, such as "label".
/// Throws InputError at the attribute for an unknown part or material, and for a pattern that matches nothing.
ShapeSelection selected_shapes(const ElementContext& context, std::string_view kind);

/// The place of the attribute that names the points.
Location selection_place(const ElementContext& context);

/// Shapes that two selections share, neither of them by precedence.
struct SharedShapes {
  std::string point;     ///< an insertion point
  std::string material;  ///< of its shapes; empty: all
};
std::optional<SharedShapes> shared_shapes(const ShapeSelection& a, const ShapeSelection& b);

}  // namespace simvis
