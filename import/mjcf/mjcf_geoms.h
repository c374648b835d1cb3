// Makes nodes from the geoms of an MJCF model.
#pragma once

#include <string>

#include "import/mjcf/mjcf_assets.h"

namespace simvis {

/// Geoms of groups 0, 1 and 2 are shown, as in MuJoCo's own viewer; those of other groups are collision shapes by
/// convention. A plane without limits has no end for rays and is drawn as endless_plane_mesh() says. A geom that is
/// wholly transparent is not drawn.
class MjcfGeoms {
 public:
  MjcfGeoms(const MjcfModel& model, SdfReport& report, ContentPool& pool)
      : model_(model), report_(report), pool_(pool), assets_(model, report, pool) {}

  /// Null: the geom is not drawn, or it is left out with a warning: wrong sizes, a mesh that is missing or broken, and
  /// fields of heights.
  NodePtr make(const MjcfElement& geom);

  /// Throws InputError with the first reason if every geom was left out, so that no model is invisible.
  void require_any() const;

 private:
  NodePtr build(const MjcfElement& geom);
  void add_shape(const MjcfElement& geom, const std::string& type, Group& group);
  void add_mesh(const MjcfElement& geom, Group& group);

  const MjcfModel& model_;
  SdfReport& report_;
  ContentPool& pool_;
  MjcfAssets assets_;
  std::string first_left_out_;
  bool has_any_ = false;
};

}  // namespace simvis
