// Measures the time that accuracy costs: every method of a laser scanner, at each resolution and tolerance, in several
// scenes, with a planar scanner and with a lidar, compared with a ray cast in double; and bare Embree in single
// precision.
//
//   accuracy [EVERY [SCENE...]]
//
// EVERY: only each EVERY-th station and heading is measured (1: all of them). SCENE: only these scenes. Prints one CSV
// row per variant; bench/results/accuracy.md describes the columns. Compare times within one run only.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numeric>
#include <string>
#include <vector>

#include "bench/accuracy/measure.h"
#include "bench/bare_embree.h"

namespace {

using namespace simvis;
using namespace simvis::bench;

constexpr float kOtherSurface = 1e-3f;  // relative; larger errors are not caused by rounding

/// True if a texture cuts holes into a surface, which bare Embree ignores.
bool has_masks(const DrawList& list) {
  return std::ranges::any_of(list.items, [&](const DrawItem& item) {
    const Material& material = *list.materials[item.material];
    return material.alpha_mode != AlphaMode::opaque && material.base_color_texture != nullptr && !lets_pass(material);
  });
}

void print_header() {
  std::puts(
      "scene,scanner,method,max_error_rel,resolution_px,scans,beams,median_ms,p10_ms,p90_ms,ratio_to_cheapest,"
      "error_rel_median,error_rel_p99,error_rel_p999,error_rel_max,share_wrong_hit,share_above_1e-3,share_cast,"
      "bound_rel_median,bound_violations,bound_violations_narrow,masks");
}

void print(const AccuracyScene& scene, const AccuracyScanner& scanner, Result& r, double cheapest_ms, bool masks) {
  BeamErrors& e = r.errors;
  const auto share = [&](std::size_t beams) { return static_cast<double>(beams) / static_cast<double>(e.beams); };
  const auto above = static_cast<std::size_t>(std::ranges::count_if(
      e.relative_errors, [](float error) { return std::isfinite(error) && error > kOtherSurface; }));
  const double median_ms = quantile(r.times_ms, 0.5);
  std::printf("%s,%s,%s,%s,", scene.name.c_str(), scanner.name.c_str(), r.method.c_str(), r.max_error_rel.c_str());
  if (r.resolution_px > 0) std::printf("%d", r.resolution_px);
  std::printf(",%zu,%zu,%.4g,%.4g,%.4g,%.3f,", r.times_ms.size(), e.beams, median_ms, quantile(r.times_ms, 0.1),
              quantile(r.times_ms, 0.9), median_ms / cheapest_ms);
  std::printf("%.3g,%.3g,%.3g,%.3g,%.3g,%.3g,", quantile(e.relative_errors, 0.5), quantile(e.relative_errors, 0.99),
              quantile(e.relative_errors, 0.999), quantile(e.relative_errors, 1), share(e.wrong_hits), share(above));
  const double share_cast =
      std::accumulate(r.cast_shares.begin(), r.cast_shares.end(), 0.0) / static_cast<double>(r.cast_shares.size());
  if (!std::isnan(share_cast)) std::printf("%.3g", share_cast);
  if (r.peer) {
    std::printf(",,,,%s\n", masks ? "ignored" : "none");
  } else {
    std::printf(",%.3g,%zu,%zu,%s\n", quantile(e.relative_bounds, 0.5), e.violations, e.narrow_violations,
                masks ? "seen" : "none");
  }
}

void measure_scene(const AccuracyScene& scene, int every) {
  for (const AccuracyScanner& scanner : accuracy_scanners()) {
    std::fprintf(stderr, "accuracy: %s, %s\n", scene.name.c_str(), scanner.name.c_str());
    std::optional<Simulation> simulation = scene.load();
    if (!simulation) {
      std::fprintf(stderr, "accuracy: %s is skipped: its files are not here\n", scene.name.c_str());
      return;
    }
    std::vector<Result> results = measure(*simulation, scene, scanner, every);
    double cheapest_ms = INFINITY;
    for (Result& result : results) {
      if (!result.peer) cheapest_ms = std::min(cheapest_ms, quantile(result.times_ms, 0.5));
    }
    const bool masks = has_masks(simulation->diagnostics().draw_list());
    for (Result& result : results) print(scene, scanner, result, cheapest_ms, masks);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const int every = argc > 1 ? std::atoi(argv[1]) : 1;
  const std::vector<std::string> wanted(argv + std::min(argc, 2), argv + argc);
  const std::vector<AccuracyScene> scenes = accuracy_scenes();
  const bool known = std::ranges::all_of(
      wanted, [&](const std::string& name) { return std::ranges::count(scenes, name, &AccuracyScene::name) > 0; });
  if (every < 1 || !known) {
    std::fprintf(stderr, "usage: accuracy [EVERY [SCENE...]], EVERY from 1, SCENE one of");
    for (const AccuracyScene& scene : scenes) std::fprintf(stderr, " %s", scene.name.c_str());
    std::fprintf(stderr, "\n");
    return 2;
  }
  print_header();
  for (const AccuracyScene& scene : scenes) {
    if (wanted.empty() || std::ranges::count(wanted, scene.name) > 0) measure_scene(scene, every);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "accuracy: %s\n", error.what());
  return 1;
}
