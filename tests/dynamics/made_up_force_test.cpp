// A force that is no part of SimVis: one file makes it, and nothing else knows it.
#include <doctest/doctest.h>

#include <cmath>

#include "elements/dynamics/forces/wrench_element.h"
#include "tests/support/moved_body.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// A spring to the origin of the world.
struct HomingDesc {
  double stiffness_n_m = 1;
  static AttributeRows<HomingDesc> rows() {
    return {row(&HomingDesc::stiffness_n_m, "stiffness", "N/m", kAboveZero, "of the spring").live()};
  }
};

class HomingElement : public WrenchElement {
 public:
  explicit HomingElement(const ElementContext& context)
      : WrenchElement(context), desc_(rows_of<HomingDesc>().read(context.attributes)) {}
  void update(ParameterView values) override { rows_of<HomingDesc>().set(desc_, values); }
  Wrench wrench(const PushedBody& body, const PhysicsStep&) override {
    return {.force_n = -desc_.stiffness_n_m * body.state.center_m};
  }

 private:
  HomingDesc desc_;
};

const ElementRegistration kHomingRegistration({
    .name = "made_up_homing",
    .summary = "Pulls a body to the origin.",
    .attributes = rows_of<HomingDesc>().table(),
    .create = create_element<HomingElement>,
});

TEST_CASE("an element of one file pushes bodies, by parameters") {
  MovedBody ball(physics("gravity='0 0 0'") +
                     body("BALL", "shape='sphere' radius='0.1' pose_offset='1 0 0 0 0 0'", "mass='2' shape='sphere'") +
                     "<element type='made_up_homing' name='HOME' insert_at='BALL' stiffness='8'/>",
                 "BALL");
  constexpr double kRate_rad_s = 2;  // sqrt(8 / 2)
  // Semi-implicit steps of h move the swing by w h / 2 of itself.
  constexpr double kOfStep_m = kRate_rad_s * kStep_s / 2;
  for (int i = 1; i <= 20; ++i) {
    ball.scene.go_to(0.1 * i);
    CHECK(std::abs(ball.motion().center_m.x - std::cos(kRate_rad_s * 0.1 * i)) < 1.1 * kOfStep_m);
  }
  ball.scene.set("HOME", "stiffness", 1e-9);
  const double speed = ball.motion().velocity_m_s.x;
  ball.scene.go_to(2.5);
  CHECK(std::abs(ball.motion().velocity_m_s.x - speed) < 1e-8);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
