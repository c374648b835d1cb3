// Makes nodes from the geoms of an MJCF model.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "engine/base/read_scope.h"
#include "import/mjcf/mjcf_assets.h"
#include "import/mjcf/mjcf_tree.h"
#include "import/model/model_description.h"
#include "import/model/shape_nodes.h"
#include "import/model/shown_visuals.h"

namespace simvis {

/// body_from_geom: between the two points of `fromto`, or else mjcf_pose(). Throws InputError for points at one place.
glm::dmat4 mjcf_geom_pose(const MjcfElement& geom);

/// Geoms of groups 0, 1 and 2 are shown, as in MuJoCo's own viewer; those of other groups are collision shapes by
/// convention. A plane without limits has no end for rays and is drawn as endless_plane_mesh() says. A geom that is
/// wholly transparent is not drawn.
class MjcfGeoms {
 public:
  MjcfGeoms(const ImportRequest& request, const MjcfTree& tree, ImportReport& report, ContentPool& pool)
      : scope_(scope_of_model(request.file)),
        report_(report),
        pool_(pool),
        shape_meshes_(pool),
        assets_(*tree.assets, report, pool),
        shown_(request) {}

  /// Null: the geom is not drawn, or it is left out with a warning: wrong sizes, a mesh or a field of heights that is
  /// missing or broken.
  NodePtr make(const MjcfElement& geom);

  /// Which of the geoms have been made.
  const ShownVisuals& shown() const { return shown_; }

 private:
  NodePtr build(const MjcfElement& geom);
  void add_shape(const MjcfElement& geom, const std::string& type, const MjcfLook& look, Group& group);

  static std::optional<ReadScope> scope_of_model(const std::filesystem::path& file);

  std::optional<ReadScope> scope_;  // of ModelFence
  ImportReport& report_;
  ContentPool& pool_;
  ShapeMeshes shape_meshes_;
  MjcfAssets assets_;
  ShownVisuals shown_;
};

}  // namespace simvis
