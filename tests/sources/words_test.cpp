// Names follow the words of the field: a search for occluder, ray packet or TLAS finds them. The words on the left were
// used before and must not come back.
#include <doctest/doctest.h>

#include <cctype>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sources");

namespace simvis {
namespace {

namespace fs = std::filesystem;

// The misleading words, each the beginning of a name, and their replacement.
const std::pair<std::vector<std::string_view>, std::string_view> kWords[] = {
    {{"HiddenParts"}, "OcclusionCuller"},
    {{"walls_of", "find_walls"}, "extract_occluders, find_occluders"},
    {{"StripSight"}, "ColumnOcclusionBuffer"},
    {{"FlatSide"}, "FacePlanes"},
    {{"SliverLimit"}, "FacingTolerance"},
    {{"ClusterFacing", "sees_only_backs", "least_cosine", "bulge"}, "NormalCone, is_backfacing, cutoff, apex_offset"},
    {{"RayBundle", "BundleCaster", "bundle_", "kTogether"}, "RayPacket, PacketCaster, packet_, kPacketSize"},
    {{"walk_tree", "expected_visits", "most_in_leaf"}, "traverse, sah_cost, max_leaf_size"},
    {{"RayTop", "RayMesh", "RayItems", "ray_block"}, "Tlas, Blas, BlasPool, RayInstances, GpuRayInstance"},
    {{"lanes.h", "all4", "all8"}, "simd.h, splat4, splat8"},
    {{"beyond_m", "NearestHit", "HitsAreThere"}, "t_min_m, ClosestHit, HitsReady"},
    {{"PickedVertex", "picks_opaque"}, "CpuSelectedVertex, cpu_selects_opaque"},
    {{"TransparentLayers", "SampleAverage", "mean_pipeline"}, "OitBuffer, ResolvePass"},
    {{"pipelines_of"}, "describe_pipelines"},
    {{"DrawTable", "DrawOrder", "ViewDrawing", "FrameDraws", "ViewShare"},
     "DrawCache, RenderQueue, ViewDrawList, FrameDrawLists, DrawPhase"},
    {{"ListChanges", "restructured("}, "DrawListDelta, mark_structure_dirty"},
    {{"content_order", "compare_content"}, "canonical_order, canonical_compare"},
    {{"pass_over", "require_passable", "LooksBack"}, "skip_frame, require_skippable, HistoryDependence"},
    {{"Duty", "ScanMoment", "ScanChoice", "ScanSurvey", "WorkTable"},
     "DueState, ScanContext, MethodSelector, MethodSurvey, CostModel"},
    {{"lay_out", "hand_over", "develop("}, "configure_rays or make_scan_layout, publish, post_process"},
    {{"show_to_people"}, "draw_visualization"},
    {{"HeldBytes", "ForeignScene", "guarded_child"}, "MemoryLedger, ImportedScene, SandboxedImport"},
};
// These are misleading where a capital letter follows.
constexpr std::string_view kPrefixes[] = {"kMost", "kLeast"};

bool is_word_letter(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) || letter == '_'; }

/// Whether a name in the text begins with this word. Regular expressions of the standard library take fifty times as
/// long.
bool has_word(std::string_view text, std::string_view word, bool before_capital = false) {
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    if (at > 0 && is_word_letter(text[at - 1])) continue;
    const std::size_t end = at + word.size();
    if (!before_capital || (end < text.size() && std::isupper(static_cast<unsigned char>(text[end])))) return true;
  }
  return false;
}

bool may_hold_words(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".h" || ending == ".cpp" || ending == ".glsl" || ending == ".vert" || ending == ".frag" ||
         ending == ".comp";
}

}  // namespace

TEST_CASE("a misleading word is found where a name begins with it") {
  CHECK(has_word("(HiddenParts)", "HiddenParts"));
  CHECK(has_word("NotHiddenParts HiddenPartsOf", "HiddenParts"));
  CHECK_FALSE(has_word("NotHiddenParts, a_HiddenParts", "HiddenParts"));
  CHECK(has_word("kMostly kMostBeams", "kMost", true));
  CHECK_FALSE(has_word("kMostly kMost", "kMost", true));
}

TEST_CASE("the sources contain no misleading word") {
  int files = 0;
  for (const char* folder : {"include", "exchange", "shaders", "engine", "scenegraph", "import", "elements", "effects",
                             "sensors", "simvis", "program", "python", "bench", "tests"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(SIMVIS_SOURCE_DIR) / folder)) {
      if (!entry.is_regular_file() || !may_hold_words(entry.path())) continue;
      if (entry.path().filename() == "words_test.cpp") continue;
      ++files;
      const std::string text = read_text(entry.path());
      CAPTURE(entry.path());
      for (const auto& [misleading, instead] : kWords) {
        for (const std::string_view word : misleading) {
          if (has_word(text, word)) FAIL_CHECK("\"" << word << "\", expected " << instead);
        }
      }
      for (const std::string_view prefix : kPrefixes) {
        if (has_word(text, prefix, true)) FAIL_CHECK("\"" << prefix << "...\", expected kMax... or kMin...");
      }
    }
  }
  CHECK(files > 500);
}

}  // namespace simvis

TEST_SUITE_END();
