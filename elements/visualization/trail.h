// The element `trail`: the path that a part has come, for people.
//
//   <element type="trail" name="PATH" insert_at="ROOT" part="ROBOT" keep="500"/>
//
// Only cameras with view="visualization" see it. It joins the places of the part's insertion point, where everything
// inserted there has moved it to, in the frames that a visualization camera was there to see. Where the element is
// inserted makes no difference.
// Parameters  width, step (m), keep, red green blue (linear), all live.
#pragma once

#include <deque>
#include <string>

#include <simvis/element.h>
#include "elements/visualization/marker_mesh.h"

namespace simvis {

class TrailElement : public Element {
 public:
  explicit TrailElement(const ElementContext& context);
  void update(ParameterView values) override;
  void observe(const Observations& seen) override;

 private:
  bool add_point(const Observations& seen);
  void draw();

  std::string name_;
  MarkerNodes nodes_;
  std::shared_ptr<Mount> mount_;
  std::deque<glm::dvec3> path_;  // world, the newest last
  double width_m_ = 0, step_m_ = 0;
  std::size_t keep_ = 2;
  glm::vec4 color_{1};
  bool stale_ = false;  // a parameter changed since the mesh was made
};

}  // namespace simvis
