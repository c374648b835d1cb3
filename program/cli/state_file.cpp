#include "program/cli/state_file.h"

#include <filesystem>

#include "engine/base/result_lock.h"
#include "program/cli/load_scene.h"
#include "program/output/atomic_file.h"
#include "program/output/new_folders.h"

namespace simvis {
namespace {

class StateOutlet : public RunOutlet {
 public:
  StateOutlet(const std::filesystem::path& file, Simulation& simulation)
      : simulation_(simulation), folders_(file.has_parent_path() ? file.parent_path() : "."), lock_(file), file_(file) {
    simulation.save_state();  // what cannot be saved is an error now, not after the last frame
  }

  void frame(const FrameTime& /*time*/) override { has_frames_ = true; }
  void finish() override {
    if (!has_frames_) return;
    in_option("--save-state", [&] { file_.write(simulation_.save_state()); });
    file_.commit();
  }

 private:
  Simulation& simulation_;
  NewFolders folders_;  // removed behind the file in them
  ResultLock lock_;
  AtomicFile file_;
  bool has_frames_ = false;
};

}  // namespace

std::unique_ptr<RunOutlet> state_outlet(const Options& options, Simulation& simulation) {
  std::unique_ptr<RunOutlet> outlet;
  in_option("--save-state", [&] { outlet = std::make_unique<StateOutlet>(options.save_state, simulation); });
  return outlet;
}

}  // namespace simvis
