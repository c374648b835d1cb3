#include "program/cli/view_files.h"

#include <filesystem>

#include <simvis/diagnostics.h>
#include "program/cli/load_scene.h"
#include "program/live/glb_file.h"
#include "simvis/built_scene.h"

namespace simvis {
namespace {

void make_folder_of(const std::string& file) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (!folder.empty()) make_folder(folder);
}

}  // namespace

ViewFiles::ViewFiles(const std::string& glb, const std::string& page) {
  if (!glb.empty()) {
    in_option("--export", [&] {
      make_folder_of(glb);
      glb_lock_.emplace(glb);
      glb_.emplace(glb);
    });
  }
  if (!page.empty()) {
    in_option("--page", [&] {
      make_folder_of(page);
      page_.emplace(page);
    });
  }
}

void ViewFiles::add(Simulation& simulation, const FrameTime& time) {
  has_frames_ = true;
  if (page_) page_->add(simulation, time);
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
