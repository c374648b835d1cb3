// The element `gnss_jammer`: a transmitter that drowns the signals of satellites around it.
//
//   <element type="gnss_jammer" name="JAM" insert_at="TRUCK" range="0"/>
//
// Parameters  range (live), in metres: receivers of satellite navigation nearer than this have no fix; 0: it is off.
// Frames   it stands at its insertion point.
// Model    Surfaces do not stop it: satellites arrive with less than 1e-15 W, and jammers that are sold transmit 0.01 W
//          to 1 W, so a wall hardly changes the range.
#pragma once

#include <memory>

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class GnssJammer : public Element {
 public:
  explicit GnssJammer(const ElementContext& context);
  void update(ParameterView values) override { range_m_ = values[0]; }

  /// Where it stands. Valid as long as the element.
  const Mount& mount() const { return *mount_; }
  double range_m() const { return range_m_; }

 private:
  std::shared_ptr<Mount> mount_;
  double range_m_ = 0;
};

}  // namespace simvis
