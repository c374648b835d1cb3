// The element `trail`: draws the path that a part has taken.
//
//   <element type="trail" name="PATH" insert_at="ROOT" part="ROBOT" keep="500"/>
//
// Only cameras with view="visualization" see it. The trail joins the positions of the part's insertion point, after all
// elements that are inserted there have moved it. It has points only from frames in which the scene had a
// visualization. The insertion point of the element itself has no effect.
// Parameters  width, step (m), keep, red green blue (linear), all live.
#pragma once

#include <deque>
#include <string>

#include <simvis/element.h>
#include <simvis/state_archive.h>
#include "elements/visualization/marker_mesh.h"

namespace simvis {

struct TrailLook {
  double width_m = 0.03, step_m = 0.05;
  double keep = 2000;  ///< points
  glm::vec3 color{0.05f, 0.2f, 0.9f};
};

class TrailElement : public Element, public Stateful {
 public:
  explicit TrailElement(const ElementContext& context);
  void update(ParameterView values) override;
  void observe(const Observations& seen) override;
  void archive(StateArchive& state) override;

 private:
  bool add_point(const Observations& seen);
  void draw();

  std::string name_;
  MarkerNodes nodes_;
  std::shared_ptr<Mount> mount_;
  std::deque<glm::dvec3> path_;  // in the world frame, the newest last
  TrailLook look_;
  bool stale_ = false;  // a parameter changed after the mesh was made
};

}  // namespace simvis
