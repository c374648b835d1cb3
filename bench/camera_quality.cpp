// Measures the cost and the benefit of supersampling and MSAA: cameras of scenes/marvin and scenes/arm, each variant
// compared with a reference of 256 samples per pixel.
//
//   camera_quality [FRAMES [SCENE.xml CAMERA]...]
//
// Prints CSV. Every variant is timed in every round, so that other load on the machine affects all alike: compare
// ratios. A frame is a step of one camera with colour only: flattening, rendering, averaging, the image in memory. The
// reference has four times the width and height and 16 samples per pixel, and is averaged over 4 x 4 pixels. rms_linear
// is over R, G, B in linear light, rms_grey_levels over their sRGB codes as in the PNG file, 0 to 255; psnr_db is that
// of the codes.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "engine/base/srgb.h"

namespace {

using namespace simvis;
using Clock = std::chrono::steady_clock;

struct Variant {
  int supersampling, msaa;
  int samples() const { return supersampling * msaa; }
};
constexpr Variant kVariants[] = {{1, 1}, {1, 2}, {1, 4}, {1, 8}, {4, 1}, {4, 2}, {4, 4}, {4, 8}, {16, 1}, {16, 4}};
constexpr int kWarmUp = 2;
constexpr std::uint32_t kFiner = 4;

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

/// Loads the scene with only this camera on, for colour alone. `finer` multiplies its width and height.
Simulation load(const std::filesystem::path& scene, const std::string& camera, const Variant& variant,
                const Image& size, std::uint32_t finer) {
  SimulationDesc desc;
  const auto override = [&](const char* attribute, const std::string& value) {
    desc.overrides.push_back({"camera", attribute, value, "camera_quality"});
  };
  override("supersampling", std::to_string(variant.supersampling));
  override("msaa", std::to_string(variant.msaa));
  override("outputs", "color");
  if (finer > 1) {
    override("width", std::to_string(finer * size.width));
    override("height", std::to_string(finer * size.height));
  }
  Simulation simulation = Simulation::load(scene, desc);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name == camera);
  return simulation;
}

Image averaged(const Image& fine) {
  Image coarse{fine.width / kFiner, fine.height / kFiner, fine.channels, {}};
  std::vector<float>& pixels = coarse.pixels.edit();
  const std::size_t channels = fine.channels;
  for (std::size_t y = 0; y < coarse.height; ++y) {
    for (std::size_t x = 0; x < coarse.width; ++x) {
      for (std::size_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (std::size_t dy = 0; dy < kFiner; ++dy) {
          for (std::size_t dx = 0; dx < kFiner; ++dx) {
            sum += fine.pixels[((y * kFiner + dy) * fine.width + x * kFiner + dx) * channels + c];
          }
        }
        pixels.push_back(static_cast<float>(sum / (kFiner * kFiner)));
      }
    }
  }
  return coarse;
}

struct Errors {
  double linear = 0, grey_levels = 0;  ///< root of the mean square
};

Errors compare(const Image& image, const Image& reference) {
  Errors errors;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (i % image.channels == 3) continue;  // alpha
    const double linear = image.pixels[i] - reference.pixels[i];
    const double grey = srgb_code(image.pixels[i]) - srgb_code(reference.pixels[i]);
    errors.linear += linear * linear;
    errors.grey_levels += grey * grey;
  }
  const double count = 3.0 * image.width * image.height;
  return {std::sqrt(errors.linear / count), std::sqrt(errors.grey_levels / count)};
}

void measure(const std::filesystem::path& scene, const std::string& camera, int frames) {
  std::vector<Variant> variants;
  std::vector<Simulation> simulations;
  for (const Variant& variant : kVariants) {
    try {
      simulations.push_back(load(scene, camera, variant, {}, 1));
    } catch (const InputError&) {  // this device does not support this msaa
      if (variant.msaa == 1) throw;
      continue;
    }
    variants.push_back(variant);
  }
  std::vector<std::vector<double>> times_ms(variants.size());
  for (int frame = 0; frame < kWarmUp + frames; ++frame) {
    for (std::size_t turn = 0; turn < variants.size(); ++turn) {
      const std::size_t v = (turn + static_cast<std::size_t>(frame)) % variants.size();  // no variant is always first
      const auto start = Clock::now();
      simulations[v].step();
      const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
      if (frame >= kWarmUp) times_ms[v].push_back(ms);
    }
  }
  const Image& plain = simulations.front().color(camera);
  Simulation fine = load(scene, camera, {16, 1}, plain, kFiner);
  fine.step();
  const Image reference = averaged(fine.color(camera));
  const double plain_ms = median(times_ms.front());
  for (std::size_t v = 0; v < variants.size(); ++v) {
    const Errors errors = compare(simulations[v].color(camera), reference);
    const double ms = median(times_ms[v]);
    std::printf("%s,%s,%d,%d,%d,%.3f,%.3f,%.6f,%.4f,%.2f\n", scene.stem().c_str(), camera.c_str(),
                variants[v].supersampling, variants[v].msaa, variants[v].samples(), ms, ms / plain_ms, errors.linear,
                errors.grey_levels, 20 * std::log10(255 / errors.grey_levels));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 15;
  std::printf("scene,camera,supersampling,msaa,samples,median_ms,ratio,rms_linear,rms_grey_levels,psnr_db\n");
  if (argc > 2) {
    for (int i = 2; i + 1 < argc; i += 2) measure(argv[i], argv[i + 1], frames);
    return 0;
  }
  measure(SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml", "ROBOT_CAM", frames);
  measure(SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml", "ROOM_CAM", frames);
  measure(SIMVIS_SOURCE_DIR "/scenes/arm/arm.xml", "HAND_CAM", frames);
  measure(SIMVIS_SOURCE_DIR "/scenes/arm/arm.xml", "ROOM_CAM", frames);
  return 0;
}
