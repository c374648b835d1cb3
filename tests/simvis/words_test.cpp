// Names follow the words of the field: a search for occluder, ray packet or TLAS finds them. The words on the left were
// used before and must not come back.
#include <doctest/doctest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <utility>

#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

// The misleading word and its replacement.
const std::pair<const char*, const char*> kWords[] = {
    {"HiddenParts", "OcclusionCuller"},
    {"walls_of|find_walls", "extract_occluders, find_occluders"},
    {"StripSight", "ColumnOcclusionBuffer"},
    {"FlatSides?", "FacePlanes"},
    {"SliverLimit", "FacingTolerance"},
    {"ClusterFacing|sees_only_backs", "NormalCone, is_backfacing"},
    {"RayBundle|BundleCaster", "RayPacket, PacketCaster"},
    {"walk_tree|expected_visits|most_in_leaf", "traverse, sah_cost, max_leaf_size"},
    {"RayTop|RayMesh|RayMeshPool|RayItems", "Tlas, Blas, BlasPool, RayInstances"},
    {"beyond_m|NearestHit|HitsAreThere", "t_min_m, ClosestHit, HitsReady"},
    {"PickedVertex|picks_opaque", "CpuSelectedVertex, cpu_selects_opaque"},
    {"TransparentLayers|SampleAverage", "OitBuffer, ResolvePass"},
    {"DrawTable|DrawOrder|ViewDrawing|FrameDraws|ViewShare",
     "DrawCache, RenderQueue, ViewDrawList, FrameDrawLists, DrawPhase"},
    {"ListChanges|restructured\\(", "DrawListDelta, mark_structure_dirty"},
    {"content_order|compare_content", "canonical_order, canonical_compare"},
    {"pass_over|require_passable|LooksBack", "skip_frame, require_skippable, HistoryDependence"},
    {"Duty|ScanMoment|ScanChoice|ScanSurvey|WorkTable",
     "DueState, ScanContext, MethodSelector, MethodSurvey, CostModel"},
    {"lay_out|hand_over", "configure_rays or make_scan_layout, publish"},
    {"kMost[A-Z]\\w*|kLeast[A-Z]\\w*", "kMax..., kMin..."},
    {"HeldBytes|ForeignScene|guarded_child", "MemoryLedger, ImportedScene, SandboxedImport"},
};

bool is_source(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".h" || ending == ".cpp" || ending == ".glsl" || ending == ".vert" || ending == ".frag" ||
         ending == ".comp";
}

}  // namespace

TEST_CASE("the sources contain no misleading word") {
  int files = 0;
  for (const char* folder : {"include", "clients", "shaders", "engine", "scenegraph", "elements", "effects", "sensors",
                             "simvis", "bench", "tests"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(SIMVIS_SOURCE_DIR) / folder)) {
      if (!entry.is_regular_file() || !is_source(entry.path())) continue;
      if (entry.path().filename() == "words_test.cpp") continue;
      ++files;
      const std::string text = read_text(entry.path());
      for (const auto& [misleading, instead] : kWords) {
        std::smatch found;
        if (!std::regex_search(text, found, std::regex("\\b(" + std::string(misleading) + ")"))) continue;
        FAIL_CHECK(entry.path().string() << ": \"" << found.str() << "\", expected " << instead);
      }
    }
  }
  CHECK(files > 500);
}

}  // namespace simvis

TEST_SUITE_END();
