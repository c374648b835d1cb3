// door.cpp: an element that turns what follows its insertion point about the z axis, like a door on its hinge.
#include <simvis/element.h>
#include <simvis/pose.h>

namespace {

constexpr simvis::AttributeSpec kAttributes[] = {
    {.name = "open", .default_value = "0", .unit = "%", .text = "how open", .min = 0, .max = 100, .live = true},
};

class Door : public simvis::Element {
 public:
  explicit Door(const simvis::ElementContext& context) : hinge_(std::make_shared<simvis::Transform>()) {
    context.scene.insert(context.command, hinge_);
  }
  void update(simvis::ParameterView values) override {  // called when a live parameter has changed
    hinge_->set_matrix(simvis::matrix_from_degrees({0, 0, 0}, 0, 0, 0.9 * values[0]));
  }

 private:
  std::shared_ptr<simvis::Transform> hinge_;
};

const simvis::ElementRegistration kRegistration({
    .name = "door",
    .summary = "Turns what follows its insertion point about the z axis, like a door on its hinge.",
    .attributes = kAttributes,
    .create = simvis::create_element<Door>,
});

}  // namespace
