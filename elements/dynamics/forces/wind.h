// The element `wind`: moving air, with gusts, for the elements `drag` that name it.
//
//   <element type="wind" name="WIND" insert_at="ROOT" x="5" gust="1.5" gust_time="2"/>
//
// Frames      the world.
// Parameters  x y z: mean velocity; gust: standard deviation of each component (m/s).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <simvis/element.h>
#include <simvis/philox.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

struct WindDesc {
  double gust_time_s = 2;
  double x_m_s = 0, y_m_s = 0, z_m_s = 0, gust_m_s = 0;

  static AttributeRows<WindDesc> rows();
};

class WindElement : public Element {
 public:
  explicit WindElement(const ElementContext& context);
  void update(ParameterView values) override { rows_of<WindDesc>().set(desc_, values); }
  /// The velocity of the air in the world at a time since the start of physics, 0 or later. It depends on the time, the
  /// run's seed, the name and the parameters only, not on earlier calls.
  glm::dvec3 velocity_m_s(double time_s) const;

 private:
  glm::dvec3 gust_at(std::uint64_t knot) const;

  std::string name_;
  SensorRandom random_;
  WindDesc desc_;
  struct Knots {
    std::uint64_t first;
    glm::dvec3 before, after;  // gusts of deviation 1 at the first knot and at the next one
  };
  mutable std::optional<Knots> knots_;  // of the last call
};

}  // namespace simvis
