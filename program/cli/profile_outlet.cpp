#include "program/cli/profile_outlet.h"

#include "engine/base/now_ns.h"
#include "program/cli/load_scene.h"
#include "program/report/profile.h"

namespace simvis {
namespace {

class ProfileOutlet : public RunOutlet {
 public:
  ProfileOutlet(const Options& options, const Simulation& simulation)
      : simulation_(simulation),
        profile_(options.profile, simulation.diagnostics().device()->name)  // instrumented, so it is open
  {}

  void frame(const FrameTime& time) override {
    const Diagnostics diagnostics = simulation_.diagnostics();
    profile_.add({.index = time.index,
                  .stages = diagnostics.stages(),
                  .written_ns = now_ns(),
                  .sensors = diagnostics.sensor_costs(),
                  .counters = diagnostics.counters(),
                  .device_memory_bytes = diagnostics.device_memory_bytes()});
    profile_.add(diagnostics.frame_plan(), *diagnostics.frame_costs());
    if (const FramePlan* const plan = diagnostics.visualization_plan()) {
      profile_.add(*plan, *diagnostics.visualization_costs());
    }
  }
  void finish() override { profile_.commit(); }

 private:
  const Simulation& simulation_;
  Profile profile_;
};

}  // namespace

std::unique_ptr<RunOutlet> profile_outlet(const Options& options, const Simulation& simulation) {
  std::unique_ptr<RunOutlet> outlet;
  in_option("--profile", [&] { outlet = std::make_unique<ProfileOutlet>(options, simulation); });
  return outlet;
}

}  // namespace simvis
