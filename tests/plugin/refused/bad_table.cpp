// A plug-in whose table of attributes has a default that the row itself does not allow.
#include <simvis/element.h>

#include <memory>

namespace simvis {
namespace {

class Nothing : public Element {
 public:
  void update(ParameterView) override {}
};

std::unique_ptr<Element> create(const ElementContext&) { return std::make_unique<Nothing>(); }

constexpr AttributeSpec kAttributes[] = {
    {.name = "size", .default_value = "-1", .unit = "m", .text = "length of its edges", .min = 0, .live = true},
};
const ElementRegistration kBad(
    {.name = "bad_table", .summary = "does nothing", .attributes = kAttributes, .create = create});

}  // namespace
}  // namespace simvis
