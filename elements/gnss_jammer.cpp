#include "elements/gnss_jammer.h"

namespace simvis {
namespace {

constexpr AttributeSpec kGnssJammerAttributes[] = {
    {.name = "range",
     .default_value = "100",
     .unit = "m",
     .text = "distance within which receivers have no fix; 0: it is off",
     .min = 0,
     .max = 1e6,
     .live = true},
};

const ElementRegistration kGnssJammerRegistration({
    .name = "gnss_jammer",
    .summary = "Jams receivers of satellite navigation around its insertion point.",
    .notes = "Sensors of type gnss within its range have no fix. Surfaces do not stop it.",
    .attributes = kGnssJammerAttributes,
    .create = create_element<GnssJammer>,
});

}  // namespace

GnssJammer::GnssJammer(const ElementContext& context) : mount_(std::make_shared<Mount>()) {
  mount_->name = context.command.require("name").value;
  context.scene.insert(context.command, mount_);
}

}  // namespace simvis
