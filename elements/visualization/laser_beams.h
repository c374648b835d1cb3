// The element `laser_beams`: draws the beams of a scanner and the points that they hit.
//
//   <element type="laser_beams" name="BEAMS" insert_at="ROOT" scanner="FRONT_SCANNER" red="1" opacity="0.5"/>
//
// Only cameras with view="visualization" see them. The beams start at the position of the scanner at the time of the
// scan. The insertion point of the element has no effect.
// Parameters  width, size, miss_length (m), every, opacity, red green blue (linear), all live.
#pragma once

#include <cstdint>
#include <string>

#include <simvis/element.h>
#include <simvis/state_archive.h>
#include "elements/visualization/marker_mesh.h"

namespace simvis {

struct LaserBeamsLook {
  double width_m = 0.01, size_m = 0.04;  ///< of beams and of hits
  double every = 1, miss_length_m = 0;
  double opacity = 0.3;  ///< of the beams; the hits are opaque
  glm::vec3 color{1, 0.05f, 0.02f};
};

class LaserBeamsElement : public Element, public Stateful {
 public:
  explicit LaserBeamsElement(const ElementContext& context);
  void update(ParameterView values) override;
  void observe(const Observations& seen) override;
  void archive(StateArchive& state) override;

 private:
  void draw(const Scan& scan);

  std::string name_, scanner_;
  MarkerNodes nodes_;
  LaserBeamsLook look_;
  std::uint64_t drawn_ = 0;  // ObservedScan::count of the scan in the mesh
  bool stale_ = false;       // a parameter changed after the mesh was made
};

}  // namespace simvis
