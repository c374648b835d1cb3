// A test outside SimVis that fails: what it leaves in the folder that it is given has the types of this program.
//
// Usage  failing_run SCENE.xml FOLDER, which prints the verdict
#include <simvis/element.h>
#include <simvis/error.h>
#include <simvis/reading_sensor.h>
#include <simvis/testing.h>

#include <cstdio>
#include <iterator>
#include <memory>

namespace {

constexpr simvis::AttributeSpec kAttributes[] = {
    {.name = "load", .default_value = "1", .unit = "kg", .text = "what the gripper carries", .live = true}};

struct Gripper : simvis::Element {
  void update(simvis::ParameterView) override {}
};

const simvis::ElementRegistration kGripper({
    .name = "own_gripper",
    .summary = "a gripper of this program",
    .attributes = kAttributes,
    .create = [](const simvis::ElementContext&) -> std::unique_ptr<simvis::Element> {
      return std::make_unique<Gripper>();
    },
});

const simvis::TableColumn kColumns[] = {
    {.name = "own_charge", .format = "%.9g", .unit = "1", .meaning = "of the battery, from 0 to 1"}};

class Battery : public simvis::ReadingSensor {
 public:
  Battery() : ReadingSensor({std::begin(kColumns), std::end(kColumns)}) {}
  void collect(const simvis::FrameTime& time, const simvis::FramePlan&, std::span<const simvis::PassResult>) override {
    set_reading(time, {1 - 1e-9 * static_cast<double>(time.time_ns)});
  }
  std::string method() const override { return "a battery that lasts for a second"; }
};

const simvis::SensorRegistration kBattery({
    .name = "own_battery",
    .summary = "a battery of this program",
    .create = [](const simvis::SensorContext&) -> std::unique_ptr<simvis::Sensor> {
      return std::make_unique<Battery>();
    },
    .outputs =
        [](const simvis::SensorContext&) { return simvis::column_outputs(kColumns, simvis::OutputKind::scalar); },
});

simvis::test_kit::Verdict charged(const simvis::Simulation& simulation) {
  const double charge = simulation.value("BATTERY", "own_charge");
  return {charge > 0.5, "the charge is " + std::to_string(charge), {}};
}

}  // namespace

int main(int, char** arguments) {
  try {
    simvis::test_kit::Run run(arguments[1], {.simulation = {}, .evidence = arguments[2], .name = "outside"});
    run.always(charged);
    while (run.step()) {
    }
    std::printf("%s\n", run.result().text.c_str());
    return run.result() ? 1 : 0;
  } catch (const simvis::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
