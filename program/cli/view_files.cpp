#include "program/cli/view_files.h"

#include <filesystem>

#include <simvis/diagnostics.h>
#include "engine/base/result_lock.h"
#include "program/cli/load_scene.h"
#include "program/cli/map_outlet.h"
#include "program/live/glb_file.h"
#include "program/live/page_recording.h"
#include "program/maps/map_files.h"
#include "program/output/atomic_file.h"
#include "program/output/new_folders.h"

namespace simvis {
namespace {

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

class ExportOutlet : public RunOutlet {
 public:
  ExportOutlet(const std::filesystem::path& file, const Simulation& simulation)
      : simulation_(simulation), folders_(folder_of(file)), lock_(file), file_(file) {}

  void frame(const FrameTime& /*time*/) override { has_frames_ = true; }
  void finish() override {
    if (!has_frames_) return;
    file_.write(live::glb_bytes(simulation_.diagnostics().draw_list(), simulation_.items()));
    file_.commit();
  }
  bool shows_all_content() const override { return true; }

 private:
  const Simulation& simulation_;
  NewFolders folders_;  // removed behind the files in them
  ResultLock lock_;
  AtomicFile file_;
  bool has_frames_ = false;
};

class PageOutlet : public RunOutlet {
 public:
  PageOutlet(const std::filesystem::path& file, Simulation& simulation)
      : simulation_(simulation), folders_(folder_of(file)), page_(file) {}

  void frame(const FrameTime& time) override { page_.add(simulation_, time); }
  void finish() override {
    if (page_.has_frames()) page_.finish();
  }
  bool shows_all_content() const override { return true; }

 private:
  Simulation& simulation_;
  NewFolders folders_;  // removed behind the files in them
  live::PageRecording page_;
};

}  // namespace

std::unique_ptr<RunOutlet> export_outlet(const Options& options, Simulation& simulation) {
  require_map_for_map_options(options);
  if (map_format_of(options.export_file)) return map_outlet(options, simulation);
  std::unique_ptr<RunOutlet> outlet;
  in_option("--export", [&] { outlet = std::make_unique<ExportOutlet>(options.export_file, simulation); });
  return outlet;
}

std::unique_ptr<RunOutlet> page_outlet(const Options& options, Simulation& simulation) {
  std::unique_ptr<RunOutlet> outlet;
  in_option("--page", [&] { outlet = std::make_unique<PageOutlet>(options.page, simulation); });
  return outlet;
}

}  // namespace simvis
