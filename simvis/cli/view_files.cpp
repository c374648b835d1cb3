#include "simvis/cli/view_files.h"

#include <filesystem>

#include <simvis/diagnostics.h>
#include "live/glb_file.h"
#include "simvis/built_scene.h"

namespace simvis {
namespace {

const std::string& with_folder(const std::string& file) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (!folder.empty()) make_folder(folder);
  return file;
}

}  // namespace

ViewFiles::ViewFiles(const std::string& glb, const std::string& page) {
  if (!glb.empty()) glb_.emplace(with_folder(glb));
  if (!page.empty()) page_.emplace(with_folder(page));
}

void ViewFiles::add(Simulation& simulation, const FrameTime& time, double step_ms) {
  has_frames_ = true;
  if (page_) page_->add(copier_.copy(simulation, time, step_ms, {.every_sensor = true, .plan = true}));
}

void ViewFiles::finish(const Simulation& simulation) {
  if (!has_frames_) return;
  if (page_) page_->finish();
  if (!glb_) return;
  const Diagnostics diagnostics = simulation.diagnostics();
  glb_->write(live::glb_bytes(diagnostics.draw_list(), simulation.items()));
  glb_->commit();
}

}  // namespace simvis
