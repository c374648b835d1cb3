// The element `physics`: bodies of the scene move as forces and contacts say.
//
//   <element type="physics" name="PHYSICS" insert_at="ROOT" step="1"/>
//
// A scene has at most one, before its bodies. It applies to the whole scene, independent of insert_at.
// Parameters  running (0 or 1), restarts (a count), both live.
#include <cmath>
#include <memory>

#include "elements/dynamics/dynamic_scene.h"
#include "elements/dynamics/model_part.h"
#include "elements/dynamics/world/engine_module.h"

namespace simvis {
namespace {

class PhysicsElement : public Element, public Stateful {
 public:
  /// Throws InputError for a second one, MachineError if the engine is missing.
  explicit PhysicsElement(const ElementContext& context);
  void update(ParameterView values) override;
  bool moves_itself() const override { return true; }
  void advance(std::int64_t time_ns, std::span<double> values) override;
  void archive(StateArchive& state) override {
    state(restarts_);
    dynamic_->archive(state);
  }

 private:
  std::shared_ptr<DynamicScene> dynamic_;
  std::optional<double> restarts_;
};

constexpr double kNanoseconds_per_ms = 1e6;

constexpr AttributeSpec kPhysicsAttributes[] = {
    {.name = "gravity",
     .kind = AttributeKind::vector,
     .default_value = "0 0 -9.80665",
     .unit = "m/s^2",
     .text = "acceleration of free fall, along the axes of the world",
     .min = -1e4,
     .max = 1e4},
    {.name = "step",
     .default_value = "1",
     .unit = "ms",
     .text = "time from one state of the bodies to the next; a frame shows the last one before it",
     .min = 0.001,
     .max = 100},
    {.name = "iterations",
     .kind = AttributeKind::integer,
     .default_value = "50",
     .text = "passes over all contacts and joints in each step",
     .min = 1,
     .max = 10000},
    {.name = "world",
     .kind = AttributeKind::part,
     .text = "part from an SDF world or an MJCF file that says of gravity, step and iterations what is not given here"},
    {.name = "running",
     .default_value = "1",
     .text = "0 holds all bodies where they are, 1 lets them move",
     .min = 0,
     .max = 1,
     .live = true},
    {.name = "restarts",
     .default_value = "0",
     .text = "each new value puts all bodies back to their start",
     .min = 0,
     .max = 1e9,
     .live = true},
};

const ElementRegistration kPhysicsRegistration({
    .name = "physics",
    .summary = "Moves the bodies of the scene as forces, contacts and joints say.",
    .notes = "A scene has at most one, in front of its elements body, robot and vehicle. Frames do not change what "
             "happens: the bodies advance in whole steps of their own.",
    .attributes = kPhysicsAttributes,
    .create = create_element<PhysicsElement>,
});

ModelWorld read_world(const ElementContext& context) {
  const CommandAttribute* const part = context.command.find("world");
  return part == nullptr ? ModelWorld() : find_model_part(context, *part, "the world of physics").source.world();
}

}  // namespace

PhysicsElement::PhysicsElement(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  const ModelWorld file = read_world(context);
  const double(&gravity)[3] = attributes.vector("gravity");
  WorldDesc world{.gravity_m_s2 = {gravity[0], gravity[1], gravity[2]},
                  .iterations = static_cast<int>(attributes.integer("iterations"))};
  double step_ms = attributes.number("step");
  const auto is_written = [&](std::string_view name) { return context.command.find(name) != nullptr; };
  if (file.gravity_m_s2 && !is_written("gravity")) world.gravity_m_s2 = *file.gravity_m_s2;
  if (file.iterations && !is_written("iterations")) world.iterations = *file.iterations;
  if (file.step_s && !is_written("step")) step_ms = *file.step_s * 1e3;
  const auto step_ns = static_cast<std::int64_t>(std::llround(step_ms * kNanoseconds_per_ms));
  world.step_s = static_cast<double>(step_ns) * 1e-9;
  dynamics_engine();  // a scene whose engine is missing does not load
  dynamic_ = std::make_shared<DynamicScene>(context.scene, world, step_ns);
  declare_dynamic_scene(context, dynamic_);
}

void PhysicsElement::update(ParameterView values) {
  dynamic_->set_running(values[0] >= 0.5);
  if (restarts_ && *restarts_ != values[1]) dynamic_->restart();
  restarts_ = values[1];
}

void PhysicsElement::advance(std::int64_t time_ns, std::span<double> /*values*/) { dynamic_->advance(time_ns); }

}  // namespace simvis
